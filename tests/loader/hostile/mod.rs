//! Files that are wrong in every way that was thought of. None panics, hangs, reads outside its folder or takes more
//! memory than a robot needs.

mod meshes;
mod robots;
mod texts;

use std::path::Path;

use super::bounded::{MOST_MEMORY, load};
use super::common::shared;
use meshes::{meshes, ways_out};
use robots::robots;
use texts::texts;
use undulate::{Inconsistent, LoadOptions, Robot};

/// What must become of a file.
enum Must {
    /// Refused, and the message says this.
    Refuse(&'static str),
    /// Loaded, with so many links.
    Load(usize),
    /// Loaded, and the collision geometry is refused with these words.
    Unread(&'static str),
    /// Loaded, and dynamics are refused with these words.
    Still(&'static str),
}
use Must::{Load, Refuse, Still, Unread};

const LIMIT: &str = r#"<limit lower="-1" upper="1" velocity="2" effort="5"/>"#;

/// An arm of one joint with something put into each place.
fn arm(link: &str, joint: &str, rest: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">{link}</link>\n\
        <joint name=\"shoulder\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/>{joint}</joint>\n{rest}</robot>\n"
    )
}

fn limits(limit: &str) -> String {
    arm("", &format!("<limit {limit}/>"), "")
}

fn more(rest: &str) -> String {
    arm("", LIMIT, rest)
}

fn collision(geometry: &str) -> String {
    arm(
        &format!("<collision><geometry>{geometry}</geometry></collision>"),
        LIMIT,
        "",
    )
}

fn mesh(name: &str) -> String {
    collision(&format!("<mesh filename=\"{name}\"/>"))
}

fn inertial(mass: &str, diagonal: [&str; 3]) -> String {
    let [x, y, z] = diagonal;
    let text = format!(
        r#"<inertial><mass value="{mass}"/><inertia ixx="{x}" ixy="0" ixz="0" iyy="{y}" iyz="0" izz="{z}"/></inertial>"#
    );
    arm(&text, LIMIT, "")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}</joint>"
    )
}

/// `links` links in a row; what `inside` says of each joint.
fn chain(links: usize, link: &str, inside: impl Fn(usize) -> String) -> String {
    let mut text = "<robot name=\"r\">".to_owned();
    for i in 0..links {
        text.push_str(&format!("<link name=\"l{i}\">{link}</link>"));
        if i > 0 {
            let (parent, child) = (format!("l{}", i - 1), format!("l{i}"));
            text.push_str(&joint(
                &format!("j{i}"),
                "continuous",
                &parent,
                &child,
                &inside(i),
            ));
        }
    }
    text + "</robot>"
}

#[test]
fn whatever_is_wrong_is_told_within_bounds_of_memory() {
    let base = tempfile::tempdir().unwrap();
    std::fs::write(base.path().join("secret.stl"), "solid secret").unwrap();
    let folder = base.path().join("robot");
    std::fs::create_dir(&folder).unwrap();
    let cases: Vec<_> = [meshes(&folder), ways_out(&folder), texts(), robots()]
        .into_iter()
        .flatten()
        .collect();
    assert!(cases.len() >= 39, "{}", cases.len());
    let mut most = 0;
    for (name, content, must) in cases {
        let file = folder.join(format!("{name}.urdf"));
        std::fs::write(&file, content).unwrap();
        let told = load(&file);
        println!("{name}: {} MB, {:.1?}", told.memory / 1000, told.time);
        most = most.max(told.memory);
        let refused = told.refused.clone().unwrap_or_default();
        assert!(
            refused.len() < 2000,
            "{name}: {} bytes of error",
            refused.len()
        );
        let fits = match must {
            Refuse(why) => refused.contains(why),
            Load(links) => told.refused.is_none() && told.links == links,
            Unread(why) => told.refused.is_none() && told.missing[0].contains(why),
            Still(why) => told.refused.is_none() && told.missing[1].contains(why),
        };
        assert!(fits, "{name}: {told:?}");
        assert!(
            name != "shaped_snake" || told.uncheckable.is_empty(),
            "{told:?}"
        );
        assert!(
            name != "long_shaped_snake" || told.uncheckable.contains("at most 4000000"),
            "{told:?}"
        );
        assert!(
            name != "shapes_by_shapes" || told.uncheckable.contains("pairs of shapes"),
            "{told:?}"
        );
        // The second shape of a geometry is not read, for it was not looked at.
        assert!(name != "two_shapes" || told.shapes == 1, "{told:?}");
        // Told as the file's, wherever in it the fault is.
        assert!(
            refused.is_empty() || refused.contains(&format!("{name}.urdf")),
            "{refused}"
        );
        std::fs::remove_file(&file).unwrap();
    }
    println!("at most {} MB", most / 1000);
    assert!(most < MOST_MEMORY);
}

