//! [`Person`]: where a person's upper arm, forearm, hand and palm point while they wave.

use nalgebra::Vector3;

use crate::anatomy::{ARM_ANGLES as ANGLES, ShoulderOrder, about_x, about_y, about_z};
use crate::error::{Reason, Result};
use crate::fourier::{Joints, Wave};

/// What of an arm points somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Segment {
    /// From the shoulder to the elbow.
    UpperArm,
    /// From the elbow to the wrist.
    Forearm,
    /// From the wrist to the fingers.
    Hand,
    /// Out of the palm.
    Palm,
}

impl Segment {
    /// All of them, from the shoulder on.
    pub const ALL: [Self; 4] = [Self::UpperArm, Self::Forearm, Self::Hand, Self::Palm];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::UpperArm => "upper_arm",
            Self::Forearm => "forearm",
            Self::Hand => "hand",
            Self::Palm => "palm",
        }
    }
}

/// How many of the angles a wave must have; where it lacks others, they are 0.
const NEEDED: usize = 4;

/// A right arm that waves, by [joint angles](crate::ARM_ANGLES) as motion capture tells them, without a carrying angle: zero is
/// the arm hanging, palm to the thigh, elbow straight, in the frame of the thorax, X left, Y up, Z forward.
#[derive(Debug, Clone)]
pub struct Person {
    wave: Wave,
    order: ShoulderOrder,
    /// Of each angle its joint in the wave.
    columns: [Option<usize>; ANGLES.len()],
}

impl Person {
    /// # Errors
    /// When the wave lacks an angle of shoulder or elbow, or has a joint that is no angle of an arm.
    pub fn new(wave: Wave, order: ShoulderOrder) -> Result<Self> {
        let angles = Joints::new(ANGLES)?;
        for joint in wave.joints() {
            angles.index(joint).map_err(|e| {
                e.because(Reason::UnknownJoint)
                    .help("give a wave as it was recorded of a person, not one of a robot's joints")
            })?;
        }
        for needed in &ANGLES[..NEEDED] {
            wave.joints()
                .index(needed)
                .map_err(|e| e.because(Reason::MissingJoint))?;
        }
        let columns = ANGLES.map(|angle| wave.joints().index(angle).ok());
        Ok(Self {
            wave,
            order,
            columns,
        })
    }

    /// The wave of their joint angles.
    pub fn wave(&self) -> &Wave {
        &self.wave
    }

    /// Unit vectors in the frame of the thorax at time `t` \[s\], in the order of [`Segment::ALL`].
    pub fn directions(&self, t: f64) -> [Vector3<f64>; 4] {
        let position = self.wave.position(t);
        let [
            flexion,
            abduction,
            rotation,
            elbow,
            pronation,
            bend,
            deviation,
        ] = self.columns.map(|c| c.map_or(0.0, |c| position[c]));
        let (flexed, abducted) = (about_x(-flexion), about_z(-abduction));
        let raised = match self.order {
            ShoulderOrder::Xzy => flexed * abducted,
            ShoulderOrder::Zxy => abducted * flexed,
        };
        let humerus = raised * about_y(rotation);
        let forearm = humerus * about_x(-elbow);
        let hand = forearm * about_y(pronation) * about_z(bend) * about_x(-deviation);
        let down = -Vector3::y();
        // The palm of a right arm that hangs faces the thigh, to the left.
        [
            humerus * down,
            forearm * down,
            hand * down,
            hand * Vector3::x(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// An arm that holds these angles \[deg\].
    fn held(angles: &[(&str, f64)], order: ShoulderOrder) -> [Vector3<f64>; 4] {
        let value = |name: &&str| angles.iter().find(|(n, _)| n == name).map_or(0.0, |a| a.1);
        let offsets = DVector::from_iterator(7, ANGLES.iter().map(|a| value(a).to_radians()));
        let joints = Joints::new(ANGLES).unwrap();
        let wave = Wave::new(joints, 1.0, offsets, DMatrix::zeros(7, 1)).unwrap();
        Person::new(wave, order).unwrap().directions(0.3)
    }

    #[test]
    fn words_say_where_an_arm_points() {
        let (left, up, forward) = (Vector3::x(), Vector3::y(), Vector3::z());
        for (angles, expected) in [
            (vec![], [-up, -up, -up, left]),
            (
                vec![("shoulder_flexion", 90.0)],
                [forward, forward, forward, left],
            ),
            // Away from the body, palm down.
            (
                vec![("shoulder_abduction", 90.0)],
                [-left, -left, -left, -up],
            ),
            (vec![("elbow_flexion", 90.0)], [-up, forward, forward, left]),
            // Turned inwards, a bent forearm lies before the belly.
            (
                vec![("elbow_flexion", 90.0), ("shoulder_rotation", 90.0)],
                [-up, left, left, -forward],
            ),
            (vec![("forearm_pronation", 90.0)], [-up, -up, -up, -forward]),
            (vec![("wrist_flexion", 90.0)], [-up, -up, left, up]),
            (vec![("wrist_deviation", 90.0)], [-up, -up, forward, left]),
        ] {
            let found = held(&angles, ShoulderOrder::Xzy);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).norm() < 1e-15, "{angles:?}: {found}");
            }
        }
    }

    #[test]
    fn the_orders_differ_where_both_raise_the_arm() {
        let angles = [("shoulder_flexion", 90.0), ("shoulder_abduction", 90.0)];
        // Abducted within the plane that flexion has turned forward: to the right. Or flexed about its own axis: it only turns.
        let [xzy, ..] = held(&angles, ShoulderOrder::Xzy);
        assert!((xzy + Vector3::x()).norm() < 1e-15, "{xzy}");
        let [zxy, ..] = held(&angles, ShoulderOrder::Zxy);
        assert!((zxy - Vector3::z()).norm() < 1e-15, "{zxy}");
    }

    #[test]
    fn a_wave_of_other_joints_is_refused() {
        let wave = |names: &[&str]| {
            let joints = Joints::new(names.iter().copied()).unwrap();
            let n = names.len();
            Wave::new(joints, 1.0, DVector::zeros(n), DMatrix::zeros(n, 1)).unwrap()
        };
        for (names, expected) in [
            (
                &["elbow"][..],
                "no joint `elbow`, expected one of shoulder_flexion",
            ),
            (&ANGLES[1..], "no joint `shoulder_flexion`"),
            (&["shoulder_flexion", "hip"], "no joint `hip`"),
        ] {
            let error = Person::new(wave(names), ShoulderOrder::Xzy).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
        }
        assert!(Person::new(wave(&ANGLES[..4]), ShoulderOrder::Zxy).is_ok());
    }
}
