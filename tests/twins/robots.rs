//! Kinematics, dynamics, gears and joint maps.

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use undulate::testing::waves;
use undulate::{Dynamics, GRAVITY, JointMap, Joints, Robot, Wave};

use crate::{Twin, Verdict, for_all, near};

pub const TWINS: [Twin; 12] = [
    ("a joint axis flipped", |broken| {
        let sign = if broken { -1.0 } else { 1.0 };
        places(|arm, q| arm.turn() * rotation(&(arm.axis * sign), q) * TIP + arm.xyz)
    }),
    ("roll, pitch and yaw in the other order", |broken| {
        places(|arm, q| {
            let turn = if broken {
                about(0, arm.rpy.x) * about(1, arm.rpy.y) * about(2, arm.rpy.z)
            } else {
                arm.turn()
            };
            turn * rotation(&arm.axis, q) * TIP + arm.xyz
        })
    }),
    ("an origin turned with its joint", |broken| {
        places(|arm, q| match broken {
            true => rotation(&arm.axis, q) * (arm.turn() * TIP + arm.xyz),
            false => arm.turn() * rotation(&arm.axis, q) * TIP + arm.xyz,
        })
    }),
    ("an inertial rpy ignored", |broken| {
        carries(|turn| if broken { Matrix3::identity() } else { turn })
    }),
    ("an inertial rpy applied backwards", |broken| {
        carries(|turn| if broken { turn.transpose() } else { turn })
    }),
    ("Coriolis forces missing", |broken| {
        pushes(|p| {
            if broken {
                p.coriolis = [0.0; 2]
            }
        })
    }),
    ("gravity of wrong sign", |broken| {
        pushes(|p| {
            if broken {
                p.gravity = p.gravity.map(|g| -g)
            }
        })
    }),
    (
        "an inertia about the joint taken for one about the centre",
        |broken| {
            pushes(|p| {
                if broken {
                    p.mass[3] -= MASS[1] * CENTER[1] * CENTER[1]
                }
            })
        },
    ),
    ("a mimic multiplier ignored", |broken| {
        geared(
            |q, multiplier| if broken { q } else { multiplier * q },
            |m| m * m,
        )
    }),
    (
        "a reflected inertia of a gear that is not squared",
        |broken| {
            geared(
                |q, multiplier| multiplier * q,
                |m| if broken { m } else { m * m },
            )
        },
    ),
    ("the sign of a joint map dropped", |broken| {
        maps(|x| {
            if broken {
                0.8 * x + 0.3
            } else {
                -0.8 * x + 0.3
            }
        })
    }),
    ("an offset of a joint map that is scaled", |broken| {
        maps(|x| {
            if broken {
                -0.8 * (x + 0.3)
            } else {
                -0.8 * x + 0.3
            }
        })
    }),
];

const TIP: Vector3<f64> = Vector3::new(0.3, -0.2, 0.5);

/// One joint and what it carries.
#[derive(Debug, Clone)]
struct Arm {
    xyz: Vector3<f64>,
    rpy: Vector3<f64>,
    axis: Vector3<f64>,
}

impl Arm {
    /// Roll, pitch and yaw about fixed axes.
    fn turn(&self) -> Matrix3<f64> {
        about(2, self.rpy.z) * about(1, self.rpy.y) * about(0, self.rpy.x)
    }

    fn robot(&self, inertial: &str) -> Robot {
        let text = |v: &Vector3<f64>| format!("{} {} {}", v.x, v.y, v.z);
        Robot::from_urdf(&format!(
            r#"<robot name="arm"><link name="base"/><link name="arm">{inertial}</link><link name="tip"/>
            <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>
            <origin xyz="{}" rpy="{}"/><axis xyz="{}"/></joint>
            <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="{}"/></joint></robot>"#,
            text(&self.xyz), text(&self.rpy), text(&self.axis), text(&TIP)
        ))
        .unwrap()
    }
}

