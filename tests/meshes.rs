//! Mesh files, sound, odd and hostile; what their hulls and decompositions hold.

mod common;

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use undulate::nalgebra::{Point3, Vector3};
use undulate::{Decomposition, ErrorKind, Hull, Mesh};

type Triangle = [[f32; 3]; 3];

/// Binary STL that says it has `count` triangles.
fn binary(triangles: &[Triangle], count: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn text(triangles: &[Triangle]) -> String {
    let mut text = "solid caf\u{e9}\n".to_owned();
    for triangle in triangles {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for [x, y, z] in triangle {
            text += &format!("      vertex {x:e} {y} {z}\r\n");
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid\n"
}

/// An L: the square of side 2 less the one beyond (1, 1), 1 high. Volume 3, its hull 3.5.
const L: [[f32; 2]; 6] = [
    [0.0, 0.0],
    [2.0, 0.0],
    [2.0, 1.0],
    [1.0, 1.0],
    [1.0, 2.0],
    [0.0, 2.0],
];

fn prism() -> Vec<Triangle> {
    let at = |i: usize, z: f32| [L[i % 6][0], L[i % 6][1], z];
    let mut triangles = Vec::new();
    for i in 0..6 {
        triangles.push([at(i, 0.0), at(i + 1, 0.0), at(i + 1, 1.0)]);
        triangles.push([at(i, 0.0), at(i + 1, 1.0), at(i, 1.0)]);
    }
    // Fans about the inner corner see the whole.
    for i in 4..8 {
        triangles.push([at(3, 1.0), at(i, 1.0), at(i + 1, 1.0)]);
        triangles.push([at(3, 0.0), at(i + 1, 0.0), at(i, 0.0)]);
    }
    triangles
}

fn l_shape() -> Mesh {
    let triangles = prism();
    Mesh::from_stl(&binary(&triangles, triangles.len() as u32)).unwrap()
}

#[test]
fn formats_agree() {
    let triangles = prism();
    let count = triangles.len() as u32;
    let mesh = l_shape();
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (12, 20));
    assert!(mesh.is_closed() && !mesh.is_inside_out());
    assert!((mesh.signed_volume() - 3.0).abs() < 1e-14);
    assert_eq!(Mesh::from_stl(text(&triangles).as_bytes()).unwrap(), mesh);
    // The name in another encoding than UTF-8.
    let latin: Vec<u8> = text(&triangles).chars().map(|c| c as u8).collect();
    assert_eq!(Mesh::from_stl(&latin).unwrap(), mesh);
    // A binary file may begin with the word, and end with padding.
    let mut solid = binary(&triangles, count);
    solid[..5].copy_from_slice(b"solid");
    assert_eq!(Mesh::from_stl(&solid).unwrap(), mesh);
    let mut padded = binary(&triangles, count);
    padded.extend([0; 49]);
    assert_eq!(Mesh::from_stl(&padded).unwrap(), mesh);

    let mut obj = "# an L\nmtllib x.mtl\no L\n".to_owned();
    for [x, y, z] in triangles.iter().flatten() {
        obj += &format!("v {x} {y} {z} 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\n");
    }
    for i in 0..triangles.len() {
        let [a, b, c] = [3 * i + 1, 3 * i + 2, 3 * i + 3];
        let back = 3 * triangles.len() + 1;
        obj += &match i % 4 {
            0 => format!("f {a} {b} {c}\n"),
            1 => format!("f {a}/1 \\\n {b}/2 {c}/3\n"),
            2 => format!("f {a}//1 {b}//1 {c}//1\r\n"),
            _ => format!("f -{}/1/1 -{}/1/1 -{}/1/1\n", back - a, back - b, back - c),
        };
    }
    assert_eq!(Mesh::read("a/b.c/L.OBJ", obj.as_bytes()).unwrap(), mesh);
    assert_eq!(Mesh::read("L.Stl", &solid).unwrap(), mesh);
    let polygon =
        Mesh::from_obj(b"v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 9 9 9\nf 1 2 3 4\n").unwrap();
    assert_eq!(polygon.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(polygon.vertices().len(), 4, "the fifth belongs to no face");
}

fn refused(bytes: &[u8], obj: bool) -> String {
    let read = if obj {
        Mesh::from_obj(bytes)
    } else {
        Mesh::from_stl(bytes)
    };
    read.err().unwrap().to_string()
}

#[test]
fn damaged_files_say_where() {
    let [first, ..] = prism()[..] else {
        unreachable!()
    };
    let bad = |x: f32| binary(&[first, [first[0], first[1], [0.0, x, 0.0]]], 2);
    for (bytes, message) in [
        (Vec::new(), "0 bytes, expected a file of STL"),
        (vec![0; 83], "83 bytes"),
        (binary(&[], 0), "no triangles"),
        (
            binary(&[first], u32::MAX),
            "4294967295 triangles announced, but there are 1",
        ),
        (
            binary(&[first], 2),
            "2 triangles announced, but there are 1",
        ),
        (
            binary(&[first, first], 1),
            "1 triangles announced, but there are 2",
        ),
        (
            binary(&[first], 1)[..130].to_vec(),
            "1 triangles announced, but there are 0",
        ),
        (bad(f32::NAN), "triangle 2: a point at 0, NaN, 0 m"),
        (bad(f32::INFINITY), "triangle 2: "),
        (bad(2e6), "triangle 2: "),
        (b"solid x\nendsolid x\n".to_vec(), "no triangles"),
        (
            b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n".to_vec(),
            "line 4: a point at 0, 0, NaN m",
        ),
        (
            b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n".to_vec(),
            "line 4: `vertex 0 0`",
        ),
        (
            b"solid x\nouter loop\nvertex 0 0 1\nendloop\n".to_vec(),
            "line 4: `endloop`, expected three vertices",
        ),
        (
            b"solid x\nouter loop\nvertex 0 0 1\nfacet\n".to_vec(),
            "line 4: ",
        ),
        (
            b"solid x\nouter loop\nvertex 0 0 1\n".to_vec(),
            "the file ends within a triangle",
        ),
        (b"solid x\nwhat\n".to_vec(), "line 2: `what`"),
    ] {
        let found = refused(&bytes, false);
        assert!(found.starts_with(message), "{found}\nnot {message}");
    }
    for (text, message) in [
        ("", "no triangles"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no triangles"),
        ("v 0 0\n", "line 1: `v 0 0`"),
        ("v 0 0 x\n", "line 1: `v 0 0 x`"),
        ("v 0 0 -inf\n", "line 1: a point"),
        ("v 0 0 1\nf 1 1\n", "line 2: a face of 2 corners"),
        (
            "v 0 0 1\nf 1 1 2\n",
            "line 2: a corner `2`, expected one of the 1 vertices so far",
        ),
        ("v 0 0 1\nf 0 1 1\n", "line 2: a corner `0`"),
        ("v 0 0 1\nf -2 1 1\n", "line 2: a corner `-2`"),
        ("v 0 0 1\nf 99999999999999999999 1 1\n", "line 2: a corner"),
        ("v 0 0 1\nf -9223372036854775808 1 1\n", "line 2: a corner"),
        ("v 0 0 1\nf 1 1 \\", "the file ends within a line"),
    ] {
        let found = refused(text.as_bytes(), true);
        assert!(found.starts_with(message), "{found}\nnot {message}");
    }
    let error = Mesh::read("arm/forearm.dae", b"<COLLADA/>").err().unwrap();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    assert!(
        error.to_string().contains("export it as STL or OBJ"),
        "{error}"
    );
}

/// Every cut and every flipped byte of a file is a mesh or an error.
#[test]
fn no_damage_panics() {
    let triangles = prism();
    let files = [binary(&triangles, 20), text(&triangles[..2]).into_bytes()];
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 -2e3\nf 1/1 -2//3 3/3/3 \\\n 1\n".to_vec();
    let mut read = 0;
    for file in files.into_iter().chain([obj]) {
        for at in 0..file.len() {
            let mut flipped = file.clone();
            flipped[at] ^= 1 << (at % 8);
            for bytes in [&file[..at], &flipped] {
                for mesh in [Mesh::from_stl(bytes), Mesh::from_obj(bytes)]
                    .into_iter()
                    .flatten()
                {
                    assert!(!mesh.hull().unwrap().vertices().is_empty());
                    read += 1;
                }
            }
        }
    }
    assert!(read > 500, "{read}");
}

#[test]
fn odd_meshes_have_hulls() {
    let one = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]];
    let hull = Mesh::from_stl(&binary(&[one], 1)).unwrap().hull().unwrap();
    assert!(hull.is_flat() && hull.vertices().len() == 3 && hull.faces().len() == 2);
    let point = Mesh::from_stl(&binary(&[[[1.0; 3]; 3]; 4], 4)).unwrap();
    assert!(!point.is_closed());
    assert_eq!(
        point.hull().unwrap().vertices(),
        [Point3::new(1.0, 1.0, 1.0)]
    );
    assert_eq!(
        point.decomposed(&Decomposition::default()).unwrap().len(),
        1
    );
    assert_eq!(
        point.enclosure(&[point.hull().unwrap()]).largest_gap,
        (0.0, 0.0)
    );
    // 100 000 triangles without area, on one line.
    let line: Vec<Triangle> = (0..100_000)
        .map(|i| {
            [
                [i as f32, 0.0, 0.0],
                [0.0; 3],
                [1.0; 3].map(|x: f32| x * i as f32 * 0.0),
            ]
        })
        .collect();
    let mesh = Mesh::from_stl(&binary(&line, 100_000)).unwrap();
    assert_eq!(mesh.hull().unwrap().vertices().len(), 2);
    assert_eq!(mesh.decomposed(&Decomposition::default()).unwrap().len(), 1);
    // Inside out: the hull does not care, the mesh knows.
    let mirrored: Vec<Triangle> = prism().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let mirrored = Mesh::from_stl(&binary(&mirrored, 20)).unwrap();
    assert!(mirrored.is_inside_out());
    assert_eq!(mirrored.hull().unwrap(), l_shape().hull().unwrap());
    assert_eq!(mirrored.enclosure(&[]).volume_ratio, None);
}

#[test]
fn scales_keep_outside_outside() {
    let mesh = l_shape();
    let scaled = mesh.scaled(&Vector3::new(1e-3, -2e-3, 1e-3)).unwrap();
    assert!((scaled.signed_volume() / 6e-9 - 1.0).abs() < 1e-12);
    assert!(!scaled.is_inside_out());
    for scale in [[0.0, 1.0, 1.0], [f64::NAN, 1.0, 1.0], [1e9, 1.0, 1.0]] {
        assert!(mesh.scaled(&Vector3::from(scale)).is_err());
    }
    assert!(Mesh::new(mesh.vertices(), &[[0, 1, 12]]).is_err());
    assert!(Mesh::new(mesh.vertices(), &[]).is_err());
}

/// How far p is out of the nearest hull, by the faces alone \[m\]; slivers have no say.
fn out(hulls: &[Hull], p: &Point3<f64>) -> f64 {
    let over = |hull: &Hull| {
        let corner = |i: u32| hull.vertices()[i as usize];
        let faces = hull.faces().iter().filter_map(|&[a, b, c]| {
            let (a, b, c) = (corner(a), corner(b), corner(c));
            let normal = (b - a).cross(&(c - a));
            let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
            (normal.norm() > 1e-6 * longest * longest).then(|| normal.normalize().dot(&(p - a)))
        });
        faces.fold(f64::NEG_INFINITY, f64::max)
    };
    hulls.iter().map(over).fold(f64::INFINITY, f64::min)
}

/// Points spread over each triangle.
fn spread(mesh: &Mesh, steps: u32) -> impl Iterator<Item = Point3<f64>> {
    mesh.triangles().iter().flat_map(move |t| {
        let [a, b, c] = t.map(|i| mesh.vertices()[i as usize]);
        (0..=steps).flat_map(move |i| {
            (0..=steps - i).map(move |j| {
                let (s, t) = (
                    f64::from(i) / f64::from(steps),
                    f64::from(j) / f64::from(steps),
                );
                a + s * (b - a) + t * (c - a)
            })
        })
    })
}

#[test]
fn an_l_is_two_boxes() {
    let mesh = l_shape();
    let one = mesh.hull().unwrap();
    assert!((one.volume() - 3.5).abs() < 1e-14);
    let whole = mesh.enclosure(std::slice::from_ref(&one));
    assert!((whole.volume_ratio.unwrap() - 3.5 / 3.0).abs() < 1e-12);
    // From the middle of the face that closes the notch.
    let (low, high) = whole.largest_gap;
    assert!(
        (0.47..=0.5).contains(&low) && (0.5..=0.526).contains(&high),
        "{low} {high}"
    );

    let parts = mesh.decomposed(&Decomposition::default()).unwrap();
    assert_eq!(parts.len(), 2);
    // Turned by half a turn, what was above the cut is below it.
    let turned = mesh.scaled(&Vector3::new(-1.0, -1.0, 1.0)).unwrap();
    let others = turned.decomposed(&Decomposition::default()).unwrap();
    let volume = |hulls: &[Hull]| hulls.iter().map(Hull::volume).sum::<f64>();
    assert_eq!(others.len(), 2);
    assert!((volume(&others) - volume(&parts)).abs() < 1e-12);
    let close = mesh.enclosure(&parts);
    assert!((close.volume_ratio.unwrap() - 1.0).abs() < 1e-12);
    assert!(close.largest_gap.1 < 1e-2, "{close:?}");
    assert!(
        parts
            .iter()
            .all(|h| h.tolerance() > 0.0 && h.tolerance() < 1e-14)
    );
    assert!(spread(&mesh, 20).all(|p| out(&parts, &p) < 1e-14));
    // One part may not be enough, and the sampling must notice.
    assert!(spread(&mesh, 20).any(|p| out(&parts[..1], &p) > 0.5));

    let same = mesh
        .decomposed(&Decomposition {
            parts: 1,
            ..Default::default()
        })
        .unwrap();
    assert_eq!(same[0].vertices(), one.vertices());
    for bad in [
        Decomposition {
            parts: 0,
            ..Default::default()
        },
        Decomposition {
            parts: 1000,
            ..Default::default()
        },
        Decomposition {
            concavity: f64::NAN,
            ..Default::default()
        },
        Decomposition {
            resolution: 0,
            ..Default::default()
        },
        Decomposition {
            resolution: usize::MAX,
            ..Default::default()
        },
    ] {
        assert_eq!(
            mesh.decomposed(&bad).err().unwrap().kind(),
            ErrorKind::Setting
        );
    }
}

/// A torus: nothing of it is in a plane, and its hull fills the hole.
#[test]
fn rings_are_taken_apart() {
    let (around, across) = (48_u32, 16_u32);
    let point = |i: u32, j: u32| {
        let (a, b) = (
            f64::from(i % around) / f64::from(around) * 2.0 * PI,
            f64::from(j % across) / f64::from(across) * 2.0 * PI,
        );
        let r = 1.0 + 0.25 * b.cos();
        Point3::new(r * a.cos(), r * a.sin(), 0.25 * b.sin())
    };
    let vertices: Vec<_> = (0..around)
        .flat_map(|i| (0..across).map(move |j| point(i, j)))
        .collect();
    let at = |i: u32, j: u32| i % around * across + j % across;
    let triangles: Vec<_> = (0..around)
        .flat_map(|i| {
            (0..across).flat_map(move |j| {
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            })
        })
        .collect();
    let mesh = Mesh::new(&vertices, &triangles).unwrap();
    assert!(mesh.is_closed() && !mesh.is_inside_out());
    let ratio = |parts| {
        let options = Decomposition {
            parts,
            concavity: 0.0,
            ..Default::default()
        };
        let hulls = mesh.decomposed(&options).unwrap();
        assert_eq!(hulls.len(), parts);
        assert!(spread(&mesh, 6).all(|p| out(&hulls, &p) < 1e-12));
        assert_eq!(hulls, mesh.decomposed(&options).unwrap());
        mesh.enclosure(&hulls).volume_ratio.unwrap()
    };
    let (one, eight) = (ratio(1), ratio(8));
    assert!(one > 1.8 && (1.0..1.35).contains(&eight), "{one} {eight}");
}

/// The surface of unit cubes at whole places, each face of two cubes left out.
fn blocks(cubes: &[[i32; 3]]) -> Mesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for cube in cubes {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beyond = *cube;
                beyond[axis] += 2 * side - 1;
                if cubes.contains(&beyond) {
                    continue;
                }
                let corner = |u: i32, v: i32| {
                    let mut p = *cube;
                    p[axis] += side;
                    p[(axis + 1) % 3] += u;
                    p[(axis + 2) % 3] += v;
                    Point3::from(p.map(f64::from))
                };
                let first = vertices.len() as u32;
                vertices.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
                for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                    let [b, c] = if side == 1 { [b, c] } else { [c, b] };
                    triangles.push([first + a, first + b, first + c]);
                }
            }
        }
    }
    Mesh::new(&vertices, &triangles).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(40) })]

    /// Solid in the middle, ragged outside: a cut within a cut must not leave a hollow.
    #[test]
    fn what_a_mesh_encloses_is_enclosed(
        gone in prop::collection::hash_set(prop::array::uniform3(0..5_i32), 5..60),
        parts in 2..17_usize,
        inner in prop::array::uniform3(0.01..0.99),
    ) {
        let all = (0..125).map(|i| [i % 5, i / 5 % 5, i / 25]);
        let middle = |c: &[i32; 3]| c.iter().all(|x| (1..4).contains(x));
        let cubes: Vec<[i32; 3]> = all.filter(|c| middle(c) || !gone.contains(c)).collect();
        let mesh = blocks(&cubes);
        prop_assert!((mesh.signed_volume() - cubes.len() as f64).abs() < 1e-9);
        let options = Decomposition { parts, concavity: 0.0, resolution: 4 };
        let hulls = mesh.decomposed(&options).unwrap();
        prop_assert!(spread(&mesh, 3).all(|p| out(&hulls, &p) < 1e-12));
        for cube in &cubes {
            let p = Point3::from(cube.map(f64::from)) + Vector3::from(inner);
            prop_assert!(out(&hulls, &p) < 1e-12, "{p} of {cube:?}");
        }
    }
}

