//! What a robot's file lacks for what is asked of it.

use super::Robot;
use crate::error::{Error, ErrorKind, Result, listed};

impl Robot {
    /// # Errors
    /// When the collision geometry of a link was not read, or the bodies that have any and `objects` around the robot are fewer than two:
    /// what is not known is not called free. The message names the links.
    pub fn require_collision(&self, objects: usize) -> Result<()> {
        let here = |e: Error| e.at(format!("robot `{}`", self.name));
        let unread: Vec<&str> = self
            .bodies
            .iter()
            .flat_map(|b| b.unread_collision.iter().map(String::as_str))
            .collect();
        if let Some(first) = unread.first() {
            return Err(here(
                Error::new(
                    ErrorKind::Infeasible,
                    format!("{} collision meshes are not read, first {first}", unread.len()),
                )
                .help("give the folder that holds the meshes (--meshes), as STL or OBJ; kinematics and limits do without"),
            ));
        }
        let shaped = self.bodies.iter().filter(|b| !b.collision.is_empty());
        let shaped = shaped.count();
        if shaped == 0 || shaped + objects < 2 {
            let without: Vec<&str> = self
                .bodies
                .iter()
                .filter(|b| b.collision.is_empty())
                .map(|b| b.name.as_str())
                .collect();
            return Err(here(
                Error::new(
                    ErrorKind::Infeasible,
                    format!(
                        "{} collision shapes, so nothing can touch; without are {}",
                        if shaped == 0 {
                            "no body has"
                        } else {
                            "a single body has"
                        },
                        listed(&without)
                    ),
                )
                .help("add <collision> elements to the URDF, or give a scene (--scene)"),
            ));
        }
        Ok(())
    }
}
