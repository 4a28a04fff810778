//! The loader: real robots load as far as their files allow, and no file takes more than its bounds.

#[path = "../common/mod.rs"]
mod common;

mod bounded;
mod hostile;

use std::path::{Path, PathBuf};

use common::shared;
use undulate::{Robot, Srdf};

/// What each robot of the shared folder has beyond kinematics: collision geometry that can be read, inertia of all that
/// moves. The counts of joints and the longest chains are those of the folder's own table.
const HAS: [(&str, bool, bool); 10] = [
    ("ur5", true, true),
    ("doosan_m1013", false, true),
    ("fanuc_m10ia", true, false),
    ("so_arm100", false, true),
    ("abb_irb2400", true, false),
    ("kuka_kr16_2", true, true),
    ("franka_panda", false, false),
    ("kinova_gen3_2f85", false, true),
    ("pepper", false, true),
    ("wx250s_6dof", true, true),
];

/// Robot, file, degrees of freedom, longest chain: rows of the table in the folder's README.
fn listed(folder: &Path) -> Vec<(String, PathBuf, usize, usize)> {
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    readme
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let (dof, chain) = (cells.get(4)?.parse().ok()?, cells.get(5)?.parse().ok()?);
            Some((cells[1].to_owned(), folder.join(cells[2]), dof, chain))
        })
        .collect()
}

#[test]
fn every_real_robot_loads_as_far_as_its_file_allows() {
    let Some(folder) = shared("real robots") else {
        return;
    };
    let rows = listed(&folder.join("robots"));
    assert_eq!(rows.len(), HAS.len());
    for (name, file, dof, chain) in rows {
        // Packages are looked for beside the file: its folder is the first root.
        let robot = Robot::open(&file).unwrap();
        let (_, collision, dynamics) = HAS.iter().find(|(n, ..)| *n == name).unwrap();
        let longest = robot.tips().into_iter().map(|tip| {
            let chain = robot.chain(tip);
            chain.iter().filter(|j| j.is_commanded).count()
        });
        println!(
            "{name}: tip {}, reach {:.3} m, {:?}, {:?}",
            robot.tip().name,
            robot.reach(robot.tip()),
            robot.require_collision(0).err(),
            robot.require_dynamics().err()
        );
        assert_eq!(robot.joints().len(), dof, "{name}: joints");
        assert_eq!(longest.max(), Some(chain), "{name}: longest chain");
        let own = robot.chain(robot.tip());
        let own = own.iter().filter(|j| j.is_commanded).count();
        assert_eq!(own, chain, "{name}: the tip's chain");
        assert_eq!(
            robot.require_collision(0).is_ok(),
            *collision,
            "{name}: collision"
        );
        assert_eq!(
            robot.require_dynamics().is_ok(),
            *dynamics,
            "{name}: dynamics"
        );
        // What is drawn and collided with is somewhere near the robot: scales and units were read.
        let reach = robot.reach(robot.tip());
        assert!(reach > 0.1 && reach < 6.0, "{name}: {reach} m");
        for solid in robot.bodies().iter().flat_map(|b| &b.collision) {
            assert!(solid.shape.radius() < 2.0, "{name}: {:?}", solid.pose);
        }
    }
}

#[test]
fn the_srdf_of_a_real_robot_names_its_links() {
    let Some(folder) = shared("a real SRDF") else {
        return;
    };
    let folder = folder.join("robots/ur5");
    let robot = Robot::open(&folder.join("ur5_robot.urdf")).unwrap();
    let srdf = Srdf::open(&folder.join("ur5.srdf")).unwrap();
    let text = std::fs::read_to_string(folder.join("ur5.srdf")).unwrap();
    let pairs = text.matches("<disable_collisions").count();
    assert_eq!(srdf.disabled().len(), pairs);
    assert_eq!(srdf.told(&robot), [""; 0]);
}
