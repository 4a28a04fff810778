//! Collision of a robot with itself and with its surroundings: which pairs are kept apart, how far apart they are, and proofs that a
//! motion keeps them so.

mod bends;
mod certificate;
mod certify;
mod configuration;
mod contacts;
mod displacement;
mod filter;
mod found;
mod frames;
mod pairs;
mod part;
mod profile;
mod scene;
mod search;
mod side;
mod verify;

pub use certificate::{Certificate, Evidence};
pub use certify::{Certification, MinimumClearance, Moment, Prover, Stretch};
pub use configuration::{Checker, Clearance};
pub use contacts::PairContacts;
pub use found::Work;
pub use pairs::{Pair, PairStatus};
pub use profile::ProfileInterval;
pub use scene::{Scene, SceneObject, SceneShape};
pub use verify::Verified;

use nalgebra::Isometry3;

use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::Joints;
use crate::geometry::Solid;
use crate::motion::Motion;
use crate::robot::Robot;
use displacement::Chains;
use frames::Frames;
use part::{Part, PartGeometry};

/// Composing the frames of joints rounds: by less than this many machine epsilons of the lengths involved for each of them.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// No robot has more, and memory grows with them.
const MOST_PAIRS: usize = 200_000;

/// Convex shapes of one link with those of another, over all pairs: a search holds something of each.
const MOST_CONVEX_PAIRS: usize = 1_000_000;

/// What pairs are checked and how closely, where the default is not what is wanted.
#[derive(Debug, Clone, Default)]
pub struct CollisionOptions {
    /// Pairs of links that are not to be kept apart.
    pub left_out: Vec<(String, String)>,
    /// Pairs of links that are, whatever is said of them elsewhere: neighbours, or pairs that an SRDF disables.
    pub kept: Vec<(String, String)>,
    /// Pairs that an SRDF disables, each with the reason that it gives.
    pub disabled: Vec<(String, String, Option<String>)>,
    /// What stands around the robot.
    pub scene: Scene,
    /// Leaves out the pairs that touch in every one of so many random configurations, drawn from a seed.
    pub always_touching: Option<(usize, u64)>,
    /// Every pair must stay farther apart than this \[m\]; distances are given less this.
    pub padding: f64,
    /// Of single pairs, instead \[m\].
    pub pair_padding: Vec<((String, String), f64)>,
}

/// The collision geometry of a robot and its surroundings, and the pairs that are to be kept apart.
#[derive(Debug, Clone)]
pub struct CollisionModel {
    robot: String,
    joints: Joints,
    frames: Frames,
    /// Of the scene, then of the robot's links, parents first.
    parts: Vec<Part>,
    /// How many of them are the scene's.
    scene: usize,
    pairs: Vec<Pair>,
    /// The pairs that are checked.
    checked: Vec<usize>,
    chains: Chains,
    /// Of every pair, the number of its first pair of convex shapes; at the end, their number.
    first_convex_pair: Vec<usize>,
    /// What rounding of frames does to a distance at most \[m\].
    rounding: f64,
}

impl CollisionModel {
    /// The shapes of `robot`, every pair of links checked but for those that one joint connects and those that `options` leaves out.
    ///
    /// # Errors
    /// When a link has collision geometry that could not be read, a name in the options is no link, a padding is negative, or there is
    /// nothing to check: what is not known is not called free.
    pub fn new(robot: &Robot, options: &CollisionOptions) -> Result<Self> {
        let here = |e: Error| e.at(format!("robot `{}`", robot.name()));
        robot
            .require_collision(options.scene.objects().len())
            .map_err(|e| e.because(Reason::NoCollisionGeometry))?;
        let frames = Frames::new(robot);
        let mut parts = options
            .scene
            .objects()
            .iter()
            .map(Part::of_object)
            .collect::<Result<Vec<_>>>()?;
        for object in &parts {
            if robot.links().iter().any(|link| link.name == object.name) {
                return Err(here(Error::new(
                    ErrorKind::Name,
                    format!(
                        "an object of the scene is called `{}`, as a link is",
                        object.name
                    ),
                )));
            }
        }
        let scene = parts.len();
        for (index, link) in robot.links().iter().enumerate() {
            let solids: Vec<&Solid> = robot.bodies()[link.body]
                .collision
                .iter()
                .filter(|solid| solid.link == index)
                .collect();
            if !solids.is_empty() {
                let frame: Isometry3<f64> = frames.frame_of(link.body);
                parts.push(Part::new(link.name.clone(), link.body, &frame, &solids).map_err(here)?);
            }
        }
        let count = parts.len() * (parts.len() - 1) / 2 - scene * scene.saturating_sub(1) / 2;
        if count > MOST_PAIRS {
            return Err(here(
                Error::new(ErrorKind::Unsupported, format!("{count} pairs of links"))
                    .expected(format!("at most {MOST_PAIRS}"))
                    .help("join links by fixed joints, or take collision shapes off those that cannot touch"),
            ));
        }
        let pairs = pairs::pairs(robot, &parts, scene, options).map_err(here)?;
        let chains = Chains::new(&frames, &parts, &pairs).map_err(here)?;
        let mut first_convex_pair = vec![0];
        for pair in &pairs {
            let count = |part: usize| match &parts[part].geometry {
                PartGeometry::Convexes { convexes, .. } => convexes.len(),
                PartGeometry::HalfSpace(_) => 1,
            };
            let last = first_convex_pair[first_convex_pair.len() - 1];
            first_convex_pair.push(last + count(pair.parts.0) * count(pair.parts.1));
        }
        let convex_pairs = first_convex_pair[pairs.len()];
        if convex_pairs > MOST_CONVEX_PAIRS {
            return Err(here(
                Error::new(
                    ErrorKind::Unsupported,
                    format!("{convex_pairs} pairs of shapes of different links"),
                )
                .expected(format!("at most {MOST_CONVEX_PAIRS}"))
                .help("give links fewer shapes: hulls that enclose several"),
            ));
        }
        let size = frames.reach() + parts.iter().map(Part::reach).fold(0.0, f64::max);
        let rounding = ROUNDING * (frames.bodies() as f64) * size;
        let mut model = Self {
            robot: robot.name().to_owned(),
            joints: robot.joints().clone(),
            frames,
            parts,
            scene,
            pairs,
            checked: Vec::new(),
            chains,
            first_convex_pair,
            rounding,
        };
        model.checked = model.those_checked();
        if let Some((samples, seed)) = options.always_touching {
            let contacts = model.contacts(robot, samples, seed)?;
            for (pair, touching) in contacts.iter().enumerate() {
                if *touching == samples && model.pairs[pair].is_checked() {
                    model.pairs[pair].status = PairStatus::AlwaysTouching { samples, seed };
                }
            }
            model.checked = model.those_checked();
        }
        let carried = pairs::neighbours(robot);
        for pair in model.checker().touching(&robot.rest()) {
            let pair = &mut model.pairs[pair];
            // Links of several joints in one place, as of a wrist, are in each other by design.
            if pair.is_checked()
                && carried.contains(&(pair.names.0.as_str(), pair.names.1.as_str()))
                && !options.kept.iter().any(|(a, b)| pair.is(a, b))
            {
                pair.status = PairStatus::Adjacent;
                continue;
            }
            match &mut pair.status {
                status @ PairStatus::Checked => *status = PairStatus::TouchingAtRest,
                PairStatus::Rigid { touching } => *touching = true,
                _ => {}
            }
        }
        model.checked = model.those_checked();
        Ok(model)
    }

