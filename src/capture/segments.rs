//! From the bones of a skeleton to the segments of an arm.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::arm::{ArmMotion, Pose};
use super::bvh::Bvh;
use super::skeleton::{Bone, BoneMap, Side};
use crate::anatomy::about_z;
use crate::error::{Error, ErrorKind, Result, listed};

/// Bones shorter than this, in the units of the file, have no direction.
const SHORTEST: f64 = 1e-9;

/// In the T-pose no bone of an arm points inwards, by more than this cosine.
const INWARD: f64 = -0.5;

/// The cosine between the line of the shoulders and the left of the thorax, above which shoulders are merely drawn up or forward.
const LEVEL: f64 = 0.5;

impl ArmMotion {
    /// The arm of one side of a skeleton.
    ///
    /// The frame of a segment is that of the T-pose, turned the least way so that its Y lies along the bone; the humerus is
    /// rolled about itself until the mean axis of the elbow is its X.
    ///
    /// # Errors
    /// When the map knows no such arm or a bone that is not there, a bone has no length or is not below the one before, or
    /// what the map says of the T-pose cannot be.
    pub fn from_bvh(bvh: &Bvh, map: &BoneMap, side: Side) -> Result<Self> {
        let Some(bones) = map.bones(side) else {
            return Err(Error::new(
                ErrorKind::Name,
                format!("no {} arm in the bone map", side.name()),
            )
            .help("add its bones, or take the other arm with --arm"));
        };
        let names: Vec<&str> = bvh.bones().collect();
        let find = |name: &str| {
            names.iter().position(|bone| *bone == name).ok_or_else(|| {
                Error::new(
                    ErrorKind::Name,
                    format!("no bone `{name}` among {}", listed(&names)),
                )
                .help("the bone map (--bones) names bones of this file")
            })
        };
        let way = |from: usize, to: usize| {
            let here = |e: Error| e.at(format!("bones `{}`, `{}`", names[from], names[to]));
            let way = bvh.way(from, to).ok_or_else(|| {
                here(
                    Error::new(ErrorKind::Shape, "the second is not below the first")
                        .expected("bones of one arm, from the shoulder on"),
                )
            })?;
            Unit::try_new(way, SHORTEST).ok_or_else(|| {
                here(
                    Error::new(ErrorKind::Value, "no distance between them")
                        .expected("an offset: it says where the bone points"),
                )
            })
        };

        let thorax = find(map.thorax.name())?;
        let upper_arm = find(bones.upper_arm.name())?;
        let forearm = find(bones.forearm.name())?;
        let upper_way = way(upper_arm, forearm)?;
        let humerus_axes = segment(&bones.upper_arm, Some(upper_way), side)?;
        let hand = match &bones.hand {
            Some(bone) => {
                let hand = find(bone.name())?;
                let fingers = bones.fingers.as_deref().map(find).transpose()?;
                let fingers = fingers.map(|fingers| way(hand, fingers)).transpose()?;
                Some((hand, segment(bone, fingers, side)?))
            }
            None => None,
        };
        let forearm_way = match hand {
            Some((hand, _)) => way(forearm, hand)?,
            None => Unit::new_unchecked(outward(&bones.forearm, side)?),
        };
        let thorax_axes = map.thorax.axes()?;

        // The other one may be missing.
        let shoulders = Side::ALL.map(|side| {
            let name = map.bones(side)?.upper_arm.name();
            names.iter().position(|bone| *bone == name)
        });
        let check = |turned: &[Matrix3<f64>]| -> Result<()> {
            let [Some(right), Some(left)] = shoulders else {
                return Ok(());
            };
            let line = bvh.place(left, turned) - bvh.place(right, turned);
            let line = (turned[thorax] * thorax_axes).transpose() * line;
            if line.x < LEVEL * line.norm() {
                return Err(Error::new(
                    ErrorKind::Value,
                    "the left shoulder is not on the left of the right one",
                )
                .expected("`up` and `forward` of the thorax as its own axes are in the T-pose")
                .help("give them in a bone map (--bones)")
                .at(format!("bone `{}`", names[thorax])));
            }
            Ok(())
        };
        let mut ends = vec![thorax, upper_arm, forearm];
        ends.extend(hand.map(|(hand, _)| hand));
        ends.extend(shoulders.iter().flatten());
        let needed = bvh.needed(ends);
        let mut turned = vec![Matrix3::identity(); names.len()];
        let mut poses = Vec::with_capacity(bvh.frames());
        for frame in 0..bvh.frames() {
            bvh.turn(frame, &needed, &mut turned);
            if frame == 0 {
                check(&turned)?;
            }
            let to_thorax = (turned[thorax] * thorax_axes).transpose();
            let humerus = to_thorax * turned[upper_arm] * humerus_axes;
            let forearm = to_thorax * (turned[forearm] * *forearm_way);
            let hand = hand.map(|(hand, axes)| to_thorax * turned[hand] * axes);
            let humerus = side.turned_as_right(humerus);
            let forearm = humerus.transpose() * side.as_right(forearm);
            poses.push(Pose {
                humerus,
                forearm,
                hand: hand.map(|hand| side.turned_as_right(hand)),
            });
        }
        let times = (0..bvh.frames()).map(|n| n as f64 / bvh.rate()).collect();
        Ok(Self::new(side, times, poses, Vec::new()))
    }
}

/// The axes of a segment, as those of an arm that hangs are in the T-pose, in the bone's own: turned so that its Y is along the bone.
fn segment(bone: &Bone, way: Option<Unit<Vector3<f64>>>, side: Side) -> Result<Matrix3<f64>> {
    let outward = outward(bone, side)?;
    let way = way.map_or(outward, Unit::into_inner);
    if way.dot(&outward) < INWARD {
        return Err(
            Error::new(ErrorKind::Value, "the bone points inwards in the T-pose")
                .expected("`up` and `forward` as its own axes are when arms are out to the sides, palms down")
                .help("say so in a bone map (--bones)")
                .at(format!("bone `{}`", bone.name())),
        );
    }
    // Not opposite: there is one such rotation.
    let least = Rotation3::rotation_between(&outward, &way).unwrap_or_default();
    let hanging = about_z(side.sign() * std::f64::consts::FRAC_PI_2);
    Ok(least.matrix() * bone.axes()? * hanging)
}

/// Where an arm points in the T-pose, in a bone's own axes.
fn outward(bone: &Bone, side: Side) -> Result<Vector3<f64>> {
    Ok(bone.axes()? * (Vector3::x() * side.sign()))
}
