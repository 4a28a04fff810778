//! What draws of a posterior cost: the fewest effective samples a second over a list of statistics, with warm-up and all, on one core.
//!
//! `cargo bench --bench posterior` prints a table; the bounds are in its heads.

use std::time::Instant;

use undulate::posterior::Schedule;
use undulate::rand::distr::Distribution;
use undulate::{
    DEMONSTRATOR_JOINTS, Diagnostics, FourierMovementPrimitive, Posterior, Target, ViaPoint, Wave,
    stream, synthetic,
};

const HARMONICS: usize = 25;
const SEEDS: [u64; 5] = [1, 2, 3, 4, 5];
const DEVIATION: f64 = 2.0;

/// Seconds of this thread on a processor; where the system does not say, by the clock.
fn seconds(start: Instant) -> f64 {
    let nanoseconds = std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|s| s.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |n| n * 1e-9)
}

/// `joints` at `times` where a draw of the primitive has them.
fn via_points(wave: &Wave, joints: &[usize], times: &[f64]) -> Vec<Target> {
    let points = times.iter().flat_map(|time| {
        joints.iter().map(|joint| {
            Target::ViaPoint(ViaPoint {
                joint: DEMONSTRATOR_JOINTS[*joint].into(),
                time: *time,
                position: wave.position(*time)[*joint],
                deviation: DEVIATION.to_radians(),
            })
        })
    });
    points.collect()
}

type Statistic = (String, Box<dyn Fn(&Wave) -> f64>);

/// Positions, log moduli, offsets and relative phases.
fn statistics() -> Vec<Statistic> {
    let mut statistics: Vec<Statistic> = Vec::new();
    for (d, joint) in DEMONSTRATOR_JOINTS.iter().enumerate() {
        for time in [0.0, 1.3, 3.1, 5.6] {
            let position = move |wave: &Wave| wave.position(time)[d];
            statistics.push((format!("{joint} at {time} s"), Box::new(position)));
        }
        for k in [1, 10, 12, 15, 20] {
            let modulus = move |wave: &Wave| wave.weights()[(d, k - 1)].norm().ln();
            statistics.push((format!("ln |{joint} {k}|"), Box::new(modulus)));
        }
        let offset = move |wave: &Wave| wave.offsets()[d];
        statistics.push((format!("offset of {joint}"), Box::new(offset)));
    }
    for k in [10, 20] {
        let lag = move |wave: &Wave| {
            let weights = wave.weights().column(k - 1);
            (weights[4] * weights[3].conj()).arg()
        };
        statistics.push((
            format!("sin of wrist {k} - elbow {k}"),
            Box::new(move |w| lag(w).sin()),
        ));
        statistics.push((
            format!("cos of wrist {k} - elbow {k}"),
            Box::new(move |w| lag(w).cos()),
        ));
    }
    statistics
}

/// The statistic with the smallest of bulk and tail effective sample size, and the largest R-hat of all.
fn worst(posterior: &Posterior) -> (String, f64, f64) {
    let (mut name, mut least, mut r_hat) = ("log-likelihood".to_owned(), f64::INFINITY, 1.0_f64);
    let mut count = |what: &str, diagnostics: Diagnostics| {
        let ess = diagnostics.bulk_ess().min(diagnostics.tail_ess());
        if ess < least {
            (name, least) = (what.to_owned(), ess);
        }
        r_hat = r_hat.max(diagnostics.r_hat());
    };
    count("log-likelihood, targets", posterior.diagnostics().unwrap());
    for (what, statistic) in statistics() {
        count(&what, posterior.diagnose(statistic).unwrap());
    }
    (name, least, r_hat)
}

fn main() {
    let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), HARMONICS).unwrap();
    let start = Instant::now();
    let cases: [(&str, f64, &[usize], &[f64]); 2] = [
        ("2 via-points, slices", 1000.0, &[3], &[1.2, 2.9]),
        (
            "15 via-points, Hamiltonian",
            200.0,
            &[0, 1, 2, 3, 4],
            &[0.7, 2.4, 4.6],
        ),
    ];
    for (case, bound, joints, times) in cases {
        println!("{case}, sd {DEVIATION} deg; at least {bound} effective samples a second");
        for seed in SEEDS {
            let wave = primitive.sample(&mut stream(seed, u64::MAX));
            let mut targets = via_points(&wave, joints, times);
            if targets.len() == 2
                && let Target::ViaPoint(point) = &mut targets[1]
            {
                point.joint = DEMONSTRATOR_JOINTS[4].into();
                point.position = wave.position(point.time)[4];
            }
            let before = seconds(start);
            let posterior = primitive
                .towards(&targets, &Schedule::default(), seed)
                .unwrap();
            let spent = seconds(start) - before;
            let (name, ess, r_hat) = worst(&posterior);
            println!(
                "  seed {seed}: {:7.0}/s  {ess:5.0} of {} draws in {spent:.2} s, R-hat {r_hat:.3}, least: {name}",
                ess / spent,
                posterior.chains() * posterior.draws()
            );
        }
    }
}
