//! The house's rule of imports: a module names lower ranks only. And no C in any build.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use proc_macro2::{TokenStream, TokenTree};

/// Modules by rank; a module may use those of lower ranks, and itself.
const RANKS: [&[&str]; 9] = [
    &["elementary", "error", "vectors"],
    &[
        "anatomy",
        "document",
        "normal",
        "parallel",
        "proportion",
        "table",
        "units",
    ],
    &["fourier", "geometry", "posterior"],
    &["demonstration", "motion", "robot"],
    &["capture", "collision", "primitive", "retarget"],
    &["baseline", "shipped", "simulation"],
    &["comparison", "feasibility"],
    &["figure", "testing"],
    &["cli"],
];

/// Beyond rank: the learning half knows no robot, the robot half no primitive.
const STRANGERS: [(&str, &str); 10] = [
    ("baseline", "robot"),
    ("capture", "robot"),
    ("comparison", "robot"),
    ("primitive", "robot"),
    ("demonstration", "robot"),
    ("retarget", "primitive"),
    ("collision", "primitive"),
    ("simulation", "primitive"),
    ("feasibility", "primitive"),
    ("feasibility", "demonstration"),
];

/// Crates that compile C, C++ or assembly, or look for a library of the system.
const NOT_RUST: [&str; 6] = ["cc", "cmake", "bindgen", "pkg-config", "vcpkg", "nasm-rs"];

fn rank(module: &str) -> Option<usize> {
    RANKS.iter().position(|modules| modules.contains(&module))
}

/// What one source file names of its own crate: (line, module).
fn uses(source: &str, path: &[String]) -> Vec<(usize, String)> {
    let file = syn::parse_file(source).expect("sources parse");
    let mut found = Vec::new();
    for item in &file.items {
        if is_test(item) {
            continue;
        }
        let tokens = quote_item(item);
        collect(tokens, path, &mut found);
    }
    found
}

fn is_test(item: &syn::Item) -> bool {
    let attributes = match item {
        syn::Item::Mod(m) => &m.attrs,
        syn::Item::Fn(f) => &f.attrs,
        syn::Item::Use(u) => &u.attrs,
        _ => return false,
    };
    attributes.iter().any(|a| match &a.meta {
        syn::Meta::List(list) => a.path().is_ident("cfg") && list.tokens.to_string() == "test",
        _ => false,
    })
}

fn quote_item(item: &syn::Item) -> TokenStream {
    use syn::__private::ToTokens;
    item.to_token_stream()
}

/// Every path that starts with `crate` or `super`, resolved to a top-level module; groups of a `use` too.
fn collect(tokens: TokenStream, path: &[String], found: &mut Vec<(usize, String)>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut i = 0;
    while i < tokens.len() {
        match &tokens[i] {
            TokenTree::Group(group) => collect(group.stream(), path, found),
            TokenTree::Ident(ident) if ident == "crate" || ident == "super" => {
                let line = ident.span().start().line;
                // The module in which the path starts: the crate, or a parent of this file's.
                let mut base: Vec<String> = if ident == "crate" {
                    Vec::new()
                } else {
                    path[..path.len().saturating_sub(1)].to_vec()
                };
                let mut next = i + 1;
                while is_path_separator(&tokens, next) {
                    next += 2;
                    match tokens.get(next) {
                        Some(TokenTree::Ident(ident)) if ident == "super" => {
                            base.pop();
                            next += 1;
                        }
                        _ => break,
                    }
                }
                match base.first() {
                    Some(module) => found.push((line, module.clone())),
                    None => found.extend(heads(tokens.get(next)).into_iter().map(|m| (line, m))),
                }
                i = next;
                continue;
            }
            _ => {}
        }
        i += 1;
    }
}

fn is_path_separator(tokens: &[TokenTree], at: usize) -> bool {
    let colon =
        |t: Option<&TokenTree>| matches!(t, Some(TokenTree::Punct(p)) if p.as_char() == ':');
    colon(tokens.get(at)) && colon(tokens.get(at + 1))
}

/// The first names of what follows `crate::`.
fn heads(token: Option<&TokenTree>) -> Vec<String> {
    match token {
        Some(TokenTree::Ident(ident)) => vec![ident.to_string()],
        Some(TokenTree::Group(group)) => {
            let mut names = Vec::new();
            let mut at_start = true;
            for token in group.stream() {
                match &token {
                    TokenTree::Ident(ident) if at_start => {
                        names.push(ident.to_string());
                        at_start = false;
                    }
                    TokenTree::Punct(p) if p.as_char() == ',' => at_start = true,
                    _ => at_start = false,
                }
            }
            names
        }
        _ => Vec::new(),
    }
}

/// Offences of a tree of sources: `file:line: what`.
fn offences(root: &Path) -> Vec<String> {
    let mut offences = Vec::new();
    for (file, path) in sources(root) {
        let Some(own) = path.first().cloned() else {
            continue;
        };
        let Some(own_rank) = rank(&own) else {
            offences.push(format!("{}: module `{own}` has no rank", file.display()));
            continue;
        };
        let source = std::fs::read_to_string(&file).unwrap();
        for (line, module) in uses(&source, &path) {
            if module == own {
                continue;
            }
            let stranger = STRANGERS.contains(&(own.as_str(), module.as_str()));
            let allowed = rank(&module).is_some_and(|r| r < own_rank) && !stranger;
            if !allowed {
                offences.push(format!(
                    "{}:{line}: `{own}` names `{module}`",
                    file.display()
                ));
            }
        }
    }
    offences
}

