//! Baselines against direct formulas, and the comparison against what is known of its input.

mod common;

use std::f64::consts::TAU;

use undulate::nalgebra::{DMatrix, DVector, dvector};
use undulate::num_complex::Complex;
use undulate::rand::RngExt;
use undulate::testing::{Seed, gaussian};
use undulate::{
    Comparison, ComparisonOptions, CsvOptions, Distance, Estimate, Gaussian, GestureModel, Joints,
    LinearGaussian, ModelKind, Recording, Resolution, RhythmicProMp, Statistic, StrokeProMp, Wave,
    Wish, clopper_pearson, stream, synthetic,
};

const FREQUENCY: f64 = 1.6;

/// Five cycles of two joints, `size` large and begun at `phase`, and a posture.
fn waving(name: &str, size: f64, phase: f64, posture: f64) -> Recording {
    let times: Vec<f64> = (0..=250).map(|n| f64::from(n) / 80.0).collect();
    let positions = DMatrix::from_fn(times.len(), 2, |n, d| {
        let turn = TAU * FREQUENCY * times[n] + phase;
        [
            posture + 0.4 * size * turn.cos(),
            0.1 * size * (turn - 0.7).cos(),
        ][d]
    });
    Recording::new(name, Joints::new(["a", "b"]).unwrap(), times, positions).unwrap()
}

/// Alike but for where they begin, so a model that aligns them knows one motion.
fn alike() -> Vec<Recording> {
    let phases = [0.0, -1.0, -2.5, -4.0];
    phases
        .map(|phase| waving(&format!("{phase}"), 1.0, phase, 0.3))
        .to_vec()
}

fn varied() -> Vec<Recording> {
    let all = [
        (0.8, 0.1),
        (1.0, 0.4),
        (1.3, 0.2),
        (0.9, 0.5),
        (1.1, 0.0),
        (1.05, 0.3),
    ];
    let record = |(m, (size, posture)): (usize, (f64, f64))| {
        waving(&m.to_string(), size, -(m as f64), posture)
    };
    all.into_iter().enumerate().map(record).collect()
}

#[test]
fn demonstrations_that_are_alike_are_drawn_as_they_are() {
    let demonstrations = alike();
    let shown = waving("shown", 1.0, 0.0, 0.3);
    // The stroke does not last as long as the recordings: a cycle at most, and a sample, is lost in aligning them.
    let stroke = StrokeProMp::learn(&demonstrations, 51).unwrap();
    assert!(stroke.duration() > 3.125 - 1.0 / FREQUENCY - 2.0 / 80.0 && stroke.duration() <= 3.125);
    let within = |t: &&f64| **t < stroke.duration();
    let lasting = shown.times().iter().take_while(within).count();
    let drawn = |model: &dyn GestureModel| model.draw(shown.times(), &mut stream(1, 0));
    let missed =
        |y: &DMatrix<f64>, rows: usize| (y.rows(0, rows) - shown.positions().rows(0, rows)).amax();
    // A sample's step is what the alignment of a stroke is uncertain by: 0.4 rad times half of 0.13 rad.
    assert!(missed(&drawn(&stroke), lasting) < 0.06);
    let rhythmic = RhythmicProMp::learn(&demonstrations, 9).unwrap();
    assert!(
        missed(&drawn(&rhythmic), 251) < 0.01,
        "{}",
        missed(&drawn(&rhythmic), 251)
    );
    let linear = LinearGaussian::learn(&demonstrations, 25).unwrap();
    assert!(
        missed(&drawn(&linear), 251) < 0.02,
        "{}",
        missed(&drawn(&linear), 251)
    );
    // The stroke ends, the others go on.
    let later: Vec<f64> = (0..100).map(|n| f64::from(n) / 10.0).collect();
    let moves = |model: &dyn GestureModel| {
        let y = model.draw(&later, &mut stream(1, 0));
        y.column(0).rows(60, 40).amax() - y.column(0).rows(60, 40).min() > 0.1
    };
    assert!(!moves(&stroke) && moves(&rhythmic) && moves(&linear));
}

#[test]
fn a_rhythmic_draw_repeats_itself_with_the_tempo_that_was_asked_for() {
    let model = RhythmicProMp::learn(synthetic(0).unwrap().recordings(), 9).unwrap();
    let asked = model.condition(&Wish::Frequency(2.0)).unwrap();
    for k in 0..5 {
        let y = asked.draw(&[0.0, 0.17, 0.5, 0.67, 7.67], &mut stream(2, k));
        assert!((y.row(0) - y.row(2)).amax() < 1e-9);
        assert!((y.row(1) - y.row(3)).amax() < 1e-9 && (y.row(1) - y.row(4)).amax() < 1e-9);
        assert!((y.row(0) - y.row(1)).amax() > 1e-3);
    }
}

