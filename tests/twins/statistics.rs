//! Gaussians, their draws and their conditioning; tempo; chains; bounds of probabilities and of alarms.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use rand::RngExt;
use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;
use undulate::posterior::{EllipticalSlice, Hamiltonian, Transition};
use undulate::testing::{Family, demonstrate_below, distribution, gaussian, refute_above};
use undulate::{
    Autoregression, Coordinate, CycleFits, FourierMovementPrimitive, Gaussian, Joints,
    LearnOptions, Observation, Recording, Wave, clopper_pearson, stream, synthetic,
};

use crate::broken::{Fault, broken as faulty};
use crate::{FAMILY, SEED, Target, Twin, Verdict, near};

pub const TWINS: [Twin; 22] = [
    ("a transposed factor", |broken| {
        draws(|f, z| (if broken { f.tr_mul(&z) } else { f * z }) + plane().mean())
    }),
    ("a variance for a standard deviation", |broken| {
        draws(|f, z| (if broken { f * f.tr_mul(&z) } else { f * z }) + plane().mean())
    }),
    ("a mean left out", |broken| {
        draws(|f, z| f * z + plane().mean() * if broken { 0.0 } else { 1.0 })
    }),
    ("uniform for normal numbers", |broken| {
        judge_draws(|k| {
            let mut rng = stream(SEED, k);
            let z = match broken {
                // Of the same variance.
                true => DVector::from_fn(2, |_, _| (rng.random::<f64>() - 0.5) * 12f64.sqrt()),
                false => normals(&mut rng),
            };
            plane().factor() * z + plane().mean()
        })
    }),
    ("seeds reused", |broken| {
        judge_draws(|k| plane().sample(&mut stream(SEED, if broken { k / 2 } else { k })))
    }),
    ("1/(M-1) for 1/M", |broken| {
        // What is learned from five vectors; a variance that is larger by a quarter.
        let vectors: Vec<DVector<f64>> = (0..5)
            .map(|k| plane().sample(&mut stream(SEED, k)))
            .collect();
        let learned = Gaussian::maximum_likelihood(&vectors).unwrap();
        let mean = vectors.iter().sum::<DVector<f64>>() / 5.0;
        let scatter = vectors
            .iter()
            .map(|x| (x - &mean) * (x - &mean).transpose());
        let scatter: DMatrix<f64> = scatter.sum();
        let found = scatter / if broken { 4.0 } else { 5.0 };
        let own = Gaussian::new(mean, found.cholesky().unwrap().l()).unwrap();
        let draws = |k| own.sample(&mut stream(SEED + 1, k));
        judge(&(0..DRAWS).map(draws).collect::<Vec<_>>(), &learned)
    }),
    ("a Schur complement of wrong sign", |broken| {
        let sign = if broken { 1.0 } else { -1.0 };
        conditions(|s, column, variance| {
            (
                column / variance,
                s + column * column.transpose() * (sign / variance),
            )
        })
    }),
    ("a gain by the standard deviation", |broken| {
        conditions(|s, column, variance| {
            let scale = if broken { variance.sqrt() } else { variance };
            (column / scale, s - column * column.transpose() / variance)
        })
    }),
    ("an offset conditioned in the wrong coordinate", |broken| {
        let primitive = learned();
        let (joints, harmonics) = (
            primitive.chart().joints().len(),
            primitive.chart().harmonics(),
        );
        // Offsets come after 2 D K moduli and phases.
        let first = 2 * joints * harmonics;
        let coordinate = primitive
            .chart()
            .coordinate(first + usize::from(broken))
            .unwrap();
        let joint = primitive.chart().joints().name(0).to_owned();
        meets(&[Observation::of(coordinate, 0.4)], |wave| {
            let j = wave.joints().index(&joint).unwrap();
            (wave.offsets()[j], 0.4)
        })
    }),
    ("a modulus conditioned without its logarithm", |broken| {
        // ln |w| = value is another wish than |w| = value.
        let value = if broken { 0.05f64.exp() } else { 0.05 };
        meets(&[Observation::modulus("elbow_flexion", 2, value)], |wave| {
            let j = wave.joints().index("elbow_flexion").unwrap();
            (wave.weights()[(j, 1)].norm(), 0.05)
        })
    }),
    ("a deviation taken for a variance", |broken| {
        let prior = learned();
        let asked = Observation::offset("elbow_flexion", 0.5).within(0.2);
        let (given, deviation) = (prior.condition(std::slice::from_ref(&asked)).unwrap(), 0.2);
        let before = prior.standard_deviation(&elbow()).unwrap().powi(-2);
        let noise: f64 = if broken {
            deviation
        } else {
            deviation * deviation
        };
        let found = given.standard_deviation(&elbow()).unwrap().powi(-2);
        near("precision", before + 1.0 / noise, found).map_err(|e| e.to_string())
    }),
    ("a tempo of half cycles", |broken| {
        tempo(|y, step| {
            let turns = y.windows(2).filter(|y| y[0] * y[1] < 0.0).count() as f64;
            turns / (y.len() - 1) as f64 / step / if broken { 1.0 } else { 2.0 }
        })
    }),
    ("an autoregression whose noise has variance 1", |broken| {
        let (phi, line) = (0.6f64, Gaussian::new(dvector![0.0], dmatrix![1.0]).unwrap());
        let scale = if broken {
            1.0
        } else {
            (1.0 - phi * phi).sqrt()
        };
        let draws: Vec<DVector<f64>> = (0..DRAWS)
            .map(|k| {
                let rng = &mut stream(SEED, k);
                let noise: Vec<f64> = (0..64).map(|_| line.sample(rng)[0]).collect();
                let own = noise.iter().fold(0.0, |x, e| phi * x + scale * e);
                // The ring's last cycle is that of the line, but for phi^64.
                let ring = Autoregression::new(phi).unwrap().on_ring(&noise);
                dvector![own, *ring.last().unwrap()]
            })
            .collect();
        let each = |i: usize| draws.iter().map(|x| dvector![x[i]]).collect::<Vec<_>>();
        judge(&each(1), &line)?;
        judge(&each(0), &line)
    }),
    ("an ellipse whose other axis is too long", |broken| {
        chains(FLAT, broken.then_some(Fault::Axis), slice(FLAT))
    }),
    ("an angle that is halved when it is rejected", |broken| {
        chains(NARROW, broken.then_some(Fault::Halving), slice(NARROW))
    }),
    ("a threshold at the likelihood", |broken| {
        chains(NARROW, broken.then_some(Fault::Threshold), slice(NARROW))
    }),
    ("a momentum that is too large", |broken| {
        chains(
            FLAT,
            broken.then_some(Fault::Momentum),
            Hamiltonian::new(2, FLAT.0),
        )
    }),
    ("trajectories that are all accepted", |broken| {
        let fault = Fault::NoMetropolis(0.15);
        chains(
            NARROW,
            broken.then_some(fault),
            Hamiltonian::new(2, NARROW.0),
        )
    }),
    ("a two-sided bound for a one-sided one", |broken| {
        covers(|failures, trials| match broken {
            true => clopper_pearson(failures, trials, 0.95).1,
            false => clopper_pearson(failures, trials, 0.9).1,
        })
    }),
    ("a normal law for the binomial", |broken| {
        covers(|failures, trials| {
            let share = failures as f64 / trials as f64;
            match broken {
                true => share + 1.6449 * (share * (1.0 - share) / trials as f64).sqrt(),
                false => demonstrate_below(failures, trials, 0.03, 0.95)
                    .map_or_else(|alarm| alarm.statistic, |()| f64::NAN),
            }
        })
    }),
    (
        "a threshold of Kolmogorov and Smirnov without its 2",
        |broken| {
            // P(D > t) is at most 2 exp(-2 N t^2).
            let threshold = (-RATE.ln() / 200.0).sqrt();
            alarms(|rng| {
                let mut samples: Vec<f64> = (0..100).map(|_| rng.random()).collect();
                samples.sort_by(f64::total_cmp);
                let steps = samples.iter().enumerate();
                let off =
                    steps.map(|(i, x)| (x - i as f64 / 100.0).max((i + 1) as f64 / 100.0 - x));
                match broken {
                    true => off.fold(0.0, f64::max) > threshold,
                    false => distribution(&samples, |x| x.clamp(0.0, 1.0), RATE).is_err(),
                }
            })
        },
    ),
    ("a budget that each test of a family spends", |broken| {
        let family = Family::new(RATE, 20);
        let level = if broken { RATE } else { family.test() };
        alarms(|rng| {
            (0..20).any(|_| {
                let samples: Vec<f64> = (0..100).map(|_| rng.random()).collect();
                distribution(&samples, |x| x.clamp(0.0, 1.0), level).is_err()
            })
        })
    }),
];

