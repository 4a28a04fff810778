//! [`Robot`]: joints, limits and bodies of a robot that is known to be consistent.

mod bounds;
mod build;
mod contents;
mod doubts;
mod dynamics;
mod inertia;
mod kinematics;
mod limits;
mod lint;
mod load;
mod meshes;
mod mimics;
mod missing;
mod payload;
mod reduce;
mod srdf;
mod tips;
mod urdf;

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};

pub use dynamics::{Dynamics, GRAVITY};
#[cfg(feature = "simulation")]
pub(crate) use dynamics::{factorise, solve};
use kinematics::Step;
pub use kinematics::{Frame, Kinematics, Twist};
pub use load::{Inconsistent, LoadOptions, MeshConvex, MeshEnclosure, MeshFiles};
pub use srdf::{EndEffector, Group, Srdf};

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Interval, Joints};
use crate::geometry::Solid;

/// A joint that moves less than this \[kg m^2, kg\] moves nothing: the mass matrix is singular in all but name.
const LEAST_INERTIA: f64 = 1e-9;

/// A robot: a tree of bodies joined by revolute, continuous or prismatic joints.
///
/// Links that fixed joints hold together are one body; body 0 is the base and does not move. A value of this type has
/// passed every check of its loader: names are unique, the tree has one root, axes are unit vectors, limits are ordered,
/// inertias are positive semidefinite. What its file lacks (inertials, meshes that can be read) is missing, not
/// guessed: [`require_dynamics`](Self::require_dynamics) and the collision model say so when they are asked.
///
/// A configuration q has one entry a joint in the order of [`joints`](Self::joints), rad (m for prismatic joints).
#[derive(Debug, Clone)]
pub struct Robot {
    name: String,
    joints: Joints,
    /// For each joint, the body that it moves.
    commanded: Vec<usize>,
    bodies: Vec<Body>,
    /// What the recursions of kinematics and dynamics need of each body.
    steps: Vec<Step>,
    links: Vec<Link>,
    /// Index of the link at the end of the chain that matters.
    tip: usize,
    enclosures: Vec<MeshEnclosure>,
    notes: Vec<String>,
}

/// What is known of a joint besides where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct JointProperties {
    /// Range of positions \[rad, m\]; `None` for continuous joints.
    pub position: Option<Interval>,
    /// Largest speed \[rad/s, m/s\]; `None` when not given.
    pub velocity: Option<f64>,
    /// Largest torque \[N m\] or force \[N\]; `None` when not given.
    pub effort: Option<f64>,
    /// Viscous damping \[N m s/rad, N s/m\].
    pub damping: f64,
    /// Coulomb friction \[N m, N\].
    pub friction: f64,
}

/// How a body moves against its parent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// About an axis: rad, rad/s, N m.
    Revolute,
    /// Along an axis: m, m/s, N.
    Prismatic,
}

/// The joint between a body and its parent, and which entry of q moves it.
#[derive(Debug, Clone)]
pub struct BodyJoint {
    /// The joint's name in the file.
    pub name: String,
    /// About or along.
    pub kind: JointKind,
    /// It mimics no other joint.
    pub is_commanded: bool,
    /// Unit axis in the body's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Entry of q.
    pub index: usize,
    /// The joint's position is `multiplier * q[index] + offset`: 1 and 0 unless the joint mimics another.
    pub multiplier: f64,
    /// \[rad, m\]
    pub offset: f64,
    /// The body's frame in its parent's at position 0.
    pub origin: Isometry3<f64>,
    /// Its own limits and losses.
    pub properties: JointProperties,
}

/// Mass, centre of mass and inertia of a body, in its frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Inertial {
    /// \[kg\], positive.
    pub mass: f64,
    /// Centre of mass \[m\].
    pub center: Vector3<f64>,
    /// About the centre of mass \[kg m^2\].
    pub inertia: Matrix3<f64>,
}

/// A rigid body: one or more links.
#[derive(Debug, Clone)]
pub struct Body {
    /// The link whose frame is the body's.
    pub name: String,
    /// Index of the body that carries it; its own index for the base. Parents come before children.
    pub parent: usize,
    /// `None` for the base.
    pub joint: Option<BodyJoint>,
    /// `None` when none of its links has a mass.
    pub inertial: Option<Inertial>,
    /// Shapes that collide.
    pub collision: Vec<Solid>,
    /// Shapes to be drawn: the visual primitives of its links and the visual meshes that collide too, and where a link has
    /// none, its collision shapes.
    pub visual: Vec<Solid>,
    /// Links whose collision geometry was not read, and why.
    pub unread_collision: Vec<String>,
    /// Links whose inertia violates the triangle inequality, and by what: it is kept as it stands, but no body has it.
    pub doubtful_inertia: Vec<String>,
}

