//! Mixtures.

#[path = "../common/mod.rs"]
mod common;
mod real;
