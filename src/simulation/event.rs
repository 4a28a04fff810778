//! [`Event`]: what happened in a rollout that should not have.

use super::Rollout;
use crate::collision::CollisionModel;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;

/// Of its effort limit, what counts as being at it.
const SATURATION: f64 = 0.999;

/// How near to its stop a joint is at it \[rad, m\]: Rapier's stops give by less.
const AT_STOP: f64 = 1e-5;

/// Something that held for a stretch of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// What it was.
    pub kind: EventKind,
    /// The first row in which it held \[s\].
    pub from: f64,
    /// The last one \[s\].
    pub to: f64,
}

/// What can happen.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// A motor gave as much as it may.
    Saturated {
        /// The joint.
        joint: String,
    },
    /// A joint was at the end of its range of positions.
    Stopped {
        /// The joint.
        joint: String,
    },
    /// A joint was faster than its velocity limit, which no plant enforces.
    TooFast {
        /// The joint.
        joint: String,
    },
    /// Two links touched, or a link an object of the scene; that did not hold them up.
    Contact {
        /// Their names, that of an object first.
        pair: (String, String),
    },
}

/// Rows in which something holds, as stretches of time.
fn stretches(rollout: &Rollout, kind: &EventKind, holds: impl Fn(usize) -> bool) -> Vec<Event> {
    let mut found: Vec<Event> = Vec::new();
    let mut is_open = false;
    for (n, time) in rollout.times.iter().enumerate() {
        let does = holds(n);
        match found.last_mut() {
            Some(event) if does && is_open => event.to = *time,
            _ if does => found.push(Event {
                kind: kind.clone(),
                from: *time,
                to: *time,
            }),
            _ => {}
        }
        is_open = does;
    }
    found
}

/// Fills in what joints ran into.
pub(super) fn events(robot: &Robot, rollout: &mut Rollout) {
    let mut all = Vec::new();
    for (j, name) in rollout.joints.iter().enumerate() {
        let (limits, joint) = (robot.properties(j), name.clone());
        if let Some(limit) = limits.effort {
            let at = |n: usize| rollout.torque[(n, j)].abs() >= SATURATION * limit;
            rollout.saturated[j] = (0..rollout.times.len() - 1).filter(|n| at(*n)).count();
            all.extend(stretches(
                rollout,
                &EventKind::Saturated {
                    joint: joint.clone(),
                },
                at,
            ));
        }
        if let Some(range) = limits.position {
            let is_at = |n: usize| {
                let q = rollout.position[(n, j)];
                q - range.lower < AT_STOP || range.upper - q < AT_STOP
            };
            let kind = EventKind::Stopped {
                joint: joint.clone(),
            };
            all.extend(stretches(rollout, &kind, is_at));
        }
        if let Some(limit) = limits.velocity {
            let kind = EventKind::TooFast { joint };
            let is = |n: usize| rollout.velocity[(n, j)].abs() > limit;
            all.extend(stretches(rollout, &kind, is));
        }
    }
    all.sort_by(|a, b| a.from.total_cmp(&b.from));
    rollout.events = all;
}

impl Rollout {
    /// When checked pairs of links, or a link and an object of the scene, touched on the way that the robot went, row by row.
    ///
    /// # Errors
    /// When the model is of other joints.
    pub fn contacts(&self, collision: &CollisionModel) -> Result<Vec<Event>> {
        if *collision.joints() != self.joints {
            return Err(Error::new(
                ErrorKind::Name,
                format!("a rollout of {}", self.joints.listed()),
            )
            .expected(collision.joints().listed()));
        }
        let mut checker = collision.checker();
        let mut open: Vec<(usize, usize)> = Vec::new();
        let mut found: Vec<Event> = Vec::new();
        let mut touching = Vec::new();
        let mut q = vec![0.0; self.joints.len()];
        for (n, time) in self.times.iter().enumerate() {
            for (q, position) in q.iter_mut().zip(self.position.row(n).iter()) {
                *q = *position;
            }
            checker.collisions(&q, &mut touching);
            open.retain(|(pair, _)| touching.contains(pair));
            for pair in &touching {
                match open.iter().find(|(p, _)| p == pair) {
                    Some((_, event)) => found[*event].to = *time,
                    None => {
                        open.push((*pair, found.len()));
                        found.push(Event {
                            kind: EventKind::Contact {
                                pair: collision.pairs()[*pair].names.clone(),
                            },
                            from: *time,
                            to: *time,
                        });
                    }
                }
            }
        }
        Ok(found)
    }
}
