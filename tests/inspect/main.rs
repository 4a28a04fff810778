//! Uncut recordings: the rhythmic part is found, what may spoil it is named, and where there is no rhythm it is said.

#[path = "../common/mod.rs"]
mod common;
mod noise;
mod windows;

use std::f64::consts::TAU;

use rand::distr::Distribution;
use rand_distr::StandardNormal;
use undulate::nalgebra::DMatrix;
use undulate::{Flag, Inspection, Joints, Recording, RhythmicPart, Variation, stream, synthetic};

/// Samples a second.
const RATE: f64 = 60.0;
const FREQUENCY: f64 = 1.7;

/// What an arm of three joints does: it hangs, is raised, waves about a posture, is lowered.
#[derive(Clone, Copy)]
struct Take {
    /// Each wave from when to when \[s\].
    waves: &'static [(f64, f64)],
    span: f64,
    /// Of the posture \[rad/s\].
    drift: f64,
    /// Standard deviation of what is seen \[rad\].
    noise: f64,
}

/// How long the arm takes from one posture to another \[s\].
const RAISING: f64 = 0.8;

impl Take {
    fn new(span: f64, waves: &'static [(f64, f64)]) -> Self {
        Self {
            waves,
            span,
            drift: 0.0,
            noise: 0.0,
        }
    }

    /// 0 where the arm hangs, 1 where it is raised, smooth between; waves begin and end with it raised.
    fn raised(&self, t: f64) -> f64 {
        let smooth = |x: f64| {
            let x = x.clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x)
        };
        let of = |(start, end): &(f64, f64)| {
            smooth((t - start + RAISING) / RAISING).min(smooth((end + RAISING - t) / RAISING))
        };
        self.waves.iter().map(of).fold(0.0, f64::max)
    }

    fn at(&self, t: f64, joint: usize) -> f64 {
        let raised = [1.9, -0.8, 1.4][joint] * self.raised(t);
        let swing: f64 = self
            .waves
            .iter()
            .filter(|(start, end)| (*start..*end).contains(&t))
            .map(|(start, _)| {
                // Each begins at a turning point, from rest.
                let phase = TAU * FREQUENCY * (t - start);
                [0.05, 0.35, 0.2][joint] * (1.0 - phase.cos())
            })
            .sum();
        raised + swing + self.drift * t * [1.0, 0.5, -0.7][joint]
    }

    fn recorded(&self) -> Recording {
        let times: Vec<f64> = (0..=(self.span * RATE) as usize)
            .map(|n| n as f64 / RATE)
            .collect();
        let mut rng = stream(5, 0);
        let positions = DMatrix::from_fn(times.len(), 3, |n, d| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            self.at(times[n], d) + self.noise * noise
        });
        Recording::new("take", joints(), times, positions).unwrap()
    }
}

fn joints() -> Joints {
    Joints::new(["pan", "lift", "elbow"]).unwrap()
}

/// Whole cycles of 1.7 Hz, 8 and 6 of them.
const ONE: &[(f64, f64)] = &[(2.0, 2.0 + 8.0 / FREQUENCY)];
const TWO: &[(f64, f64)] = &[(2.0, 2.0 + 8.0 / FREQUENCY), (11.0, 11.0 + 6.0 / FREQUENCY)];

fn overlap(part: &RhythmicPart, start: f64, end: f64) -> f64 {
    let both = (part.end.min(end) - part.start.max(start)).max(0.0);
    both / (part.end.max(end) - part.start.min(start))
}

fn codes(recording: &Recording) -> Vec<&'static str> {
    let inspection = Inspection::of(recording).unwrap();
    inspection.findings.iter().map(|f| f.flag.code()).collect()
}

/// The samples that `keeps` takes.
fn thinned(recording: &Recording, keeps: impl Fn(f64) -> bool) -> Recording {
    let kept: Vec<usize> = (0..recording.times().len())
        .filter(|n| keeps(recording.times()[*n]))
        .collect();
    let times = kept.iter().map(|n| recording.times()[*n]).collect();
    let positions = recording.positions().select_rows(&kept);
    Recording::new("thinned", joints(), times, positions).unwrap()
}

