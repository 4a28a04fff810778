//! Which pairs are checked, and why: for a report, and what of it should worry.

use clap::Args;
use serde_json::{Value, json};

use super::output;
use crate::collision::{CollisionModel, PairContacts, PairStatus};
use crate::error::Result;
use crate::robot::Robot;

/// Whether pairs are looked at by themselves.
#[derive(Args, Clone, Default)]
pub(super) struct PairArguments {
    /// List every pair of links, whether it is checked and why, and in how many random configurations it touches.
    #[arg(long)]
    pairs: bool,
    /// How many random configurations.
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "pairs")]
    pair_samples: usize,
    /// The seed that they are drawn from.
    #[arg(long, value_name = "SEED", default_value_t = 0, requires = "pairs")]
    pair_seed: u64,
}

impl PairArguments {
    /// Random contacts of every pair, where they are asked for; pairs that an SRDF disables and that do touch are told.
    pub fn contacts(
        &self,
        collision: &CollisionModel,
        robot: &Robot,
    ) -> Result<Option<Vec<PairContacts>>> {
        if !self.pairs {
            return Ok(None);
        }
        let contacts = collision.pair_contacts(robot, self.pair_samples, self.pair_seed)?;
        for found in &contacts {
            let PairStatus::Disabled { reason } = &found.pair.status else {
                continue;
            };
            if !found.never() {
                let (a, b) = &found.pair.names;
                output::warn(format!(
                    "the SRDF disables {a} and {b}{}, and they touch in {} of {} random configurations; --keep {a}:{b} checks them",
                    reason.as_ref().map_or(String::new(), |r| format!(" ({r})")),
                    found.touching,
                    found.samples
                ));
            }
        }
        Ok(Some(contacts))
    }

    pub fn json(&self, collision: &CollisionModel, contacts: Option<&[PairContacts]>) -> Value {
        let pairs = collision.pairs().iter().enumerate();
        pairs
            .map(|(i, pair)| {
                let mut entry = json!({
                    "links": [pair.names.0, pair.names.1],
                    "checked": pair.is_checked(),
                    "status": pair.status.to_string(),
                    "padding_m": pair.padding,
                });
                if let Some(found) = contacts.map(|c| &c[i]) {
                    entry["touching"] = json!(found.touching);
                    entry["samples"] = json!(found.samples);
                    entry["seed"] = json!(self.pair_seed);
                }
                entry
            })
            .collect()
    }

    pub fn table(&self, contacts: &[PairContacts]) -> String {
        let rows: Vec<Vec<String>> = contacts
            .iter()
            .map(|found| {
                vec![
                    format!("{} and {}", found.pair.names.0, found.pair.names.1),
                    found.pair.status.to_string(),
                    match found {
                        found if found.always() => "always".to_owned(),
                        found if found.never() => "never".to_owned(),
                        found => found.touching.to_string(),
                    },
                ]
            })
            .collect();
        let touching = format!(
            "touching in {} random configurations of seed {}",
            self.pair_samples, self.pair_seed
        );
        output::table(&["pair", "status", &touching], &rows)
    }
}

/// Says of pairs what stands in the way of every motion, or is touched by design.
pub(super) fn tell(collision: &CollisionModel, scene: &[String]) {
    for pair in collision.pairs() {
        let (a, b) = &pair.names;
        match pair.status {
            PairStatus::TouchingAtRest => output::warn(format!(
                "{a} and {b} touch when all joints are at 0, or as near to it as their limits allow: a motion that comes by there does not pass; if they touch by design, --leave-out {a}:{b}"
            )),
            PairStatus::Rigid { touching: true } if scene.contains(a) => output::warn(format!(
                "{a} of the scene touches {b}, which does not move: no motion changes that, and the pair is not checked"
            )),
            _ => {}
        }
    }
}

/// Links that move and have no collision shape in the body that they belong to: nothing keeps them apart from anything.
pub(super) fn without_shapes(robot: &Robot) -> Vec<String> {
    let bodies = robot.bodies().iter().filter(|b| {
        b.joint.is_some()
            && b.collision.is_empty()
            && (!b.visual.is_empty() || b.inertial.is_some())
    });
    bodies.map(|b| b.name.clone()).collect()
}
