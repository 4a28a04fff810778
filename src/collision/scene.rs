//! What stands around the robot: tables, walls, people.

use std::path::Path;

use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::error::{Error, ErrorKind, Result};
use crate::geometry::{HalfSpace, Shape};
use crate::units::parse_angle;

/// No more objects: time grows with them.
const MOST_OBJECTS: usize = 10_000;

/// Objects that stand still in the base frame of the robot.
///
/// ```
/// use undulate::Scene;
///
/// let scene = Scene::from_toml(r#"
/// [[object]]
/// name = "table"
/// half_space = { normal = [0, 0, 1], offset = -0.02 }   # everything below z = -2 cm
///
/// [[object]]
/// name = "shelf"
/// box = { size = [0.4, 0.3, 0.02] }                     # lengths along x, y, z [m]
/// position = [0.6, 0.2, 0.8]
/// rpy = ["0deg", "0deg", "30deg"]                       # about the fixed x, then y, then z
///
/// [[object]]
/// name = "arm of a person"
/// capsule = { from = [0.9, 0.0, 1.3], to = [0.7, -0.2, 1.1], radius = 0.06 }
/// "#)?;
/// assert_eq!(scene.objects().len(), 3);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    objects: Vec<SceneObject>,
}

/// An object of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneObject {
    /// Its name, which no other object has.
    pub name: String,
    /// What and where it is, in the base frame.
    pub shape: SceneShape,
}

/// What an object is.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneShape {
    /// A shape, at a pose of its centre.
    Solid(Shape, Isometry3<f64>),
    /// All that is behind a plane: a floor, a table top without an edge, a wall.
    HalfSpace(HalfSpace),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    object: Vec<ObjectEntry>,
}

/// One of the shapes, and where it is.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectEntry {
    name: String,
    #[serde(rename = "box")]
    cuboid: Option<BoxEntry>,
    sphere: Option<SphereEntry>,
    cylinder: Option<RoundEntry>,
    capsule: Option<RoundEntry>,
    half_space: Option<HalfSpaceEntry>,
    position: Option<[f64; 3]>,
    rpy: Option<[AngleEntry; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxEntry {
    size: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SphereEntry {
    radius: f64,
}

/// About z with a length, or from one end of the axis to the other.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoundEntry {
    radius: f64,
    length: Option<f64>,
    from: Option<[f64; 3]>,
    to: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HalfSpaceEntry {
    normal: [f64; 3],
    #[serde(default)]
    offset: f64,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum AngleEntry {
    Radians(f64),
    Text(String),
}

impl Scene {
    /// Objects, the names of which differ.
    ///
    /// # Errors
    /// When two have the same name, or there are more than ten thousand.
    pub fn new(objects: Vec<SceneObject>) -> Result<Self> {
        if objects.len() > MOST_OBJECTS {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} objects", objects.len()))
                    .expected(format!("at most {MOST_OBJECTS}")),
            );
        }
        let mut names: Vec<&str> = objects.iter().map(|o| o.name.as_str()).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|w| w[0] == w[1]) {
            return Err(Error::new(
                ErrorKind::Name,
                format!("two objects are called `{}`", twice[0]),
            ));
        }
        Ok(Self { objects })
    }

    /// Reads a scene: a table `[[object]]` each, with a `name`, one of `box`, `sphere`, `cylinder`, `capsule` and `half_space`, and
    /// `position` \[m\] and `rpy` (rad, or text such as `"30deg"`) of its centre where that is not said otherwise.
    ///
    /// # Errors
    /// When the text is no TOML of that form, a length is not positive and finite, or a name is there twice.
    pub fn from_toml(text: &str) -> Result<Self> {
        let file: File = toml::from_str(text).map_err(|e| {
            Error::new(ErrorKind::Syntax, e.to_string().trim().to_owned()).expected("a scene")
        })?;
        let objects = file
            .object
            .into_iter()
            .map(|entry| {
                let place = format!("object `{}`", entry.name);
                entry.object().map_err(|e| e.at(place))
            })
            .collect::<Result<Vec<_>>>()?;
        Self::new(objects)
    }

    /// Reads a scene file.
    ///
    /// # Errors
    /// Those of [`from_toml`](Self::from_toml), and when the file cannot be read.
    pub fn open(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, &e))?;
        Self::from_toml(&text).map_err(|e| e.at(path.display().to_string()))
    }

    /// The objects, as given.
    pub fn objects(&self) -> &[SceneObject] {
        &self.objects
    }
}

