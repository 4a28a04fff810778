//! Beginnings, ends and changes of waves: smooth, within limits, clear; and a stop at every tick.

use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{
    CheckOptions, Checker, CollisionModel, CollisionOptions, JointLimit, JointLimits, Leg, Motion,
    Passages, Planner, Player, Reason, Robot, Scene, State, Verdict, Wave, shipped, stream,
    synthetic,
};
use undulate::{FourierMovementPrimitive, Means, mend, rand::distr::Distribution};

/// Of controllers \[s\].
const STEP: f64 = 1e-3;

struct Arm {
    robot: Robot,
    collision: CollisionModel,
    waves: Vec<Wave>,
}

/// A shipped robot with waves of the demonstrator that it can do.
fn arm(name: &str, count: usize) -> Arm {
    let robot = shipped::robot(name).unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 25).unwrap();
    let map = shipped::map(&format!("{name}_demonstrator")).unwrap();
    let means = [Means::Shift, Means::ShrinkOffending, Means::Slow];
    let mut waves = Vec::new();
    for draw in 0.. {
        let wave = map
            .apply(&primitive.sample(&mut stream(5, draw)), &robot)
            .unwrap();
        let options = CheckOptions::default();
        let mended = mend(&robot, &mut collision.prover(), &wave, &options, &means).unwrap();
        if mended.verdict.passes() {
            waves.push(mended.wave);
        }
        if waves.len() == count {
            break;
        }
    }
    Arm {
        robot,
        collision,
        waves,
    }
}

/// Looks at states tick by tick: limits, contact, and that each follows from the one before.
struct Watch<'a> {
    robot: &'a Robot,
    checker: Checker<'a>,
    before: Option<State>,
}

impl<'a> Watch<'a> {
    fn new(arm: &'a Arm) -> Self {
        Self {
            robot: &arm.robot,
            checker: arm.collision.checker(),
            before: None,
        }
    }

    fn see(&mut self, state: &State) {
        let q = state.position.as_slice();
        assert!(self.checker.collision(q).is_none(), "contact at {q:?}");
        for (j, position) in q.iter().enumerate() {
            let own = self.robot.properties(j);
            assert!(own.position.is_none_or(|range| range.contains(*position)));
            assert!(
                own.velocity
                    .is_none_or(|limit| state.velocity[j].abs() <= limit)
            );
        }
        if let Some(before) = &self.before {
            for (j, position) in q.iter().enumerate() {
                let [a, b] = [&before.acceleration, &state.acceleration].map(|a| a[j]);
                // No jump: the jerk makes the change, and where it turns within a tick the snap, below 1e5 rad/s^4.
                let jerk = before.jerk[j].abs().max(state.jerk[j].abs());
                assert!((b - a).abs() <= 2.0 * jerk * STEP + 1e5 * STEP * STEP);
                // The trapezoidal rule, up to the third derivative.
                let jerk = jerk + (b - a).abs() / STEP;
                let ahead = before.velocity[j] + 0.5 * STEP * (a + b);
                assert!((state.velocity[j] - ahead).abs() <= jerk * STEP * STEP + 1e-12);
                let ahead =
                    before.position[j] + 0.5 * STEP * (before.velocity[j] + state.velocity[j]);
                let bend = a.abs().max(b.abs()) + jerk * STEP;
                assert!((position - ahead).abs() <= bend * STEP * STEP + 1e-12);
            }
        }
        self.before = Some(state.clone());
    }
}

