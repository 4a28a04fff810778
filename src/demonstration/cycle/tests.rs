use super::*;
use crate::fourier::CycleRing;
use nalgebra::{DMatrix, dmatrix, dvector};
use num_complex::Complex;
use rand::SeedableRng;
use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;
use rand_distr::StandardNormal;

fn joints() -> Joints {
    Joints::new(["a", "b"]).unwrap()
}

/// 1.83 Hz, a swing of 0.3 and its second harmonic; the other joint swings less, and late.
fn cycle() -> Wave {
    Wave::new(
        joints(),
        1.0 / 1.83,
        dvector![0.4, -1.0],
        dmatrix![
            Complex::new(0.15, 0.0), Complex::new(0.0, 0.02);
            Complex::new(0.03, 0.06), Complex::new(0.01, 0.0)
        ],
    )
    .unwrap()
}

fn recorded(name: &str, times: Vec<f64>, at: impl Fn(f64, usize) -> f64) -> Recording {
    let positions = DMatrix::from_fn(times.len(), 2, |n, d| at(times[n], d));
    Recording::new(name, joints(), times, positions).unwrap()
}

fn uniform(span: f64) -> Vec<f64> {
    (0..=(60.0 * span) as usize)
        .map(|n| n as f64 / 60.0)
        .collect()
}

#[test]
fn a_steady_cycle_is_found_on_uneven_stamps_with_a_gap_and_drift() {
    let cycle = cycle();
    let times: Vec<f64> = (0..300)
        .map(|n| 7.0 + (f64::from(n) + 0.4 * (f64::from(n * n) * 0.7).sin()) / 60.0)
        .filter(|t| !(9.2..9.7).contains(t))
        .collect();
    let (start, middle) = (times[0], (times[0] + times[times.len() - 1]) / 2.0);
    let drifting = recorded("r", times, |t, d| {
        cycle.position(t - start)[d] + 0.1 * (t - middle)
    });
    let fits = CycleFits::new(&[drifting], 2).unwrap();
    let fit = &fits.fits()[0];
    assert!(
        (fit.frequency() / 1.83 - 1.0).abs() < 5e-4,
        "{}",
        fit.frequency()
    );
    assert!((fit.wave.weights() - cycle.weights()).camax() < 0.01 * 0.15);
    assert!((fit.wave.offsets() - cycle.offsets()).amax() < 1e-3);
    assert!(fit.explained > 0.999 && fit.explained_with_jitter > 0.999);
    assert!(
        fit.amplitude_jitter < 0.01 && fit.tempo_jitter < 0.01,
        "{fit:?}"
    );
}

/// 60 recordings of 4 to 11 cycles, cut anywhere from rings of 40 cycles with known levels and coefficients; seed 11.
/// Standard errors, from how estimates scatter between seeds: 0.1 of a coefficient, 0.08 of the mean ln level.
/// The bounds are three of them: false alarms of 0.3 % each.
#[test]
fn levels_and_memory_of_jitter_are_recovered_from_short_recordings() {
    let (amplitude, tempo) = (
        Autoregression::new(0.5).unwrap(),
        Autoregression::new(0.0).unwrap(),
    );
    let (level, tempo_level) = (0.12, 0.05);
    let ring = CycleRing::new(40).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let recordings: Vec<Recording> = (0..60)
        .map(|m| {
            let mut draw = |process: &Autoregression, level: f64| -> Vec<f64> {
                let normals: Vec<f64> = (0..40).map(|_| StandardNormal.sample(&mut rng)).collect();
                process
                    .on_ring(&normals)
                    .iter()
                    .map(|x| level * x)
                    .collect()
            };
            let wave = ring
                .wave(
                    &cycle(),
                    &draw(&amplitude, level),
                    &draw(&tempo, tempo_level),
                )
                .unwrap();
            let cycles = 4.0 + f64::from(m % 8);
            let start = 0.3 * f64::from(m);
            recorded(&m.to_string(), uniform(cycles / 1.83), |t, d| {
                wave.position(start + t)[d]
            })
        })
        .collect();
    let fits = CycleFits::new(&recordings, 2).unwrap();
    assert_eq!(fits.fits().len(), 60, "{:?}", fits.left_out());
    assert!(
        (fits.amplitude().coefficient() - 0.5).abs() < 0.3,
        "{fits:?}"
    );
    assert!(fits.tempo().coefficient().abs() < 0.3, "{fits:?}");
    let mean = |of: &dyn Fn(&CycleFit) -> f64| {
        fits.fits().iter().map(of).sum::<f64>() / fits.fits().len() as f64
    };
    let log = mean(&|f| (f.amplitude_jitter / level).ln());
    let tempo_log = mean(&|f| (f.tempo_jitter / tempo_level).ln());
    assert!(
        log.abs() < 0.24 && tempo_log.abs() < 0.24,
        "{log} {tempo_log}"
    );
    // What is seen of it is far less, so the test would notice if nothing were corrected.
    let seen: f64 = recordings
        .iter()
        .map(|r| (crate::demonstration::Variation::of(r).unwrap().envelope / level).ln())
        .sum();
    assert!(seen / 60.0 < -0.4, "{}", seen / 60.0);
    // Levels are alike, so they come out alike, though each recording alone tells little of its own.
    let spread = mean(&|f| ((f.amplitude_jitter / level).ln() - log).powi(2)).sqrt();
    assert!(spread < 0.2, "{spread}");
    // A tempo that wanders does not make amplitudes smaller.
    let swing = mean(&|f| f.wave.weights()[(0, 0)].norm() / 0.15);
    assert!((swing - 1.0).abs() < 0.03, "{swing}");
}