fn arms() -> impl Strategy<Value = Arm> {
    let vector = || (-1.0..1.0f64, -1.0..1.0f64, 0.2..1.0f64);
    (vector(), vector(), vector()).prop_map(|(xyz, rpy, axis)| Arm {
        xyz: Vector3::new(xyz.0, xyz.1, xyz.2),
        rpy: Vector3::new(rpy.0, rpy.1, rpy.2),
        axis: Vector3::new(axis.0, axis.1, axis.2),
    })
}

fn about(axis: usize, angle: f64) -> Matrix3<f64> {
    rotation(&Vector3::ith(axis, 1.0), angle)
}

/// Rodrigues' formula.
fn rotation(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let cross = axis.normalize().cross_matrix();
    Matrix3::identity() + cross * angle.sin() + cross * cross * (1.0 - angle.cos())
}

/// Where the tip is, as the library has it.
fn places(tip: impl Fn(&Arm, f64) -> Vector3<f64>) -> Verdict {
    for_all((arms(), 0.2..3.0f64), |(arm, q)| {
        let poses = arm.robot("").link_poses(&[q]);
        let expected = poses.last().unwrap().translation.vector;
        near("the tip is off by", (tip(&arm, q) - expected).norm(), 0.0)
    })
}

/// Inertia about the joint's axis of six masses on the axes of an inertial frame that is turned, as the library has it.
fn carries(turn: impl Fn(Matrix3<f64>) -> Matrix3<f64>) -> Verdict {
    for_all((arms(), arms()), |(arm, inertial)| {
        let [x, y, z] = [0.5, 0.3, 0.2f64].map(|half| 2.0 * half * half);
        let (ixx, iyy, izz) = (y + z, x + z, x + y);
        let [r, p, w] = inertial.rpy.into();
        let robot = arm.robot(&format!(
            r#"<inertial><origin rpy="{r} {p} {w}"/><mass value="6"/>
            <inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>"#
        ));
        let axis = arm.axis.normalize();
        let frame = turn(inertial.turn());
        let points = (0..3).map(|i| frame * Vector3::ith(i, [0.5, 0.3, 0.2][i]));
        let found: f64 = points.map(|p| 2.0 * axis.cross(&p).norm_squared()).sum();
        let expected = Dynamics::new(&robot).mass_matrix(&robot, &[0.4])[(0, 0)];
        near("an inertia", found, expected)
    })
}

/// Lengths \[m\], masses \[kg\], and moments about the centres \[kg m^2\] of two rods that hang in a plane.
const LENGTH: f64 = 0.7;
const CENTER: [f64; 2] = [0.3, 0.25];
const MASS: [f64; 2] = [2.0, 1.3];
const MOMENT: [f64; 2] = [0.08, 0.03];

/// The terms of Lagrange's equations of two rods.
struct Pendulum {
    /// Row by row.
    mass: [f64; 4],
    coriolis: [f64; 2],
    gravity: [f64; 2],
}

impl Pendulum {
    fn at(q: [f64; 2], v: [f64; 2]) -> Self {
        let coupling = MASS[1] * LENGTH * CENTER[1];
        let far = MOMENT[1] + MASS[1] * CENTER[1] * CENTER[1];
        let near = MOMENT[0] + MASS[0] * CENTER[0] * CENTER[0] + MASS[1] * LENGTH * LENGTH;
        let both = far + coupling * q[1].cos();
        let swirl = coupling * q[1].sin();
        let weight = |m: f64, angle: f64| -GRAVITY.z * m * angle.sin();
        let lower = weight(MASS[1] * CENTER[1], q[0] + q[1]);
        Self {
            mass: [near + 2.0 * both - far, both, both, far],
            coriolis: [-swirl * v[1] * (2.0 * v[0] + v[1]), swirl * v[0] * v[0]],
            gravity: [
                lower + weight(MASS[0] * CENTER[0] + MASS[1] * LENGTH, q[0]),
                lower,
            ],
        }
    }
}

