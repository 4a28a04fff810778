//! From the name of a mesh in a URDF to a file, which lies in one of the roots whatever the name says.

use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

use crate::error::{Error, ErrorKind, Result};

/// Ends of a path that are looked for.
const MOST_ENDS: usize = 32;

/// A folder in which meshes may lie, without links in its path.
#[derive(Debug)]
struct Root {
    path: PathBuf,
    name: Option<OsString>,
}

/// Folders in which meshes may lie.
#[derive(Debug)]
pub(super) struct Roots(Vec<Root>);

/// A regular file in one of the roots.
#[derive(Debug, PartialEq)]
pub(super) struct Found {
    /// Without links in it.
    pub path: PathBuf,
    /// Whether only an end of the name was found.
    pub by_end: bool,
}

/// What became of one place where the file might be.
enum Place {
    File(PathBuf),
    Absent,
    Barred(&'static str),
}

impl Roots {
    /// # Errors
    /// When a root is no folder.
    pub fn new(folders: &[PathBuf]) -> Result<Self> {
        let root = |folder: &PathBuf| {
            // The folder of a file that is named without one is the current one.
            let folder = match folder.as_os_str().is_empty() {
                true => Path::new("."),
                false => folder,
            };
            let path = folder
                .canonicalize()
                .map_err(|e| Error::io(folder, &e).help("give a folder that holds the meshes"))?;
            if !path.is_dir() {
                return Err(Error::new(ErrorKind::Io, "a file")
                    .expected("a folder that holds the meshes")
                    .at(folder.display().to_string()));
            }
            let name = path.file_name().map(ToOwned::to_owned);
            Ok(Root { path, name })
        };
        folders.iter().map(root).collect::<Result<_>>().map(Self)
    }

    /// The file that `name` stands for, or why there is none.
    pub fn find(&self, name: &str) -> std::result::Result<Found, String> {
        let mut barred = None;
        let mut found = self.first(name, &mut barred);
        // `file://` names are often written as addresses.
        if found.is_none() && name.contains('%') {
            found = decoded(name).and_then(|name| self.first(&name, &mut barred));
        }
        found.ok_or_else(|| {
            barred.map_or_else(
                || match self.0.as_slice() {
                    [] => "there is no folder to look for it in".to_owned(),
                    [root] => format!("no such file in {}", root.path.display()),
                    many => format!("no such file in any of {} folders", many.len()),
                },
                str::to_owned,
            )
        })
    }

    fn first(&self, name: &str, barred: &mut Option<&'static str>) -> Option<Found> {
        let mut take = |path: PathBuf, by_end| match self.look(&path) {
            Place::File(path) => Some(Found { path, by_end }),
            Place::Absent => None,
            Place::Barred(why) => {
                barred.get_or_insert(why);
                None
            }
        };
        if let Some(rest) = name
            .strip_prefix("package://")
            .or_else(|| name.strip_prefix("model://"))
        {
            let (package, inside) = rest.split_once('/').unwrap_or((rest, ""));
            return self.0.iter().find_map(|root| {
                let is_package = root.name.as_ref().is_some_and(|n| n == package);
                let own = is_package.then(|| root.path.join(relative(inside)));
                take(root.path.join(relative(rest)), false)
                    .or_else(|| own.and_then(|path| take(path, false)))
            });
        }
        let path = name.strip_prefix("file://").unwrap_or(name);
        if path.contains("://") {
            barred.get_or_insert("only package://, file:// and plain paths are read");
            return None;
        }
        if !path.starts_with('/') {
            return self
                .0
                .iter()
                .find_map(|root| take(root.path.join(path), false));
        }
        if let Some(found) = take(PathBuf::from(path), false) {
            return Some(found);
        }
        // An absolute path of another machine: its longest end that is here.
        let mut rest = path
            .rmatch_indices('/')
            .nth(MOST_ENDS - 1)
            .map_or(path, |(i, _)| &path[i..]);
        while let Some((_, end)) = rest.split_once('/') {
            rest = end;
            let here = |root: &Root| take(root.path.join(relative(end)), true);
            if let Some(found) = self.0.iter().find_map(here) {
                return Some(found);
            }
        }
        None
    }

    /// Looks at one path. What leads out of the roots by its words alone is not even asked for.
    fn look(&self, path: &Path) -> Place {
        const OUT: Place = Place::Barred("it leads out of the folders that may be read");
        let inside = |path: &Path| self.0.iter().any(|root| path.starts_with(&root.path));
        if !plain(path).is_some_and(|p| inside(&p)) {
            return OUT;
        }
        // Links are resolved, and may lead out too.
        let Ok(real) = path.canonicalize() else {
            return Place::Absent;
        };
        if !inside(&real) {
            return OUT;
        }
        // A pipe would wait for ever, a device never end.
        match real.metadata() {
            Ok(data) if data.is_file() => Place::File(real),
            Ok(_) => Place::Barred("it is no regular file"),
            Err(_) => Place::Absent,
        }
    }
}

/// As a path to be joined: an absolute one would take the place of what it is joined to.
fn relative(path: &str) -> &str {
    path.trim_start_matches('/')
}

/// A path without `.` and `..`; `None` when it leads above everything.
fn plain(path: &Path) -> Option<PathBuf> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                if !plain.pop() {
                    return None;
                }
            }
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    Some(plain)
}

/// `%20` as a space and so on; `None` when it is no text.
fn decoded(name: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = name.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let code = after
            .get(..2)
            .filter(|_| *first == b'%')
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = &after[if code.is_some() { 2 } else { 0 }..];
    }
    String::from_utf8(bytes).ok()
}

