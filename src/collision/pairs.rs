//! Which pairs of links, and of links and objects of the scene, are kept apart, and why.

use super::CollisionOptions;
use super::part::Part;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;

/// Why a pair is checked or not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PairStatus {
    /// It is checked.
    Checked,
    /// It is checked, although it touches in the rest configuration already: no motion that comes by there will pass. The
    /// shapes are too large, or the pair should be left out.
    TouchingAtRest,
    /// Not checked: one carries the other by a joint, and their shapes may overlap by design; or by several, with links without shapes between, and
    /// they do overlap at rest.
    Adjacent,
    /// Not checked: no joint lies between, so they never move against each other.
    Rigid {
        /// Whether they touch, now and always.
        touching: bool,
    },
    /// Not checked: an SRDF disables it, for the reason that it gives.
    Disabled {
        /// As the file has it, if it does.
        reason: Option<String>,
    },
    /// Not checked: it touched in every one of so many random configurations.
    AlwaysTouching {
        /// Configurations looked at.
        samples: usize,
        /// The seed that they were drawn from.
        seed: u64,
    },
    /// Not checked: the caller said so.
    LeftOut,
}

impl PairStatus {
    /// Whether such a pair is checked.
    pub fn is_checked(&self) -> bool {
        matches!(self, Self::Checked | Self::TouchingAtRest)
    }
}

/// Two links, or an object of the scene and a link, that might touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Their names, the one nearer to the base first.
    pub names: (String, String),
    /// Whether it is checked, and why.
    pub status: PairStatus,
    /// They must stay farther apart than this \[m\], on top of any margin; distances are given less this.
    pub padding: f64,
    /// Indices of its parts.
    pub(super) parts: (usize, usize),
}

impl Pair {
    /// Whether it is checked.
    pub fn is_checked(&self) -> bool {
        self.status.is_checked()
    }

    /// Whether it is of these two, in either order.
    pub(super) fn is(&self, a: &str, b: &str) -> bool {
        (self.names.0 == a && self.names.1 == b) || (self.names.0 == b && self.names.1 == a)
    }
}

/// All pairs of parts of which at least one is a link's. `parts` are the scene's and then the links', parents first.
pub(super) fn pairs(
    robot: &Robot,
    parts: &[Part],
    scene: usize,
    options: &CollisionOptions,
) -> Result<Vec<Pair>> {
    let neighbours = neighbours(robot);
    let mut pairs = Vec::new();
    for b in scene..parts.len() {
        for a in 0..b {
            let names = (parts[a].name.clone(), parts[b].name.clone());
            let status = if parts[a].body == parts[b].body {
                PairStatus::Rigid { touching: false }
            } else if a >= scene
                && neighbours.contains(&(names.0.as_str(), names.1.as_str()))
                && robot.bodies()[parts[b].body].parent == parts[a].body
            {
                PairStatus::Adjacent
            } else {
                PairStatus::Checked
            };
            pairs.push(Pair {
                names,
                status,
                padding: options.padding,
                parts: (a, b),
            });
        }
    }
    for (a, b, reason) in &options.disabled {
        for pair in pairs
            .iter_mut()
            .filter(|p| p.is(a, b) && p.status == PairStatus::Checked)
        {
            pair.status = PairStatus::Disabled {
                reason: reason.clone(),
            };
        }
    }
    let mut each = |names: &(String, String), change: &dyn Fn(&mut Pair) -> Result<()>| {
        for name in [&names.0, &names.1] {
            let known = parts.iter().any(|p| p.name == *name)
                || robot.links().iter().any(|l| l.name == *name);
            if !known {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("no link or object `{name}`"),
                ));
            }
        }
        pairs
            .iter_mut()
            .filter(|p| p.is(&names.0, &names.1))
            .map(change)
            .collect::<Result<Vec<()>>>()
            .map(|changed| changed.len())
    };
    // What is asked for and cannot be is no wish to be passed over.
    let refuse = |wish: &str, (a, b): &(String, String), why: &str| {
        Error::new(ErrorKind::Setting, format!("{wish} {a} and {b}: {why}"))
    };
    let without = "they are no two links or objects of which both have shapes and one is a link's";
    let same =
        |a: &&(String, String), b: &(String, String)| **a == *b || (a.0 == b.1 && a.1 == b.0);
    if let Some(names) = options
        .kept
        .iter()
        .find(|kept| options.left_out.iter().any(|out| same(kept, out)))
    {
        return Err(refuse("to check", names, "it is to be left out as well"));
    }
    for names in &options.left_out {
        each(names, &|pair| {
            pair.status = PairStatus::LeftOut;
            Ok(())
        })?;
    }
    for names in &options.kept {
        let kept = each(names, &|pair| {
            if matches!(pair.status, PairStatus::Rigid { .. }) {
                return Err(refuse(
                    "to check",
                    names,
                    "no joint lies between them, nothing moves them against each other",
                ));
            }
            pair.status = PairStatus::Checked;
            Ok(())
        })?;
        if kept == 0 {
            return Err(refuse("to check", names, without));
        }
    }
    for (names, padding) in &options.pair_padding {
        let padded = each(names, &|pair| {
            if !pair.is_checked() {
                return Err(refuse(
                    "a padding of",
                    names,
                    &format!("the pair is not checked ({})", pair.status),
                )
                .help("--keep checks it"));
            }
            pair.padding = *padding;
            Ok(())
        })?;
        if padded == 0 {
            return Err(refuse("a padding of", names, without));
        }
    }
    if let Some(pair) = pairs
        .iter()
        .find(|p| !(p.padding >= 0.0 && p.padding.is_finite()))
    {
        return Err(Error::new(
            ErrorKind::Setting,
            format!("a padding of {} m", pair.padding),
        )
        .expected("zero or more"));
    }
    Ok(pairs)
}

/// Links with shapes, each after the next link with shapes on its way to the base: siblings on a link without are none.
pub(super) fn neighbours(robot: &Robot) -> Vec<(&str, &str)> {
    let links = robot.links();
    let mut has_shapes = vec![false; links.len()];
    for solid in robot.bodies().iter().flat_map(|b| &b.collision) {
        has_shapes[solid.link] = true;
    }
    // Links come parents first.
    let mut nearest: Vec<Option<usize>> = Vec::with_capacity(links.len());
    for link in links {
        nearest.push(
            link.parent
                .and_then(|p| if has_shapes[p] { Some(p) } else { nearest[p] }),
        );
    }
    let shaped = (0..links.len()).filter(|i| has_shapes[*i]);
    shaped
        .filter_map(|i| nearest[i].map(|p| (links[p].name.as_str(), links[i].name.as_str())))
        .collect()
}
