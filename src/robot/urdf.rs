//! URDF to [`Robot`].

use std::path::Path;

use super::load::{LoadOptions, MeshFiles};
use super::{Robot, bounds, build, lint, reduce};
use crate::error::{Error, ErrorKind, Result};

impl Robot {
    /// Reads a URDF text.
    ///
    /// ```
    /// use undulate::Robot;
    ///
    /// let robot = Robot::from_urdf(r#"<robot name="r">
    ///   <link name="base"/> <link name="arm"/>
    ///   <joint name="shoulder" type="revolute">
    ///     <parent link="base"/> <child link="arm"/> <origin xyz="0 0 1"/> <axis xyz="0 1 0"/>
    ///     <limit lower="-1" upper="1" velocity="3" effort="20"/>
    ///   </joint>
    /// </robot>"#)?;
    /// assert_eq!(robot.joints().name(0), "shoulder");
    /// assert!(robot.require_dynamics().is_err()); // no masses
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_urdf(text: &str) -> Result<Self> {
        Self::load(text, &LoadOptions::default())
    }

    /// Reads a URDF file and the meshes that it names, as far as they lie in its folder.
    ///
    /// # Errors
    /// As [`load`](Self::load), and when the file cannot be read.
    pub fn open(path: &Path) -> Result<Self> {
        Self::open_with(path, LoadOptions::default())
    }

    /// Reads a URDF file. Where `options` name folders for meshes, or nothing, its own folder is looked at first.
    ///
    /// # Errors
    /// As [`load`](Self::load), and when the file cannot be read.
    pub fn open_with(path: &Path, mut options: LoadOptions) -> Result<Self> {
        let text = bounds::read(path)?;
        let own = path.parent().unwrap_or(Path::new("")).to_owned();
        match &mut options.meshes {
            MeshFiles::None => options.meshes = MeshFiles::Folders(vec![own]),
            MeshFiles::Folders(folders) => folders.insert(0, own),
            MeshFiles::Embedded(_) => {}
        }
        Self::load(&text, &options).map_err(|e| e.at(path.display().to_string()))
    }