/// A name's content among those in the program.
pub(super) fn embedded(
    files: &[(&'static str, &'static [u8])],
    name: &str,
) -> Option<&'static [u8]> {
    let rest = name.strip_prefix("package://").unwrap_or(name);
    let get = |path: &str| files.iter().find(|(p, _)| *p == path).map(|(_, c)| *c);
    get(rest).or_else(|| {
        let (_, inside) = rest.split_once('/')?;
        get(inside).filter(|_| rest.len() < name.len())
    })
}

/// The name of a mesh as it is told.
pub(in crate::robot) fn shown(name: &str) -> String {
    // Ends of paths say more than their starts.
    let end = name.char_indices().rev().nth(60).map_or(0, |(i, _)| i);
    match end {
        0 => name.to_owned(),
        _ => format!("..{}", &name[end..]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_their_roots_and_nowhere_else() {
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path().canonicalize().unwrap();
        for file in [
            "out.stl",
            "ws/arm/meshes/a b.stl",
            "ws/arm/meshes/deep/a.stl",
            "ws/arm/urdf/u.stl",
        ] {
            let path = base.join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, file).unwrap();
        }
        let roots = |names: &[&str]| {
            Roots::new(&names.iter().map(|n| base.join(n)).collect::<Vec<_>>()).unwrap()
        };
        let told = |roots: &Roots, name: &str| match roots.find(name) {
            Ok(found) => {
                let content = std::fs::read_to_string(found.path).unwrap();
                format!("{content}{}", if found.by_end { " by its end" } else { "" })
            }
            Err(why) => why,
        };
        const DEEP: &str = "ws/arm/meshes/deep/a.stl";
        const OUT: &str = "it leads out of the folders that may be read";
        let (ws, arm, urdf) = (roots(&["ws"]), roots(&["ws/arm"]), roots(&["ws/arm/urdf"]));
        let both = roots(&["ws/arm/urdf", "ws/arm"]);
        let inside = base.join(DEEP).display().to_string();
        let outside = base.join("out.stl").display().to_string();
        for (roots, name, expected) in [
            (&ws, "package://arm/meshes/deep/a.stl", DEEP),
            (&arm, "package://arm/meshes/deep/a.stl", DEEP),
            (&arm, "model://arm//meshes/deep/a.stl", DEEP),
            (&arm, "meshes/deep/a.stl", DEEP),
            (&arm, "./meshes/../meshes/deep/a.stl", DEEP),
            (&arm, "file://meshes/deep/a.stl", DEEP),
            (&arm, "file://meshes/a%20b.stl", "ws/arm/meshes/a b.stl"),
            (&arm, &format!("file://{inside}"), DEEP),
            (&arm, &inside, DEEP),
            (
                &arm,
                "file:///opt/other/arm/meshes/deep/a.stl",
                "ws/arm/meshes/deep/a.stl by its end",
            ),
            (&urdf, "../meshes/deep/a.stl", OUT),
            (&both, "../meshes/deep/a.stl", DEEP),
            (&arm, "../../out.stl", OUT),
            (&arm, "%2e%2e/%2e%2e/out.stl", OUT),
            (&arm, "package://../../out.stl", OUT),
            (&arm, "package://arm/../../out.stl", OUT),
            (&arm, &format!("file://{outside}"), OUT),
            (&arm, "file:///etc/passwd", OUT),
            (&arm, "/../../../../etc/passwd", OUT),
            (&arm, "meshes", "it is no regular file"),
            (&arm, "package://arm", "it is no regular file"),
            (
                &arm,
                "http://x/y.stl",
                "only package://, file:// and plain paths are read",
            ),
        ] {
            assert_eq!(told(roots, name), expected, "{name}");
        }
        for absent in ["", "meshes\\deep\\a.stl", "a\0.stl", "package://", "%"] {
            let why = told(&arm, absent);
            assert!(
                why.contains("no such file") || why.contains("no regular file"),
                "{absent}: {why}"
            );
        }
        assert!(Roots::new(&[base.join("none")]).is_err());
        assert!(Roots::new(&[base.join("out.stl")]).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_do_not_lead_out() {
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path();
        std::fs::create_dir_all(base.join("root/in")).unwrap();
        std::fs::write(base.join("secret.stl"), "secret").unwrap();
        std::fs::write(base.join("root/in/a.stl"), "a").unwrap();
        let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, base.join(name)).unwrap();
        link("../secret.stl", "root/file.stl");
        link("..", "root/up");
        link("in", "root/way");
        link("loop", "root/loop");
        let roots = Roots::new(&[base.join("root")]).unwrap();
        for name in ["file.stl", "up/secret.stl", "way/../../secret.stl"] {
            let why = roots.find(name).unwrap_err();
            assert!(why.contains("leads out"), "{name}: {why}");
        }
        assert!(roots.find("loop").unwrap_err().contains("no such file"));
        assert!(roots.find("way/a.stl").is_ok());
    }

    #[test]
    fn what_is_in_the_program_is_found_by_its_path() {
        let files: &[(&str, &[u8])] = &[("arm/a.stl", b"a"), ("b.stl", b"b")];
        for (name, content) in [
            ("package://arm/a.stl", Some(&b"a"[..])),
            ("arm/a.stl", Some(b"a")),
            ("package://arm/b.stl", Some(b"b")),
            ("b.stl", Some(b"b")),
            ("other/b.stl", None),
            ("file:///b.stl", None),
        ] {
            assert_eq!(embedded(files, name), content, "{name}");
        }
    }
}