/// Torques of two rods, as the library has them.
fn pushes(fault: impl Fn(&mut Pendulum)) -> Verdict {
    let rod = |k: usize, parent: &str, z: f64| {
        let (center, mass, moment) = (-CENTER[k], MASS[k], MOMENT[k]);
        // Turning about -y swings a hanging rod towards +x.
        format!(
            r#"<link name="rod_{k}"><inertial><origin xyz="0 0 {center}"/><mass value="{mass}"/>
            <inertia ixx="0.5" iyy="{moment}" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
            <joint name="joint_{k}" type="continuous"><parent link="{parent}"/><child link="rod_{k}"/>
            <origin xyz="0 0 {z}"/><axis xyz="0 -1 0"/></joint>"#
        )
    };
    let rods = rod(0, "base", 0.0) + &rod(1, "rod_0", -LENGTH);
    let urdf = format!(r#"<robot name="rods"><link name="base"/>{rods}</robot>"#);
    let robot = Robot::from_urdf(&urdf).unwrap();
    let pair = || [-3.0..3.0f64, -3.0..3.0f64];
    for_all((pair(), pair(), pair()), |(q, v, a)| {
        let mut pendulum = Pendulum::at(q, v);
        fault(&mut pendulum);
        let Pendulum {
            mass: m,
            coriolis: c,
            gravity: g,
        } = pendulum;
        let mut dynamics = Dynamics::new(&robot);
        let expected = dynamics.inverse(&robot, &q, &v, &a, &GRAVITY);
        for k in 0..2 {
            let found = m[2 * k] * a[0] + m[2 * k + 1] * a[1] + c[k] + g[k];
            near("a torque", found, expected[k])?;
        }
        Ok(())
    })
}

/// A slide of 0.5 kg that mimics a drum of 0.4 kg m^2: where it is, and what the drum has to move, as the library has it.
fn geared(slide: impl Fn(f64, f64) -> f64, reflected: impl Fn(f64) -> f64) -> Verdict {
    for_all((-1.0..1.0f64, 1.5..4.0f64), |(q, multiplier)| {
        let robot = Robot::from_urdf(&format!(
            r#"<robot name="geared"><link name="base"/>
            <link name="drum"><inertial><mass value="2"/><inertia ixx="0.4" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
            <link name="slide"><inertial><mass value="0.5"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
            <joint name="turn" type="continuous"><parent link="base"/><child link="drum"/></joint>
            <joint name="push" type="prismatic"><parent link="base"/><child link="slide"/><limit lower="-9" upper="9" effort="1" velocity="1"/>
            <mimic joint="turn" multiplier="{multiplier}"/></joint></robot>"#
        ))?;
        let at = robot
            .links()
            .iter()
            .position(|link| link.name == "slide")
            .unwrap();
        let expected = robot.link_poses(&[q])[at].translation.x;
        near("the slide", slide(q, multiplier), expected)?;
        let expected = Dynamics::new(&robot).mass_matrix(&robot, &[q])[(0, 0)];
        near(
            "the drum's inertia",
            0.4 + 0.5 * reflected(multiplier),
            expected,
        )
    })
}

/// A robot's joint of a learned one, as the library maps it.
fn maps(joint: impl Fn(f64) -> f64) -> Verdict {
    let robot = Arm {
        xyz: TIP,
        rpy: TIP,
        axis: TIP,
    }
    .robot("");
    let toml = "[joints.turn]\nfrom = \"elbow\"\nsign = -1\nscale = 0.8\noffset = 0.3\n";
    let map = JointMap::from_toml(toml).unwrap();
    for_all((waves(1..=1, 1..=3), -3.0..3.0f64), |(wave, t)| {
        let (offsets, weights) = (wave.offsets().clone(), wave.weights().clone());
        let learned = Wave::new(Joints::new(["elbow"])?, wave.period(), offsets, weights)?;
        let mapped = map.apply(&learned, &robot)?;
        near(
            "a joint",
            joint(learned.position(t)[0]),
            mapped.position(t)[0],
        )
    })
}