fn waves() -> Vec<Wave> {
    let mut rng = Seed(3).rng();
    let joints = Joints::new(["a", "b"]).unwrap();
    (0..7)
        .map(|_| {
            let mut number = || rng.random_range(-0.2..0.2);
            let weights = DMatrix::from_fn(2, 3, |_, _| Complex::new(number(), number()));
            Wave::new(joints.clone(), 2.0, dvector![number(), number()], weights).unwrap()
        })
        .collect()
}

#[test]
fn a_linear_gaussian_has_the_sample_mean_and_shrinks_correlations_alone() {
    let waves = waves();
    let model = LinearGaussian::of_waves(&waves).unwrap();
    let vector = |w: &Wave| {
        let at = |i: usize| w.weights()[(i / 3, i % 3)];
        let parts = (0..6).map(|i| at(i).re).chain((0..6).map(|i| at(i).im));
        DVector::from_iterator(14, parts.chain(w.offsets().iter().copied()))
    };
    let vectors: Vec<DVector<f64>> = waves.iter().map(vector).collect();
    let mean = vectors.iter().sum::<DVector<f64>>() / 7.0;
    let sample: DMatrix<f64> = vectors
        .iter()
        .map(|x| (x - &mean) * (x - &mean).transpose() / 7.0)
        .sum();
    let found = model.gaussian().covariance();
    assert!((model.gaussian().mean() - &mean).amax() < 1e-15);
    assert!((found.diagonal() - sample.diagonal()).amax() < 1e-15);
    // Between real parts, imaginary parts and offsets the target has nothing: one factor for all.
    let kept = found[(0, 6)] / sample[(0, 6)];
    assert!((-1e-12..0.951).contains(&kept), "{kept}");
    let block = |i: usize| i / 6;
    for i in 0..14 {
        for j in 0..14 {
            if block(i) != block(j) {
                assert!(
                    (found[(i, j)] - kept * sample[(i, j)]).abs() < 1e-15,
                    "{i} {j}"
                );
            }
        }
    }
    // The density of an own demonstration is that of the normal law, by its formula.
    let cholesky = found.cholesky().unwrap();
    let deviation = &vectors[0] - &mean;
    let quadratic = deviation.dot(&cholesky.solve(&deviation));
    let logarithm = 2.0 * cholesky.l().diagonal().iter().map(|l| l.ln()).sum::<f64>();
    let expected = -0.5 * (quadratic + logarithm + 14.0 * TAU.ln());
    let times: Vec<f64> = (0..=60).map(|n| f64::from(n) / 30.0).collect();
    let positions = DMatrix::from_fn(61, 2, |n, d| waves[0].position(times[n])[d]);
    let recording = Recording::new("own", waves[0].joints().clone(), times, positions).unwrap();
    let density = model.log_density(&recording).unwrap();
    assert!((density - expected).abs() < 1e-6, "{density} {expected}");
}

/// Seed 8, N = 2000, false alarm 1e-6: draws at three times are normal, with the mean and covariance that the bases give them.
#[test]
fn a_strokes_draws_follow_its_bases() {
    let model = StrokeProMp::learn(&varied(), 51).unwrap();
    let times = [0.0, 0.4, 1.1];
    let (apart, mut design) = (1.0 / 50.0, DMatrix::zeros(3, 102));
    for (n, t) in times.iter().enumerate() {
        let base = |b: usize| {
            let away = (t / model.duration() - b as f64 * apart) / (WIDTH * apart);
            (-0.5 * away * away).exp()
        };
        let sum: f64 = (0..51).map(base).sum();
        (0..51).for_each(|b| design[(n, b)] = base(b) / sum);
    }
    let mean = &design * model.gaussian().mean();
    let covariance = &design * model.gaussian().covariance() * design.transpose();
    let draws = |scale: f64| -> Vec<DVector<f64>> {
        let draw = |k| {
            let y = model.draw(&times, &mut stream(8, k));
            &mean + scale * (y.column(0) - &mean)
        };
        (0..2000).map(draw).collect()
    };
    let expected = Gaussian::new(mean.clone(), covariance.cholesky().unwrap().unpack()).unwrap();
    gaussian(&draws(1.0), &expected, 1e-6).unwrap();
    assert!(gaussian(&draws(1.2), &expected, 1e-6).is_err());
}

