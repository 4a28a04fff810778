//! Skeletons that are known by the names of their bones.

use super::bvh::Bvh;
use super::skeleton::{ArmBones, Bone, BoneMap, Side};

/// A skeleton: of `sides` one word, right then left, stands for `*` in its bones' names.
pub(super) struct Known {
    pub name: &'static str,
    sides: [&'static str; 2],
    thorax: &'static str,
    /// Upper arm, forearm and hand.
    arm: [&'static str; 3],
    fingers: Option<&'static str>,
    /// Whether its bones lie along their own X, and the T-pose is not where nothing is turned.
    along_x: bool,
}

pub(super) const KNOWN: [Known; 4] = [
    // The hand is where the wrist turns: `RightHand` has what of it the forearm does.
    Known {
        name: "CMU, for MotionBuilder",
        sides: ["Right", "Left"],
        thorax: "Spine1",
        arm: ["*Arm", "*ForeArm", "*FingerBase"],
        fingers: Some("*HandIndex1"),
        along_x: false,
    },
    Known {
        name: "CMU, for Daz",
        sides: ["r", "l"],
        thorax: "chest",
        arm: ["*Shldr", "*ForeArm", "*Hand"],
        fingers: Some("*Mid1"),
        along_x: false,
    },
    Known {
        name: "Bandai Namco",
        sides: ["R", "L"],
        thorax: "Chest",
        arm: ["UpperArm_*", "LowerArm_*", "Hand_*"],
        fingers: None,
        along_x: true,
    },
    Known {
        name: "Mixamo",
        sides: ["Right", "Left"],
        thorax: "Spine2",
        arm: ["*Arm", "*ForeArm", "*Hand"],
        fingers: Some("*HandMiddle1"),
        along_x: false,
    },
];

/// Its map, or the bones that are missing.
pub(super) fn find(known: &Known, bvh: &Bvh) -> Result<BoneMap, Vec<String>> {
    let find = |name: &str| {
        let own = |bone: &&str| bone.rsplit(':').next() == Some(name);
        bvh.bones()
            .find(own)
            .map(str::to_owned)
            .ok_or_else(|| vec![name.to_owned()])
    };
    let arm = |side: Side, word: &str| {
        let found = known.arm.map(|name| find(&name.replace('*', word)));
        let missing: Vec<String> = found
            .iter()
            .filter_map(|f| f.clone().err())
            .flatten()
            .collect();
        let [Ok(upper_arm), Ok(forearm), Ok(hand)] = found else {
            return Err(missing);
        };
        let bone = |bone| match known.along_x {
            false => Bone::World(bone),
            true => Bone::Turned {
                bone,
                up: [0.0, side.sign(), 0.0],
                forward: [0.0, 0.0, side.sign()],
            },
        };
        Ok(ArmBones {
            upper_arm: bone(upper_arm),
            forearm: bone(forearm),
            hand: Some(bone(hand)),
            fingers: known
                .fingers
                .and_then(|name| find(&name.replace('*', word)).ok()),
        })
    };
    let [right, left] = [
        arm(Side::Right, known.sides[0]),
        arm(Side::Left, known.sides[1]),
    ];
    let thorax = find(known.thorax);
    if let (Ok(bone), true) = (&thorax, right.is_ok() || left.is_ok()) {
        let bone = bone.clone();
        return Ok(BoneMap {
            name: Some(known.name),
            thorax: match known.along_x {
                false => Bone::World(bone),
                true => Bone::Turned {
                    bone,
                    up: [1.0, 0.0, 0.0],
                    forward: [0.0, 1.0, 0.0],
                },
            },
            right: right.ok(),
            left: left.ok(),
        });
    }
    // What one more arm lacks is no matter.
    let arm = right
        .err()
        .into_iter()
        .chain(left.err())
        .min_by_key(Vec::len);
    Err(thorax.err().into_iter().chain(arm).flatten().collect())
}