#[test]
fn what_has_no_three_cycles_of_a_rhythm_is_left_out_by_name() {
    let cycle = cycle();
    let good = recorded("good", uniform(4.0), |t, d| cycle.position(t)[d]);
    let short = recorded("short", uniform(1.2), |t, d| cycle.position(t)[d]);
    // A quadratic congruence: as good as noise.
    let noise = recorded("noise", uniform(4.0), |t, d| {
        let n = (60.0 * t).round() as u64;
        ((n * n * 7919 + 104_729 * n * (d as u64 + 1)) % 1009) as f64 / 1009.0
    });
    let still = recorded("still", uniform(4.0), |_, _| 0.5);
    let ramp = recorded("ramp", uniform(4.0), |t, _| 0.5 * t);
    let coarse = recorded(
        "coarse",
        (0..12).map(|n| 0.4 * f64::from(n)).collect(),
        |t, d| cycle.position(t)[d],
    );
    let huge = recorded("huge", uniform(4.0), |t, d| 1e200 * cycle.position(t)[d]);
    let all = [
        good.clone(),
        short.clone(),
        noise,
        still,
        ramp,
        coarse,
        huge,
    ];
    let fits = CycleFits::new(&all, 3).unwrap();
    let names = |fits: &CycleFits| {
        fits.fits()
            .iter()
            .map(|f| f.name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&fits), ["good"], "{fits:?}");
    assert_eq!(fits.left_out().len(), 6);
    assert!(
        fits.left_out()[0].reason.contains("2.3 cycles in 1.20 s"),
        "{fits:?}"
    );
    let error = CycleFits::new(&[short], 3).unwrap_err();
    assert!(error.to_string().contains("short: 2.3 cycles"), "{error}");
    assert!(CycleFits::new(&[], 3).is_err());
    assert!(CycleFits::new(&[good], 0).is_err());
}

#[test]
fn a_recording_in_which_one_joint_stands_still_is_left_out_by_name() {
    let cycle = cycle();
    let good = |name| recorded(name, uniform(4.0), |t, d| cycle.position(t)[d]);
    let half = recorded("half", uniform(4.0), |t, d| {
        if d == 0 { cycle.position(t)[0] } else { 0.7 }
    });
    let fits = CycleFits::new(&[good("one"), half, good("two")], 2).unwrap();
    assert_eq!(fits.fits().len(), 2);
    let [left_out] = fits.left_out() else {
        panic!("{:?}", fits.left_out());
    };
    assert!(left_out.name == "half" && left_out.reason.contains("`b` stands still"));
}

/// The second joint goes to and fro twice a cycle, in one recording farther than the first.
#[test]
fn a_joint_that_moves_twice_a_cycle_does_not_double_the_tempo() {
    let recordings: Vec<Recording> = [0.02, 0.03, 0.3, 0.01]
        .iter()
        .enumerate()
        .map(|(m, twice)| {
            let phase = move |t: f64| std::f64::consts::TAU * (0.95 + 0.01 * m as f64) * t;
            recorded(&m.to_string(), uniform(6.0), |t, d| {
                [0.2 * phase(t).cos(), twice * (2.0 * phase(t)).cos()][d]
            })
        })
        .collect();
    assert!((recordings[2].tempo() - 1.94).abs() < 0.02);
    let fits = CycleFits::new(&recordings, 2).unwrap();
    let fit = &fits.fits()[2];
    assert!((fit.frequency() - 0.97).abs() < 0.01, "{fit:?}");
    assert!(fit.explained > 0.999, "{fit:?}");
    // One that is as fast, with little in it that is slower, stays as it is.
    let mut fast = recordings.clone();
    fast[2] = recorded("fast", uniform(6.0), |t, _| {
        0.2 * (12.2 * t).cos() + 0.03 * (6.1 * t).cos()
    });
    let frequency = CycleFits::new(&fast, 2).unwrap().fits()[2].frequency();
    assert!((frequency - 1.94).abs() < 0.01, "{frequency}");
}

#[test]
fn a_still_joint_beside_a_waving_one_is_fitted() {
    let cycle = cycle();
    let half = recorded("half", uniform(4.0), |t, d| {
        if d == 0 { cycle.position(t)[0] } else { 0.7 }
    });
    let fits = CycleFits::new(&[half], 2).unwrap();
    let wave = &fits.fits()[0].wave;
    assert!((wave.offsets()[1] - 0.7).abs() < 1e-12);
    assert!(wave.weights().row(1).camax() < 1e-12);
}
