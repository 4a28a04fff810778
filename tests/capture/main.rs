//! Motion capture to the angles of an arm: skeletons and positions made from known angles, real recordings, and bad files.

#[path = "../common/mod.rs"]
mod common;
mod hostile;
mod known;
mod shared;
#[path = "../common/skeleton.rs"]
mod skeleton;
