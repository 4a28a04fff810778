//! Joints that mimic others: every chain ends at a joint that moves by itself.

use std::collections::HashMap;

use roxmltree::{Node, NodeId};

use super::xml::{Names, Xml};
use crate::error::{Error, ErrorKind, Result, listed};

impl<'a> Xml<'a> {
    /// Follows every chain of mimics, each joint once.
    pub(super) fn mimics(&self, root: Node<'a, 'a>, joints: &Names<'a>) -> Result<()> {
        // Each joint that was passed, with the walk that passed it.
        let mut passed: HashMap<NodeId, NodeId> = HashMap::new();
        for start in root.children().filter(|n| n.has_tag_name("joint")) {
            let mut at = start;
            while !passed.contains_key(&at.id()) {
                passed.insert(at.id(), start.id());
                match self.leader(at, joints).map_err(|e| self.inside(e, at))? {
                    Some((mimic, leader)) if passed.get(&leader.id()) == Some(&start.id()) => {
                        let name = listed(&[leader.attribute("name").unwrap_or("")]);
                        let what = format!("mimic of `{name}` comes back to itself");
                        return Err(self.inside(self.refuse(mimic, what), at));
                    }
                    Some((_, leader)) => at = leader,
                    None => break,
                }
            }
        }
        Ok(())
    }

    /// The <mimic> of a joint and the joint that it follows.
    fn leader(
        &self,
        joint: Node<'a, 'a>,
        joints: &Names<'a>,
    ) -> Result<Option<(Node<'a, 'a>, Node<'a, 'a>)>> {
        let Some(mimic) = self
            .child(joint, "mimic")
            .filter(|_| joint.attribute("type") != Some("fixed"))
        else {
            return Ok(None);
        };
        let name = self.text(mimic, "joint")?;
        if self.optional_number(mimic, "multiplier")? == Some(0.0) {
            return Err(self
                .refuse(mimic, "a mimic with multiplier 0 never moves")
                .help("make the joint fixed"));
        }
        self.optional_number(mimic, "offset")?;
        let shown = listed(&[name]);
        let Some(leader) = joints.get(name).copied() else {
            return Err(
                Error::new(ErrorKind::Name, format!("no joint `{shown}` to mimic"))
                    .at(self.line(mimic)),
            );
        };
        if leader.attribute("type") == Some("fixed") {
            return Err(self.refuse(mimic, format!("mimic of the fixed joint `{shown}`")));
        }
        Ok(Some((mimic, leader)))
    }
}
