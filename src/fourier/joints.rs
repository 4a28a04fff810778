//! Names of joints: the one way in which learned joints and robot joints find each other.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::error::{Error, ErrorKind, Result, listed};

/// The names of the joints of a motion, in order: not empty, none twice. Cheap to clone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Joints(Arc<[String]>);

impl Joints {
    /// # Errors
    /// When there is no name, an empty name, or a name twice.
    pub fn new<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Result<Self> {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        if names.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "no joints").expected("at least one"));
        }
        let mut seen = BTreeSet::new();
        for (i, name) in names.iter().enumerate() {
            if name.trim().is_empty() {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("joint {} has no name", i + 1),
                ));
            }
            if !seen.insert(name) {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("joint `{name}` is named twice"),
                ));
            }
        }
        Ok(Self(names.into()))
    }

    /// Number of joints, D.
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The names in order.
    pub fn iter(&self) -> std::slice::Iter<'_, String> {
        self.0.iter()
    }

    /// The name of joint `index`; panics when there is none, as slices do.
    pub fn name(&self, index: usize) -> &str {
        &self.0[index]
    }

    /// The index of a joint.
    ///
    /// # Errors
    /// When there is no such joint; the message lists those that are there.
    pub fn index(&self, name: &str) -> Result<usize> {
        self.0.iter().position(|n| n == name).ok_or_else(|| {
            Error::new(ErrorKind::Name, format!("no joint `{name}`"))
                .expected(format!("one of {}", self.listed()))
        })
    }

    /// The names in one line, for messages; the first dozen of them.
    pub fn listed(&self) -> String {
        listed(&self.0)
    }
}

impl<'a> IntoIterator for &'a Joints {
    type Item = &'a String;
    type IntoIter = std::slice::Iter<'a, String>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
