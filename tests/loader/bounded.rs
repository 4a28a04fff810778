//! Files loaded in a process of their own, which says how much memory it took.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use undulate::{CollisionModel, CollisionOptions, Robot};

/// Names the file that the child loads.
const FILE: &str = "UNDULATE_LOADER_CHILD";

/// Only a hang takes so long.
const DEADLINE: Duration = Duration::from_secs(300);

/// The largest memory of a process that loads a file \[kB\].
pub const MOST_MEMORY: u64 = 200_000;

/// What became of a file.
#[derive(Debug)]
pub struct Told {
    /// The error, if it was refused.
    pub refused: Option<String>,
    /// Why collision and dynamics are refused, where the file was loaded.
    pub missing: [String; 2],
    /// Why there is no collision model, where the file was loaded.
    pub uncheckable: String,
    pub links: usize,
    pub shapes: usize,
    /// Largest resident memory \[kB\]; 0 where the system does not tell.
    pub memory: u64,
    pub time: Duration,
}

/// Run as a test of its own it does nothing; run by [`load`] it loads one file and says what became of it.
#[test]
fn child() {
    let Some(file) = std::env::var_os(FILE) else {
        return;
    };
    let line = |key: &str, value: &str| println!("\n@{key} {}", value.replace('\n', " "));
    match Robot::open(Path::new(&file)) {
        Err(e) => line("refused", &e.to_string()),
        Ok(robot) => {
            let missing = |result: undulate::Result<()>| {
                result.err().map_or_else(String::new, |e| e.to_string())
            };
            line("collision", &missing(robot.require_collision(0)));
            line("dynamics", &missing(robot.require_dynamics()));
            let model = CollisionModel::new(&robot, &CollisionOptions::default());
            line("uncheckable", &missing(model.map(|_| ())));
            line("links", &robot.links().len().to_string());
            let shapes: usize = robot.bodies().iter().map(|b| b.collision.len()).sum();
            line("shapes", &shapes.to_string());
            // All that `undulate robot` asks.
            let asked = robot.doubts().len() + robot.tips().len();
            assert!(asked > 0 && robot.reach(robot.tip()) >= 0.0);
        }
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let peak = peak.map_or("0", |l| l.trim().trim_end_matches(" kB"));
    line("memory", peak);
    line("end", "");
}

/// Loads `file` in a process of its own. A panic or a hang of that process fails.
pub fn load(file: &Path) -> Told {
    let started = Instant::now();
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "bounded::child", "--nocapture"])
        .env(FILE, file)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > DEADLINE {
            child.kill().unwrap();
            panic!("{} hangs", file.display());
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("\n@end"),
        "{}: {text}{}",
        file.display(),
        String::from_utf8_lossy(&output.stderr)
    );
    let get = |key: &str| {
        let key = format!("@{key} ");
        let value = text.lines().find_map(|l| l.strip_prefix(key.as_str()));
        value.map(ToOwned::to_owned)
    };
    let count = |key: &str| get(key).map_or(0, |n| n.parse().unwrap());
    let told = Told {
        refused: get("refused"),
        missing: ["collision", "dynamics"].map(|key| get(key).unwrap_or_default()),
        uncheckable: get("uncheckable").unwrap_or_default(),
        links: count("links"),
        shapes: count("shapes"),
        memory: count("memory") as u64,
        time: started.elapsed(),
    };
    assert!(
        told.memory < MOST_MEMORY,
        "{}: {} kB",
        file.display(),
        told.memory
    );
    told
}