const DRAWS: u64 = 6000;
/// Of false alarms where they are counted, and in how many runs.
const RATE: f64 = 0.05;
const RUNS: u64 = 5000;

/// Its factor is not its own transpose's.
fn plane() -> Gaussian {
    Gaussian::new(dvector![1.0, -2.0], dmatrix![0.4, -0.15; 0.3, 0.2]).unwrap()
}

fn learned() -> FourierMovementPrimitive {
    FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), 6, &LearnOptions::paper()).unwrap()
}

fn elbow() -> Coordinate {
    Coordinate::Offset {
        joint: "elbow_flexion".to_owned(),
    }
}

fn normals(rng: &mut ChaCha8Rng) -> DVector<f64> {
    let standard = Gaussian::new(DVector::zeros(2), DMatrix::identity(2, 2)).unwrap();
    standard.sample(rng)
}

fn judge(draws: &[DVector<f64>], law: &Gaussian) -> Verdict {
    gaussian(draws, law, FAMILY.test()).map_err(|alarm| alarm.to_string())
}

fn judge_draws(draw: impl Fn(u64) -> DVector<f64>) -> Verdict {
    judge(&(0..DRAWS).map(draw).collect::<Vec<_>>(), &plane())
}

/// Of the factor and two normal numbers.
fn draws(of: impl Fn(&DMatrix<f64>, DVector<f64>) -> DVector<f64>) -> Verdict {
    judge_draws(|k| of(&plane().factor(), normals(&mut stream(SEED, k))))
}

