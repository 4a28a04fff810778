//! A person's wave on robots whose axes are others: by joint maps where these are exact, and by how far each direction is off.

use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{
    DirectionFit, JointMap, Joints, LoadOptions, MeshFiles, Person, Residual, Robot, RobotArm,
    Segment, ShoulderOrder, Wave, limits, shipped,
};

#[path = "common/mod.rs"]
mod common;
#[path = "common/program.rs"]
mod program;

use program::{fails, files, json};

/// Six angles of an arm that `wave_arm` has too; without the wrist's flexion.
const ANGLES: [(&str, f64, f64); 6] = [
    ("shoulder_flexion", 40.0, 4.0),
    ("shoulder_abduction", 50.0, 5.0),
    ("shoulder_rotation", -60.0, 9.0),
    ("elbow_flexion", 100.0, 14.0),
    ("forearm_pronation", 20.0, 6.0),
    ("wrist_deviation", 5.0, 10.0),
];

/// `wave_arm`'s joints are those angles.
const SAME: &str = "[joints.shoulder_pitch]\nfrom = 'shoulder_flexion'\n[joints.shoulder_roll]\nfrom = 'shoulder_abduction'\n[joints.shoulder_yaw]\nfrom = 'shoulder_rotation'\n[joints.elbow]\nfrom = 'elbow_flexion'\n[joints.forearm]\nfrom = 'forearm_pronation'\n[joints.wrist]\nfrom = 'wrist_deviation'\n";

/// A UR5 that hangs on a wall at the person's right, so that its first axis is the person's from side to side.
const UR5: &str = "forward = [1, 0, 0]\nup = [0, 1, 0]\n[upper_arm]\nlink = 'upper_arm_link'\naxis = [0, 0, 1]\nweight = 0.1\n[forearm]\nlink = 'forearm_link'\naxis = [0, 0, 1]\n[hand]\nlink = 'ee_link'\naxis = [1, 0, 0]\n[palm]\nlink = 'ee_link'\naxis = [0, 1, 0]\nweight = 0.3\n";

/// A person who waves, their elbow first.
fn wave() -> Wave {
    let offsets = ANGLES.iter().map(|j| j.1.to_radians());
    let weights = DMatrix::from_fn(ANGLES.len(), 3, |j, k| {
        let modulus = ANGLES[j].2.to_radians() / 2.0 / (1.0 + 4.0 * k as f64);
        Complex::from_polar(modulus, j as f64 + 2.0 * k as f64)
    });
    Wave::new(
        Joints::new(ANGLES.map(|j| j.0)).unwrap(),
        0.7,
        DVector::from_iterator(ANGLES.len(), offsets),
        weights,
    )
    .unwrap()
}

fn person() -> Person {
    Person::new(wave(), ShoulderOrder::Xzy).unwrap()
}

/// The limits of the robot, its bounds exact over the period.
fn keeps_its_limits(robot: &Robot, fit: &DirectionFit) {
    for used in limits(robot, &fit.wave).unwrap() {
        if used.quantity == undulate::Derivative::Position {
            assert_eq!(used.excess(), 0.0, "{used:?}");
        }
    }
}

fn told(name: &str, residuals: &[Residual]) {
    for r in residuals {
        let [rms, peak] = [r.rms, r.peak].map(f64::to_degrees);
        println!(
            "{name} {}: rms {rms:.2} deg, peak {peak:.2} deg",
            r.segment.name()
        );
    }
}

#[test]
fn the_fit_points_where_an_exact_joint_map_does() {
    let robot = shipped::robot("wave_arm").unwrap();
    let arm = shipped::arm("wave_arm").unwrap();
    let mapped = JointMap::from_toml(SAME)
        .unwrap()
        .apply(&wave(), &robot)
        .unwrap();
    let fit = arm.fit(&person(), &robot, 3).unwrap();
    keeps_its_limits(&robot, &fit);
    assert!(fit.at_limit.is_empty());
    for i in 0..1000 {
        let t = 0.7 * f64::from(i) / 1000.0;
        let at = |wave: &Wave| arm.directions(&robot, wave.position(t).as_slice()).unwrap();
        for (a, b) in at(&fit.wave).iter().zip(at(&mapped)) {
            assert!((a - b).norm() < 1e-6, "{t}: {a} {b}");
        }
    }
    // Nor are the joints others: six directions' worth of angles for six joints.
    assert!((fit.wave.offsets() - mapped.offsets()).amax() < 1e-6);
}

