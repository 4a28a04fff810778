//! [`Bvh`]: a skeleton and its motion, as motion capture is exchanged.

mod parse;

use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use crate::anatomy::{about_x, about_y, about_z};
use crate::error::{Error, ErrorKind, Result};

/// A skeleton of bones, each turned in every frame, read from BVH text.
///
/// ```
/// use undulate::Bvh;
///
/// let bvh = Bvh::from_text("
///     HIERARCHY
///     ROOT hip
///     {
///         OFFSET 0 0 0
///         CHANNELS 3 Zrotation Xrotation Yrotation
///         End Site { OFFSET 0 1 0
///         }
///     }
///     MOTION
///     Frames: 2
///     Frame Time: 0.008333
///     0 0 0
///     90 0 0
/// ")?;
/// assert_eq!((bvh.bones().count(), bvh.frames()), (1, 2));
/// assert_eq!(bvh.rate(), 120.0); // what 0.008333 s is rounded from
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    /// A parent comes before its children.
    bones: Vec<Bone>,
    channels: usize,
    rate: f64,
    /// Frame by frame, \[deg\] where a channel turns.
    values: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
struct Bone {
    name: String,
    parent: Option<usize>,
    /// From its parent where nothing is turned, in the parent's axes.
    offset: Vector3<f64>,
    /// What turns it, in this order, and the channel that says by how much.
    turns: Vec<(Axis, usize)>,
    /// Where the file names it.
    line: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Axis {
    X,
    Y,
    Z,
}

impl Bvh {
    /// Reads a BVH text. Channels may be any, in any order; what moves a bone away from its offset is not looked at.
    ///
    /// # Errors
    /// Names the line of whatever is not BVH, ends too early, is called twice, or is no finite number.
    pub fn from_text(text: &str) -> Result<Self> {
        parse::bvh(text)
    }

    /// [`from_text`](Self::from_text) of a file.
    ///
    /// # Errors
    /// Those of `from_text`, and when the file cannot be read.
    pub fn open(path: &Path) -> Result<Self> {
        let bytes = crate::document::bytes(path)?;
        // Names of bones may be in any encoding.
        Self::from_text(&String::from_utf8_lossy(&bytes))
            .map_err(|e| e.at(path.display().to_string()))
    }

    /// The names of its bones, parents first.
    pub fn bones(&self) -> impl Iterator<Item = &str> {
        self.bones.iter().map(|bone| bone.name.as_str())
    }

    /// How many frames there are.
    pub fn frames(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Frames a second: a whole number where the frame time is one rounded to the digits that the file has.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// With another rate \[Hz\], for files whose frame time is wrong.
    ///
    /// # Errors
    /// When no camera has it.
    pub fn with_rate(self, rate: f64) -> Result<Self> {
        if !parse::FRAME_TIMES.contains(&(1.0 / rate)) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a rate of {rate} Hz"))
                    .expected("frames a second, such as 120"),
            );
        }
        Ok(Self { rate, ..self })
    }

    /// A bone and those above it, itself first.
    pub(super) fn ancestors(&self, bone: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(bone), |bone| self.bones[*bone].parent)
    }

    /// The way from bone `from` to one below it where nothing is turned; `None` where it is not below.
    pub(super) fn way(&self, from: usize, to: usize) -> Option<Vector3<f64>> {
        let mut way = Vector3::zeros();
        for bone in self.ancestors(to) {
            if bone == from {
                return Some(way);
            }
            way += self.bones[bone].offset;
        }
        None
    }

    /// Where the bones of `parts` are turned to in a frame, and those above them; the others keep what they have in `turned`.
    pub(super) fn turn(&self, frame: usize, parts: &[usize], turned: &mut [Matrix3<f64>]) {
        let row = &self.values[frame * self.channels..][..self.channels];
        for &part in parts {
            let bone = &self.bones[part];
            let mut rotation = bone.parent.map_or(Matrix3::identity(), |p| turned[p]);
            for (axis, channel) in &bone.turns {
                let angle = row[*channel].to_radians();
                rotation *= match axis {
                    Axis::X => about_x(angle),
                    Axis::Y => about_y(angle),
                    Axis::Z => about_z(angle),
                };
            }
            turned[part] = rotation;
        }
    }

    /// Where a bone begins, seen from the root, by the rotations that [`turn`](Self::turn) found.
    pub(super) fn place(&self, bone: usize, turned: &[Matrix3<f64>]) -> Vector3<f64> {
        self.ancestors(bone)
            .filter_map(|bone| {
                let parent = self.bones[bone].parent?;
                Some(turned[parent] * self.bones[bone].offset)
            })
            .sum()
    }

    /// The bones above and including these, parents first.
    pub(super) fn needed(&self, bones: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut needed: Vec<usize> = bones.into_iter().flat_map(|b| self.ancestors(b)).collect();
        needed.sort_unstable();
        needed.dedup();
        needed
    }
}
