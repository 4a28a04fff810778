//! Mechanisms whose equations fit on a line.

use nalgebra::{Matrix2, Vector2, Vector3};
use undulate::{Dynamics, GRAVITY, Robot};

/// Two rods in the plane y = 0, hanging at zero: lengths to the next joint and to the centre of mass \[m\], masses \[kg\],
/// moments about the centre \[kg m^2\].
const LENGTH: f64 = 0.7;
const CENTER: [f64; 2] = [0.3, 0.25];
const MASS: [f64; 2] = [2.0, 1.3];
const MOMENT: [f64; 2] = [0.08, 0.03];

fn double_pendulum() -> Robot {
    let link = |k: usize| {
        format!(
            r#"<link name="rod_{k}"><inertial><origin xyz="0 0 {}"/><mass value="{}"/>
            <inertia ixx="0.5" ixy="0" ixz="0" iyy="{}" iyz="0" izz="0.5"/></inertial></link>"#,
            -CENTER[k], MASS[k], MOMENT[k]
        )
    };
    // Turning about -y swings a hanging rod towards +x.
    let joint = |name: &str, parent: &str, child: &str, z: f64| {
        format!(
            r#"<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>
            <origin xyz="0 0 {z}"/><axis xyz="0 -1 0"/></joint>"#
        )
    };
    Robot::from_urdf(&format!(
        r#"<robot name="double_pendulum"><link name="base"/>{}{}{}{}</robot>"#,
        link(0),
        link(1),
        joint("first", "base", "rod_0", 0.0),
        joint("second", "rod_0", "rod_1", -LENGTH),
    ))
    .unwrap()
}

/// M, C v and g of Lagrange's equations; the second angle is relative to the first rod.
fn equations(q: [f64; 2], v: [f64; 2]) -> (Matrix2<f64>, Vector2<f64>, Vector2<f64>) {
    let [m1, m2] = MASS;
    let [c1, c2] = CENTER;
    let [i1, i2] = MOMENT;
    let coupling = m2 * LENGTH * c2;
    let far = i2 + m2 * c2 * c2;
    let both = far + coupling * q[1].cos();
    let near = i1 + m1 * c1 * c1 + m2 * LENGTH * LENGTH;
    let mass = Matrix2::new(near + far + 2.0 * coupling * q[1].cos(), both, both, far);
    let swirl = coupling * q[1].sin();
    let coriolis = Vector2::new(
        -swirl * (2.0 * v[0] * v[1] + v[1] * v[1]),
        swirl * v[0] * v[0],
    );
    let g = -GRAVITY.z;
    let lower = m2 * c2 * g * (q[0] + q[1]).sin();
    let gravity = Vector2::new((m1 * c1 + m2 * LENGTH) * g * q[0].sin() + lower, lower);
    (mass, coriolis, gravity)
}

#[test]
fn a_double_pendulum_obeys_lagrange() {
    let robot = double_pendulum();
    let mut dynamics = Dynamics::new(&robot);
    for (q, v, a) in [
        ([0.0, 0.0], [0.0, 0.0], [1.0, -1.0]),
        ([0.4, -1.1], [2.0, -3.0], [0.5, 4.0]),
        ([-2.0, 2.9], [-1.5, 0.7], [-6.0, 2.0]),
    ] {
        let (mass, coriolis, gravity) = equations(q, v);
        let found = dynamics
            .mass_matrix(&robot, &q)
            .fixed_view::<2, 2>(0, 0)
            .into_owned();
        assert!((found - mass).amax() < 1e-14, "{found} {mass}");
        let still = Vector2::from_column_slice(dynamics.gravity_forces(&robot, &q, &GRAVITY));
        assert!((still - gravity).amax() < 1e-13, "{still} {gravity}");
        let swirl = dynamics.inverse(&robot, &q, &v, &[0.0; 2], &Vector3::zeros());
        let swirl = Vector2::from_column_slice(swirl);
        assert!((swirl - coriolis).amax() < 1e-13, "{swirl} {coriolis}");
        let tau = mass * Vector2::from(a) + coriolis + gravity;
        let found = dynamics
            .forward(&robot, &q, &v, tau.as_slice(), &GRAVITY)
            .unwrap();
        let error = (Vector2::from_column_slice(found) - Vector2::from(a)).amax();
        assert!(error < 1e-12, "{error:e}");
    }
}

#[test]
fn a_gear_adds_the_square_of_its_ratio() {
    // A finger that mimics a slide: 3 m/s along x for each rad/s about x.
    let robot = Robot::from_urdf(
        r#"<robot name="geared"><link name="base"/>
        <link name="drum"><inertial><mass value="2"/><inertia ixx="0.4" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <link name="slide"><inertial><mass value="0.5"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <joint name="turn" type="continuous"><parent link="base"/><child link="drum"/></joint>
        <joint name="push" type="prismatic"><parent link="base"/><child link="slide"/><limit lower="-9" upper="9" effort="1" velocity="1"/>
        <mimic joint="turn" multiplier="3" offset="0.25"/></joint></robot>"#,
    )
    .unwrap();
    let mut dynamics = Dynamics::new(&robot);
    let reflected = 0.4 + 9.0 * 0.5;
    assert_eq!(dynamics.mass_matrix(&robot, &[0.3])[(0, 0)], reflected);
    // Gravity along x pulls the slide alone, and through it the drum.
    let pull = Vector3::new(2.0, 0.0, 0.0);
    let found = dynamics
        .forward(&robot, &[0.3], &[1.0], &[0.0], &pull)
        .unwrap()[0];
    assert!(
        (found - 3.0 * 0.5 * 2.0 / reflected).abs() < 1e-15,
        "{found}"
    );
}

#[test]
fn a_joint_that_moves_nothing_is_named_and_not_divided_by() {
    // Two joints about one axis with nothing between them to move: M is singular though its diagonal is not.
    let robot = Robot::from_urdf(
        r#"<robot name="idle"><link name="base"/>
        <link name="ring"><inertial><mass value="1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
        <link name="disc"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <joint name="outer" type="continuous"><parent link="base"/><child link="ring"/></joint>
        <joint name="inner" type="continuous"><parent link="ring"/><child link="disc"/></joint></robot>"#,
    )
    .unwrap();
    robot.require_dynamics().unwrap();
    let mut dynamics = Dynamics::new(&robot);
    let error = dynamics
        .forward(&robot, &[0.0; 2], &[0.0; 2], &[1.0; 2], &GRAVITY)
        .unwrap_err();
    assert!(
        error.to_string().contains("joint `inner` moves no inertia"),
        "{error}"
    );
    let nowhere = dynamics.forward(&robot, &[f64::NAN; 2], &[0.0; 2], &[1.0; 2], &GRAVITY);
    assert!(nowhere.is_err());
}

#[test]
#[should_panic(expected = "one position a joint")]
fn a_short_configuration_is_a_mistake() {
    let robot = double_pendulum();
    Dynamics::new(&robot).mass_matrix(&robot, &[0.0]);
}