/// A named frame fixed to a body.
#[derive(Debug, Clone)]
pub struct Link {
    /// Its name in the file.
    pub name: String,
    /// Index of its body.
    pub body: usize,
    /// The link's frame in the body's.
    pub pose: Isometry3<f64>,
    /// Index of the link that holds it; `None` for the root. It comes before.
    pub parent: Option<usize>,
    /// The joint that holds it, fixed or not; `None` for the root.
    pub joint: Option<String>,
}

impl BodyJoint {
    /// What damping and friction take at a rate \[N m, N\]; no friction at rest.
    pub(crate) fn resistance(&self, rate: f64) -> f64 {
        let sign = if rate == 0.0 { 0.0 } else { rate.signum() };
        self.properties.damping * rate + self.properties.friction * sign
    }
}

impl Robot {
    /// The robot's name in its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of the joints that can be commanded, base to tip; joints that mimic others are not among them.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Joint `index`, in the order of [`joints`](Self::joints). Panics when there is none, as slices do.
    pub fn joint(&self, index: usize) -> &BodyJoint {
        let body = &self.bodies[self.commanded[index]];
        body.joint
            .as_ref()
            .expect("`commanded` names bodies with a joint")
    }

    /// What is known of joint `index`.
    pub fn properties(&self, index: usize) -> &JointProperties {
        &self.joint(index).properties
    }

    /// Every joint that moves a body, with the body's index; those that mimic others too.
    pub fn moving(&self) -> impl Iterator<Item = (usize, &BodyJoint)> {
        self.bodies
            .iter()
            .enumerate()
            .filter_map(|(i, b)| b.joint.as_ref().map(|j| (i, j)))
    }

    /// Bodies, the base first, parents before children.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Links, the root first.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// # Errors
    /// When no link has this name.
    pub fn link(&self, name: &str) -> Result<&Link> {
        self.links.iter().find(|l| l.name == name).ok_or_else(|| {
            Error::new(ErrorKind::Name, format!("no link `{name}`"))
                .expected(format!("one of the robot's {} links", self.links.len()))
                .at(format!("robot `{}`", self.name))
        })
    }

    /// How closely hulls enclose their meshes, where [`LoadOptions::measure`] asked for it; in the order of the links.
    pub fn enclosures(&self) -> &[MeshEnclosure] {
        &self.enclosures
    }

    /// What was left out, normalised or read as not given.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The configuration that stands for rest: 0 where the limits allow it, else the nearest position that they do.
    pub fn rest(&self) -> Vec<f64> {
        (0..self.joints.len())
            .map(|j| {
                self.properties(j)
                    .position
                    .map_or(0.0, |i| 0.0_f64.clamp(i.lower, i.upper))
            })
            .collect()
    }

    /// # Errors
    /// When a body that moves has no mass, or a joint moves nothing that has inertia; the message names the link or joint.
    pub fn require_dynamics(&self) -> Result<()> {
        let refuse = |what: String| {
            Err(Error::new(ErrorKind::Infeasible, what)
                .expected("mass and inertia for every link that moves")
                .help("add an <inertial> to the URDF; kinematics and collision checks work without")
                .at(format!("robot `{}`", self.name)))
        };
        for body in &self.bodies[1..] {
            if body.inertial.is_none() {
                return refuse(format!("link `{}` moves and has no mass", body.name));
            }
            if let Some(told) = body.doubtful_inertia.first() {
                return Err(Error::new(ErrorKind::Infeasible, told.clone())
                    .expected("moments of a body with mass")
                    .help("recompute the inertia from the mesh or shape, or have it mended (--mend-inertia)")
                    .at(format!("robot `{}`", self.name)));
            }
        }
        let diagonal = dynamics::mass_diagonal(self, &self.rest());
        for (name, inertia) in self.joints.iter().zip(diagonal) {
            if inertia < LEAST_INERTIA {
                return refuse(format!(
                    "joint `{name}` moves an inertia of {inertia:.1e} kg m^2"
                ));
            }
        }
        Ok(())
    }

    /// # Errors
    /// When `joints` are not this robot's, name by name and in order.
    pub fn require_joints(&self, joints: &Joints) -> Result<()> {
        if *joints == self.joints {
            return Ok(());
        }
        Err(
            Error::new(ErrorKind::Name, format!("a motion of {}", joints.listed()))
                .expected(self.joints.listed())
                .help("map the motion to the robot's joints with a joint map")
                .at(format!("robot `{}`", self.name)),
        )
    }
}
