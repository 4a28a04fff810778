//! Standard normal vectors that shrink towards 0, where they are most typical.

use proptest::strategy::{NewTree, Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use crate::normal;

/// The scale is known to this share of what was drawn; it is sought by halving.
const FINEST: f64 = 1.0 / 64.0;

/// A standard normal vector, and which of some parts are to be silent.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Draw {
    pub z: Vec<f64>,
    pub silent: Vec<bool>,
}

/// Standard normal vectors of so many entries, with so many parts, none of them silent. They shrink in three stages:
///
/// 1. the whole vector towards 0, by halving: the least length at which the case still fails, along the direction that was drawn;
/// 2. entries to 0, by halves, quarters and so on down to single ones, and what is left of the vector as a whole again;
/// 3. parts to silence, one after the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Latent {
    pub entries: usize,
    pub parts: usize,
}

impl Strategy for Latent {
    type Tree = LatentTree;
    type Value = Draw;

    fn new_tree(&self, runner: &mut TestRunner) -> NewTree<Self> {
        let mut z = vec![0.0; self.entries];
        normal::fill(runner.rng(), &mut z);
        Ok(LatentTree::new(z, self.parts))
    }
}

/// Keeps what still fails, and tries the next simplification of that.
#[derive(Debug, Clone)]
pub(super) struct LatentTree {
    drawn: Vec<f64>,
    kept: Draw,
    tried: Draw,
    /// Scales at which the case passes (below 0 as long as 0 has not been tried) and fails, and the one that is tried.
    passes: f64,
    fails: f64,
    scale: f64,
    /// The block of entries that comes next, of a size that is halved down to 0.
    block: usize,
    size: usize,
    /// Whether the scale is sought for the second time.
    is_last: bool,
    part: usize,
    is_done: bool,
}

impl LatentTree {
    fn new(z: Vec<f64>, parts: usize) -> Self {
        let kept = Draw {
            z: z.clone(),
            silent: vec![false; parts],
        };
        Self {
            size: z.len().div_ceil(2),
            drawn: z,
            tried: kept.clone(),
            kept,
            passes: -1.0,
            fails: 1.0,
            scale: 1.0,
            block: 0,
            is_last: false,
            part: 0,
            is_done: false,
        }
    }

    fn is_scaling(&self) -> bool {
        self.fails > 0.0 && self.fails - self.passes > FINEST
    }

    /// Whether there is something left to try. If not, what is kept stands.
    fn advance(&mut self) -> bool {
        self.tried = self.kept.clone();
        if self.is_scaling() {
            self.scale = 0.5 * (self.passes + self.fails).max(0.0);
            if self.passes < 0.0 {
                self.scale = 0.0;
            }
            self.tried.z = self.drawn.iter().map(|z| z * self.scale).collect();
            return true;
        }
        while self.size > 0 {
            let end = (self.block + self.size).min(self.drawn.len());
            let entries = &mut self.tried.z[self.block..end];
            self.block = end;
            if end == self.drawn.len() {
                self.block = 0;
                self.size /= 2;
            }
            if entries.iter().any(|z| *z != 0.0) {
                entries.fill(0.0);
                return true;
            }
        }
        // What is left points elsewhere: it may be nearer along that.
        if self.fails > 0.0 && self.drawn != self.kept.z && !self.is_last {
            self.is_last = true;
            self.drawn.clone_from(&self.kept.z);
            (self.passes, self.fails) = (0.0, 1.0);
            return self.advance();
        }
        while self.part < self.kept.silent.len() {
            self.part += 1;
            if !self.kept.silent[self.part - 1] {
                self.tried.silent[self.part - 1] = true;
                return true;
            }
        }
        false
    }
}

impl ValueTree for LatentTree {
    type Value = Draw;

    fn current(&self) -> Draw {
        self.tried.clone()
    }

    fn simplify(&mut self) -> bool {
        if self.is_scaling() {
            self.fails = self.scale;
        }
        self.kept = self.tried.clone();
        self.advance()
    }

    fn complicate(&mut self) -> bool {
        if self.is_scaling() {
            self.passes = self.scale;
        }
        // Back at what fails it says so once: a tree that has nowhere to go back to ends the shrinking of all that is drawn beside it.
        self.advance() || !std::mem::replace(&mut self.is_done, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As proptest does it.
    fn shrunk(mut tree: LatentTree, fails: impl Fn(&Draw) -> bool) -> (Draw, usize) {
        let mut tries = 0;
        let mut goes_on = tree.simplify();
        while goes_on {
            tries += 1;
            goes_on = if fails(&tree.current()) {
                tree.simplify()
            } else {
                tree.complicate()
            };
        }
        (tree.current(), tries)
    }

    #[test]
    fn what_always_fails_is_the_mean_in_silence() {
        let (draw, tries) = shrunk(LatentTree::new(vec![1.0, -2.0, 0.5], 2), |_| true);
        assert_eq!(draw.z, [0.0; 3]);
        assert_eq!(draw.silent, [true; 2]);
        assert_eq!(tries, 3);
    }

    #[test]
    fn what_never_fails_again_stays_as_it_was_drawn() {
        let z = vec![1.0, -2.0, 0.5];
        let (draw, tries) = shrunk(LatentTree::new(z.clone(), 2), |_| false);
        assert_eq!(draw.z, z);
        assert_eq!(draw.silent, [false; 2]);
        assert!(tries < 20, "{tries}");
    }

    /// Along the way that is left it may fail sooner than along the one that was drawn.
    #[test]
    fn what_is_left_is_scaled_again() {
        let fails = |z: &[f64]| z[0] >= 1.0 || z[1] < 1.0 && z[0] >= 0.5;
        let (draw, _) = shrunk(LatentTree::new(vec![2.0, 10.0], 0), |d| fails(&d.z));
        assert!((0.5..0.5 + 2.0 * FINEST).contains(&draw.z[0]), "{draw:?}");
        assert_eq!(draw.z[1], 0.0);
    }

    #[test]
    fn the_entry_and_the_part_that_matter_are_left() {
        // The second entry below -1 and a third part that is heard.
        let tree = LatentTree::new(vec![1.5, -2.0, 0.5, 0.1, 2.0], 4);
        let (draw, _) = shrunk(tree, |d| d.z[1] < -1.0 && !d.silent[2]);
        assert!(
            draw.z[1] < -1.0 && draw.z[1] >= -1.0 - 2.0 * FINEST,
            "{draw:?}"
        );
        assert_eq!([draw.z[0], draw.z[2], draw.z[3], draw.z[4]], [0.0; 4]);
        assert_eq!(draw.silent, [true, true, false, true]);
    }
}
