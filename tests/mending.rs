//! Waves made executable: at the least change, and then within every limit.
//!
//! `UNDULATE_WAVES=10000` mends so many waves of real demonstrations, shared out over five robots.

mod common;

use rand::distr::Distribution;
use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{
    Change, CheckOptions, CollisionModel, CollisionOptions, CsvOptions, Demonstrations, Derivative,
    Duration, Dynamics, FourierMovementPrimitive, GRAVITY, JointLimit, JointLimits, JointMap,
    LoadOptions, Means, MeshFiles, Motion, PeriodGrid, Reason, Recording, Robot, Spline, Srdf,
    StartPosture, State, Wave, Waypoint, Waypoints, efforts, mend, shipped, stream, synthetic,
};

/// Of the grid on which mended waves are looked at \[Hz\].
const RATE: f64 = 10_000.0;
/// By no more than this may a limit be broken there \[rad, rad/s, N m\].
const EXCESS: f64 = 1e-9;

struct Arm {
    robot: Robot,
    collision: CollisionModel,
}

fn arm(name: &str) -> Arm {
    let robot = shipped::robot(name).unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    Arm { robot, collision }
}

/// The fourth joint of the arm swings by `amplitude` \[rad\] about `offset` at `frequency` \[Hz\], the others stand still.
fn swing(robot: &Robot, amplitude: f64, offset: f64, frequency: f64) -> Wave {
    let mut weights = DMatrix::zeros(6, 1);
    weights[(3, 0)] = Complex::new(amplitude / 2.0, 0.0);
    let mut offsets = DVector::from_element(6, 0.4);
    offsets[3] = offset;
    Wave::new(robot.joints().clone(), 1.0 / frequency, offsets, weights).unwrap()
}

/// An arm that no effort holds back, with a limit of its own.
fn limited(limit: JointLimit) -> CheckOptions {
    CheckOptions {
        limits: JointLimits::default().with(Some("elbow"), limit).unwrap(),
        ..CheckOptions::default()
    }
}

#[test]
fn a_swing_is_slowed_by_as_much_as_its_peaks_are_too_high() {
    let Arm { robot, collision } = arm("wave_arm");
    let wave = swing(&robot, 0.3, 1.2, 0.5);
    let w = wave.angular_frequency();
    let velocity = JointLimit {
        velocity: Some(0.3 * w / 1.5),
        ..JointLimit::default()
    };
    let acceleration = JointLimit {
        acceleration: Some(0.3 * w * w / 2.25),
        ..JointLimit::default()
    };
    for limit in [velocity, acceleration] {
        let options = limited(limit);
        let mut prover = collision.prover();
        let mended = mend(&robot, &mut prover, &wave, &options, &[Means::Slow]).unwrap();
        let [Change::Slowed { factor }] = mended.changes.as_slice() else {
            panic!("{:?}", mended.changes);
        };
        assert!(mended.verdict.passes());
        assert!((factor - 1.5).abs() < 1e-5, "{factor}");
        // No less would do.
        let less = wave.slowed(factor * (1.0 - 1e-5)).unwrap();
        let again = mend(&robot, &mut prover, &less, &options, &[]).unwrap();
        assert!(!again.verdict.passes());
    }
}

#[test]
fn amplitudes_shrink_to_the_limit_and_no_farther() {
    let Arm { robot, collision } = arm("wave_arm");
    let wave = swing(&robot, 0.5, 1.2, 0.5);
    let position = JointLimit {
        position: Some(undulate::Interval {
            lower: 0.0,
            upper: 1.4,
        }),
        ..JointLimit::default()
    };
    let options = limited(position);
    for (means, whose) in [
        (Means::ShrinkOffending, Some("elbow".to_owned())),
        (Means::Shrink, None),
    ] {
        let mut prover = collision.prover();
        let mended = mend(&robot, &mut prover, &wave, &options, &[means]).unwrap();
        let [Change::Shrunk { joint, factor }] = mended.changes.as_slice() else {
            panic!("{:?}", mended.changes);
        };
        assert!(mended.verdict.passes() && *joint == whose);
        assert!((factor - 0.4).abs() < 1e-5, "{factor}");
    }
    // The offset itself beyond the limit: no amplitude helps, a shift does.
    let wave = swing(&robot, 0.1, 1.5, 0.5);
    let mut prover = collision.prover();
    let small = mend(&robot, &mut prover, &wave, &options, &[Means::Shrink]).unwrap();
    assert_eq!(small.verdict.reasons(), [Reason::PositionLimit]);
    let shifted = mend(&robot, &mut prover, &wave, &options, &[Means::Shift]).unwrap();
    let [Change::Shifted { joint, by }] = shifted.changes.as_slice() else {
        panic!("{:?}", shifted.changes);
    };
    assert!(shifted.verdict.passes() && joint == "elbow" && (by + 0.2).abs() < 1e-5);
}

