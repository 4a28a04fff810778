//! Kinematics and dynamics allocate nothing once their workspaces exist.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use undulate::nalgebra::{DMatrix, DVector, Point3};
use undulate::num_complex::Complex;
use undulate::{
    CheckOptions, CollisionModel, CollisionOptions, Dynamics, Frame, GRAVITY, Kinematics, Planner,
    State, Wave, shipped,
};

thread_local! {
    /// Of this thread alone: the test harness has others.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, and a count.
struct Counting;

// SAFETY: every call is handed to `System` unchanged, so its guarantees hold; counting touches a constant-initialised
// `Cell` of this thread, which neither allocates nor has a destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`, which is `System`'s.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `System` with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Allocations that `work` makes.
fn count(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.with(Cell::get);
    work();
    ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn nothing_is_allocated_after_the_workspaces() {
    for name in shipped::robots() {
        let robot = shipped::robot(name).unwrap();
        let n = robot.joints().len();
        let (q, v, tau) = (robot.rest(), vec![0.5; n], vec![1.0; n]);
        let mut dynamics = Dynamics::new(&robot);
        let mut kinematics = Kinematics::new(&robot);
        let mut frames = vec![Frame::identity(); robot.bodies().len()];
        let mut poses = robot.body_poses(&q);
        let tip = robot.tip();
        let point = Point3::new(0.0, 0.1, 0.2);
        let frames = count(|| {
            robot.body_frames_into(&q, &mut frames);
            robot.body_poses_into(&q, &mut poses);
            kinematics.frames(&robot, &q);
        });
        let velocities = count(|| {
            kinematics.twists(&robot, &q, &v);
            kinematics.link_twist(&robot, &q, &v, tip);
        });
        let jacobian = count(|| {
            kinematics.jacobian(&robot, &q, tip.body, &point);
            kinematics.link_jacobian(&robot, &q, tip);
        });
        let inverse = count(|| {
            dynamics.inverse(&robot, &q, &v, &tau, &GRAVITY);
            dynamics.gravity_forces(&robot, &q, &GRAVITY);
        });
        let mass = count(|| {
            dynamics.mass_matrix(&robot, &q);
        });
        let forward = count(|| {
            dynamics.forward(&robot, &q, &v, &tau, &GRAVITY).unwrap();
        });
        let energies = count(|| {
            dynamics.kinetic_energy(&robot, &q, &v);
            dynamics.potential_energy(&robot, &q, &GRAVITY);
        });
        let all = [
            frames, velocities, jacobian, inverse, mass, forward, energies,
        ];
        assert_eq!(all, [0; 7], "{name}");
        // The counter counts.
        assert!(count(|| drop(Dynamics::new(&robot))) > 5);
    }
}

#[test]
fn a_player_allocates_nothing_while_it_plays_and_stops() {
    let robot = shipped::robot("wave_arm").unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let mut weights = DMatrix::zeros(6, 1);
    weights[(3, 0)] = Complex::new(0.1, 0.0);
    let offsets = DVector::from_element(6, 0.4);
    let wave = Wave::new(robot.joints().clone(), 1.0, offsets, weights).unwrap();
    let options = CheckOptions::default();
    let mut planner = Planner::new(&robot, &collision, options, 1e-3).unwrap();
    let mut player = planner.start(&wave, &robot.rest()).unwrap();
    let slower = planner
        .change(&player, &wave.slowed(1.2).unwrap(), 1.0)
        .unwrap();
    let mut state = State::zeros(6);
    let count = count(|| {
        // What is given back is dropped elsewhere.
        std::mem::forget(player.take(slower).unwrap());
        for _ in 0..5000 {
            player.tick(&mut state);
        }
        player.stop();
        while !player.has_stopped() {
            player.tick(&mut state);
        }
    });
    assert_eq!(count, 0);
}

/// A longer rollout takes larger tables, and no more of them.
#[cfg(feature = "simulation")]
#[test]
fn nothing_is_allocated_in_a_step_of_our_plant() {
    use undulate::nalgebra::{DMatrix, DVector};
    use undulate::{Plant, Simulation, SimulationOptions, Wave};

    let robot = shipped::robot("wave_arm").unwrap();
    let (joints, offsets) = (robot.joints().clone(), DVector::from_element(6, 0.3));
    let still = Wave::new(joints, 1.0, offsets, DMatrix::zeros(6, 1)).unwrap();
    let allocations = |duration| {
        let options = SimulationOptions {
            plant: Plant::Rk4,
            friction: Some(0.1),
            duration: Some(duration),
            ..SimulationOptions::default()
        };
        let simulation = Simulation::new(&robot, options).unwrap();
        count(|| drop(simulation.run(&still).unwrap()))
    };
    assert_eq!(allocations(0.2), allocations(0.4));
}