/// Files below `root` with their module paths; `lib.rs` and `main.rs` are the top and may name all.
fn sources(root: &Path) -> BTreeMap<PathBuf, Vec<String>> {
    let mut found = BTreeMap::new();
    let mut open = vec![root.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let file = entry.unwrap().path();
            if file.is_dir() {
                open.push(file);
                continue;
            }
            if file.extension().is_none_or(|e| e != "rs") {
                continue;
            }
            let relative = file.strip_prefix(root).unwrap().with_extension("");
            let mut path: Vec<String> = relative
                .iter()
                .map(|part| part.to_str().unwrap().to_owned())
                .collect();
            if path.last().is_some_and(|p| p == "mod") {
                path.pop();
            }
            if path != ["lib"] && path != ["main"] {
                found.insert(file, path);
            }
        }
    }
    found
}

#[test]
fn modules_name_lower_ranks_only() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    assert!(crate::sources(&sources).len() > 20);
    let offences = offences(&sources);
    assert!(offences.is_empty(), "\n{}", offences.join("\n"));
}

#[test]
fn a_broken_house_is_noticed() {
    let house = tempfile::tempdir().unwrap();
    let write = |file: &str, source: &str| {
        let path = house.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, source).unwrap();
    };
    write(
        "fourier/wave.rs",
        "use crate::error::Error;\nuse crate::robot::Robot;\n",
    );
    write(
        "fourier/mod.rs",
        "mod wave;\nfn f(_: super::collision::Pair) {}\n",
    );
    write("primitive/mod.rs", "use crate::{fourier::Wave, robot};\n");
    write(
        "collision/deep/mod.rs",
        "use super::super::cli::run;\nuse super::Pair;\n",
    );
    write(
        "robot.rs",
        "#[cfg(test)]\nmod tests { use crate::testing::waves; }\nfn g() { crate::error::f(crate::testing::waves) }\n",
    );
    write("lonely.rs", "");
    let found: Vec<String> = offences(house.path())
        .into_iter()
        .map(|o| o.replace(&format!("{}/", house.path().display()), ""))
        .collect();
    assert_eq!(
        found,
        [
            "collision/deep/mod.rs:1: `collision` names `cli`",
            "fourier/mod.rs:2: `fourier` names `collision`",
            "fourier/wave.rs:2: `fourier` names `robot`",
            "lonely.rs: module `lonely` has no rank",
            "primitive/mod.rs:1: `primitive` names `robot`",
            "robot.rs:3: `robot` names `testing`",
        ]
    );
}

/// The crates of a `cargo tree` that need more than a Rust compiler, each with the line that brought it.
fn foreign(tree: &str) -> Vec<String> {
    tree.lines()
        .filter(|line| {
            let name = line.split_whitespace().next().unwrap_or("");
            // linux-raw-sys is Rust: numbers of system calls, no library.
            NOT_RUST.contains(&name) || (name.ends_with("-sys") && name != "linux-raw-sys")
        })
        .map(str::to_owned)
        .collect()
}

#[test]
fn no_build_needs_a_c_compiler() {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let output = Command::new(cargo)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args([
            "tree",
            "--locked",
            "--all-features",
            "--edges",
            "all",
            "--prefix",
            "none",
        ])
        .args(["--target", "x86_64-unknown-linux-gnu"])
        .output()
        .unwrap();
    let tree = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(tree.lines().count() > 50, "{tree}");
    let offenders = foreign(&tree);
    assert!(
        offenders.is_empty(),
        "crates that build C: {offenders:?}; see `cargo tree -i NAME`"
    );
}

#[test]
fn a_crate_that_builds_c_is_named() {
    let tree =
        "undulate v0.1.0\nalloca v0.4.0\ncc v1.2.3\nlinux-raw-sys v0.12.1\nopenssl-sys v0.9.0\n";
    assert_eq!(foreign(tree), ["cc v1.2.3", "openssl-sys v0.9.0"]);
}

#[test]
fn the_readme_shows_the_test_that_a_user_runs() {
    let readme = include_str!("../README.md");
    let shown = format!(
        "```rust,ignore\n{}```",
        include_str!("user/tests/gesture.rs")
    );
    assert!(
        readme.contains(&shown),
        "tests/user/tests/gesture.rs is another"
    );
    let dependency = readme.lines().find(|line| line.contains("\"testing\"]"));
    let features = |line: &str| {
        line.split_once("default-features")
            .map(|(_, rest)| rest.to_owned())
    };
    let manifest = include_str!("user/Cargo.toml").lines();
    let own = manifest.filter(|line| line.starts_with("undulate"));
    let own: Vec<_> = own.map(features).collect();
    assert_eq!(own, [dependency.and_then(features)]);
}
