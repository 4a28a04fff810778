//! BVH text, line by line: no recursion, and no space for what is announced and does not come.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::{Axis, Bone, Bvh};
use crate::error::{Error, ErrorKind, Reason, Result};

/// A person with all fingers has a hundred bones.
const MOST_BONES: usize = 4096;

/// Turns and lengths beyond this, in any unit, are of no person.
const LARGEST: f64 = 1e9;

/// Frame times \[s\] of no camera.
pub(super) const FRAME_TIMES: std::ops::RangeInclusive<f64> = 1e-5..=10.0;

/// # Errors
/// Those of [`Bvh::from_text`].
pub(super) fn bvh(text: &str) -> Result<Bvh> {
    let mut lines = Lines::new(text);
    let (bones, channels) = hierarchy(&mut lines)?;
    motion(&mut lines, bones, channels)
}

/// Lines of a text, with their numbers, without those that are empty.
struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    last: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            lines: text.trim_start_matches('\u{feff}').lines().enumerate(),
            last: 1,
        }
    }

    fn next(&mut self) -> Option<(usize, &'a str)> {
        for (i, line) in self.lines.by_ref() {
            self.last = i + 1;
            let line = line.trim();
            if !line.is_empty() {
                return Some((i + 1, line));
            }
        }
        None
    }

    /// The text ends where more was to come.
    fn cut_short(&self, expected: &str) -> Error {
        Error::new(ErrorKind::Syntax, "the file is cut short")
            .expected(expected)
            .help("export or download it again")
            .at(format!("line {}", self.last))
    }
}

/// What the braces of a hierarchy are around.
enum Open {
    Bone(usize),
    EndSite,
}

/// Bones and the count of their channels, up to the line MOTION.
fn hierarchy(lines: &mut Lines<'_>) -> Result<(Vec<Bone>, usize)> {
    let mut reader = Hierarchy::default();
    const FIRST: &str = "HIERARCHY, as the first word of a BVH file";
    match lines.next() {
        Some((_, line)) if line.eq_ignore_ascii_case("HIERARCHY") => {}
        Some((at, line)) => return Err(found(line, FIRST).at(format!("line {at}"))),
        None => return Err(Error::new(ErrorKind::Syntax, "the file is empty").expected(FIRST)),
    }
    while let Some((at, line)) = lines.next() {
        if line.eq_ignore_ascii_case("MOTION") {
            return reader.finish().map_err(|e| e.at(format!("line {at}")));
        }
        let mut rest = line;
        while !rest.is_empty() {
            let end = rest.find(['{', '}']).unwrap_or(rest.len());
            let statement = if end == 0 { &rest[..1] } else { &rest[..end] };
            rest = rest[statement.len()..].trim_start();
            reader
                .take(statement.trim_end(), at)
                .map_err(|e| e.at(format!("line {at}")))?;
        }
    }
    Err(lines.cut_short("the hierarchy to end, and MOTION"))
}

#[derive(Default)]
struct Hierarchy {
    bones: Vec<Bone>,
    by_name: HashMap<String, usize>,
    channels: usize,
    open: Vec<Open>,
    /// A name whose brace has not come yet.
    announced: Option<Open>,
}

impl Hierarchy {
    fn take(&mut self, statement: &str, line: usize) -> Result<()> {
        let (word, rest) = statement
            .split_once(char::is_whitespace)
            .unwrap_or((statement, ""));
        let rest = rest.trim();
        if self.announced.is_some() && word != "{" {
            return Err(found(statement, "`{` after a bone's name"));
        }
        match word.to_ascii_uppercase().as_str() {
            "{" => {
                let open = self
                    .announced
                    .take()
                    .ok_or_else(|| found("{", "a bone's name before it"))?;
                self.open.push(open);
            }
            "}" => {
                self.open
                    .pop()
                    .ok_or_else(|| found("}", "as many `{` before it"))?;
            }
            "ROOT" if self.open.is_empty() => self.bone(rest, None, line)?,
            "JOINT" => {
                let parent = self.owner("JOINT within the braces of its parent")?;
                self.bone(rest, Some(parent), line)?;
            }
            "END" => {
                self.owner("End Site within the braces of a bone")?;
                self.announced = Some(Open::EndSite);
            }
            "OFFSET" => {
                let offset = vector(rest)?;
                if let Some(Open::Bone(bone)) = self.open.last() {
                    self.bones[*bone].offset = offset;
                }
            }
            "CHANNELS" => {
                let bone = self.owner("CHANNELS within the braces of a bone")?;
                self.channels(bone, rest)?;
            }
            _ => {
                return Err(found(
                    statement,
                    "ROOT, JOINT, End Site, OFFSET, CHANNELS, a brace, or MOTION",
                ));
            }
        }
        Ok(())
    }