#[test]
fn waves_begin_and_end_at_rest() {
    for name in shipped::robots() {
        let arm = arm(name, 2);
        let rest = arm.robot.rest();
        for wave in &arm.waves {
            let options = CheckOptions::default();
            let mut passages = Passages::new(&arm.robot, arm.collision.prover(), options);
            let performance = passages.perform(&[wave], &rest, 3.0).unwrap();
            assert!(performance.verdict.passes());
            let sequence = performance.sequence;
            println!("{name}: legs end at {:?} s", &sequence.times()[1..]);
            let [Leg::Move(_), Leg::Wave { duration, .. }, Leg::Move(_)] = sequence.legs() else {
                panic!("{:?}", sequence.legs());
            };
            assert!(*duration >= 3.0 && *duration <= 3.0 + wave.period());
            let mut state = State::zeros(rest.len());
            for time in [0.0, sequence.duration()] {
                sequence.state_into(time, &mut state);
                assert!((&state.position - DVector::from_column_slice(&rest)).amax() < 1e-12);
                assert!(state.velocity.amax() < 1e-9 && state.acceleration.amax() < 1e-6);
            }
            let mut watch = Watch::new(&arm);
            for n in 0..=(sequence.duration() / STEP) as usize {
                sequence.state_into(n as f64 * STEP, &mut state);
                watch.see(&state);
            }
        }
    }
}

#[test]
fn one_wave_goes_over_into_the_next() {
    let arm = arm("column_arm", 3);
    let options = CheckOptions::default();
    let mut passages = Passages::new(&arm.robot, arm.collision.prover(), options);
    let waves: Vec<&Wave> = arm.waves.iter().collect();
    let performance = passages.perform(&waves, &arm.robot.rest(), 2.0).unwrap();
    let sequence = performance.sequence;
    assert_eq!(sequence.legs().len(), 7);
    let mut watch = Watch::new(&arm);
    let mut state = State::zeros(7);
    for n in 0..=(sequence.duration() / STEP) as usize {
        sequence.state_into(n as f64 * STEP, &mut state);
        watch.see(&state);
    }
    assert!(passages.perform(&[], &arm.robot.rest(), 2.0).is_err());
}

#[test]
fn what_cannot_begin_is_refused_with_its_reason() {
    let arm = arm("wave_arm", 1);
    let wave = &arm.waves[0];
    let options = CheckOptions::default();
    let mut passages = Passages::new(&arm.robot, arm.collision.prover(), options.clone());
    let mut beyond = arm.robot.rest();
    beyond[3] = 9.0;
    let error = passages.perform(&[wave], &beyond, 1.0).unwrap_err();
    assert_eq!(Reason::of(&error), Reason::PositionLimit, "{error}");
    let fast = wave.slowed(0.05).unwrap();
    let error = passages
        .perform(&[&fast], &arm.robot.rest(), 1.0)
        .unwrap_err();
    assert_eq!(Reason::of(&error), Reason::VelocityLimit, "{error}");
    assert!(passages.perform(&[wave], &[0.0], 1.0).is_err());
    assert!(
        passages
            .perform(&[wave], &arm.robot.rest(), f64::NAN)
            .is_err()
    );
    assert!(Planner::new(&arm.robot, &arm.collision, options, 0.0).is_err());
}

#[test]
fn a_posture_that_touches_is_refused() {
    // The upper arm turned into the torso: found by looking.
    let arm = arm("wave_arm", 1);
    let mut checker = arm.collision.checker();
    let mut random = stream(0, 0);
    let touching = std::iter::repeat_with(|| -> Vec<f64> {
        (0..6)
            .map(|j| {
                let range = arm.robot.properties(j).position.unwrap();
                let unit: f64 = undulate::rand::RngExt::random(&mut random);
                range.lower + unit * range.width()
            })
            .collect()
    })
    .find(|q| checker.collision(q).is_some())
    .unwrap();
    let options = CheckOptions::default();
    let mut passages = Passages::new(&arm.robot, arm.collision.prover(), options);
    let error = passages
        .perform(&[&arm.waves[0]], &touching, 1.0)
        .unwrap_err();
    assert_eq!(Reason::of(&error), Reason::SelfCollision, "{error}");
}

/// Ticks a player until a time \[s\].
fn play(player: &mut Player, watch: &mut Watch<'_>, until: f64) {
    let mut state = State::zeros(player.joints().len());
    while player.time() < until {
        player.tick(&mut state);
        watch.see(&state);
    }
}