impl ObjectEntry {
    fn object(self) -> Result<SceneObject> {
        let given = [
            self.cuboid.is_some(),
            self.sphere.is_some(),
            self.cylinder.is_some(),
            self.capsule.is_some(),
            self.half_space.is_some(),
        ];
        let count = given.iter().filter(|g| **g).count();
        if count != 1 {
            return Err(Error::new(ErrorKind::Shape, format!("{count} shapes"))
                .expected("one of box, sphere, cylinder, capsule, half_space"));
        }
        let placed = self.position.is_some() || self.rpy.is_some();
        let pose = pose(self.position, self.rpy)?;
        let shape = if let Some(entry) = self.half_space {
            if placed {
                return Err(Error::new(ErrorKind::Shape, "a half-space with a position")
                    .expected("its normal and its offset from the origin along it"));
            }
            SceneShape::HalfSpace(HalfSpace::new(entry.normal.into(), entry.offset)?)
        } else if let Some(entry) = self.cuboid {
            let size = entry.size.map(length);
            let [x, y, z] = size;
            SceneShape::Solid(
                Shape::Box {
                    half_extents: Vector3::new(x?, y?, z?) / 2.0,
                },
                pose,
            )
        } else if let Some(entry) = self.sphere {
            let radius = length(entry.radius)?;
            SceneShape::Solid(Shape::Sphere { radius }, pose)
        } else if let Some(entry) = self.cylinder {
            let (radius, length, pose) = entry.placed(pose, placed)?;
            SceneShape::Solid(Shape::Cylinder { radius, length }, pose)
        } else if let Some(entry) = self.capsule {
            let (radius, length, pose) = entry.placed(pose, placed)?;
            SceneShape::Solid(Shape::Capsule { radius, length }, pose)
        } else {
            return Err(Error::new(ErrorKind::Shape, "no shape"));
        };
        Ok(SceneObject {
            name: self.name,
            shape,
        })
    }
}

impl RoundEntry {
    /// Radius, length of the axis, and pose.
    fn placed(self, pose: Isometry3<f64>, is_placed: bool) -> Result<(f64, f64, Isometry3<f64>)> {
        let radius = length(self.radius)?;
        match (self.length, self.from, self.to) {
            (Some(axis), None, None) => Ok((radius, length(axis)?, pose)),
            (None, Some(from), Some(to)) if !is_placed => {
                let (from, to) = (coordinates(from)?, coordinates(to)?);
                let along = to - from;
                let turn =
                    Rotation3::rotation_between(&Vector3::z(), &along).unwrap_or_else(|| {
                        Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
                    });
                let middle = Point3::from((from + to) / 2.0);
                let pose = Isometry3::from_parts(
                    Translation3::from(middle),
                    UnitQuaternion::from_rotation_matrix(&turn),
                );
                Ok((radius, length(along.norm())?, pose))
            }
            _ => Err(Error::new(ErrorKind::Shape, "an axis that is not clear")
                .expected("`length` with a position, or `from` and `to` alone")),
        }
    }
}

fn pose(position: Option<[f64; 3]>, rpy: Option<[AngleEntry; 3]>) -> Result<Isometry3<f64>> {
    let position = coordinates(position.unwrap_or([0.0; 3]))?;
    let angle = |entry: &AngleEntry| match entry {
        AngleEntry::Radians(angle) if angle.is_finite() => Ok(*angle),
        AngleEntry::Radians(angle) => {
            Err(Error::new(ErrorKind::Value, format!("an angle of {angle}")))
        }
        AngleEntry::Text(text) => parse_angle(text),
    };
    let turn = match &rpy {
        None => UnitQuaternion::identity(),
        Some([roll, pitch, yaw]) => {
            UnitQuaternion::from_euler_angles(angle(roll)?, angle(pitch)?, angle(yaw)?)
        }
    };
    Ok(Isometry3::from_parts(Translation3::from(position), turn))
}

