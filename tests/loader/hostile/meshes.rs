//! Meshes that are faulty, and names of meshes that lead out of the folders.

use std::path::Path;

use super::Must::{self, Load, Refuse, Unread};
use super::mesh;

fn triangle(corner: &str) -> String {
    format!(
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex {corner}\nendloop\nendfacet\n"
    )
}

/// Files of faulty meshes, and what must become of a robot that names each.
pub fn meshes(folder: &Path) -> Vec<(&'static str, Vec<u8>, Must)> {
    let mut all = Vec::new();
    let mut file = |name: &'static str, content: Vec<u8>, must: Must| {
        std::fs::write(folder.join(name), content).unwrap();
        all.push((name, mesh(name).into_bytes(), must));
    };
    let solid = |inside: &str| format!("solid s\n{inside}endsolid s\n").into_bytes();
    file("empty.stl", Vec::new(), Refuse("empty.stl"));
    file(
        "endless.stl",
        solid(&triangle("0 1 0").repeat(400_000)),
        Unread("larger than 16 MB"),
    );
    file(
        "cut.stl",
        b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0".to_vec(),
        Refuse("cut.stl"),
    );
    file("nan.stl", solid(&triangle("0 nan 0")), Refuse("nan.stl"));
    file("none.stl", solid(""), Refuse("none.stl"));
    file("far.stl", solid(&triangle("0 1e300 0")), Refuse("far.stl"));
    file("flat.stl", solid(&triangle("0 1 0")), Load(2));
    file("needle.stl", solid(&triangle("2 0 0")), Load(2));
    let mut lying = vec![0; 84];
    lying[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    lying.extend([0; 50]);
    file("lying.stl", lying, Refuse("triangles announced"));
    // The most that a file can hold: no two corners equal. On a sphere all are corners of the hull, on a cylinder few.
    let triangles = ((16 << 20) - 84) / 50;
    let full = |round: bool| {
        let mut full = vec![0; 80];
        full.extend((triangles as u32).to_le_bytes());
        for n in 0..3 * triangles {
            if n % 3 == 0 {
                full.extend([0; 12]);
            }
            let turn = n as f64;
            let height = 2.0 * (turn * 0.618_033_988_749_895).fract() - 1.0;
            let radius = if round {
                (1.0 - height * height).sqrt()
            } else {
                1.0
            };
            for number in [radius * turn.cos(), radius * turn.sin(), height] {
                full.extend((number as f32).to_le_bytes());
            }
            if n % 3 == 2 {
                full.extend([0; 2]);
            }
        }
        full
    };
    file(
        "sphere.stl",
        full(true),
        Unread("a hull of more than 200000 corners"),
    );
    file("full.stl", full(false), Load(2));
    file(
        "index.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4000000000\n".to_vec(),
        Refuse("index.obj"),
    );
    file(
        "beyond.obj",
        b"v 0 0 0\nf 1 99999999999999999999999 -7\n".to_vec(),
        Refuse("beyond.obj"),
    );
    file(
        "fan.obj",
        format!(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf {}\n",
            "1 2 3 ".repeat(300_000)
        )
        .into_bytes(),
        Load(2),
    );
    file(
        "scene.dae",
        b"<COLLADA/>".to_vec(),
        Unread("a mesh of format `dae`"),
    );
    all
}

/// Names of meshes that lead somewhere else.
pub fn ways_out(folder: &Path) -> Vec<(&'static str, Vec<u8>, Must)> {
    const OUT: Must = Unread("it leads out of the folders that may be read");
    let mut all = Vec::new();
    let mut name = |what: &'static str, name: &str, must: Must| {
        all.push((what, mesh(name).into_bytes(), must));
    };
    name("passwd", "file:///etc/passwd", OUT);
    name("absolute", "/etc/passwd", OUT);
    name("up", "../../../../../../../../etc/passwd", OUT);
    name(
        "package_up",
        "package://../../../../../../../../etc/passwd",
        OUT,
    );
    name(
        "package_in_up",
        "package://arm/../../../../../../../../etc/passwd",
        OUT,
    );
    name(
        "percent",
        "%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
        OUT,
    );
    name("sibling", "../secret.stl", OUT);
    name(
        "web",
        "https://example.org/a.stl",
        Unread("only package://"),
    );
    name("windows", r"C:\meshes\arm.stl", Unread("no such file"));
    name("backslash", r"..\..\etc\passwd", Unread("no such file"));
    name("folder", ".", Unread("no regular file"));
    name("nothing", "package://", Unread("no regular file"));
    let stretched = r#"full.stl" scale="-2 0.5 0.1"#;
    name("full_stretched", stretched, Load(2));
    name("xacro", "${dir}/a.stl", Refuse("unexpanded xacro"));
    name(
        "long_name",
        &"a/".repeat(3000),
        Refuse("filename of 6000 bytes"),
    );
    #[cfg(unix)]
    {
        let link =
            |to: &str, from: &str| std::os::unix::fs::symlink(to, folder.join(from)).unwrap();
        link("../secret.stl", "link.stl");
        link("..", "way");
        link("ring.stl", "ring.stl");
        link("/dev/zero", "zero.stl");
        name("link", "link.stl", OUT);
        name("way", "way/secret.stl", OUT);
        name("ring", "ring.stl", Unread("no such file"));
        name("device", "zero.stl", OUT);
        let made = std::process::Command::new("mkfifo")
            .arg(folder.join("pipe.stl"))
            .status();
        if made.is_ok_and(|status| status.success()) {
            name("pipe", "pipe.stl", Unread("no regular file"));
        }
    }
    all
}
