//! The ends of a robot's chains, and the one that matters.

use super::{Link, Robot};
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
    pub fn chain(&self, link: &Link) -> Vec<&super::BodyJoint> {
        let mut chain = Vec::new();
        let mut body = link.body;
        while let Some(joint) = &self.bodies[body].joint {
            chain.push(joint);
            body = self.bodies[body].parent;
        }
        chain.reverse();
        chain
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
            let own = body.joint.as_ref().is_some_and(|j| self.is_commanded(j));
            depths[i] = depths[body.parent] + usize::from(own);
        }
        // Links come parents first, so the last of the deepest is the end of its chain.
        (0..self.links.len())
            .max_by_key(|i| depths[self.links[*i].body])
            .unwrap_or(0)
    }
}
