//! Robots to be fuzzed, with how many waves of each in a small run: shipped ones, and real ones where they are.

use undulate::{CollisionOptions, LoadOptions, MeshFiles, Robot, Srdf, shipped};

/// Two balls of `radius` \[m\] on arms of 1 m that turn about one post. When they are thin, a touch is over in milliseconds.
pub fn carousel(radius: f64) -> Robot {
    let arm = |name: &str| {
        format!(
            r#"<link name="{name}"><collision><origin xyz="1 0 0"/><geometry><sphere radius="{radius}"/></geometry></collision></link>
            <joint name="{name}_joint" type="continuous"><parent link="post"/><child link="{name}"/><axis xyz="0 0 1"/></joint>"#
        )
    };
    Robot::from_urdf(&format!(
        r#"<robot name="carousel"><link name="post"/>{}{}</robot>"#,
        arm("one"),
        arm("two")
    ))
    .unwrap()
}

/// A radius \[m\] with which a touch is easily missed.
pub const THIN: f64 = 0.005;

pub fn robots() -> Vec<(&'static str, Robot, CollisionOptions, u64)> {
    let wave_arm = shipped::robot("wave_arm").unwrap();
    let mut robots = vec![
        ("wave_arm", wave_arm, CollisionOptions::default(), 40),
        (
            "thin_carousel",
            carousel(THIN),
            CollisionOptions::default(),
            200,
        ),
    ];
    if let Some(folder) = crate::common::shared("certificates of real robots") {
        for (name, urdf, srdf) in [
            ("ur5", "ur5/ur5_robot.urdf", Some("ur5/ur5.srdf")),
            ("kuka_kr16_2", "kuka_kr16_2/kr16_2.urdf", None),
        ] {
            let path = folder.join("robots").join(urdf);
            let options = LoadOptions {
                meshes: MeshFiles::Folders(vec![path.parent().unwrap().to_owned()]),
                ..LoadOptions::default()
            };
            let robot = Robot::open_with(&path, options).unwrap();
            let disabled = srdf.map(|file| {
                Srdf::open(&folder.join("robots").join(file))
                    .unwrap()
                    .disabled()
                    .to_vec()
            });
            let options = CollisionOptions {
                disabled: disabled.unwrap_or_default(),
                always_touching: Some((200, 0)),
                ..CollisionOptions::default()
            };
            robots.push((name, robot, options, 60));
        }
    }
    robots
}