#[test]
fn a_left_arm_is_a_right_one_in_a_mirror() {
    let fit = |name: &str| {
        let robot = shipped::robot(name).unwrap();
        let fit = shipped::arm(name)
            .unwrap()
            .fit(&person(), &robot, 3)
            .unwrap();
        keeps_its_limits(&robot, &fit);
        fit.wave.position(0.2)
    };
    let (right, left) = (fit("wave_arm"), fit("wave_arm_left"));
    for (joint, sign) in [1.0, -1.0, -1.0, 1.0, -1.0, 1.0].into_iter().enumerate() {
        assert!(
            (right[joint] - sign * left[joint]).abs() < 1e-6,
            "{right} {left}"
        );
    }
}

#[test]
fn robots_of_other_axes_come_as_near_as_they_can() {
    for (name, most, weights) in [
        // A ball for a shoulder and seven joints: everything.
        ("column_arm", [1e-6; 4], [1.0; 4]),
        // Six joints, and what weighs most stays near.
        ("table_arm", [60.0, 25.0, 8.0, 8.0], [0.1, 1.0, 1.0, 0.3]),
    ] {
        let robot = shipped::robot(name).unwrap();
        let arm = shipped::arm(name).unwrap();
        // A robot's joints do not move as a person's, so their wave has overtones.
        let fit = arm.fit(&person(), &robot, 12).unwrap();
        told(name, &fit.residuals);
        keeps_its_limits(&robot, &fit);
        let segments: Vec<Segment> = fit.residuals.iter().map(|r| r.segment).collect();
        assert_eq!(segments, Segment::ALL);
        for (residual, most) in fit.residuals.iter().zip(most) {
            assert!(residual.peak.to_degrees() < most, "{name}: {residual:?}");
        }
        // What fewer harmonics cost is told.
        let coarse = arm.fit(&person(), &robot, 1).unwrap();
        let cost = |fit: &DirectionFit| -> f64 {
            let squares = fit.residuals.iter().map(|r| r.rms * r.rms);
            squares
                .zip(weights)
                .map(|(square, weight)| weight * square)
                .sum()
        };
        assert!(cost(&coarse) > cost(&fit), "{name}");
    }
}

#[test]
fn a_ur5_waves_as_a_person_does() {
    let Some(folder) = common::shared("a UR5, and waves of people") else {
        return;
    };
    let ur5 = folder.join("robots/ur5");
    let urdf = ur5.join("ur5_robot.urdf");
    let options = LoadOptions {
        meshes: MeshFiles::Folders(vec![ur5]),
        ..LoadOptions::default()
    };
    let robot = Robot::open_with(&urdf, options).unwrap();
    let arm = RobotArm::from_toml(UR5).unwrap();
    let fit = arm.fit(&person(), &robot, 12).unwrap();
    told("ur5", &fit.residuals);
    keeps_its_limits(&robot, &fit);
    for (residual, most) in fit.residuals.iter().zip([30.0, 10.0, 5.0, 5.0]) {
        assert!(residual.peak.to_degrees() < most, "{residual:?}");
    }

    // People as they were recorded, on every robot.
    let at = tempfile::tempdir().unwrap();
    let waves = folder.join("waves");
    let list = waves.join("sets/A_right_normal_1p5_3hz.txt");
    let [list, root, urdf] = [&list, &waves, &urdf].map(|path| {
        // Tests run in the package's folder, and the program in another.
        std::fs::canonicalize(path).unwrap().display().to_string()
    });
    let learn = [
        "learn",
        "--list",
        &list,
        "--root",
        &root,
        "-o",
        "model.json",
    ];
    program::done(at.path(), &learn);
    program::done(at.path(), &["sample", "model.json", "-o", "wave.json"]);
    std::fs::write(at.path().join("ur5.toml"), UR5).unwrap();
    for (robot, directions, most) in [
        (urdf.as_str(), "ur5.toml", [45.0, 10.0, 5.0, 5.0]),
        ("column_arm", "column_arm", [2.0; 4]),
        ("table_arm", "table_arm", [90.0, 20.0, 10.0, 10.0]),
    ] {
        let fit = [
            "fit",
            "wave.json",
            "--robot",
            robot,
            "--directions",
            directions,
            "-o",
            "out.json",
        ];
        let report = json(at.path(), &fit);
        for (residual, most) in report["residuals"].as_array().unwrap().iter().zip(most) {
            println!("{robot} {residual}");
            assert!(
                residual["peak_deg"].as_f64().unwrap() < most,
                "{robot}: {residual}"
            );
        }
    }
}