/// Gain and covariance given one offset, of Sigma, its column and the variance; as the library conditions.
fn conditions(
    of: impl Fn(&DMatrix<f64>, &DVector<f64>, f64) -> (DVector<f64>, DMatrix<f64>),
) -> Verdict {
    let (prior, value) = (learned(), 0.7);
    let asked = Observation::offset("elbow_flexion", value);
    let at = prior.chart().row(&elbow()).unwrap()[0].0;
    let sigma = prior.gaussian().covariance();
    let column = sigma.column(at).into_owned();
    let (gain, covariance) = of(&sigma, &column, column[at]);
    let given = prior.condition(&[asked]).unwrap();
    let mean = prior.gaussian().mean() + gain * (value - prior.gaussian().mean()[at]);
    let off = (mean - given.gaussian().mean()).amax();
    near("mean off by", off, 0.0)
        .and_then(|()| {
            let off = (covariance - given.gaussian().covariance()).amax();
            near("covariance off by", off, 0.0)
        })
        .map_err(|e| e.to_string())
}

/// What every draw has when it is asked for, and should have.
fn meets(asked: &[Observation], measured: impl Fn(&Wave) -> (f64, f64)) -> Verdict {
    let given = learned().condition(asked).unwrap();
    (0..20)
        .map(|k| measured(&given.sample(&mut stream(SEED, k))))
        .try_for_each(|(found, expected)| near("a draw", found, expected))
        .map_err(|e| e.to_string())
}

