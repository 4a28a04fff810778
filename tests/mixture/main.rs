//! Mixtures of primitives, and learning curves: against plain formulas on dense matrices, with assertions that broken twins fail.

#[path = "../common/mod.rs"]
mod common;
mod conditioning;
mod curve;
mod dense;
mod expectation;
mod files;
mod kinds;
mod sampling;
mod toy;
