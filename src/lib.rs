//! Wave gestures for robots, learned from people.
//!
//! `undulate` learns rhythmic gestures from demonstrations as Fourier movement primitives (Panteris, Manschitz and
//! Calinon, "Learning, Generating and Adapting Wave Gestures for Expressive Human-Robot Interaction", HRI 2020
//! Companion, doi 10.1145/3371382.3378286), draws waves that vary as a person's do, conditions them on amplitude, phase,
//! posture and tempo, puts them on a robot described by URDF, checks limits and self-collision, and executes them as a
//! multibody in Rapier. Pure Rust.
//!
//! # From recordings to a robot
//!
//! Everything meets at the [`Wave`]: the learning half ends in one, the robot half starts from one.
//!
//! ```text
//! recordings --> Demonstrations --> FourierBasis --> LogPolar --> Gaussian --> FourierMovementPrimitive
//!                                                                               | condition (again a primitive)
//!                                                                               v sample
//!                                       Wave: a periodic motion of named joints, a finite Fourier series
//!                                                                               | JointMap
//!      URDF --> Robot (valid, or it does not exist) -----------+----------------+--+-----------------+
//!                                                        CollisionModel      Simulation         figures
//!                                                           (parry)          (Rapier, RK4)
//! ```
//!
//! ```
//! use rand::distr::Distribution;
//! use undulate::*;
//!
//! # #[cfg(feature = "simulation")] {
//! // Learn, and ask for a large, slow wave from the elbow.
//! let primitive = FourierMovementPrimitive::learn(&synthetic(0)?, 25)?;
//! let large = primitive.condition(&[Observation::modulus("elbow_flexion", 10, 5f64.to_radians())])?;
//!
//! // Put draws on a robot until one keeps its limits and its distance.
//! let robot = shipped::robot("wave_arm")?;
//! let map = shipped::map("wave_arm_demonstrator")?;
//! let collision = CollisionModel::new(&robot, &CollisionOptions::default())?;
//! let mut draws = (0..).map(|k| map.apply(&large.sample(&mut stream(7, k)), &robot));
//! let wave = loop {
//!     let wave = draws.next().unwrap()?;
//!     if Verdict::of(&robot, &collision, &wave, 0.005)?.passes() {
//!         break wave;
//!     }
//! };
//!
//! // Execute it.
//! let rollout = Simulation::new(&robot, SimulationOptions::default())?.run(&wave)?;
//! assert!(rollout.rms_error().max() < 1e-3); // rad
//! # }
//! # Ok::<(), undulate::Error>(())
//! ```
//!
//! # Notation
//!
//! D joints, period T \[s\], w = 2 pi / T \[rad/s\], harmonics k = 1..K, M demonstrations.
//!
//! | symbol | meaning | where |
//! |---|---|---|
//! | y_d(t) = w_{d,0} + 2 Re sum w_{d,k} exp(i k w t) | position of joint d \[rad\] | [`Wave`] |
//! | w_{d,0} | offset: the posture it waves about | [`Coordinate::Offset`] |
//! | \|w_{d,k}\| | modulus: HALF the amplitude of harmonic k | [`Coordinate::Modulus`] |
//! | Arg w_{d,k} | phase | [`Coordinate::Phase`] |
//! | x | all log moduli, phases and offsets, 2DK + D numbers | [`LogPolar`] |
//! | mu, Sigma = F F^T + Kronecker blocks + diagonal | the Gaussian over x | [`Gaussian`], [`Covariance`] |
//! | a^T x = b | an observation, exact or with a standard deviation | [`Observation`], [`LinearObservation`] |
//! | f, s_d, j | of cycles: frequency \[Hz\], swing \[rad\], jitter | [`Coordinate`], [`Cycles`] |
//! | E y(t), Cov(y(t), y(s)) | the trajectories' moments | [`TrajectoryMoments`] |
//!
//! Angles are radians, lengths metres, times seconds, everywhere; text with units (`5deg`) is for people.
//!
//! # What holds
//!
//! * A value that exists is valid: constructors return [`Result`], operations return new values.
//! * No file or text makes the crate panic; every [`Error`] says what, where, what was expected and what to do. (Slices of
//!   another length than the robot has joints do, as indexing does; such functions say so.)
//! * A model file and a seed give the same waves, bit for bit, on every machine and with vectors of any width.
//! * Draws of Markov chains come with R-hat and effective sample sizes, and say so if the chains have not mixed ([`posterior`]).
//! * The learning half knows no robot, the robot half no primitive; modules use only modules below them (a test holds that).
//!
//! # What a check assumes
//!
//! That the collision shapes of the URDF enclose the robot, that each joint is within its tolerance of where it is commanded
//! to be, and that nothing but the [`Scene`] is in reach. Under these, [`Prover::certify`] proves a motion clear between
//! samples too, and a [`Certificate`] can be verified again. This is no safety function in the sense of any standard.
//!
//! # Features
//!
//! | feature | brings | default |
//! |---|---|---|
//! | `robot` | URDF, kinematics, dynamics, joint maps, self-collision (parry, urdf-rs) | with `cli` |
//! | `simulation` | execution in Rapier, and by a plant of our own | with `cli` |
//! | `figure` | plots, and with `robot` pictures of robots | with `cli` |
//! | `testing` | strategies and statistical assertions for `cargo test` (proptest); with `robot` of robots too | no |
//! | `cli` | the `undulate` program | yes |

#![warn(missing_docs)]
#![forbid(unsafe_code)]

