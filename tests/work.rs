//! How much work proofs are, by counters that are the same on every machine: a search that looks at more than it did fails here, however fast the
//! machine is.

use undulate::rand::distr::Distribution;
use undulate::{
    Certification, CollisionModel, CollisionOptions, FourierMovementPrimitive, Prover, Robot, Wave,
    Work, shipped, stream, synthetic,
};

/// Of the searches below, as they are now; more by a tenth fails, and fewer should be written here.
const CERTIFY: [usize; 2] = [1048, 2627];
const MINIMUM: [usize; 2] = [5784, 11_912];
const ROOM: f64 = 1.1;

fn arm() -> (Robot, CollisionModel) {
    let robot = shipped::robot("wave_arm").unwrap();
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    (robot, model)
}

fn waves(robot: &Robot) -> Vec<Wave> {
    let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 12).unwrap();
    let (_, map) = shipped::map_for("wave_arm", primitive.chart().joints())
        .unwrap()
        .expect("a shipped map for the demonstrator");
    (0..20)
        .map(|k| {
            let wave: Wave = primitive.sample(&mut stream(3, k));
            map.apply(&wave, robot).unwrap()
        })
        .collect()
}

/// Intervals and distances of all searches together.
fn total(works: impl Iterator<Item = Work>) -> [usize; 2] {
    works.fold([0, 0], |[intervals, distances], work| {
        [intervals + work.intervals, distances + work.distances]
    })
}

fn certify(prover: &mut Prover<'_>, waves: &[(Wave, f64)]) -> [usize; 2] {
    total(
        waves
            .iter()
            .map(|(wave, margin)| prover.certify(wave, *margin, &[]).unwrap().work()),
    )
}

/// The same proofs by the plain bounds that a written certificate takes, each joint by what it moves alone.
fn by_plain_bounds(robot: &Robot, prover: &mut Prover<'_>, waves: &[(Wave, f64)]) -> [usize; 2] {
    total(waves.iter().map(|(wave, margin)| {
        let made = prover.certificate(robot, wave, *margin, &[], Vec::new(), Vec::new());
        made.unwrap().0.work()
    }))
}

fn is_within(found: [usize; 2], known: [usize; 2]) -> bool {
    let most = known.map(|count| (count as f64 * ROOM) as usize);
    found[0] <= most[0] && found[1] <= most[1]
}

#[test]
fn proofs_look_at_no_more_than_they_did() {
    let (robot, model) = arm();
    let mut prover = model.prover();
    let waves = waves(&robot);
    let minima: Vec<_> = waves
        .iter()
        .map(|wave| prover.minimum_clearance(wave, 1e-4).unwrap())
        .collect();
    let minimum = total(minima.iter().map(|found| found.work));
    // A margin a millimetre below the clearance, where there is one: what little is to spare is what takes work.
    let close: Vec<(Wave, f64)> = waves
        .into_iter()
        .zip(&minima)
        .filter(|(_, found)| found.lower > 2e-3)
        .map(|(wave, found)| (wave, found.lower - 1e-3))
        .collect();
    for (wave, margin) in &close {
        let proof = prover.certify(wave, *margin, &[]).unwrap();
        assert!(matches!(proof, Certification::Clear { .. }), "{proof:?}");
    }
    let certified = certify(&mut prover, &close);
    let plain = by_plain_bounds(&robot, &mut prover, &close);
    println!(
        "of {} waves: {certified:?} certified, {plain:?} by plain bounds; {minimum:?} minimum",
        close.len()
    );
    assert!(
        is_within(certified, CERTIFY),
        "{certified:?} of {CERTIFY:?}"
    );
    assert!(is_within(minimum, MINIMUM), "{minimum:?} of {MINIMUM:?}");
    // A search that forgot its better bounds would be found out.
    assert!(!is_within(plain, CERTIFY), "{plain:?} of {CERTIFY:?}");
}
