//! What several test files need.

use std::path::PathBuf;

/// The folder of real recordings, robots and oracles named by `UNDULATE_SHARED`. Not set: `None`, and one line says what
/// was left out. Set but missing: a failure.
pub fn shared(what: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("UNDULATE_SHARED") else {
        println!("left out, UNDULATE_SHARED is not set: {what}");
        return None;
    };
    // Tests run in the package's folder, as the path in the variable is meant.
    let folder = PathBuf::from(folder);
    assert!(
        folder.is_dir(),
        "UNDULATE_SHARED={} is not a folder",
        folder.display()
    );
    Some(folder)
}