    fn owner(&self, expected: &str) -> Result<usize> {
        match self.open.last() {
            Some(Open::Bone(bone)) => Ok(*bone),
            _ => Err(Error::new(ErrorKind::Syntax, "outside a bone").expected(expected)),
        }
    }

    fn bone(&mut self, name: &str, parent: Option<usize>, line: usize) -> Result<()> {
        if name.is_empty() {
            return Err(Error::new(ErrorKind::Syntax, "a bone without name")
                .expected("its name on the same line"));
        }
        if self.bones.len() == MOST_BONES {
            return Err(Error::new(ErrorKind::Value, "too many bones")
                .expected(format!("at most {MOST_BONES}")));
        }
        if let Some(&other) = self.by_name.get(name) {
            let above = self.open.iter().any(|open| match open {
                Open::Bone(bone) => *bone == other,
                Open::EndSite => false,
            });
            let what = if above {
                format!("a cycle: bone `{name}` is below itself")
            } else {
                format!("two bones `{name}`")
            };
            return Err(Error::new(ErrorKind::Name, what)
                .expected(format!(
                    "a name of its own; the other is on line {}",
                    self.bones[other].line
                ))
                .help("rename one of them"));
        }
        let bone = self.bones.len();
        self.by_name.insert(name.to_owned(), bone);
        self.bones.push(Bone {
            name: name.to_owned(),
            parent,
            offset: Vector3::zeros(),
            turns: Vec::new(),
            line,
        });
        self.announced = Some(Open::Bone(bone));
        Ok(())
    }

    fn channels(&mut self, bone: usize, text: &str) -> Result<()> {
        const KINDS: &str = "Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation";
        let mut words = text.split_whitespace();
        let count = words.next().and_then(|n| n.parse::<usize>().ok());
        let names: Vec<&str> = words.collect();
        if count != Some(names.len()) {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("CHANNELS {text}: {} names", names.len()),
            )
            .expected("a count and as many names"));
        }
        if names
            .iter()
            .enumerate()
            .any(|(i, n)| names[..i].contains(n))
        {
            return Err(Error::new(
                ErrorKind::Name,
                format!("CHANNELS {text}: one of them twice"),
            )
            .expected(KINDS));
        }
        for name in names {
            let axis = match name.to_ascii_lowercase().as_str() {
                "xrotation" => Some(Axis::X),
                "yrotation" => Some(Axis::Y),
                "zrotation" => Some(Axis::Z),
                "xposition" | "yposition" | "zposition" => None,
                _ => {
                    return Err(
                        Error::new(ErrorKind::Name, format!("channel `{name}`")).expected(KINDS)
                    );
                }
            };
            if let Some(axis) = axis {
                self.bones[bone].turns.push((axis, self.channels));
            }
            self.channels += 1;
        }
        Ok(())
    }

    fn finish(self) -> Result<(Vec<Bone>, usize)> {
        let unclosed = self.open.iter().rev().find_map(|open| match open {
            Open::Bone(bone) => Some(&self.bones[*bone]),
            Open::EndSite => None,
        });
        if let Some(bone) = unclosed {
            return Err(Error::new(
                ErrorKind::Syntax,
                format!("{} braces are not closed", self.open.len()),
            )
            .expected(format!(
                "`}}` for bone `{}` of line {}",
                bone.name, bone.line
            )));
        }
        if self.channels == 0 {
            return Err(Error::new(ErrorKind::Shape, "no bone with channels")
                .expected("ROOT, and CHANNELS in its braces"));
        }
        Ok((self.bones, self.channels))
    }
}