#[test]
fn a_wave_is_changed_while_it_runs_and_stopped_within_what_was_said() {
    let arm = arm("wave_arm", 3);
    let options = CheckOptions::default();
    let mut planner = Planner::new(&arm.robot, &arm.collision, options, STEP).unwrap();
    let mut player = planner.start(&arm.waves[0], &arm.robot.rest()).unwrap();
    let mut watch = Watch::new(&arm);
    play(&mut player, &mut watch, 3.0);
    // Slower, then another wave; too fast is refused, and what runs goes on.
    let slower = arm.waves[0].slowed(1.3).unwrap();
    let plan = planner.change(&player, &slower, 0.05).unwrap();
    player.take(plan).unwrap();
    play(&mut player, &mut watch, 8.0);
    let error = planner
        .change(&player, &slower.slowed(0.02).unwrap(), 0.05)
        .unwrap_err();
    assert_eq!(Reason::of(&error), Reason::VelocityLimit, "{error}");
    let plan = planner.change(&player, &arm.waves[1], 0.05).unwrap();
    // A plan is for the player as it was, and for a time to come.
    let late = plan.clone();
    let twice = planner.change(&player, &arm.waves[2], 0.05).unwrap();
    player.take(plan).unwrap();
    assert!(player.take(twice).is_err());
    play(&mut player, &mut watch, 14.0);
    assert!(player.take(late).is_err());
    // Stopped from many ticks, each time within what was said.
    let mut longest = 0.0_f64;
    for n in 0..40 {
        let mut stopping = player.clone();
        let mut watch = Watch::new(&arm);
        play(&mut stopping, &mut watch, 14.0 + 0.037 * f64::from(n));
        let said = stopping.longest_stop();
        let begun = stopping.time();
        let takes = stopping.stop();
        assert!(takes <= said, "{takes} of {said}");
        longest = longest.max(takes);
        let mut state = State::zeros(6);
        while !stopping.has_stopped() {
            stopping.tick(&mut state);
            watch.see(&state);
            assert!(stopping.time() <= begun + takes + 2.0 * STEP);
        }
        stopping.tick(&mut state);
        assert_eq!(
            (state.velocity.amax(), state.acceleration.amax()),
            (0.0, 0.0)
        );
        assert!(planner.change(&stopping, &arm.waves[0], 0.0).is_err());
    }
    println!(
        "stops take up to {longest:.3} s, said {:.3} s",
        player.longest_stop()
    );
}

#[test]
fn a_plan_is_of_one_player_alone() {
    let arm = arm("wave_arm", 3);
    let options = CheckOptions::default();
    let mut planner = Planner::new(&arm.robot, &arm.collision, options, STEP).unwrap();
    let mut one = planner.start(&arm.waves[0], &arm.robot.rest()).unwrap();
    let mut other = planner.start(&arm.waves[1], &arm.robot.rest()).unwrap();
    let plan = planner.change(&one, &arm.waves[2], 0.1).unwrap();
    let error = other.take(plan.clone()).unwrap_err();
    assert!(
        error.to_string().contains("a plan for what is not played"),
        "{error}"
    );
    assert!(one.take(plan).is_ok());
}

#[test]
fn touching_oneself_does_not_hide_behind_touching_the_scene() {
    let robot = shipped::robot("wave_arm").unwrap();
    let arm = arm("wave_arm", 1);
    // Through the torso, and through a ball around the base.
    let mut wave = arm.waves[0].clone();
    for draw in 0.. {
        let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 25).unwrap();
        let map = shipped::map("wave_arm_demonstrator").unwrap();
        wave = map
            .apply(&primitive.sample(&mut stream(5, draw)), &robot)
            .unwrap();
        if !arm.collision.certify(&wave, 0.0, &[]).unwrap().is_clear() {
            break;
        }
    }
    let scene =
        Scene::from_toml("[[object]]\nname = \"fog\"\nsphere = { radius = 3.0 }\n").unwrap();
    let options = CollisionOptions {
        scene,
        ..CollisionOptions::default()
    };
    let collision = CollisionModel::new(&robot, &options).unwrap();
    let asked = CheckOptions {
        accuracy: Some(1e-3),
        ..CheckOptions::default()
    };
    let verdict = Verdict::with(&robot, &mut collision.prover(), &wave, &asked).unwrap();
    let reasons = verdict.reasons();
    for reason in [Reason::SelfCollision, Reason::SceneCollision] {
        assert!(reasons.contains(&reason), "{reasons:?}");
    }
}

