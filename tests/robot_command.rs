//! `undulate robot`, and how the other verbs read robots.

#[path = "common/program.rs"]
mod program;

use program::{done, fails, json};

const ARM: &str = r#"<robot name="arm">
<link name="base"><collision><geometry><box size="1 1 0.1"/></geometry></collision></link>
<link name="upper"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="5"/></inertial>
<collision><geometry><mesh filename="package://arm/meshes/upper.obj" scale="0.5 0.5 0.5"/></geometry></collision></link>
<link name="palm"/><link name="finger"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 2 0"/>
<limit lower="-90" upper="90" velocity="3" effort="0"/></joint>
<joint name="wrist" type="fixed"><parent link="upper"/><child link="palm"/><origin xyz="0 0 1"/></joint>
<joint name="curl" type="continuous"><parent link="palm"/><child link="finger"/><mimic joint="shoulder" multiplier="2"/></joint>
</robot>"#;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn a_robot_is_described_with_what_is_missing_mended_and_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir_all(at.join("share/arm/meshes")).unwrap();
    std::fs::write(at.join("arm.urdf"), ARM).unwrap();
    std::fs::write(at.join("share/arm/meshes/upper.obj"), CUBE).unwrap();
    std::fs::write(
        at.join("arm.srdf"),
        r#"<robot name="arm"><disable_collisions link1="base" link2="palm"/></robot>"#,
    )
    .unwrap();

    let bare = json(at, &["robot", "arm.urdf"]);
    assert!(bare["missing"]["kinematics"].is_null());
    let missing = |key: &str| bare["missing"][key].as_str().unwrap().to_owned();
    assert!(
        missing("collision").contains("package://arm/meshes/upper.obj"),
        "{bare}"
    );
    assert!(
        missing("dynamics").contains("line 3: principal moments"),
        "{bare}"
    );

    let full = [
        "robot",
        "arm.urdf",
        "--meshes",
        "share",
        "--srdf",
        "arm.srdf",
        "--mend-inertia",
        "--measure",
        "--tip",
        "palm",
    ];
    let told = json(at, &full);
    assert!(told["missing"]["collision"].is_null(), "{told}");
    assert_eq!(told["bodies"][1]["shapes"][0]["corners"], 4);
    assert_eq!(told["tip"], "palm");
    assert_eq!(told["tips"], serde_json::json!(["finger"]));
    assert_eq!(told["reach_m"], 1.0);
    assert_eq!(told["mass_kg"], 2.0);
    assert_eq!(told["links"][2]["kind"], "fixed");
    assert_eq!(told["joints"][1]["follows"]["multiplier"], 2.0);
    assert_eq!(told["srdf"]["disabled"][0][1], "palm");
    // The hull of a tetrahedron is itself.
    let gap = told["enclosures"][0]["largest_gap_m"][1].as_f64().unwrap();
    assert!(gap < 1e-3, "{told}");
    let notes = told["notes"].to_string();
    for note in ["mended", "no effort limit", "axis of length 2.000e0"] {
        assert!(notes.contains(note), "{note}: {notes}");
    }
    assert!(told["doubts"].to_string().contains("degrees?"), "{told}");

    let words = done(at, &full);
    for word in [
        "robot `arm`: 1 joints, 4 links in 3 bodies, 2.000 kg",
        "tip `palm` of finger; it reaches at most 1.000 m",
        "    upper  <- shoulder, revolute about y",
        "      palm  <- wrist, fixed",
        "= 2 shoulder",
        "hull of 4 corners",
        "SRDF: 1 pairs disabled",
        "looks wrong:",
    ] {
        assert!(words.contains(word), "lacks `{word}`: {words}");
    }
    // Taken apart, a convex mesh stays whole.
    let parts = json(
        at,
        &["robot", "arm.urdf", "--meshes", "share", "--decompose", "4"],
    );
    assert_eq!(parts["bodies"][1]["shapes"].as_array().unwrap().len(), 1);
}

#[test]
fn what_cannot_be_described_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("arm.urdf"), ARM).unwrap();
    std::fs::write(at.join("cut.urdf"), &ARM[..200]).unwrap();
    for (code, arguments, word) in [
        (1, vec!["robot", "nobody"], "no robot `nobody`"),
        (1, vec!["robot", "cut.urdf"], "cut.urdf, line"),
        (1, vec!["robot", "arm.urdf", "--meshes", "none"], "none: "),
        (1, vec!["robot", "arm.urdf", "--srdf", "none"], "none: "),
        (
            1,
            vec!["robot", "arm.urdf", "--tip", "toe"],
            "no link `toe`",
        ),
        (
            2,
            vec!["robot", "arm.urdf", "--decompose", "0"],
            "1 to 64 parts",
        ),
    ] {
        let error = fails(at, code, &arguments);
        assert!(
            error.contains(word),
            "{arguments:?} lacks `{word}`: {error}"
        );
    }
}