/// The tempo of a swing, from samples and their distance in time.
fn tempo(of: impl Fn(&[f64], f64) -> f64) -> Verdict {
    let (step, frequency) = (0.01, 1.7);
    let times: Vec<f64> = (0..1200).map(|n| n as f64 * step).collect();
    let y: Vec<f64> = times
        .iter()
        .map(|t| 0.5 * (TAU * frequency * t + 0.3).cos())
        .collect();
    let positions = DMatrix::from_column_slice(y.len(), 1, &y);
    let joints = Joints::new(["elbow"]).unwrap();
    let recording = Recording::new("swing", joints, times, positions).unwrap();
    let expected = CycleFits::new(&[recording], 2).unwrap().fits()[0].frequency();
    let found = of(&y, step);
    // What counting resolves: half a cycle of twenty.
    let is_near = (found / expected - 1.0).abs() < 0.025;
    is_near
        .then_some(())
        .ok_or(format!("{found} Hz for {expected} Hz"))
}

/// A target, and the precision of the first number with it, prior included.
type Narrowed = (Target, f64);

const FLAT: Narrowed = (
    |_, gradient| {
        gradient.fill(0.0);
        0.0
    },
    1.0,
);

/// -(z - 0.8)^2 / (2 0.01) of the first.
const NARROW: Narrowed = (
    |z, gradient| {
        gradient.copy_from_slice(&[(0.8 - z[0]) / 0.01, 0.0]);
        -(z[0] - 0.8).powi(2) / 0.02
    },
    101.0,
);

fn slice((target, _): Narrowed) -> impl Transition {
    let mut gradient = [0.0; 2];
    EllipticalSlice::new(2, move |z: &DVector<f64>| {
        target(z.as_slice(), &mut gradient)
    })
}

/// Independent chains that start from their law are still of it ten steps later: draws that are independent, and a test that is exact.
fn chains((target, precision): Narrowed, fault: Option<Fault>, sound: impl Transition) -> Verdict {
    let factor = DMatrix::from_diagonal(&dvector![1.0 / f64::sqrt(precision), 1.0]);
    let mean = dvector![0.8 * (precision - 1.0) / precision, 0.0];
    let law = Gaussian::new(mean, factor).unwrap();
    match fault {
        Some(fault) => judge(&ends(&law, faulty(2, target, fault)), &law),
        None => judge(&ends(&law, sound), &law),
    }
}

fn ends(law: &Gaussian, mut kernel: impl Transition) -> Vec<DVector<f64>> {
    let end = |k| {
        let rng = &mut stream(SEED, k);
        assert!(kernel.start(law.sample(rng).as_slice()).unwrap());
        (0..10).for_each(|_| kernel.step(rng).unwrap());
        DVector::from_column_slice(kernel.position())
    };
    (0..DRAWS).map(end).collect()
}

/// An upper bound at 95 %: at it, so few failures have a chance of just 5 %.
fn covers(bound: impl Fn(u64, u64) -> f64) -> Verdict {
    let trials = 100;
    for failures in [1, 3, 9] {
        let p = bound(failures, trials);
        let mut term = (1.0 - p).powi(trials as i32);
        let mut tail = term;
        for i in 0..failures {
            term *= (trials - i) as f64 / (i + 1) as f64 * p / (1.0 - p);
            tail += term;
        }
        near("a chance", tail, 0.05).map_err(|e| e.to_string())?;
    }
    Ok(())
}

/// A check of true samples raises alarms at its rate, or less often.
fn alarms(check: impl Fn(&mut ChaCha8Rng) -> bool) -> Verdict {
    let found = (0..RUNS).filter(|k| check(&mut stream(SEED, *k))).count() as u64;
    refute_above(found, RUNS, RATE, FAMILY.test()).map_err(|alarm| alarm.to_string())
}
