//! The certificate as a file: what is proven, all that it rests on, and the tree of the proof.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::pairs::PairStatus;
use super::part::PartGeometry;
use super::search::Leaf;
use super::{Certification, CollisionModel, Moment, Prover};
use crate::document;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::geometry::{Shape, Solid};
use crate::motion::Motion;
use crate::robot::Robot;

/// What the format calls itself.
const CERTIFICATE: &str = "undulate certificate";
/// The version that is written; all from 1 to it are read.
const VERSION: u64 = 1;

/// More intervals than this are no certificate: a gigabyte of text.
const MOST_LEAVES: usize = 4_000_000;

/// What a certificate does not say.
pub(super) const NOT_COVERED: [&str; 5] = [
    "links or parts of them outside the collision geometry",
    "joints farther from the motion than the tolerance",
    "objects that are not in the scene, and objects that move",
    "pairs listed as not checked",
    "functional safety in the sense of any standard",
];

/// A proof that a motion keeps clear, with all that it rests on and its tree: what [`verify`](Self::verify) checks again by other means.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    pub(super) joints: Joints,
    pub(super) file: File,
}

/// A file or another input that a certificate rests on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evidence {
    /// What it is: `urdf`, `motion`, `srdf`, `scene`, `joint map`.
    pub what: String,
    /// What it was called.
    pub name: String,
    /// Of its bytes, in hexadecimal digits.
    pub sha256: String,
}