#[test]
fn hostile_files_get_what_their_manifest_says() {
    let Some(folder) = shared("hostile URDFs") else {
        return;
    };
    let folder = folder.join("hostile");
    let manifest = std::fs::read_to_string(folder.join("manifest.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(manifest.as_bytes());
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 24);
    for row in &rows {
        let (name, expected) = (&row[0], &row[2]);
        let told = load(&folder.join(name));
        println!("{name}: {told:?}");
        let loaded = told.refused.is_none();
        let [collision, dynamics] = &told.missing;
        let fits = match name {
            // Kinematics do without the mesh, and what is outside is not read.
            "46_mesh_traversal.urdf" => loaded && collision.contains("leads out of the folders"),
            "49_mesh_missing.urdf" => loaded && collision.contains("no such file"),
            "51_mesh_lying_stl.urdf" => !loaded,
            _ if expected.starts_with("load") => loaded,
            _ if expected.starts_with("kinematics ok") || expected.contains("singular") => {
                loaded && dynamics.contains("link `")
            }
            _ => !loaded,
        };
        assert!(fits, "{name}, {expected}: {told:?}");
    }
}

#[test]
fn what_is_no_file_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    assert!(Robot::open(folder.path()).is_err());
    assert!(Robot::open(&folder.path().join("none.urdf")).is_err());
    #[cfg(unix)]
    for endless in ["/dev/zero", "/dev/null"] {
        assert!(Robot::open(Path::new(endless)).is_err(), "{endless}");
    }
}

#[test]
fn mended_inertias_are_said_and_make_dynamics_possible() {
    let options = LoadOptions {
        inertia: Inconsistent::Mend,
        ..LoadOptions::default()
    };
    for diagonal in [["1", "1", "5"], ["1", "-1", "1"]] {
        let text = inertial("1", diagonal);
        let robot = Robot::load(&text, &options).unwrap();
        robot.require_dynamics().unwrap();
        let notes = robot.notes().join("\n");
        assert!(
            notes.contains("link `arm`") && notes.contains("mended"),
            "{notes}"
        );
        let kept = Robot::from_urdf(&text).and_then(|robot| robot.require_dynamics());
        assert!(kept.is_err());
    }
    // A sound one stays as it is.
    let text = inertial("1", ["1", "2", "3"]);
    let moments = |options: &LoadOptions| {
        let robot = Robot::load(&text, options).unwrap();
        robot.bodies()[1].inertial.clone().unwrap()
    };
    assert_eq!(moments(&options), moments(&LoadOptions::default()));
}

#[test]
fn a_negative_scale_mirrors() {
    let folder = tempfile::tempdir().unwrap();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(folder.path().join("a.obj"), corners).unwrap();
    let file = folder.path().join("r.urdf");
    let text = collision(r#"<mesh filename="a.obj" scale="-1 0.5 2"/>"#);
    std::fs::write(&file, text).unwrap();
    let robot = Robot::open(&file).unwrap();
    let undulate::Shape::Hull(hull) = &robot.bodies()[1].collision[0].shape else {
        panic!("a mesh becomes a hull");
    };
    let mut found: Vec<[f64; 3]> = hull.vertices().iter().map(|v| v.coords.into()).collect();
    found.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let expected = [
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 6.0],
        [0.0, 1.0, 0.0],
    ];
    assert_eq!(found, expected);
    assert!((hull.volume() - 1.0).abs() < 1e-12);
}
