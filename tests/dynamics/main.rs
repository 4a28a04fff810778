//! Kinematics and dynamics against textbooks, against laws that hold for every robot, and against Pinocchio.

#[path = "../common/mod.rs"]
mod common;

mod laws;
mod pinocchio;
mod swing;
mod textbook;
