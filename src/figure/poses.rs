//! The robot in several poses at once, as in figure 3 of the paper.

use nalgebra::{Isometry3, Point3, Vector3};

use super::camera::corners;
use super::image::{Color, Image};
use super::robot_view::{self, Solid, View};
use crate::error::Result;
use crate::fourier::Interval;
use crate::geometry;
use crate::robot::Robot;

/// Vertical angle of view \[rad\].
const FIELD_OF_VIEW: f64 = 0.5;

/// How far below the moving bodies the base is shown, as a share of their extent.
const BELOW: f64 = 0.1;

/// How far beyond the end of the hand its path is drawn \[m\].
const BEYOND: f64 = 0.012;

/// Space about what is shown.
const MARGIN: f64 = 1.06;

/// Colour of links for which the file gives none.
const PLAIN: Color = Color::new(205, 208, 212);

/// Where the eye is, seen from the robot, which looks along x: in front, a little to its right and above.
const DIRECTION: Vector3<f64> = Vector3::new(1.0, -0.30, 0.12);

/// Configurations of one robot, to be drawn over each other.
pub struct Poses<'a> {
    /// Whose configurations.
    pub robot: &'a Robot,
    /// Oldest first; the newest is opaque, the oldest nearly transparent.
    pub configurations: &'a [Vec<f64>],
    /// Configurations through which the tip's path is drawn, in time.
    pub path: &'a [Vec<f64>],
}

impl Poses<'_> {
    /// A picture of `size` px with the camera in front of the robot, at a distance that shows the moving bodies and the
    /// upper part of the base.
    ///
    /// # Errors
    /// When a number is not finite or the size is none of a picture.
    pub fn draw(&self, size: (u32, u32)) -> Result<Image> {
        let robot = self.robot;
        let still = solids(&robot.bodies()[0].visual, &Isometry3::identity());
        let ghosts: Vec<Vec<Solid>> = self
            .configurations
            .iter()
            .map(|q| {
                let poses = robot.body_poses(q);
                robot
                    .bodies()
                    .iter()
                    .zip(&poses)
                    .skip(1)
                    .flat_map(|(body, pose)| solids(&body.visual, pose))
                    .collect()
            })
            .collect();
        let (hand, point) = self.fingertip();
        let path: Vec<Point3<f64>> = self
            .path
            .iter()
            .map(|q| robot.body_poses(q)[hand] * point)
            .collect();
        robot_view::render(
            &self.view(&still, &ghosts, &path, size),
            &still,
            &ghosts,
            &path,
            size,
        )
    }

    /// A point just beyond the end of the hand, where its path is not hidden by it: the body of the robot's tip, and the
    /// point in its frame, in the direction of the tip as far out as the body reaches.
    fn fingertip(&self) -> (usize, Point3<f64>) {
        let tip = self.robot.tip();
        let outwards = tip.pose.translation.vector;
        let Some(direction) = outwards.try_normalize(1e-9) else {
            return (tip.body, Point3::from(outwards));
        };
        let reach = solids(
            &self.robot.bodies()[tip.body].visual,
            &Isometry3::identity(),
        )
        .iter()
        .flat_map(|s| corners(&s.shape, &s.pose))
        .map(|corner| corner.coords.dot(&direction))
        .fold(outwards.norm(), f64::max);
        (tip.body, Point3::from(direction * (reach + BEYOND)))
    }

    /// Frames everything that moves, and of the base what is not far below it.
    fn view(
        &self,
        still: &[Solid],
        ghosts: &[Vec<Solid>],
        path: &[Point3<f64>],
        size: (u32, u32),
    ) -> View {
        let towards = DIRECTION.normalize();
        let right = Vector3::z().cross(&towards).normalize();
        let up = towards.cross(&right);
        // Extent to the right, upwards and towards the eye.
        let place = |p: &Point3<f64>| [right, up, towards].map(|axis| axis.dot(&p.coords));
        let mut moving = [Interval {
            lower: f64::INFINITY,
            upper: f64::NEG_INFINITY,
        }; 3];
        let include = |extents: &mut [Interval; 3], p: [f64; 3]| {
            for (extent, x) in extents.iter_mut().zip(p) {
                *extent = Interval {
                    lower: extent.lower.min(x),
                    upper: extent.upper.max(x),
                };
            }
        };
        let around = |s: &Solid| corners(&s.shape, &s.pose);
        for p in ghosts
            .iter()
            .flatten()
            .flat_map(around)
            .chain(path.iter().copied())
        {
            include(&mut moving, place(&p));
        }
        let mut shown = moving;
        let lowest = moving[1].lower - BELOW * moving[1].width().max(moving[0].width());
        for p in still.iter().flat_map(around) {
            // What lies far below is cut by the edge of the picture, not shown small.
            let [x, y, z] = place(&p);
            if y >= lowest {
                include(&mut shown, [x, y, z]);
            }
        }
        let middle = shown.map(|e| (e.lower + e.upper) / 2.0);
        let target = right * middle[0] + up * middle[1] + towards * middle[2];
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let half = (shown[1].width() / 2.0).max(shown[0].width() / 2.0 / aspect);
        let distance = MARGIN * half / (FIELD_OF_VIEW / 2.0).tan() + shown[2].width() / 2.0;
        View {
            eye: Point3::from(target + towards * distance),
            target: Point3::from(target),
            field_of_view: FIELD_OF_VIEW,
        }
    }
}

fn solids(visual: &[geometry::Solid], body: &Isometry3<f64>) -> Vec<Solid> {
    visual
        .iter()
        .map(|solid| Solid {
            shape: solid.shape.clone(),
            pose: body * solid.pose,
            color: solid.color.map_or(PLAIN, |rgb| {
                let [r, g, b] = rgb.map(|c| (c * 255.0).round() as u8);
                Color::new(r, g, b)
            }),
        })
        .collect()
}
