//! Inputs of motion capture: BVH files, bone maps, tables of positions.

use undulate::{ArmMotion, BoneMap, Bvh, PositionOptions, ShoulderOrder, Side};

use super::text;

/// Bones with the names of the seed's map.
const SKELETON: &str = "HIERARCHY
ROOT chest {
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT upper {
        OFFSET -1 0 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        JOINT lower {
            OFFSET -3 0 0
            CHANNELS 1 Yrotation
            JOINT hand {
                OFFSET -2 0 0
                JOINT tip { OFFSET -1 0 0
                }
            }
        }
    }
}
MOTION
Frames: 2
Frame Time: 0.1
0 0 0 10 20 30 40
0 1 0 10 20 40 60
";

pub fn bvh(data: &[u8]) {
    let Some(text) = text(data) else {
        return;
    };
    if let Ok(map) = BoneMap::from_json(text) {
        used(&Bvh::from_text(SKELETON).expect("a skeleton"), &map);
    }
    if let Ok(bvh) = Bvh::from_text(text) {
        assert!(bvh.frames() >= 2 && bvh.rate() > 0.0);
        if let Ok(map) = BoneMap::recognise(&bvh) {
            used(&bvh, &map);
        }
    }
}

pub fn positions(data: &[u8]) {
    for shoulder in [None, Some([-0.2, 1.4, 0.0])] {
        for side in Side::ALL {
            let options = PositionOptions { side, shoulder };
            if let Ok(motion) = ArmMotion::from_positions(data, options) {
                angles(&motion);
            }
        }
    }
}

fn used(bvh: &Bvh, map: &BoneMap) {
    for side in map.sides() {
        if let Ok(motion) = ArmMotion::from_bvh(bvh, map, side) {
            angles(&motion);
        }
    }
}

fn angles(motion: &ArmMotion) {
    assert!(motion.speed().is_finite() && motion.hinge_roll().is_finite());
    let part = motion.between(0.05, 0.4);
    for motion in [Some(motion), part.as_ref().ok()].into_iter().flatten() {
        for order in [ShoulderOrder::Xzy, ShoulderOrder::Zxy] {
            let captured = motion.angles("fuzzed", order).expect("finite angles");
            assert_eq!(captured.recording.times()[0], 0.0);
            captured
                .notes
                .iter()
                .for_each(|note| drop(note.to_string()));
        }
    }
}