fn stl_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            stl_below(&path, found);
        } else if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("stl"))
        {
            found.push(path);
        }
    }
    found.sort();
}

#[test]
fn meshes_of_real_robots_are_enclosed() {
    let Some(shared) = common::shared("meshes of real robots") else {
        return;
    };
    let mut paths = Vec::new();
    stl_below(&shared.join("robots"), &mut paths);
    assert!(paths.len() >= 40, "{}", paths.len());
    for path in &paths {
        let name = path.display().to_string();
        let mesh = Mesh::read(&name, &std::fs::read(path).unwrap()).unwrap();
        let hull = mesh.hull().unwrap();
        // Some files have numbers of 1e-36.
        assert!(!hull.is_flat() && hull.tolerance() < 1e-29, "{name}");
        let (centre, radius) = hull.bounding_sphere();
        let size = radius + centre.coords.norm();
        assert!(
            mesh.vertices()
                .iter()
                .all(|p| out(std::slice::from_ref(&hull), p) <= 1e-12 * size),
            "{name}"
        );
        assert!(
            mesh.vertices()
                .iter()
                .all(|p| (p - centre).norm() <= radius),
            "{name}"
        );
        if mesh.is_closed() {
            let ratio = hull.volume() / mesh.signed_volume().abs();
            assert!(ratio >= 1.0 - 1e-12, "{name}: {ratio}");
        }
    }
}

#[test]
fn a_count_that_lies_is_found_before_it_is_believed() {
    let Some(shared) = common::shared("the hostile STL") else {
        return;
    };
    let bytes = std::fs::read(shared.join("hostile/lying.stl")).unwrap();
    let error = Mesh::read("lying.stl", &bytes).err().unwrap();
    assert!(
        error
            .to_string()
            .starts_with("lying.stl: 4294967295 triangles announced, but there are 1"),
        "{error}"
    );
}