#[test]
fn acceleration_limits_hold_over_joins() {
    let arm = arm("wave_arm", 1);
    let limit = JointLimit {
        acceleration: Some(40.0),
        ..JointLimit::default()
    };
    let options = CheckOptions {
        limits: JointLimits::default().with(None, limit).unwrap(),
        ..CheckOptions::default()
    };
    let mut weights = DMatrix::zeros(6, 1);
    weights[(3, 0)] = Complex::new(0.1, 0.0);
    let offsets = DVector::from_element(6, 0.4);
    let wave = Wave::new(arm.robot.joints().clone(), 1.0, offsets, weights).unwrap();
    let mut passages = Passages::new(&arm.robot, arm.collision.prover(), options);
    let performance = passages.perform(&[&wave], &arm.robot.rest(), 2.0).unwrap();
    let mut state = State::zeros(6);
    for n in 0..=(performance.sequence.duration() / STEP) as usize {
        performance.sequence.state_into(n as f64 * STEP, &mut state);
        assert!(state.acceleration.amax() <= 40.0);
    }
}

/// A ball on an arm that turns about a post and can be raised, and a post in its way: straight over is not possible, a detour is.
#[test]
fn a_way_around_what_stands_in_between_is_clear() {
    let robot = Robot::from_urdf(
        r#"<robot name="crane"><link name="base"/><link name="post"/><link name="arm">
        <collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="turn" type="revolute"><parent link="base"/><child link="post"/><axis xyz="0 0 1"/>
        <limit lower="-2" upper="2" velocity="3" effort="9"/></joint>
        <joint name="raise" type="revolute"><parent link="post"/><child link="arm"/><axis xyz="0 -1 0"/>
        <limit lower="-1.2" upper="1.2" velocity="3" effort="9"/></joint></robot>"#,
    )
    .unwrap();
    let scene = Scene::from_toml(
        "[[object]]\nname = \"pole\"\nsphere = { radius = 0.15 }\nposition = [1, 0, 0]",
    )
    .unwrap();
    let options = CollisionOptions {
        scene,
        ..CollisionOptions::default()
    };
    let collision = CollisionModel::new(&robot, &options).unwrap();
    let wave = Wave::new(
        robot.joints().clone(),
        1.0,
        DVector::from_vec(vec![0.8, 0.0]),
        DMatrix::from_column_slice(2, 1, &[Complex::new(0.05, 0.0), Complex::new(0.0, 0.02)]),
    )
    .unwrap();
    // Straight on it touches.
    let straight = (0..=100).map(|n| -0.8 + 0.016 * f64::from(n));
    let touches = |turn: f64| collision.clearance(&[turn, 0.0]).unwrap().distance < 0.0;
    assert!(straight.clone().any(touches));
    let checked = CheckOptions::default();
    let mut passages = Passages::new(&robot, collision.prover(), checked);
    let performance = passages.perform(&[&wave], &[-0.8, 0.0], 2.0).unwrap();
    let sequence = performance.sequence;
    let mut state = State::zeros(2);
    for n in 0..=(sequence.duration() / STEP) as usize {
        sequence.state_into(n as f64 * STEP, &mut state);
        let q = state.position.as_slice();
        assert!(collision.clearance(q).unwrap().distance > 0.0, "{n}: {q:?}");
    }
}