    /// The same with the pairs checked that an SRDF disables, and no others; `None` when it disables none.
    fn of_disabled(&self) -> Result<Option<Self>> {
        let mut model = self.clone();
        for pair in &mut model.pairs {
            pair.status = match pair.status {
                PairStatus::Disabled { .. } => PairStatus::Checked,
                PairStatus::Checked | PairStatus::TouchingAtRest => PairStatus::LeftOut,
                _ => continue,
            };
        }
        model.checked = model.those_checked();
        if model.checked.is_empty() {
            return Ok(None);
        }
        model.chains = Chains::new(&model.frames, &model.parts, &model.pairs)?;
        Ok(Some(model))
    }

    /// Where a motion makes links touch that an SRDF says need not be kept apart, a moment each pair: an SRDF may be of another robot, or wrong.
    ///
    /// # Errors
    /// When the motion is not of the robot's joints.
    pub fn disabled_collisions<M: Motion>(&self, motion: &M) -> Result<Vec<Moment>> {
        let mut found = Vec::new();
        let Some(mut model) = self.of_disabled()? else {
            return Ok(found);
        };
        while !model.checked.is_empty() {
            let Certification::Collides { witness, .. } = model.certify(motion, 0.0, &[])? else {
                break;
            };
            for pair in model.pairs.iter_mut().filter(|p| p.names == witness.pair) {
                pair.status = PairStatus::LeftOut;
            }
            model.checked = model.those_checked();
            found.push(witness);
        }
        Ok(found)
    }

    fn those_checked(&self) -> Vec<usize> {
        let pairs = self.pairs.iter().enumerate();
        pairs
            .filter(|(_, p)| p.is_checked())
            .map(|(i, _)| i)
            .collect()
    }

    /// The joints of the robot, in the order of every configuration.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Every pair of links with shapes, and whether and why it is checked.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// What rounding of frames adds where prismatic joints reach `length` \[m\] farther.
    fn rounding_of(&self, length: f64) -> f64 {
        ROUNDING * (self.frames.bodies() as f64) * length
    }

    fn convex_pairs(&self) -> usize {
        self.first_convex_pair[self.pairs.len()]
    }

    fn names(&self, pair: usize) -> (String, String) {
        self.pairs[pair].names.clone()
    }

    /// # Errors
    /// When `joints` are not those of the robot, or no pair is checked.
    fn require(&self, joints: &Joints) -> Result<()> {
        if *joints != self.joints {
            return Err(
                Error::new(ErrorKind::Name, format!("a motion of {}", joints.listed()))
                    .expected(self.joints.listed())
                    .help("map the motion to the robot's joints with a joint map")
                    .at(format!("robot `{}`", self.robot)),
            );
        }
        if self.checked.is_empty() {
            return Err(Error::new(
                ErrorKind::Infeasible,
                "no pair of links is checked: those with collision shapes are neighbours or left out",
            )
            .because(Reason::NoCollisionGeometry)
            .help("add collision shapes to the URDF, or leave out fewer pairs")
            .at(format!("robot `{}`", self.robot)));
        }
        Ok(())
    }
}