    /// Reads a URDF text as `options` say.
    ///
    /// A mesh that is not found, not readable or of a format that is not read leaves its body with
    /// [`unread_collision`](super::Body::unread_collision): kinematics do without. One that contradicts itself is an error.
    ///
    /// # Errors
    /// When the text is no URDF of one tree of revolute, continuous, prismatic and fixed joints with finite numbers, asks
    /// for more than a robot needs (16 MB, 300 000 elements), or when `options` name a link or folder that is not there;
    /// the message names line and link or joint. See the errors' texts for each case.
    pub fn load(text: &str, options: &LoadOptions) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.is_empty() {
            return Err(Error::new(ErrorKind::Syntax, "the file is empty").expected("a URDF"));
        }
        let (parsed, doubtful) = {
            let document = lint::parse(text)?;
            let doubtful = lint::lint(&document, options.inertia)?;
            (reduce::parse(&document)?, doubtful)
        };
        build::build(&parsed, &doubtful, options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm of one joint with something inserted in each place.
    fn arm(link: &str, joint: &str, kind: &str, rest: &str) -> String {
        format!(
            r#"<robot name="r">
<link name="base"/>
<link name="arm">{link}</link>
<joint name="shoulder" type="{kind}"><parent link="base"/><child link="arm"/>{joint}</joint>
{rest}</robot>"#
        )
    }

    const LIMIT: &str = r#"<limit lower="-1" upper="1" velocity="2" effort="5"/>"#;

    #[test]
    fn what_is_wrong_is_refused_by_line_and_name() {
        let sphere = |size: &str| {
            format!(r#"<collision><geometry><sphere radius="{size}"/></geometry></collision>"#)
        };
        let inertial = |mass: &str, ixx: &str, iyy: &str| {
            format!(
                r#"<inertial><mass value="{mass}"/><inertia ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="1"/></inertial>"#
            )
        };
        for (text, message) in [
            (String::new(), "the file is empty"),
            ("<robot>".into(), "line 1"),
            ("<model/>".into(), "root element <model>"),
            ("<robot name='r'/>".into(), "no links"),
            (
                arm("", "", "revolute", ""),
                "joint `shoulder`, line 4: a revolute joint without <limit>",
            ),
            (
                arm("", LIMIT, "planar", ""),
                "joint `shoulder`, line 4: a planar joint",
            ),
            (arm("", LIMIT, "hinge", ""), "joint type `hinge`"),
            (
                arm(
                    "",
                    &format!(r#"<axis xyz="0 0 0"/>{LIMIT}"#),
                    "revolute",
                    "",
                ),
                "an axis of length zero",
            ),
            (
                arm("", &format!(r#"<axis xyz="1 0"/>{LIMIT}"#), "revolute", ""),
                "xyz=\"1 0\", expected 3 finite numbers",
            ),
            (
                arm(
                    "",
                    &format!(r#"<origin xyz="1 2 x 3"/>{LIMIT}"#),
                    "revolute",
                    "",
                ),
                "xyz=\"1 2 x 3\"",
            ),
            (
                arm(
                    "",
                    &format!(r#"<origin rpy="0 0 ${{pi}}"/>{LIMIT}"#),
                    "revolute",
                    "",
                ),
                "unexpanded xacro",
            ),
            (
                arm(
                    "",
                    r#"<limit lower="1" upper="-1" velocity="2" effort="5"/>"#,
                    "revolute",
                    "",
                ),
                "lower limit 1 above upper limit -1",
            ),
            (
                arm(
                    "",
                    r#"<limit lower="nan" upper="1" velocity="2" effort="5"/>"#,
                    "revolute",
                    "",
                ),
                "lower=\"nan\"",
            ),
            (
                arm(
                    "",
                    r#"<limit lower="0" upper="1" velocity="-2" effort="5"/>"#,
                    "revolute",
                    "",
                ),
                "negative velocity",
            ),
            (
                arm(
                    "",
                    &format!(r#"{LIMIT}<mimic joint="shoulder"/>"#),
                    "revolute",
                    "",
                ),
                "comes back to itself",
            ),
            (
                arm(
                    "",
                    &format!(r#"{LIMIT}<mimic joint="ghost"/>"#),
                    "revolute",
                    "",
                ),
                "no joint `ghost` to mimic",
            ),
            (
                arm("", LIMIT, "revolute", r#"<link name="arm"/>"#),
                "two links are called `arm`",
            ),
            (
                arm("", LIMIT, "revolute", r#"<link name="loose"/>"#),
                "2 roots",
            ),
            (
                arm(
                    "",
                    LIMIT,
                    "revolute",
                    r#"<joint name="j" type="fixed"><parent link="arm"/><child link="ghost"/></joint>"#,
                ),
                "no link `ghost` to be its child",
            ),
            (
                arm(
                    "",
                    LIMIT,
                    "revolute",
                    r#"<joint name="j" type="fixed"><parent link="arm"/><child link="base"/></joint>"#,
                ),
                "cycle",
            ),
            (
                arm(
                    "",
                    LIMIT,
                    "revolute",
                    r#"<joint name="j" type="fixed"><parent link="base"/><child link="arm"/></joint>"#,
                ),
                "two parents",
            ),
            (
                arm(&sphere("-1"), LIMIT, "revolute", ""),
                "radius=\"-1\", expected positive lengths",
            ),
            (
                arm(&inertial("NaN", "1", "1"), LIMIT, "revolute", ""),
                "value=\"NaN\"",
            ),
            (
                arm(&inertial("1", "-1", "1"), LIMIT, "revolute", ""),
                "not positive semidefinite",
            ),
            (
                format!(
                    "<!DOCTYPE r [<!ENTITY a 'b'>]>{}",
                    arm("", LIMIT, "revolute", "")
                ),
                "a document type declaration",
            ),
            (
                format!("<robot>{}{}</robot>", "<a>".repeat(100), "</a>".repeat(100)),
                "nest deeper",
            ),
        ] {
            let error = Robot::from_urdf(&text).unwrap_err().to_string();
            assert!(
                error.contains(message),
                "expected `{message}`, got: {error}"
            );
        }
    }

    #[test]
    fn elements_are_no_back_door_for_attributes() {
        let limit = r#"<limit velocity="2"><lower>-9</lower><upper>nan</upper></limit>"#;
        let origin = format!(r#"<origin><xyz>nan 0 0</xyz></origin>{LIMIT}"#);
        let twice = format!(r#"{LIMIT}<limit lower="-9" upper="9" velocity="2"/>"#);
        let far = format!(r#"<origin xyz="1.5e308 0 0"/>{LIMIT}"#);
        let long = format!(r#"<axis xyz="0 1e200 0"/>{LIMIT}"#);
        for (joint, message) in [
            (limit, "<limit> with elements inside"),
            (&origin, "<origin> with elements inside"),
            (&twice, "a second <limit>"),
            (&far, "numbers within"),
            (&long, "numbers within"),
        ] {
            let error = Robot::from_urdf(&arm("", joint, "revolute", ""))
                .unwrap_err()
                .to_string();
            assert!(
                error.contains(message),
                "expected `{message}`, got: {error}"
            );
        }
        let visual =
            r#"<visual><origin xyz="nan 0 0"/><geometry><sphere radius="1"/></geometry></visual>"#;
        assert!(Robot::from_urdf(&arm(visual, LIMIT, "revolute", "")).is_err());
    }

    #[test]
    fn position_limits_of_zero_hold() {
        let text = arm("", r#"<limit velocity="1"/>"#, "revolute", "");
        let robot = Robot::from_urdf(&text).unwrap();
        assert_eq!(
            robot.properties(0).position.map(|p| (p.lower, p.upper)),
            Some((0.0, 0.0))
        );
        assert!(
            robot.notes().iter().any(|n| n.contains("may not move")),
            "{:?}",
            robot.notes()
        );
    }

    #[test]
    fn leftovers_in_attributes_that_are_not_read_do_no_harm() {
        let text = arm(
            "",
            LIMIT,
            "revolute",
            r#"<ros2_control name="${name}"/><gazebo reference="${x}"/>"#,
        );
        assert!(Robot::from_urdf(&text).is_ok());
    }

    #[test]
    fn an_axis_is_x_unless_given_and_is_normalised() {
        let text = arm("", LIMIT, "revolute", "");
        let axis = |text: &str| {
            let robot = Robot::from_urdf(text).unwrap();
            robot.bodies()[1].joint.clone().unwrap().axis.into_inner()
        };
        assert_eq!(axis(&text), nalgebra::Vector3::x());
        let text = arm(
            "",
            &format!(r#"<axis xyz="0 3 0"/>{LIMIT}"#),
            "revolute",
            "",
        );
        assert_eq!(axis(&text), nalgebra::Vector3::y());
    }

    #[test]
    fn limits_of_zero_are_not_given() {
        let robot = Robot::from_urdf(&arm(
            "",
            r#"<limit lower="-1" upper="1" velocity="0" effort="0"/>"#,
            "revolute",
            "",
        ))
        .unwrap();
        assert_eq!(robot.properties(0).velocity, None);
        assert_eq!(robot.properties(0).effort, None);
        assert!(
            robot.notes().iter().any(|n| n.contains("`shoulder`")),
            "{:?}",
            robot.notes()
        );
    }
}
