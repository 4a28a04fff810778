//! Posteriors by Markov chains: so far, whether chains have mixed.

mod diagnostics;
mod effective;
mod rank;

pub use diagnostics::Diagnostics;
