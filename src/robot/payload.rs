//! A robot that carries something.

use nalgebra::{Matrix3, Point3};

use super::dynamics::SpatialInertia;
use super::{Inertial, Robot};
use crate::error::{Error, ErrorKind, Result};

impl Robot {
    /// The same robot with a point of `mass` \[kg\] at `center`, in the frame of link `link` \[m\], fixed to that link.
    ///
    /// # Errors
    /// When there is no such link or it does not move, the mass is not positive, or a number is not finite.
    pub fn carrying(&self, link: &str, mass: f64, center: &Point3<f64>) -> Result<Self> {
        let here = |e: Error| e.at(format!("payload of link `{link}`"));
        let found = self.link(link).map_err(here)?;
        if !(mass > 0.0 && mass.is_finite()) {
            let error = Error::new(ErrorKind::Setting, format!("a mass of {mass} kg"));
            return Err(here(error.expected("more than 0")));
        }
        if !center.iter().all(|x| x.is_finite()) {
            let error = Error::new(ErrorKind::Setting, format!("a centre of mass at {center}"));
            return Err(here(error.expected("finite numbers")));
        }
        let body = found.body;
        if body == 0 {
            return Err(here(
                Error::new(ErrorKind::Infeasible, "the link belongs to the base")
                    .expected("a link that moves"),
            ));
        }
        let load = Inertial {
            mass,
            center: (found.pose * center).coords,
            inertia: Matrix3::zeros(),
        };
        let mut loaded = self.clone();
        let both = match &self.bodies[body].inertial {
            Some(own) => own.joined(&load),
            None => load,
        };
        loaded.steps[body].inertia = SpatialInertia::of(&both);
        loaded.bodies[body].inertial = Some(both);
        Ok(loaded)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_load_on_a_link_that_is_mounted_hangs_where_the_mount_puts_it() {
        let robot = Robot::from_urdf(
            r#"<robot name="r"><link name="base"/><link name="arm"/><link name="hand"/>
            <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/></joint>
            <joint name="mount" type="fixed"><parent link="arm"/><child link="hand"/>
            <origin xyz="0.3 0 0" rpy="0 0 1.5707963267948966"/></joint></robot>"#,
        )
        .unwrap();
        let loaded = robot
            .carrying("hand", 2.0, &Point3::new(0.1, 0.0, 0.05))
            .unwrap();
        let body = robot.link("hand").unwrap().body;
        let inertial = loaded.bodies()[body].inertial.as_ref().unwrap();
        assert_eq!(inertial.mass, 2.0);
        assert!((inertial.center - Vector3::new(0.3, 0.1, 0.05)).norm() < 1e-12);
    }
}
