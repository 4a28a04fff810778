//! Joints that mimic others, as functions of the joint that is commanded.

use std::collections::HashMap;

use crate::error::{Error, ErrorKind, Result};

/// Multipliers within this and its inverse: chains of mimics multiply theirs.
const LARGEST: f64 = 1e9;

/// Position = `multiplier` * q\[`index`\] + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Follows {
    pub index: usize,
    pub multiplier: f64,
    pub offset: f64,
}

/// How each joint follows those that are commanded; `commanded` are these, in the order of q. The lint has seen to it
/// that every chain of mimics ends at one.
pub(super) fn resolve<'a>(
    joints: &'a [urdf_rs::Joint],
    commanded: &'a [String],
) -> Result<HashMap<&'a str, Follows>> {
    let mut known: HashMap<&str, Follows> = commanded
        .iter()
        .enumerate()
        .map(|(index, name)| {
            let itself = Follows {
                index,
                multiplier: 1.0,
                offset: 0.0,
            };
            (name.as_str(), itself)
        })
        .collect();
    let by_name: HashMap<&str, &urdf_rs::Mimic> = joints
        .iter()
        .filter_map(|j| Some((j.name.as_str(), j.mimic.as_ref()?)))
        .collect();
    for joint in joints {
        // Up to a joint that is known, and down again: each joint is passed once.
        let mut chain = Vec::new();
        let mut at = joint.name.as_str();
        while let (None, Some(mimic)) = (known.get(at), by_name.get(at)) {
            chain.push((at, *mimic));
            at = &mimic.joint;
        }
        let Some(mut follows) = known.get(at).copied() else {
            continue;
        };
        for (name, mimic) in chain.into_iter().rev() {
            let gain = mimic.multiplier.unwrap_or(1.0);
            follows.multiplier *= gain;
            follows.offset = gain * follows.offset + mimic.offset.unwrap_or(0.0);
            let sound = (1.0 / LARGEST..=LARGEST).contains(&follows.multiplier.abs())
                && follows.offset.abs() <= LARGEST;
            if !sound {
                return Err(Error::new(
                    ErrorKind::Value,
                    format!(
                        "its chain of mimics comes to {:e} times the joint that leads, and {:e}",
                        follows.multiplier, follows.offset
                    ),
                )
                .expected(format!("a multiplier within {LARGEST:e} and its inverse"))
                .at(format!("joint `{name}`")));
            }
            known.insert(name, follows);
        }
    }
    Ok(known)
}