#[test]
fn means_help_in_any_order() {
    let Arm { robot, collision } = arm("wave_arm");
    // Too far bent, and too fast besides: neither hides what the other needs.
    let range = robot.properties(3).position.unwrap();
    let wave = swing(&robot, 0.3, range.upper + 0.1, 4.0);
    for means in [
        [Means::Shift, Means::ShrinkOffending],
        [Means::ShrinkOffending, Means::Shift],
    ] {
        let options = CheckOptions::default();
        let mended = mend(&robot, &mut collision.prover(), &wave, &options, &means).unwrap();
        // What so bent an arm hits is no matter of these means.
        let reasons = mended.verdict.reasons();
        let limits = [Reason::PositionLimit, Reason::VelocityLimit];
        assert!(
            !limits.iter().any(|r| reasons.contains(r)),
            "{means:?}: {reasons:?}"
        );
    }
}

/// The arm with friction in its elbow.
fn rubbing() -> Robot {
    let text = shipped::robot_text("wave_arm").unwrap();
    let at = text.find("<joint name=\"elbow\"").unwrap();
    let end = at + text[at..].find("</joint>").unwrap();
    let joint = &text[at..end];
    let joint = match joint.find("<dynamics") {
        Some(start) => {
            let stop = start + joint[start..].find("/>").unwrap() + 2;
            format!("{}{}", &joint[..start], &joint[stop..])
        }
        None => joint.to_owned(),
    };
    let friction = "<dynamics damping=\"0.1\" friction=\"3\"/>";
    Robot::from_urdf(&format!("{}{joint}{friction}{}", &text[..at], &text[end..])).unwrap()
}

#[test]
fn efforts_are_told_on_both_sides_of_their_jumps() {
    // A joint that turns back while it is lifted: friction changes sign where the torque is largest.
    let robot = rubbing();
    let wave = swing(&robot, 0.3, 1.2, 0.7);
    let told = efforts(&robot, &wave).unwrap();
    let elbow = told.iter().find(|e| e.joint == "elbow").unwrap();
    let mut dynamics = Dynamics::new(&robot);
    let (mut lower, mut upper) = (f64::INFINITY, f64::NEG_INFINITY);
    for n in 0..200_000 {
        let state = wave.state(wave.period() * f64::from(n) / 200_000.0);
        let [q, v, a] =
            [&state.position, &state.velocity, &state.acceleration].map(|x| x.as_slice());
        let tau = dynamics.inverse(&robot, q, v, a, &GRAVITY)[3];
        let rubbed = tau + 0.1 * v[3] + 3.0 * v[3].signum();
        (lower, upper) = (lower.min(rubbed), upper.max(rubbed));
    }
    let slack = 1e-6 * (upper - lower);
    assert!(elbow.range.lower <= lower + slack, "{elbow:?} {lower}");
    assert!(elbow.range.upper >= upper - slack, "{elbow:?} {upper}");
    // A cubic move: accelerations jump at its waypoints, to where no sample within is.
    let joints = robot.joints().clone();
    // Time, position, velocity.
    let rows = [[0.0, 0.9, 2.0], [1.0, 1.5, -2.0], [1.6, 0.9, 0.0]];
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for [_, position, velocity] in rows {
        let (mut at, mut rate) = (vec![0.4; 6], vec![0.0; 6]);
        (at[3], rate[3]) = (position, velocity);
        q.push(at);
        v.push(rate);
    }
    let waypoints = rows.iter().enumerate().map(|(n, row)| Waypoint {
        time: row[0],
        positions: &q[n],
        velocities: Some(&v[n]),
        accelerations: None,
    });
    let waypoints = Waypoints::new(joints, waypoints).unwrap();
    let spline = Spline::new(&waypoints, StartPosture::Given).unwrap();
    let told = efforts(&robot, &spline).unwrap();
    let elbow = told.iter().find(|e| e.joint == "elbow").unwrap();
    let mut state = State::zeros(6);
    for time in [1e-7, 1.0 - 1e-7, 1.0 + 1e-7, 1.6 - 1e-7] {
        spline.state_into(time, &mut state);
        let [q, v, a] =
            [&state.position, &state.velocity, &state.acceleration].map(|x| x.as_slice());
        let tau = dynamics.inverse(&robot, q, v, a, &GRAVITY)[3];
        let rubbed = tau + 0.1 * v[3] + 3.0 * v[3].signum();
        assert!(
            (elbow.range.lower - 1e-4..=elbow.range.upper + 1e-4).contains(&rubbed),
            "{time}: {rubbed} {elbow:?}"
        );
    }
}