#[test]
fn the_verb_writes_a_wave_that_check_takes_and_tells_what_is_off() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("wave.json"), wave().to_json()).unwrap();
    let fit = ["fit", "wave.json", "--robot", "wave_arm", "-o", "out.json"];
    let report = json(at, &fit);
    assert_eq!(report["residuals"].as_array().unwrap().len(), 4);
    assert!(report["residuals"][2]["peak_deg"].as_f64().unwrap() < 1e-4);
    assert_eq!(report["at_limit"], serde_json::json!([]));
    let checked = json(at, &["check", "out.json", "--robot", "wave_arm"]);
    assert_eq!(checked["passes"], true);
    // A forearm that leaves its plane, by what turns in a plane.
    std::fs::write(
        at.join("stiff.toml"),
        "[forearm]\nlink = 'shoulder_pitch_link'\naxis = [0, 0, -1]\n",
    )
    .unwrap();
    let stiff = [&fit[..], &["--directions", "stiff.toml"]].concat();
    let output = program::run(at, &stiff);
    assert_eq!(output.status.code(), Some(0));
    let warned = program::text(&output.stderr);
    assert!(warned.contains("forearm is up to"), "{warned}");
}

#[test]
fn what_cannot_be_fitted_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("wave.json"), wave().to_json()).unwrap();
    let robot = shipped::robot("wave_arm").unwrap();
    let other = JointMap::from_toml(SAME).unwrap().apply(&wave(), &robot);
    std::fs::write(at.join("other.json"), other.unwrap().to_json()).unwrap();
    std::fs::write(
        at.join("arm.urdf"),
        shipped::robot_text("wave_arm").unwrap(),
    )
    .unwrap();
    for (name, text) in [
        ("link.toml", "[hand]\nlink = 'claw'\naxis = [1, 0, 0]\n"),
        ("zero.toml", "[hand]\nlink = 'hand'\naxis = [0, 0, 0]\n"),
        ("still.toml", "[hand]\nlink = 'head'\naxis = [1, 0, 0]\n"),
        ("broken.toml", "[hand\n"),
    ] {
        std::fs::write(at.join(name), text).unwrap();
    }
    let before = files(at);
    for (code, line, words) in [
        (
            1,
            "other.json --robot wave_arm",
            "no joint `shoulder_pitch`",
        ),
        (1, "missing.json --robot wave_arm", "missing.json"),
        (
            1,
            "wave.json --robot wave_arm --directions link.toml",
            "no link `claw`",
        ),
        (
            1,
            "wave.json --robot wave_arm --directions zero.toml",
            "zero.toml, [hand], axis",
        ),
        (
            1,
            "wave.json --robot wave_arm --directions still.toml",
            "no joint moves",
        ),
        (
            1,
            "wave.json --robot wave_arm --directions broken.toml",
            "broken.toml, line 1",
        ),
        (
            1,
            "wave.json --robot wave_arm --directions ur6",
            "no directions `ur6`",
        ),
        (2, "wave.json --robot arm.urdf", "expected --directions"),
        (2, "wave.json --robot wave_arm --harmonics 0", "0 harmonics"),
        (
            2,
            "wave.json --robot wave_arm --harmonics 61",
            "61 harmonics",
        ),
        (
            2,
            "wave.json --robot wave_arm --order yxz",
            "invalid value 'yxz'",
        ),
    ] {
        let line = format!("fit {line} -o out.json");
        let error = fails(at, code, &line.split(' ').collect::<Vec<_>>());
        assert!(error.contains(words), "{line}: {error}");
        assert_eq!(files(at), before, "{line}");
    }
}
