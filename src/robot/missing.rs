//! What a robot's file lacks for what is asked of it.

use super::Robot;
use crate::error::{Error, ErrorKind, Result, listed};

impl Robot {
    /// # Errors
    /// When the collision geometry of a link was not read, or fewer than two bodies have any: what is not known is not
    /// called free. The message names the links.
    pub fn require_collision(&self) -> Result<()> {
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
        if shaped.count() < 2 {
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
                        "fewer than two bodies have collision shapes; without are {}",
                        listed(&without)
                    ),
                )
                .help("add <collision> elements to the URDF"),
            ));
        }
        Ok(())
    }
}