#[test]
fn what_passes_is_left_alone() {
    let Arm { robot, collision } = arm("wave_arm");
    let wave = swing(&robot, 0.1, 1.2, 0.5);
    let means = [Means::Shift, Means::Slow, Means::Shrink];
    let options = CheckOptions::default();
    let mended = mend(&robot, &mut collision.prover(), &wave, &options, &means).unwrap();
    assert!(mended.verdict.passes() && mended.changes.is_empty() && mended.wave == wave);
}

#[test]
fn efforts_are_those_of_inverse_dynamics_on_a_fine_grid() {
    let Arm { robot, .. } = arm("wave_arm");
    let mut weights = DMatrix::zeros(6, 5);
    for j in 0..6 {
        for k in 0..5 {
            weights[(j, k)] = Complex::from_polar(0.04, (3 * j + 5 * k) as f64);
        }
    }
    let wave = Wave::new(
        robot.joints().clone(),
        1.7,
        DVector::from_element(6, 0.5),
        weights,
    )
    .unwrap();
    let found = efforts(&robot, &wave).unwrap();
    let mut dynamics = Dynamics::new(&robot);
    let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 6];
    for n in 0..100_000 {
        let s = wave.state(1.7e-5 * f64::from(n));
        dynamics.inverse(
            &robot,
            s.position.as_slice(),
            s.velocity.as_slice(),
            s.acceleration.as_slice(),
            &GRAVITY,
        );
        for (range, (body, joint)) in ranges.iter_mut().zip(robot.moving()) {
            let rate = s.velocity[joint.index];
            let own = &joint.properties;
            let effort = dynamics.body_efforts()[body]
                + own.damping * rate
                + own.friction * if rate == 0.0 { 0.0 } else { rate.signum() };
            *range = (range.0.min(effort), range.1.max(effort));
        }
    }
    for (found, (low, high)) in found.iter().zip(ranges) {
        let scale = 1e-6 * (high - low);
        assert!(
            (found.range.lower - low).abs() < scale && (found.range.upper - high).abs() < scale,
            "{found:?}, on the grid {low} .. {high}"
        );
    }
}

/// A robot, its collision model, and what puts a demonstrated wave on it.
type Target = (String, Robot, CollisionModel, JointMap);

/// As a map for the UR5: axes of a person on joints of the robot that swing likewise.
const UR5: &str = r#"
[joints.shoulder_pan_joint]
from = "shoulder_rotation"
[joints.shoulder_lift_joint]
from = "shoulder_flexion"
offset = "-90deg"
[joints.elbow_joint]
from = "elbow_flexion"
[joints.wrist_1_joint]
from = "forearm_pronation"
offset = "-90deg"
[joints.wrist_2_joint]
from = "wrist_deviation"
[joints.wrist_3_joint]
from = "wrist_flexion"
"#;