/// Frames, and with them the whole.
fn motion(lines: &mut Lines<'_>, bones: Vec<Bone>, channels: usize) -> Result<Bvh> {
    let (at, text) = setting(lines, "Frames:")?;
    let announced: usize = text
        .parse()
        .map_err(|_| found(text, "Frames: and a whole number").at(format!("line {at}")))?;
    let (at, text) = setting(lines, "Frame Time:")?;
    let rate = rate(text).map_err(|e| e.at(format!("line {at}")))?;

    let mut values = Vec::new();
    while let Some((at, line)) = lines.next() {
        if values.len() / channels >= announced {
            return Err(Error::new(ErrorKind::Shape, "more frames than announced")
                .expected(format!("{announced}, as in `Frames:`"))
                .help("put the count of frames right")
                .at(format!("line {at}")));
        }
        let before = values.len();
        for (i, word) in line.split_whitespace().enumerate() {
            values.push(
                number(word)
                    .map_err(|e| e.at(format!("number {}", i + 1)).at(format!("line {at}")))?,
            );
        }
        let found = values.len() - before;
        if found != channels {
            return Err(
                Error::new(ErrorKind::Shape, format!("a frame of {found} numbers"))
                    .expected(format!("{channels}, one a channel"))
                    .help("if it is the last line the file is cut short: export it again, or take the line out and put `Frames:` right")
                    .at(format!("line {at}")),
            );
        }
    }
    let frames = values.len() / channels;
    if frames < announced {
        return Err(Error::new(
            ErrorKind::Shape,
            format!("{frames} frames, the file is cut short"),
        )
        .expected(format!("{announced}, as in `Frames:`"))
        .help("export or download it again, or put the count of frames right")
        .at(format!("line {}", lines.last)));
    }
    if frames < 2 {
        return Err(
            Error::new(ErrorKind::Shape, format!("{frames} frames")).expected("at least two")
        );
    }
    Ok(Bvh {
        bones,
        channels,
        rate,
        values,
    })
}

/// What follows a name on the next line.
fn setting<'a>(lines: &mut Lines<'a>, name: &str) -> Result<(usize, &'a str)> {
    let Some((at, line)) = lines.next() else {
        return Err(lines.cut_short(&format!("`{name}`")));
    };
    match line.split_at_checked(name.len()) {
        Some((word, rest)) if word.eq_ignore_ascii_case(name) => Ok((at, rest.trim())),
        _ => Err(found(line, &format!("`{name}`")).at(format!("line {at}"))),
    }
}

/// Frames a second from a frame time. 0.0333333 is a thirtieth: a whole rate is taken where its frame time has these digits.
fn rate(text: &str) -> Result<f64> {
    let time = number(text)?;
    if !FRAME_TIMES.contains(&time) {
        return Err(
            Error::new(ErrorKind::Value, format!("a frame time of {time} s")).expected(format!(
                "{} to {}",
                FRAME_TIMES.start(),
                FRAME_TIMES.end()
            )),
        );
    }
    let whole = (1.0 / time).round();
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    let rounded = (1.0 / whole - time).abs() <= 0.5 * 0.1f64.powi(digits.min(20) as i32);
    Ok(if whole >= 1.0 && rounded {
        whole
    } else {
        1.0 / time
    })
}

fn vector(text: &str) -> Result<Vector3<f64>> {
    let numbers = text
        .split_whitespace()
        .map(number)
        .collect::<Result<Vec<_>>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err(found(text, "three numbers")),
    }
}

fn number(text: &str) -> Result<f64> {
    match text.parse::<f64>() {
        Ok(number) if number.abs() <= LARGEST => Ok(number),
        _ => Err(found(text, "a finite number")
            .because(Reason::NotFinite)
            .help("write decimals with a point; take frames without data out of the file")),
    }
}

/// Text that is something else; not all of it, it may be long.
fn found(text: &str, expected: &str) -> Error {
    let shown = crate::error::listed(&[text]);
    Error::new(ErrorKind::Syntax, format!("found `{shown}`")).expected(expected)
}
