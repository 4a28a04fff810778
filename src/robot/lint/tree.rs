//! Links and joints together: one tree.

use std::collections::{HashMap, HashSet};

use roxmltree::Node;

use super::xml::{Names, Xml};
use crate::error::{Error, ErrorKind, Result, listed};

impl<'a> Xml<'a> {
    /// One root, one parent a link, no cycle.
    pub(super) fn tree(&self, links: &Names<'a>, joints: &Names<'a>) -> Result<()> {
        let end = |joint: Node<'a, 'a>, tag| {
            self.child(joint, tag)
                .and_then(|n| n.attribute("link"))
                .unwrap_or("")
        };
        let mut parents: HashMap<&str, &str> = HashMap::new();
        let mut in_order: Vec<Node> = joints.values().copied().collect();
        in_order.sort_by_key(|n| n.range().start);
        for joint in in_order {
            let (parent, child) = (end(joint, "parent"), end(joint, "child"));
            if let Some(other) = parents.insert(child, parent) {
                return Err(self.refuse(
                    joint,
                    format!("link `{child}` has two parents, `{other}` and `{parent}`"),
                ));
            }
        }
        let mut roots: Vec<&str> = links
            .keys()
            .copied()
            .filter(|l| !parents.contains_key(l))
            .collect();
        roots.sort_unstable();
        match roots.as_slice() {
            [] => {
                let mut all: Vec<&str> = links.keys().copied().collect();
                all.sort_unstable();
                Err(
                    Error::new(ErrorKind::Shape, "no root: the links form a cycle")
                        .expected("one link without a parent")
                        .at(format!("links {}", listed(&all))),
                )
            }
            // With one root and one parent each, what is not reached from the root is in a cycle.
            [root] => {
                let mut children: HashMap<&str, Vec<&str>> = HashMap::new();
                for (child, parent) in &parents {
                    children.entry(parent).or_default().push(child);
                }
                let mut reached = HashSet::from([*root]);
                let mut open = vec![*root];
                while let Some(link) = open.pop() {
                    for child in children.get(link).into_iter().flatten() {
                        reached.insert(child);
                        open.push(child);
                    }
                }
                let mut lost: Vec<&str> = links
                    .keys()
                    .copied()
                    .filter(|l| !reached.contains(l))
                    .collect();
                lost.sort_unstable();
                if lost.is_empty() {
                    return Ok(());
                }
                Err(
                    Error::new(ErrorKind::Shape, "links form a cycle apart from the root")
                        .expected("a tree")
                        .at(format!("links {}", listed(&lost))),
                )
            }
            many => Err(
                Error::new(ErrorKind::Shape, format!("{} roots", many.len()))
                    .expected("one link without a parent")
                    .help("join the parts with a fixed joint")
                    .at(format!("links {}", listed(many))),
            ),
        }
    }
}