#[test]
fn raising_and_lowering_are_left_out_whatever_the_drift_and_noise() {
    for (drift, noise) in [(0.0, 0.0), (0.03, 0.0), (0.0, 0.01), (-0.05, 0.02)] {
        let take = Take {
            drift,
            noise,
            ..Take::new(10.0, ONE)
        };
        let parts = take.recorded().rhythmic_parts();
        assert_eq!(parts.len(), 1, "{parts:?}");
        let (start, end) = ONE[0];
        let overlap = overlap(&parts[0], start, end);
        println!("drift {drift}, noise {noise}: {overlap:.2}, {:?}", parts[0]);
        assert!(overlap > 0.85, "{parts:?}");
        assert!((parts[0].frequency / FREQUENCY - 1.0).abs() < 0.05);
        assert!((parts[0].cycles - 8.0).abs() <= 0.5);
        assert_eq!(parts[0].whole_cycles().cycles.fract(), 0.0);
    }
}

#[test]
fn two_waves_are_two_parts_and_two_gestures() {
    let recording = Take::new(17.0, TWO).recorded();
    let parts = recording.rhythmic_parts();
    assert_eq!(parts.len(), 2, "{parts:?}");
    for (part, (start, end)) in parts.iter().zip(TWO) {
        assert!(overlap(part, *start, *end) > 0.8, "{part:?}");
    }
    let gestures = recording.gestures();
    assert_eq!(gestures.len(), 2);
    assert!(gestures[1].times()[0] > 10.0 && gestures[1].name().starts_with("take, "));
    assert!(codes(&recording).contains(&"several-parts"));
    assert!(!Inspection::of(&recording).unwrap().is_spoilt());
}

#[test]
fn no_rhythm_and_one_cycle_are_called_so() {
    let still = Take::new(6.0, &[]);
    let raised = Take::new(8.0, &[(2.0, 2.0)]);
    let once = Take::new(5.0, &[(2.0, 2.0 + 1.0 / FREQUENCY)]);
    for (name, take) in [("still", still), ("raised", raised), ("once", once)] {
        let recording = take.recorded();
        assert!(recording.rhythmic_parts().is_empty(), "{name}");
        assert_eq!(
            recording.gestures(),
            std::slice::from_ref(&recording),
            "{name}"
        );
        let codes = codes(&recording);
        println!("{name}: {codes:?}");
        assert!(
            codes.contains(&"no-rhythm") || codes.contains(&"few-cycles"),
            "{name}"
        );
    }
    // One cycle, cut as a window.
    let window = thinned(&once.recorded(), |t| {
        (2.0..2.0 + 1.0 / FREQUENCY).contains(&t)
    });
    assert!(codes(&window).contains(&"few-cycles"));
}

/// From after the seventh cycle of eight, to where the arm hangs again, and while it hangs.
#[test]
fn a_gap_that_ends_a_part_is_told_and_one_far_from_it_is_not() {
    let take = Take::new(12.0, ONE).recorded();
    let end = 2.0 + 7.0 / FREQUENCY;
    let told = thinned(&take, |t| !(end..end + 1.6).contains(&t));
    assert!(codes(&told).contains(&"gap"), "{:?}", codes(&told));
    let parts = told.rhythmic_parts();
    assert!(parts.len() == 1 && parts[0].end <= end, "{parts:?}");
    let far = thinned(&take, |t| !(9.0..10.6).contains(&t));
    assert_eq!(codes(&far), Vec::<&str>::new());
}

#[test]
fn gaps_and_frozen_frames_are_named_and_bridged() {
    let whole = Take::new(10.0, ONE).recorded();
    let gap = thinned(&whole, |t| !(4.0..4.6).contains(&t));
    let mut positions = whole.positions().clone();
    let frozen = 240..276;
    for n in frozen {
        for d in 0..3 {
            positions[(n, d)] = positions[(239, d)];
        }
    }
    let frozen = Recording::new("frozen", joints(), whole.times().to_vec(), positions).unwrap();
    for (recording, code) in [(gap, "gap"), (frozen, "frozen-frames")] {
        let parts = recording.rhythmic_parts();
        assert_eq!(parts.len(), 1, "{code}: {parts:?}");
        assert!(overlap(&parts[0], ONE[0].0, ONE[0].1) > 0.85);
        assert!((parts[0].cycles - 8.0).abs() <= 1.0, "{parts:?}");
        let inspection = Inspection::of(&recording).unwrap();
        let [finding] = inspection.findings.as_slice() else {
            panic!("{:?}", inspection.findings);
        };
        assert_eq!(finding.flag.code(), code);
        assert!((finding.time.unwrap() - 4.0).abs() < 0.05 && (finding.value - 0.6).abs() < 0.05);
    }
    assert_eq!(codes(&whole), Vec::<&str>::new());
}