mod anatomy;
mod baseline;
mod capture;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "robot")]
mod collision;
mod comparison;
mod demonstration;
mod document;
mod elementary;
mod error;
#[cfg(feature = "robot")]
mod feasibility;
#[cfg(feature = "figure")]
pub mod figure;
mod fourier;
#[cfg(feature = "robot")]
mod geometry;
#[cfg(feature = "robot")]
mod motion;
mod normal;
mod parallel;
pub mod posterior;
mod primitive;
mod proportion;
#[cfg(feature = "robot")]
mod retarget;
#[cfg(feature = "robot")]
mod robot;
#[cfg(feature = "robot")]
pub mod shipped;
#[cfg(feature = "simulation")]
mod simulation;
mod table;
#[cfg(feature = "testing")]
pub mod testing;
mod units;
mod vectors;

pub use {nalgebra, num_complex, rand};

pub use anatomy::{ARM_ANGLES, ShoulderOrder};
pub use baseline::{
    GestureModel, LinearGaussian, ModelKind, Resolution, RhythmicProMp, StrokeProMp, Wish,
};
pub use capture::{ArmMotion, BoneMap, Bvh, CaptureNote, Captured, PositionOptions, Side};
#[cfg(feature = "robot")]
pub use collision::{
    Certificate, Certification, Checker, Clearance, CollisionModel, CollisionOptions, Evidence,
    MinimumClearance, Moment, Pair, PairContacts, PairStatus, ProfileInterval, Prover, Scene,
    SceneObject, SceneShape, Stretch, Verified, Work,
};
pub use comparison::{
    Compared, Comparison, ComparisonOptions, Conditioned, Distance, Estimate, Paired, Seconds,
    Statistic,
};
pub use demonstration::{
    CsvOptions, CycleFit, CycleFits, DEMONSTRATOR_JOINTS, DEMONSTRATOR_PERIOD, Demonstrations,
    Duration, Finding, Flag, Inspection, Leakage, LeftOut, Recording, Rhythm, RhythmicPart,
    Variation, synthetic,
};
pub use error::{Error, ErrorKind, Reason, Result};
#[cfg(feature = "robot")]
pub use feasibility::{
    Assessment, Bounded, Change, CheckOptions, EffortUse, JointLimit, JointLimits, LimitSource,
    LimitUse, Means, Mended, Passages, Performance, Plan, Planner, Player, Verdict, Worst, efforts,
    limits, limits_with, mend, without_velocity_limit,
};
pub use fourier::{
    Autoregression, CycleResidual, CycleRing, Derivative, Extremes, FourierBasis, Interval, Joints,
    PeriodGrid, State, Wave,
};
#[cfg(feature = "robot")]
pub use geometry::{
    Ball, BoundingCapsule, Convex, Decomposition, Enclosure, HalfSpace, Hull, Mesh, Placed,
    Placement, Separation, Shape, SignedDistance, Solid, Warm, intersects, rough_separation,
    separation, signed_distance,
};
#[cfg(feature = "robot")]
pub use motion::{
    Degree, Jump, Leg, Motion, MoveOptions, PlayMotion, Sequence, SequenceTube, Spline, SplineTube,
    StartPosture, Tube, TubeRows, WaveTube, Waypoint, Waypoints,
};
pub use posterior::Diagnostics;
pub use primitive::{
    Band, Bound, BoundedDraws, Bounds, ChartForm, Component, Coordinate, Covariance, CurvePoint,
    Cycles, Estimator, Example, FourierMovementPrimitive, Gaussian, Grouping, GroupingOptions,
    Harmonic, HeldOut, HeldOutKinds, Jitter, JitterOf, Kinds, Kronecker, LearnOptions,
    LearningCurve, LinearObservation, LogPolar, LoneEnd, Mixture, Observation, OffsetEvidence,
    OffsetForm, Offsets, PhaseForm, Posterior, Quantity, SampleMean, Seen, Start, StartSpread,
    Target, TrajectoryMoments, Unit, ViaPoint, WeightGradient, stream,
};
pub use proportion::clopper_pearson;
#[cfg(feature = "robot")]
pub use retarget::{DirectionFit, JointMap, Person, Residual, RobotArm, Segment, Source};
#[cfg(feature = "robot")]
pub use robot::{
    Body, BodyJoint, Dynamics, EndEffector, Frame, GRAVITY, Group, Inconsistent, Inertial,
    JointKind, JointProperties, Kinematics, Link, LoadOptions, MeshConvex, MeshEnclosure,
    MeshFiles, Robot, Srdf, Twist,
};
#[cfg(feature = "simulation")]
pub use simulation::{
    Control, Energy, Event, EventKind, MultibodyWorld, Payload, Plant, Push, Pushed, Rollout,
    Simulation, SimulationOptions,
};

/// The README's example is a doctest.
#[cfg(all(doctest, feature = "simulation"))]
#[doc = include_str!("../README.md")]
struct Readme;

/// What is handed to threads must be fit for them.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<Error>();
    shared::<Wave>();
    shared::<PeriodGrid>();
    shared::<CycleRing>();
    shared::<Demonstrations>();
    shared::<FourierMovementPrimitive>();
    shared::<Mixture>();
    shared::<Diagnostics>();
    #[cfg(feature = "robot")]
    {
        shared::<Mesh>();
        shared::<Shape>();
        shared::<Robot>();
        shared::<Dynamics>();
        shared::<Kinematics>();
        shared::<CollisionModel>();
        shared::<JointMap>();
        shared::<Verdict>();
        shared::<Plan>();
        shared::<Player>();
        shared::<Spline>();
        shared::<Sequence>();
        shared::<PlayMotion>();
        shared::<JointLimits>();
    }
    #[cfg(feature = "simulation")]
    {
        shared::<Rollout>();
        shared::<Simulation<'_>>();
    }
};
