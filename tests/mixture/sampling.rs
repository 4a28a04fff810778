//! Draws of a mixture.

use rand::RngExt;
use rand::distr::Distribution;
use undulate::{Component, Estimator, Mixture, Wave, clopper_pearson, stream};

use crate::toy;

/// Two kinds that nothing lies between, by 0.3 and 0.7.
fn mixture() -> Mixture {
    toy::labelled([6, 14], 60.0, Estimator::default())
}

fn is_small(wave: &Wave) -> bool {
    wave.weights()[(0, 0)].norm() < 2.0
}

const DRAWS: u64 = 2000;
const FALSE_ALARM: f64 = 1e-6;

/// Whether the share of small waves among [`DRAWS`] draws of seed 11 is 0.3, by an exact binomial test with a false alarm probability of [`FALSE_ALARM`]. A share of
/// 0.5 is seen but for a probability below 1e-40.
fn has_its_share(mixture: &Mixture) -> bool {
    let small = (0..DRAWS).filter(|k| is_small(&mixture.sample(&mut stream(11, *k))));
    let (low, high) = clopper_pearson(small.count() as u64, DRAWS, 1.0 - FALSE_ALARM);
    println!("between {low:.3} and {high:.3}");
    (low..=high).contains(&0.3)
}

#[test]
fn kinds_are_drawn_by_their_weights() {
    let mixture = mixture();
    assert!(has_its_share(&mixture));
    // Weights that are not looked at are seen.
    let equal = mixture.components().iter().map(|c| Component {
        weight: 0.5,
        ..c.clone()
    });
    assert!(!has_its_share(&Mixture::new(equal.collect()).unwrap()));
}

#[test]
fn a_draw_is_one_of_its_primitive() {
    let mixture = mixture();
    for k in 0..50 {
        let wave = mixture.sample(&mut stream(5, k));
        let mut rng = stream(5, k);
        let name = if rng.random::<f64>() < 0.3 {
            "small"
        } else {
            "large"
        };
        let primitive = &mixture.component(name).unwrap().primitive;
        assert_eq!(wave, primitive.sample(&mut rng));
        assert_eq!(is_small(&wave), name == "small");
    }
    // Of one kind there is nothing to choose.
    let one = Component {
        weight: 1.0,
        ..mixture.components()[0].clone()
    };
    let one = Mixture::new(vec![one]).unwrap();
    let alone = &mixture.components()[0].primitive;
    assert_eq!(
        one.sample(&mut stream(5, 3)),
        alone.sample(&mut stream(5, 3))
    );
}
