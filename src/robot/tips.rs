//! The ends of a robot's chains, and the one that matters.

use super::{BodyJoint, JointKind, Link, Robot};
use crate::error::{Error, ErrorKind, Result, listed};

impl Robot {
    /// Links that hold no other: fingers, tools, heads. In the order of [`links`](Self::links).
    pub fn tips(&self) -> Vec<&Link> {
        let mut holds = vec![false; self.links.len()];
        for parent in self.links.iter().filter_map(|l| l.parent) {
            holds[parent] = true;
        }
        self.links
            .iter()
            .zip(holds)
            .filter_map(|(link, holds)| (!holds).then_some(link))
            .collect()
    }

    /// The link at the end of the chain that matters: that chosen at loading, else the last on the chain of most
    /// commanded joints.
    pub fn tip(&self) -> &Link {
        &self.links[self.tip]
    }

    /// The joints from the base to a link that move it, those that mimic others too, base first.
    pub fn chain(&self, link: &Link) -> Vec<&BodyJoint> {
        let mut chain = Vec::new();
        let mut body = link.body;
        while let Some(joint) = &self.bodies[body].joint {
            chain.push(joint);
            body = self.bodies[body].parent;
        }
        chain.reverse();
        chain
    }

    /// A bound on the distance \[m\] of a link's frame from the axis point of the first joint that moves it, for all
    /// configurations within the limits: the lengths of the way added up, slides at their farthest. Infinite where a slide has no
    /// limits; 0 for a link that does not move.
    pub fn reach(&self, link: &Link) -> f64 {
        let farthest = |joint: &BodyJoint| match joint.kind {
            JointKind::Revolute => 0.0,
            JointKind::Prismatic => match &self.properties(joint.index).position {
                None => f64::INFINITY,
                Some(range) => [range.lower, range.upper]
                    .map(|q| (joint.multiplier * q + joint.offset).abs())
                    .into_iter()
                    .fold(0.0, f64::max),
            },
        };
        let chain = self.chain(link);
        let way: f64 = chain
            .iter()
            .skip(1)
            .map(|joint| joint.origin.translation.vector.norm())
            .sum();
        match chain.is_empty() {
            true => 0.0,
            false => {
                way + link.pose.translation.vector.norm()
                    + chain.iter().map(|joint| farthest(joint)).sum::<f64>()
            }
        }
    }

    /// The same robot with another tip: the link of this name, or the one that [`tip`](Self::tip) says.
    ///
    /// # Errors
    /// When no link has this name.
    pub fn with_tip(mut self, name: Option<&str>) -> Result<Self> {
        let chosen = match name {
            None => Some(self.longest()),
            Some(name) => self.links.iter().position(|l| l.name == name),
        };
        let Some(tip) = chosen else {
            let tips: Vec<&str> = self.tips().iter().map(|l| l.name.as_str()).collect();
            return Err(Error::new(
                ErrorKind::Name,
                format!("no link `{}` to be the tip", listed(&[name.unwrap_or("")])),
            )
            .expected(format!("a link; chains end at {}", listed(&tips)))
            .at(format!("robot `{}`", self.name)));
        };
        self.tip = tip;
        Ok(self)
    }

    fn longest(&self) -> usize {
        let mut depths = vec![0; self.bodies.len()];
        for (i, body) in self.bodies.iter().enumerate().skip(1) {
            let own = body.joint.as_ref().is_some_and(|j| j.is_commanded);
            depths[i] = depths[body.parent] + usize::from(own);
        }
        // Links come parents first, so the last of the deepest is the end of its chain.
        (0..self.links.len())
            .max_by_key(|i| depths[self.links[*i].body])
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::LoadOptions;

    const GRIPPER: &str = r#"<robot name="r">
        <link name="base"/><link name="arm"/><link name="palm"/><link name="slide"/><link name="left"/><link name="right"/>
        <joint name="a" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="0 0 5"/></joint>
        <joint name="m" type="fixed"><parent link="arm"/><child link="palm"/><origin xyz="0.3 0.4 0"/></joint>
        <joint name="s" type="prismatic"><parent link="palm"/><child link="slide"/><origin xyz="0 0 1"/>
          <limit lower="-0.2" upper="0.1" velocity="1" effort="1"/></joint>
        <joint name="l" type="prismatic"><parent link="palm"/><child link="left"/>
          <limit lower="-9" upper="9" velocity="1" effort="1"/><mimic joint="s" multiplier="-2" offset="0.1"/></joint>
        <joint name="f" type="fixed"><parent link="left"/><child link="right"/><origin xyz="0 2 0"/></joint>
        </robot>"#;

    #[test]
    fn the_tip_is_chosen_or_ends_the_chain_of_most_commanded_joints() {
        let robot = Robot::from_urdf(GRIPPER).unwrap();
        let tips: Vec<&str> = robot.tips().iter().map(|l| l.name.as_str()).collect();
        assert_eq!(tips, ["slide", "right"]);
        // `l` follows `s`, and makes its chain no longer.
        assert_eq!(robot.tip().name, "slide");
        let options = LoadOptions {
            tip: Some("palm".into()),
            ..LoadOptions::default()
        };
        assert_eq!(Robot::load(GRIPPER, &options).unwrap().tip().name, "palm");
        let error = robot.with_tip(Some("nose")).unwrap_err().to_string();
        assert!(
            error.contains("no link `nose`") && error.contains("slide, right"),
            "{error}"
        );
    }

    #[test]
    fn reach_adds_the_way_after_the_first_joint_and_slides_at_their_farthest() {
        let robot = Robot::from_urdf(GRIPPER).unwrap();
        let link = |name: &str| robot.links().iter().find(|l| l.name == name).unwrap();
        // To the slide's origin (0.3, 0.4, 1), and 0.2 m on.
        assert!((robot.reach(link("slide")) - (1.25f64.sqrt() + 0.2)).abs() < 1e-15);
        // Of -2 q + 0.1 for q in -0.2 .. 0.1 the farthest is 0.5.
        assert!((robot.reach(link("right")) - (0.5 + 0.5 + 2.0)).abs() < 1e-15);
        assert_eq!(robot.reach(link("base")), 0.0);
    }
}
