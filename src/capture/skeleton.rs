//! [`BoneMap`]: which bones of a skeleton are thorax, upper arm, forearm and hand.

use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

use super::bvh::Bvh;
use super::known::{self, KNOWN};
use crate::error::{Error, ErrorKind, Result, listed};

/// Two directions whose cross product is shorter than this span no plane.
const PARALLEL: f64 = 1e-3;

/// Which arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The right one.
    Right,
    /// The left one, whose angles are those of its mirror image.
    Left,
}

impl Side {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Right, Self::Left];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// The sign of X, which points left, on this side.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Right => -1.0,
            Self::Left => 1.0,
        }
    }

    /// A direction of this side as one of a right arm: of a left one its mirror image across the plane between them.
    pub(super) fn as_right(self, v: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(-self.sign() * v.x, v.y, v.z)
    }

    /// A rotation of this side as one of a right arm.
    pub(super) fn turned_as_right(self, rotation: Matrix3<f64>) -> Matrix3<f64> {
        let mirror = self.as_right(Vector3::new(1.0, 1.0, 1.0));
        Matrix3::from_fn(|i, j| mirror[i] * rotation[(i, j)] * mirror[j])
    }
}

/// Which bones are what, and how they stand in the T-pose: arms out to the sides, palms down.
///
/// Skeletons that are known by their bones' names need none. As JSON, a bone by its name where its axes in the T-pose are the
/// world's with Y up and Z forward, as in most files, whose T-pose is where nothing is turned; else with the directions of its
/// own axes that point up and forward then:
///
/// ```
/// use undulate::BoneMap;
///
/// let map = BoneMap::from_json(r#"{
///     "thorax": {"bone": "Spine_02", "up": [1, 0, 0], "forward": [0, 1, 0]},
///     "right": {
///         "upper_arm": "Arm_R",
///         "forearm": "Elbow_R",
///         "hand": "Wrist_R",
///         "fingers": "Middle_R"
///     }
/// }"#)?;
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// `hand` may be left out, and its three angles are then; `fingers` is a bone below the hand towards which it points, without
/// which it points where the forearm does in the T-pose. `left` is like `right`; at least one of them is given.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoneMap {
    #[serde(skip)]
    pub(super) name: Option<&'static str>,
    pub(super) thorax: Bone,
    pub(super) right: Option<ArmBones>,
    pub(super) left: Option<ArmBones>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ArmBones {
    pub upper_arm: Bone,
    pub forearm: Bone,
    pub hand: Option<Bone>,
    pub fingers: Option<String>,
}

/// A bone, and which of its own axes are up and forward in the T-pose.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "a bone's name, or {\"bone\", \"up\", \"forward\"}"
)]
pub(super) enum Bone {
    World(String),
    Turned {
        bone: String,
        up: [f64; 3],
        forward: [f64; 3],
    },
}

impl Bone {
    pub(super) fn name(&self) -> &str {
        match self {
            Self::World(bone) | Self::Turned { bone, .. } => bone,
        }
    }

    /// What is left, up and forward in the T-pose, in the bone's own axes.
    pub(super) fn axes(&self) -> Result<Matrix3<f64>> {
        let Self::Turned { up, forward, .. } = self else {
            return Ok(Matrix3::identity());
        };
        let unit = |v: &[f64; 3]| Vector3::from(*v).try_normalize(0.0);
        let (up, forward) = unit(up).zip(unit(forward)).unwrap_or_default();
        let left = up.cross(&forward);
        // Lengths beyond those of numbers are normalized to none, or to no number.
        if left.norm().is_nan() || left.norm() <= PARALLEL {
            return Err(Error::new(ErrorKind::Value, "up and forward span no plane")
                .expected("two directions at a right angle, such as [0, 1, 0] and [0, 0, 1]")
                .at(format!("bone `{}`", self.name())));
        }
        let left = left.normalize();
        Ok(Matrix3::from_columns(&[left, up, left.cross(&up)]))
    }
}

impl BoneMap {
    /// Reads what a file says.
    ///
    /// # Errors
    /// When the text is no JSON of the form above, no arm is given, or up and forward of a bone span no plane.
    pub fn from_json(text: &str) -> Result<Self> {
        let map: Self = serde_json::from_str(text).map_err(|e| {
            Error::new(ErrorKind::Syntax, e.to_string())
                .expected("{\"thorax\": BONE, \"right\": {\"upper_arm\": BONE, \"forearm\": BONE, \"hand\": BONE, \"fingers\": NAME}, \"left\": ..}")
                .at(format!("line {}, column {}", e.line(), e.column()))
        })?;
        let arms = [&map.right, &map.left].into_iter().flatten();
        let bones =
            arms.flat_map(|arm| [Some(&arm.upper_arm), Some(&arm.forearm), arm.hand.as_ref()]);
        for bone in bones.flatten().chain([&map.thorax]) {
            bone.axes()?;
        }
        if map.right.is_none() && map.left.is_none() {
            return Err(Error::new(ErrorKind::Shape, "no arm").expected("`right`, `left` or both"));
        }
        Ok(map)
    }

    /// That of a known skeleton, by its bones' names: those of CMU's recordings in the forms for MotionBuilder and for Daz, of
    /// Bandai Namco's, and of Mixamo. What stands before a colon in a name does not count. An arm of which a bone is missing is
    /// left out.
    ///
    /// # Errors
    /// When no known skeleton has its thorax and an arm here; says what the nearest lacks.
    pub fn recognise(bvh: &Bvh) -> Result<Self> {
        let mut nearest: Option<(&str, Vec<String>)> = None;
        for skeleton in &KNOWN {
            match known::find(skeleton, bvh) {
                Ok(map) => return Ok(map),
                Err(missing) => {
                    if nearest
                        .as_ref()
                        .is_none_or(|(_, m)| missing.len() < m.len())
                    {
                        nearest = Some((skeleton.name, missing));
                    }
                }
            }
        }
        let (name, missing) = nearest.unwrap_or_default();
        let bones: Vec<&str> = bvh.bones().collect();
        Err(Error::new(
            ErrorKind::Name,
            format!(
                "an unknown skeleton of bones {}; nearest to that of {name}, without {}",
                listed(&bones),
                listed(&missing)
            ),
        )
        .help("say in a bone map (--bones) which are thorax, upper arm, forearm and hand"))
    }

    /// The known skeleton that it is of.
    pub fn skeleton(&self) -> Option<&'static str> {
        self.name
    }

    /// The arms that it knows.
    pub fn sides(&self) -> impl Iterator<Item = Side> {
        Side::ALL
            .into_iter()
            .filter(|side| self.bones(*side).is_some())
    }

    pub(super) fn bones(&self, side: Side) -> Option<&ArmBones> {
        match side {
            Side::Right => self.right.as_ref(),
            Side::Left => self.left.as_ref(),
        }
    }
}