fn sources() -> (FourierMovementPrimitive, Vec<Target>) {
    let names = ["wave_arm", "wave_arm_left", "table_arm", "column_arm"];
    let shared = common::shared("mending of real waves on a real robot");
    let which = if shared.is_some() {
        "human"
    } else {
        "demonstrator"
    };
    let mut targets: Vec<Target> = names
        .iter()
        .map(|name| {
            let Arm { robot, collision } = arm(name);
            let map = shipped::map(&format!("{name}_{which}")).unwrap();
            ((*name).to_owned(), robot, collision, map)
        })
        .collect();
    let Some(shared) = shared else {
        let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 25).unwrap();
        return (primitive, targets);
    };
    let folder = shared.join("robots/ur5");
    let options = LoadOptions {
        meshes: MeshFiles::Folders(vec![folder.clone()]),
        ..LoadOptions::default()
    };
    let robot = Robot::open_with(&folder.join("ur5_robot.urdf"), options).unwrap();
    let options = CollisionOptions {
        disabled: Srdf::open(&folder.join("ur5.srdf"))
            .unwrap()
            .disabled()
            .to_vec(),
        always_touching: Some((200, 0)),
        ..CollisionOptions::default()
    };
    let collision = CollisionModel::new(&robot, &options).unwrap();
    targets.push((
        "ur5".to_owned(),
        robot,
        collision,
        JointMap::from_toml(UR5).unwrap(),
    ));
    let root = shared.join("waves");
    let list = root.join("sets/A_right_normal_1p5_3hz.txt");
    let files = Recording::files_listed(&list, Some(&root)).unwrap();
    let recordings = files
        .iter()
        .map(|file| Recording::open(file, &CsvOptions::default()).unwrap())
        .collect();
    let demonstrations = Demonstrations::new(recordings, Duration::Auto).unwrap();
    let primitive = FourierMovementPrimitive::learn(&demonstrations, 20).unwrap();
    (primitive, targets)
}

/// The farthest that a wave leaves the limits of a robot on the grid.
fn worst(robot: &Robot, wave: &Wave) -> f64 {
    let points = (RATE * wave.period()).ceil() as usize;
    let grid = PeriodGrid::new(points, wave.harmonics());
    let [q, v, a] = [
        Derivative::Position,
        Derivative::Velocity,
        Derivative::Acceleration,
    ]
    .map(|derivative| wave.on_grid(&grid, derivative));
    let mut dynamics = Dynamics::new(robot);
    let row = |table: &DMatrix<f64>, n: usize| table.row(n).iter().copied().collect::<Vec<f64>>();
    let mut worst = f64::NEG_INFINITY;
    for n in 0..points {
        let (q, v, a) = (row(&q, n), row(&v, n), row(&a, n));
        dynamics.inverse(robot, &q, &v, &a, &GRAVITY);
        for (body, joint) in robot.moving() {
            let own = &joint.properties;
            let position = joint.multiplier * q[joint.index] + joint.offset;
            let rate = joint.multiplier * v[joint.index];
            let friction = if rate == 0.0 { 0.0 } else { rate.signum() };
            let effort =
                dynamics.body_efforts()[body] + own.damping * rate + own.friction * friction;
            if let Some(range) = own.position {
                worst = worst
                    .max(range.lower - position)
                    .max(position - range.upper);
            }
            if let Some(limit) = own.velocity {
                worst = worst.max(rate.abs() - limit);
            }
            if let Some(limit) = own.effort {
                worst = worst.max(effort.abs() - limit);
            }
        }
    }
    worst
}

#[test]
fn mended_waves_keep_every_limit() {
    let (primitive, targets) = sources();
    let asked = std::env::var("UNDULATE_WAVES").map_or(10 * targets.len() as u64, |n| {
        n.parse().expect("UNDULATE_WAVES is a number")
    });
    let each = asked.div_ceil(targets.len() as u64);
    let means = [
        Means::Shift,
        Means::ShrinkOffending,
        Means::Slow,
        Means::Shrink,
    ];
    for (name, robot, collision, map) in &targets {
        let mut prover = collision.prover();
        let (mut whole, mut by, mut lost) = (0, [0; 4], 0);
        for draw in 0..each {
            let wave = primitive.sample(&mut stream(11, draw));
            let wave = map.apply(&wave, robot).unwrap();
            let options = CheckOptions::default();
            let mended = mend(robot, &mut prover, &wave, &options, &means).unwrap();
            if !mended.verdict.passes() {
                lost += 1;
                continue;
            }
            if mended.changes.is_empty() {
                whole += 1;
            }
            for (n, count) in by.iter_mut().enumerate() {
                let is = |change: &Change| match change {
                    Change::Shifted { .. } => n == 0,
                    Change::Shrunk { joint, .. } => n == if joint.is_some() { 1 } else { 3 },
                    Change::Slowed { .. } => n == 2,
                };
                *count += usize::from(mended.changes.iter().any(is));
            }
            let worst = worst(robot, &mended.wave);
            assert!(worst <= EXCESS, "{name}, draw {draw}: {worst}");
        }
        println!(
            "{name}: {each} waves, {whole} pass as they are; shifted {}, joints shrunk {}, slowed {}, all shrunk {}; not to be mended {lost}",
            by[0], by[1], by[2], by[3]
        );
        assert!(lost < each, "{name}: none could be mended");
    }
}