impl Evidence {
    /// The fingerprint of some bytes.
    pub fn new(what: &str, name: &str, bytes: &[u8]) -> Self {
        Self {
            what: what.to_owned(),
            name: name.to_owned(),
            sha256: hex(Sha256::digest(bytes).as_slice()),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    format: String,
    version: u64,
    pub robot: String,
    joints: Vec<String>,
    pub duration_s: f64,
    pub is_periodic: bool,
    pub margin_m: f64,
    /// Of each joint, rad or m.
    pub tolerance: Vec<f64>,
    pub clearance_above_m: f64,
    pub nearest: (String, String),
    pub rests_on: Vec<Evidence>,
    /// Of all shapes of links and scene, as they were used.
    pub geometry_sha256: String,
    geometry: Vec<GeometryEntry>,
    /// Where each limit came from that the motion was held to, as its maker tells.
    limits: Vec<String>,
    pub checked: Vec<PairEntry>,
    pub not_checked: Vec<UncheckedEntry>,
    pub not_covered: Vec<String>,
    /// Intervals of time \[s\]: middle, half width, and which of the checked pairs are proven on it.
    pub tree: Vec<(f64, f64, Vec<usize>)>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct GeometryEntry {
    part: String,
    shapes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PairEntry {
    pub pair: (String, String),
    pub padding_m: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct UncheckedEntry {
    pub pair: (String, String),
    pub why: String,
}

impl Prover<'_> {
    /// [`certify`](Self::certify), with the proof as a certificate where there is one; `rests_on` are the inputs, and `limits` says where
    /// limits came from that the motion was held to.
    ///
    /// # Errors
    /// Those of [`certify`](Self::certify).
    pub fn certificate<M: Motion>(
        &mut self,
        robot: &Robot,
        motion: &M,
        margin: f64,
        tolerance: &[f64],
        rests_on: Vec<Evidence>,
        limits: Vec<String>,
    ) -> Result<(Certification, Option<Certificate>)> {
        robot.require_joints(motion.joints())?;
        let (certification, leaves) = self.with_leaves(motion, margin, tolerance)?;
        let Certification::Clear { bound, .. } = &certification else {
            return Ok((certification, None));
        };
        let file = self
            .model()
            .file(robot, motion, margin, tolerance, bound, leaves);
        let file = File {
            rests_on,
            limits,
            ..file
        };
        let certificate = Certificate {
            joints: motion.joints().clone(),
            file,
        };
        Ok((certification, Some(certificate)))
    }
}

impl CollisionModel {
    fn file<M: Motion>(
        &self,
        robot: &Robot,
        motion: &M,
        margin: f64,
        tolerance: &[f64],
        bound: &Moment,
        leaves: Vec<Leaf>,
    ) -> File {
        let mut padded = tolerance.to_vec();
        padded.resize(self.joints().len(), 0.0);
        // Numbers among the checked pairs.
        let mut numbers = vec![0; self.pairs.len()];
        for (number, pair) in self.checked.iter().enumerate() {
            numbers[*pair] = number;
        }
        let checked = self.checked.iter().map(|i| &self.pairs[*i]);
        File {
            format: CERTIFICATE.to_owned(),
            version: VERSION,
            robot: robot.name().to_owned(),
            joints: motion.joints().iter().cloned().collect(),
            duration_s: motion.duration(),
            is_periodic: motion.is_periodic(),
            margin_m: margin,
            tolerance: padded,
            clearance_above_m: bound.distance,
            nearest: bound.pair.clone(),
            rests_on: Vec::new(),
            geometry_sha256: self.geometry_sha256(robot),
            geometry: self.geometry(robot),
            limits: Vec::new(),
            checked: checked
                .map(|pair| PairEntry {
                    pair: pair.names.clone(),
                    padding_m: pair.padding,
                })
                .collect(),
            not_checked: self.not_checked(),
            not_covered: NOT_COVERED.map(str::to_owned).to_vec(),
            tree: leaves
                .into_iter()
                .filter(|leaf| !leaf.pairs.is_empty())
                .map(|leaf| {
                    let pairs = leaf.pairs.iter().map(|pair| numbers[*pair]).collect();
                    (leaf.middle, leaf.half, pairs)
                })
                .collect(),
        }
    }

    pub(super) fn not_checked(&self) -> Vec<UncheckedEntry> {
        let unchecked = self.pairs.iter().filter(|p| !p.is_checked());
        unchecked
            .map(|pair| UncheckedEntry {
                pair: pair.names.clone(),
                why: pair.status.to_string(),
            })
            .collect()
    }

    fn geometry(&self, robot: &Robot) -> Vec<GeometryEntry> {
        let of_links = robot
            .links()
            .iter()
            .enumerate()
            .filter_map(|(index, link)| {
                let shapes: Vec<String> = solids(robot, index).map(|s| told(&s.shape)).collect();
                (!shapes.is_empty()).then(|| GeometryEntry {
                    part: link.name.clone(),
                    shapes,
                })
            });
        let of_scene = self.parts[..self.scene].iter().map(|part| GeometryEntry {
            part: part.name.clone(),
            shapes: vec![match part.geometry {
                PartGeometry::HalfSpace(_) => "half-space".to_owned(),
                PartGeometry::Convexes { .. } => "shape of the scene".to_owned(),
            }],
        });
        of_scene.chain(of_links).collect()
    }

    /// The fingerprint of all coordinates and sizes of the shapes of links, body by body, and of the scene.
    pub fn geometry_sha256(&self, robot: &Robot) -> String {
        let mut hash = Sha256::new();
        for (index, link) in robot.links().iter().enumerate() {
            for solid in solids(robot, index) {
                hash.update(link.name.as_bytes());
                for number in numbers_of(solid) {
                    hash.update(number.to_le_bytes());
                }
            }
        }
        for part in &self.parts[..self.scene] {
            hash.update(format!("{part:?}").as_bytes());
        }
        hex(hash.finalize().as_slice())
    }
}

fn solids(robot: &Robot, link: usize) -> impl Iterator<Item = &Solid> {
    let body = robot.links()[link].body;
    robot.bodies()[body]
        .collision
        .iter()
        .filter(move |s| s.link == link)
}

fn told(shape: &Shape) -> String {
    match shape {
        Shape::Box { .. } => "box".to_owned(),
        Shape::Sphere { .. } => "sphere".to_owned(),
        Shape::Cylinder { .. } => "cylinder".to_owned(),
        Shape::Capsule { .. } => "capsule".to_owned(),
        Shape::Hull(hull) => format!("convex hull of {} vertices", hull.vertices().len()),
    }
}

fn numbers_of(solid: &Solid) -> Vec<f64> {
    let mut numbers: Vec<f64> = solid.pose.to_homogeneous().iter().copied().collect();
    match &solid.shape {
        Shape::Box { half_extents } => numbers.extend([1.0].iter().chain(half_extents.iter())),
        Shape::Sphere { radius } => numbers.extend([2.0, *radius]),
        Shape::Cylinder { radius, length } => numbers.extend([3.0, *radius, *length]),
        Shape::Capsule { radius, length } => numbers.extend([4.0, *radius, *length]),
        Shape::Hull(hull) => {
            numbers.extend([5.0, hull.tolerance()]);
            numbers.extend(hull.vertices().iter().flat_map(|v| [v.x, v.y, v.z]));
        }
    }
    numbers
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

impl Certificate {
    /// The certificate file, version 1.
    pub fn to_json(&self) -> String {
        document::write(&self.file)
    }

    /// Reads a certificate file. That it can be read says nothing: see [`verify`](Self::verify).
    ///
    /// # Errors
    /// When the text is no certificate file, is cut short or of a later version, or its counts do not fit together.
    pub fn from_json(text: &str) -> Result<Self> {
        let file: File = document::read(text, CERTIFICATE, VERSION)?;
        let joints = Joints::new(file.joints.iter().cloned())?;
        let wrong = |what: String| Error::new(ErrorKind::Shape, what);
        if file.tolerance.len() != joints.len() {
            return Err(wrong(format!("{} tolerances", file.tolerance.len()))
                .expected(format!("one for each of {} joints", joints.len())));
        }
        if file.tree.len() > MOST_LEAVES {
            return Err(wrong(format!("{} intervals", file.tree.len()))
                .expected(format!("at most {MOST_LEAVES}")));
        }
        let pairs = file.checked.len();
        if let Some((.., named)) = file
            .tree
            .iter()
            .find(|(.., named)| named.iter().any(|p| *p >= pairs))
        {
            return Err(wrong(format!("an interval with pairs {named:?}"))
                .expected(format!("numbers below {pairs}")));
        }
        Ok(Self { joints, file })
    }

    /// The joints of the motion.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Every pair is proven to stay farther apart than this \[m\].
    pub fn margin(&self) -> f64 {
        self.file.margin_m
    }

    /// How far each joint may be from the motion \[rad, m\].
    pub fn tolerance(&self) -> &[f64] {
        &self.file.tolerance
    }

    /// The files that it rests on.
    pub fn rests_on(&self) -> &[Evidence] {
        &self.file.rests_on
    }

    /// How many intervals its tree has.
    pub fn intervals(&self) -> usize {
        self.file.tree.len()
    }
}

impl std::fmt::Display for PairStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Checked => f.write_str("checked"),
            Self::TouchingAtRest => f.write_str("checked, touching at rest"),
            Self::Adjacent => f.write_str("adjacent"),
            Self::Rigid { touching: false } => f.write_str("no joint between them"),
            Self::Rigid { touching: true } => f.write_str("no joint between them, touching"),
            Self::Disabled { reason: None } => f.write_str("disabled by an SRDF"),
            Self::Disabled {
                reason: Some(reason),
            } => write!(f, "disabled by an SRDF: {reason}"),
            Self::AlwaysTouching { samples, seed } => {
                write!(
                    f,
                    "touching in all {samples} random configurations of seed {seed}"
                )
            }
            Self::LeftOut => f.write_str("left out by the caller"),
        }
    }
}