#[test]
fn jumps_of_whole_turns_are_named_and_taken_out() {
    let whole = Take::new(10.0, ONE).recorded();
    let mut positions = whole.positions().clone();
    for n in 300..400 {
        positions[(n, 1)] += TAU;
    }
    let times = whole.times().to_vec();
    let jumping = Recording::new("jumping", joints(), times, positions).unwrap();
    let inspection = Inspection::of(&jumping).unwrap();
    let jump = inspection
        .findings
        .iter()
        .find(|f| f.flag == Flag::TurnJump)
        .unwrap();
    assert_eq!((jump.time, jump.value), (Some(5.0), 2.0));
    assert_eq!(jump.joint.as_deref(), Some("lift"));
    assert!(overlap(&inspection.parts[0], ONE[0].0, ONE[0].1) > 0.85);
    let mended = jumping.unwrapped();
    assert!((mended.positions() - whole.positions()).amax() < 1e-12);
    assert_eq!(whole.unwrapped(), whole);
    assert!(codes(&mended).is_empty());
}

#[test]
fn a_still_joint_a_fast_one_and_a_singular_shoulder_are_named() {
    let names = [
        "shoulder_flexion",
        "shoulder_abduction",
        "shoulder_rotation",
        "elbow_flexion",
        "wrist_deviation",
    ];
    let times: Vec<f64> = (0..=300).map(|n| f64::from(n) / RATE).collect();
    let positions = DMatrix::from_fn(times.len(), 5, |n, d| {
        let swing = (TAU * FREQUENCY * times[n]).sin();
        match d {
            0 => 0.2 * swing + if n == 150 { 0.6 } else { 0.0 },
            1 => 1.4 + 0.1 * swing,
            2 => 0.3,
            _ => 1.0 + 0.4 * swing,
        }
    });
    let joints = Joints::new(names).unwrap();
    let recording = Recording::new("shoulder", joints, times, positions).unwrap();
    let inspection = Inspection::of(&recording).unwrap();
    let joint = |flag: Flag| {
        let finding = inspection.findings.iter().find(|f| f.flag == flag);
        finding.and_then(|f| f.joint.clone())
    };
    assert_eq!(joint(Flag::StillJoint).as_deref(), Some(names[2]));
    assert_eq!(joint(Flag::FastJump).as_deref(), Some(names[0]));
    assert!(joint(Flag::Gimbal).is_some());
    assert_eq!(joint(Flag::Gap), None);
}

#[test]
fn slow_drift_goes_and_the_rhythm_stays() {
    let times: Vec<f64> = (0..=720).map(|n| f64::from(n) / RATE).collect();
    let recorded = |slow: f64| {
        let positions = DMatrix::from_fn(times.len(), 3, |n, d| {
            let t = times[n];
            let swing = 0.3 * (TAU * FREQUENCY * t + d as f64).sin();
            0.5 + swing + slow * (TAU * t / 12.0).sin()
        });
        Recording::new("slow", joints(), times.clone(), positions).unwrap()
    };
    let (steady, drifting) = (recorded(0.0), recorded(0.4));
    let rest = |r: &Recording| (r.positions() - steady.positions()).norm();
    let before = rest(&drifting);
    let (line, slow) = (
        rest(&drifting.without_drift()),
        rest(&drifting.without_slow_drift()),
    );
    println!(
        "drift left: line {:.2}, slow {:.2}",
        line / before,
        slow / before
    );
    assert!(slow < 0.15 * before && slow < 0.5 * line);
    // Without a drift next to nothing goes.
    assert!(rest(&steady.without_slow_drift()) < 0.05 * steady.positions().norm());
}

