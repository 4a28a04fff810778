//! The meshes of `table_arm`: the generator that made the files in `robots/table_arm`, and proof that it did.
//!
//! `cargo test --test table_arm -- --ignored` writes the files anew after a change of [`parts::PARTS`].

mod loft;
mod parts;

use std::path::{Path, PathBuf};

use undulate::Mesh;

fn file(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/table_arm");
    folder.join(format!("{name}.obj"))
}

#[test]
fn the_committed_files_are_what_the_generator_makes() {
    let mut bytes = 0;
    for part in parts::PARTS {
        let committed = std::fs::read_to_string(file(part.name)).unwrap();
        assert!(committed == part.obj(), "{} differs", part.name);
        bytes += committed.len();
    }
    let files = std::fs::read_dir(file("x").parent().unwrap())
        .unwrap()
        .count();
    assert_eq!(files, parts::PARTS.len(), "a file that nobody made");
    assert!(bytes < 200_000, "{bytes} bytes ship with the crate");
}

#[test]
fn every_part_is_a_closed_convex_body_of_moderate_size() {
    for part in parts::PARTS {
        let mesh = Mesh::read("part.obj", part.obj().as_bytes()).unwrap();
        let count = mesh.vertices().len();
        assert!(
            (60..=220).contains(&count),
            "{}: {count} vertices",
            part.name
        );
        assert!(mesh.is_closed() && !mesh.is_inside_out(), "{}", part.name);
        let hull = mesh.hull().unwrap();
        // The hull has every vertex, and no more volume than rounding to 10 um leaves between flat and bent sides.
        assert_eq!(hull.vertices().len(), count, "{}", part.name);
        let gap = hull.volume() - mesh.signed_volume();
        assert!(
            gap >= 0.0 && gap < 2e-3 * hull.volume(),
            "{}: {gap:e} m^3",
            part.name
        );
    }
}

#[test]
#[ignore = "writes into the sources"]
fn write() {
    for part in parts::PARTS {
        std::fs::write(file(part.name), part.obj()).unwrap();
    }
}