/// Coordinates and lengths beyond this \[m\] are no surroundings.
const FARTHEST: f64 = 1e6;

fn coordinates(point: [f64; 3]) -> Result<Vector3<f64>> {
    if point.iter().all(|x| x.abs() <= FARTHEST) {
        return Ok(point.into());
    }
    Err(
        Error::new(ErrorKind::Value, format!("a point at {point:?}"))
            .expected(format!("coordinates within {FARTHEST:e} m")),
    )
}

fn length(length: f64) -> Result<f64> {
    if length > 0.0 && length <= FARTHEST {
        return Ok(length);
    }
    Err(
        Error::new(ErrorKind::Value, format!("a length of {length} m"))
            .expected(format!("more than 0, at most {FARTHEST:e}")),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_reaches_from_end_to_end() {
        let scene = Scene::from_toml(
            "[[object]]\nname = \"a\"\ncapsule = { from = [1, 2, 3], to = [1, 2, 1], radius = 0.1 }",
        )
        .unwrap();
        let SceneShape::Solid(Shape::Capsule { radius, length }, pose) = &scene.objects()[0].shape
        else {
            panic!("{scene:?}");
        };
        assert_eq!((*radius, *length), (0.1, 2.0));
        let end = pose * Point3::new(0.0, 0.0, 1.0);
        assert!((end - Point3::new(1.0, 2.0, 1.0)).norm() < 1e-12, "{end}");
    }

    /// About fixed axes: roll about x first, then pitch about y, then yaw about z.
    #[test]
    fn an_object_is_turned_as_rpy_says() {
        let scene = Scene::from_toml(
            "[[object]]\nname = \"a\"\nbox = { size = [1, 2, 3] }\nrpy = [\"90deg\", 0, \"180deg\"]\nposition = [1, 0, 0]",
        )
        .unwrap();
        let SceneShape::Solid(_, pose) = &scene.objects()[0].shape else {
            panic!("{scene:?}");
        };
        for (from, to) in [
            (Vector3::x(), -Vector3::x()),
            (Vector3::y(), Vector3::z()),
            (Vector3::z(), Vector3::y()),
        ] {
            assert!((pose * from - to).norm() < 1e-12, "{from} {to}");
        }
        assert_eq!(pose.translation.vector, Vector3::x());
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, message) in [
            ("[[object]]\nname = \"a\"", "object `a`: 0 shapes"),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = 1 }\nbox = { size = [1, 1, 1] }",
                "2 shapes",
            ),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = 0 }",
                "a length of 0 m",
            ),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = nan }",
                "a length of NaN m",
            ),
            (
                "[[object]]\nname = \"a\"\nbox = { size = [1, -1, 1] }",
                "a length of -1 m",
            ),
            (
                "[[object]]\nname = \"a\"\nhalf_space = { normal = [0, 0, 0] }",
                "a half-space of normal",
            ),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = 1 }\nposition = [inf, 0, 0]",
                "a point at",
            ),
            (
                "[[object]]\nname = \"a\"\ncapsule = { radius = 1 }",
                "an axis that is not clear",
            ),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = 1 }\nrpy = [\"1\", \"x\", \"1\"]",
                "angle `x`",
            ),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = 1, colour = 3 }",
                "unknown field `colour`",
            ),
            (
                "[[object]]\nname = \"a\"\nsphere = { radius = 1 }\n[[object]]\nname = \"a\"\nsphere = { radius = 1 }",
                "two objects are called `a`",
            ),
        ] {
            let error = Scene::from_toml(text).unwrap_err().to_string();
            assert!(
                error.contains(message),
                "expected `{message}`, got: {error}"
            );
        }
    }
}