/// The width of a stroke's bases, in their distances.
const WIDTH: f64 = 0.6;

#[test]
fn models_pass_through_what_they_can_and_refuse_what_they_cannot() {
    let recordings = synthetic(0).unwrap().recordings()[..6].to_vec();
    let learn = |kind: ModelKind| kind.learn(&recordings, Resolution::default()).unwrap();
    let joint = "wrist_deviation".to_owned();
    let through = Wish::Position {
        joint: joint.clone(),
        time: 0.5,
        position: 0.1,
    };
    let swing = Wish::Swing { joint, swing: 0.2 };
    for kind in [ModelKind::StrokeProMp, ModelKind::LinearGaussian] {
        let model = learn(kind).condition(&through).unwrap();
        for k in 0..5 {
            let y = model.draw(&[0.0, 0.5], &mut stream(4, k));
            assert!((y[(1, 4)] - 0.1).abs() < 1e-9, "{kind:?} {y}");
        }
        assert!(learn(kind).condition(&swing).is_err());
        assert!(learn(kind).condition(&Wish::Frequency(2.0)).is_err());
    }
    assert!(learn(ModelKind::RhythmicProMp).condition(&swing).is_err());
    assert!(learn(ModelKind::RhythmicProMp).condition(&through).is_err());
    assert!(learn(ModelKind::CommonPeriod).condition(&swing).is_err());
    assert!(learn(ModelKind::Cycle).condition(&swing).is_ok());
    for kind in ModelKind::ALL {
        assert!(
            kind.learn(&recordings[..1], Resolution::default()).is_err(),
            "{kind:?}"
        );
    }
}

/// Seed 5, 400 sets of 12: where intervals cover with the probability that they say, 380 cover, with a standard error of 4.4. The interval of
/// Clopper and Pearson leaves 0.95 out with probability below 1e-6 then, and does where they cover with 0.8.
#[test]
fn intervals_cover_as_often_as_they_say() {
    let covered = |confidence: f64| {
        let mut rng = Seed(5).rng();
        let sets = (0..400u64).filter(|set| {
            let mut normal = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
            let values: Vec<f64> = (0..12).map(|_| normal()).collect();
            let found = Estimate::of_mean(&values, confidence, *set);
            found.lower <= 0.0 && 0.0 <= found.upper
        });
        sets.count() as u64
    };
    let says = |covered: u64, confidence: f64| {
        let (low, high) = clopper_pearson(covered, 400, 1.0 - 1e-6);
        (low..=high).contains(&confidence)
    };
    let found = covered(0.95);
    assert!(says(found, 0.95), "{found}");
    assert!(!says(covered(0.8), 0.95));
}

fn quick(draws: u64) -> ComparisonOptions {
    ComparisonOptions {
        draws,
        threads: 2,
        ..ComparisonOptions::default()
    }
}

#[test]
fn statistics_of_the_demonstrator_are_what_it_was_made_with() {
    let demonstrations = synthetic(0).unwrap();
    let options = ComparisonOptions {
        folds: Some(3),
        ..quick(10)
    };
    let comparison = Comparison::new(demonstrations.recordings(), &options, || ()).unwrap();
    assert_eq!((comparison.demonstrations.len(), comparison.folds), (15, 3));
    let at = |s: Statistic| Statistic::ALL.iter().position(|o| *o == s).unwrap();
    let own = |s: Statistic| comparison.demonstrated[at(s)];
    // From 10 to 20 cycles, denser towards both ends.
    let cycles: Vec<f64> = (0..15)
        .map(|m| 15.0 - 5.0 * (std::f64::consts::PI * f64::from(m) / 14.0).cos())
        .collect();
    let mean = cycles.iter().sum::<f64>() / 15.0;
    let square = cycles.iter().map(|c| (c - mean).powi(2)).sum::<f64>() / 15.0;
    let tempo = own(Statistic::TempoBetween);
    assert!(
        (tempo.value / (square.sqrt() / mean) - 1.0).abs() < 0.03,
        "{tempo:?}"
    );
    // Each joint's lag has a standard deviation of 0.1 rad, so has the dominant one's.
    let phases = own(Statistic::PhaseSpread);
    assert!(
        phases.lower < 0.02f64.sqrt() && 0.02f64.sqrt() < phases.upper,
        "{phases:?}"
    );
    assert_eq!(own(Statistic::Rhythmless).value, 0.0);
    // What its own tests hold of a cycle and of a common period is seen here.
    let of = |kind: ModelKind, s: Statistic| {
        let model = comparison.models.iter().find(|m| m.kind == kind).unwrap();
        model.statistics[at(s)].value / own(s).value
    };
    assert!((of(ModelKind::Cycle, Statistic::Envelope) - 1.0).abs() < 0.25);
    assert!(of(ModelKind::CommonPeriod, Statistic::Envelope) > 3.0);
    assert!(of(ModelKind::RhythmicProMp, Statistic::Envelope) < 0.25);
    // Only a model that has a coordinate for it draws what is asked for.
    let cycle = &comparison.models[0];
    let [plain, swing, frequency] = cycle.given.each_ref().map(|g| g.as_ref().unwrap());
    assert!(swing.swing_off.value < 0.3 * plain.swing_off.value);
    assert!(frequency.frequency_off.value < 0.1 * plain.frequency_off.value);
}