#[test]
fn the_odd_one_of_a_set_is_named() {
    // The slowest wave of each of six demonstrators.
    let slowest = |seed| synthetic(seed).unwrap().recordings()[0].clone();
    let mut recordings: Vec<Recording> = (0..6).map(slowest).collect();
    // Some have the shoulder near its singularity, which makes none odd.
    let odd_flags = |recordings: &[Recording]| -> Vec<Vec<Flag>> {
        let odd = [Flag::OddFrequency, Flag::OddSize, Flag::OddPosture];
        let inspections = Inspection::of_set(recordings).unwrap();
        let flags = inspections.iter().map(|inspection| {
            let mut flags: Vec<Flag> = inspection.findings.iter().map(|f| f.flag).collect();
            flags.retain(|f| odd.contains(f));
            flags.dedup();
            flags
        });
        flags.collect()
    };
    assert!(odd_flags(&recordings).iter().all(Vec::is_empty));
    let odd = &recordings[3];
    let mut positions = odd.positions().clone();
    for mut column in positions.column_iter_mut() {
        let mean = column.mean();
        column.apply(|y| *y = mean + 2.5 * (*y - mean));
    }
    positions.column_mut(0).add_scalar_mut(1.0);
    let times = odd.times().iter().map(|t| 2.0 * t).collect();
    recordings[3] = Recording::new("odd", odd.joints().clone(), times, positions).unwrap();
    for (i, flags) in odd_flags(&recordings).into_iter().enumerate() {
        let expected = if i == 3 {
            vec![Flag::OddFrequency, Flag::OddSize, Flag::OddPosture]
        } else {
            Vec::new()
        };
        assert_eq!(flags, expected, "recording {i}");
    }
}

/// From 1.5 to 3 Hz they are too unlike for the spread alone to tell 4.5 Hz from them.
#[test]
fn twice_the_usual_frequency_is_odd_however_the_others_vary() {
    let mut recordings = synthetic(0).unwrap().recordings().to_vec();
    let last = recordings.pop().unwrap();
    let times = last.times().iter().map(|t| t / 1.5).collect();
    let positions = last.positions().clone();
    recordings.push(Recording::new("fast", last.joints().clone(), times, positions).unwrap());
    for inspection in Inspection::of_set(&recordings).unwrap() {
        let is_odd = inspection
            .findings
            .iter()
            .any(|f| f.flag == Flag::OddFrequency);
        assert_eq!(is_odd, inspection.name == "fast", "{}", inspection.name);
    }
}

#[test]
fn recordings_that_are_hardly_any_are_looked_at_without_a_panic() {
    let recording = |times: Vec<f64>| {
        let positions = DMatrix::from_fn(times.len(), 3, |n, d| (n * (d + 1)) as f64);
        Recording::new("r", joints(), times, positions).unwrap()
    };
    for times in [
        vec![0.0, 1.0],
        vec![0.0, 1e-300],
        vec![-1e9, 0.0, 1e9],
        vec![0.0, 1e-9, 1e12],
        (0..50).map(|n| 20.0 * f64::from(n)).collect(),
        (0..500).map(|n| 1e-6 * f64::from(n)).collect(),
    ] {
        let recording = recording(times);
        let inspection = Inspection::of(&recording).unwrap();
        assert!(inspection.parts.is_empty() && inspection.is_spoilt());
        assert_eq!(recording.gestures().len(), 1);
        assert_eq!(recording.without_slow_drift(), recording.without_drift());
    }
    let huge = DMatrix::from_fn(100, 3, |n, _| if n % 2 == 0 { 1e308 } else { -1e308 });
    let times = (0..100).map(|n| f64::from(n) / RATE).collect();
    let huge = Recording::new("huge", joints(), times, huge).unwrap();
    assert!(Inspection::of(&huge).unwrap().is_spoilt());
}

#[test]
fn codes_are_unique_and_explained() {
    let mut codes: Vec<&str> = Flag::ALL.iter().map(|f| f.code()).collect();
    assert!(Flag::ALL.iter().all(|f| !f.meaning().is_empty()));
    codes.sort_unstable();
    codes.dedup();
    assert_eq!(codes.len(), Flag::ALL.len());
}

#[test]
fn what_is_a_rhythm_from_end_to_end_stays_as_it_is() {
    for seed in 0..3 {
        for recording in synthetic(seed).unwrap().recordings() {
            assert_eq!(recording.gestures(), std::slice::from_ref(recording));
            let parts = recording.rhythmic_parts();
            let [part] = parts.as_slice() else {
                panic!("{}: {parts:?}", recording.name());
            };
            assert!(part.duration() > 0.9 * recording.span(), "{part:?}");
        }
    }
}

#[test]
fn an_hour_is_inspected() {
    let mut recording = Take::new(3600.0, &[(2.0, 1800.0), (2400.0, 3000.0)]).recorded();
    let inspection = Inspection::of(&recording).unwrap();
    assert_eq!(inspection.parts.len(), 2, "{:?}", inspection.parts);
    assert!(overlap(&inspection.parts[0], 2.0, 1800.0) > 0.99);
    recording = recording.gestures().remove(0);
    let variation = Variation::of(&recording).unwrap();
    assert!((variation.frequency / FREQUENCY - 1.0).abs() < 1e-3);
}
