//! What is done with fuzzed bytes: each input is read, and what was read is used, printed, and read again.
//!
//! Nothing here may panic, hang or take more memory than the input accounts for; a refusal is an answer. The same functions are run
//! on all seeds and regressions by `tests/fuzzed.rs`, on any toolchain.

mod capture;
mod distance;
mod gestures;
mod robots;

/// A name, of a folder of seeds too, and what is done with bytes.
pub type Target = (&'static str, fn(&[u8]));

/// What is fuzzed.
pub const TARGETS: [Target; 16] = [
    ("recording", gestures::recording),
    ("bvh", capture::bvh),
    ("positions", capture::positions),
    ("model", gestures::model),
    ("wave", gestures::wave),
    ("condition", gestures::condition),
    ("urdf", robots::urdf),
    ("srdf", robots::srdf),
    ("scene", robots::scene),
    ("joint_map", robots::joint_map),
    ("limits", robots::limits),
    ("moves", robots::moves),
    ("certificate", robots::certificate),
    ("stl", robots::stl),
    ("obj", robots::obj),
    ("distance", distance::distance),
];

/// Runs one of [`TARGETS`].
///
/// # Panics
/// When there is none of this name, and when the target found something.
pub fn run(name: &str, data: &[u8]) {
    let (_, target) = TARGETS
        .iter()
        .find(|(known, _)| *known == name)
        .expect("a name of the table");
    target(data);
}

/// Text, as most readers take it.
fn text(data: &[u8]) -> Option<&str> {
    std::str::from_utf8(data).ok()
}