#[test]
fn a_seed_gives_the_same_comparison_on_any_number_of_threads() {
    let recordings = &synthetic(1).unwrap().recordings()[..5].to_vec();
    let with = |threads: usize| {
        let options = ComparisonOptions {
            threads,
            ..quick(3)
        };
        let c = Comparison::new(recordings, &options, || ()).unwrap();
        let models = c
            .models
            .iter()
            .map(|m| format!("{:?}", (&m.statistics, &m.distances, &m.given)));
        (c.demonstrated, c.paired, models.collect::<Vec<_>>())
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let recordings = synthetic(0).unwrap().recordings().to_vec();
    let refused = |recordings: &[Recording], options: &ComparisonOptions| {
        Comparison::new(recordings, options, || ())
            .unwrap_err()
            .to_string()
    };
    assert!(refused(&recordings[..3], &quick(2)).contains("3 of 3 recordings have a rhythm"));
    assert!(refused(&recordings, &quick(1)).contains("1 draws"));
    for folds in [0, 1, 16] {
        let options = ComparisonOptions {
            folds: Some(folds),
            ..quick(2)
        };
        assert!(refused(&recordings, &options).contains("folds"));
    }
    for confidence in [0.0, 1.0, f64::NAN] {
        let options = ComparisonOptions {
            confidence,
            ..quick(2)
        };
        assert!(refused(&recordings, &options).contains("confidence"));
    }
}

/// Prints what is won and lost on real sets; holds what is stable: the envelope and the tempo of draws are nearer with a cycle than with any baseline.
#[test]
fn real_sets_are_compared() {
    let Some(shared) = common::shared("real sets of waves") else {
        return;
    };
    let mut won = [0; 4];
    for set in ["A", "B", "C", "D", "E", "F", "G"] {
        let mut lists = std::fs::read_dir(shared.join("waves/sets"))
            .unwrap()
            .map(|e| e.unwrap().path());
        let named =
            |f: &std::path::PathBuf| f.file_name().unwrap().to_str().unwrap().starts_with(set);
        let files =
            Recording::files_listed(&lists.find(named).unwrap(), Some(&shared.join("waves")))
                .unwrap();
        let open = |f: &std::path::PathBuf| Recording::open(f, &CsvOptions::default()).unwrap();
        let recordings: Vec<Recording> = files.iter().map(open).collect();
        let options = ComparisonOptions {
            folds: Some(4),
            ..quick(20)
        };
        let comparison = Comparison::new(&recordings, &options, || ()).unwrap();
        for p in &comparison.paired {
            let Estimate {
                value,
                lower,
                upper,
            } = p.difference;
            println!(
                "set {set}: {} of {} less that of {}: {value:.3} ({lower:.3} .. {upper:.3})",
                p.distance.name(),
                p.baseline.name(),
                p.ours.name()
            );
        }
        for p in comparison
            .paired
            .iter()
            .filter(|p| p.ours == ModelKind::Cycle)
        {
            assert!(p.difference.upper > 0.0, "set {set} is lost: {p:?}");
            won[p.distance as usize] += usize::from(p.difference.lower > 0.0);
        }
    }
    println!(
        "won, of seven sets: {:?} {won:?}",
        Distance::ALL.map(Distance::name)
    );
    let [_, power, level, course] = won;
    assert!(power >= 3 && level >= 6 && course >= 6, "{won:?}");
}
