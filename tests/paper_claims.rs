//! The claims of the paper that the main job stands for, over 20 seeds of the demonstrator.

use undulate::{FourierMovementPrimitive, LearnOptions, Observation, synthetic};

const ELBOW: &str = "elbow_flexion";
const WRIST: &str = "wrist_deviation";
const HARMONICS: usize = 25;

fn centroid(primitive: &FourierMovementPrimitive, joint: &str) -> f64 {
    let (mut weighted, mut total) = (0.0, 0.0);
    for k in 7..=HARMONICS {
        let modulus = primitive.median_modulus(joint, k).unwrap();
        weighted += k as f64 * modulus;
        total += modulus;
    }
    weighted / total
}

#[test]
fn medians_follow_the_conditions_for_18_of_20_seeds() {
    let mut held = 0;
    for seed in 0..20 {
        let primitive = FourierMovementPrimitive::learn_with(
            &synthetic(seed).unwrap(),
            HARMONICS,
            &LearnOptions::paper(),
        )
        .unwrap();
        let given = |joint: &str, k: usize, degrees: f64| {
            let observation = Observation::modulus(joint, k, f64::to_radians(degrees));
            primitive.condition(&[observation]).unwrap()
        };
        let (slow, fast) = (given(ELBOW, 10, 5.0), given(WRIST, 20, 4.0));
        let median =
            |p: &FourierMovementPrimitive, joint: &str, k| p.median_modulus(joint, k).unwrap();
        let wrist_to_elbow = median(&slow, WRIST, 10) / median(&slow, ELBOW, 10);
        let ratio = |p: &FourierMovementPrimitive| median(p, ELBOW, 20) / median(p, ELBOW, 10);
        let rise = ratio(&fast) / ratio(&primitive);
        let shift = centroid(&fast, ELBOW) - centroid(&primitive, ELBOW);
        println!(
            "seed {seed:2}: wrist/elbow {wrist_to_elbow:.2}, rise {rise:.1} (of E10 {:.1}), shift {shift:.2} (of E10 {:.2}), E10 {:.2} W20 {:.2} deg",
            ratio(&fast) / ratio(&slow),
            centroid(&fast, ELBOW) - centroid(&slow, ELBOW),
            median(&primitive, ELBOW, 10).to_degrees(),
            median(&primitive, WRIST, 20).to_degrees(),
        );
        held += usize::from((0.6..=1.1).contains(&wrist_to_elbow) && rise >= 3.0 && shift >= 2.0);
    }
    assert!(held >= 18, "{held} of 20 seeds");
}
