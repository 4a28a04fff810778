//! Files that are wrong in every way that was thought of. None panics, hangs, reads outside its folder or takes more
//! memory than a robot needs.

use std::path::Path;

use super::bounded::{MOST_MEMORY, load};
use super::common::shared;
use undulate::{Inconsistent, LoadOptions, Robot};

/// What must become of a file.
enum Must {
    /// Refused, and the message says this.
    Refuse(&'static str),
    /// Loaded, with so many links.
    Load(usize),
    /// Loaded, and the collision geometry is refused with these words.
    Unread(&'static str),
    /// Loaded, and dynamics are refused with these words.
    Still(&'static str),
}
use Must::{Load, Refuse, Still, Unread};

const LIMIT: &str = r#"<limit lower="-1" upper="1" velocity="2" effort="5"/>"#;

/// An arm of one joint with something put into each place.
fn arm(link: &str, joint: &str, rest: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">{link}</link>\n\
        <joint name=\"shoulder\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/>{joint}</joint>\n{rest}</robot>\n"
    )
}

fn limits(limit: &str) -> String {
    arm("", &format!("<limit {limit}/>"), "")
}

fn more(rest: &str) -> String {
    arm("", LIMIT, rest)
}

fn collision(geometry: &str) -> String {
    arm(
        &format!("<collision><geometry>{geometry}</geometry></collision>"),
        LIMIT,
        "",
    )
}

fn mesh(name: &str) -> String {
    collision(&format!("<mesh filename=\"{name}\"/>"))
}

fn inertial(mass: &str, diagonal: [&str; 3]) -> String {
    let [x, y, z] = diagonal;
    let text = format!(
        r#"<inertial><mass value="{mass}"/><inertia ixx="{x}" ixy="0" ixz="0" iyy="{y}" iyz="0" izz="{z}"/></inertial>"#
    );
    arm(&text, LIMIT, "")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}</joint>"
    )
}

/// `links` links in a row; what `inside` says of each joint.
fn chain(links: usize, link: &str, inside: impl Fn(usize) -> String) -> String {
    let mut text = "<robot name=\"r\">".to_owned();
    for i in 0..links {
        text.push_str(&format!("<link name=\"l{i}\">{link}</link>"));
        if i > 0 {
            let (parent, child) = (format!("l{}", i - 1), format!("l{i}"));
            text.push_str(&joint(
                &format!("j{i}"),
                "continuous",
                &parent,
                &child,
                &inside(i),
            ));
        }
    }
    text + "</robot>"
}

fn triangle(corner: &str) -> String {
    format!(
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex {corner}\nendloop\nendfacet\n"
    )
}

/// Files of faulty meshes, and what must become of a robot that names each.
fn meshes(folder: &Path) -> Vec<(&'static str, Vec<u8>, Must)> {
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
fn ways_out(folder: &Path) -> Vec<(&'static str, Vec<u8>, Must)> {
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

/// Texts that are no XML of a robot, or too much of it.
fn texts() -> Vec<(&'static str, Vec<u8>, Must)> {
    let utf16 = |text: &str| {
        text.encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect::<Vec<u8>>()
    };
    let bytes = |text: String| text.into_bytes();
    let robot = |inside: String| format!("<robot name=\"r\">{inside}</robot>").into_bytes();
    let million = |piece: &str| robot(piece.repeat(1_000_000));
    vec![
        ("mark", bytes(format!("\u{feff}{}", more(""))), Load(2)),
        (
            "utf16",
            [&[0xff, 0xfe][..], &utf16(&more(""))].concat(),
            Refuse("save it as UTF-8"),
        ),
        ("utf16_bare", utf16(&more("")), Refuse("line 1")),
        ("nul", bytes(more("\0")), Refuse("line")),
        (
            "latin",
            [more("").as_bytes(), &[0xe9]].concat(),
            Refuse("not UTF-8"),
        ),
        ("blank", b" \n\t ".to_vec(), Refuse("the file is empty")),
        ("two_roots", bytes(more("") + "<robot/>"), Refuse("line")),
        ("unclosed", bytes(more("<a>")), Refuse("line")),
        ("crossed", bytes(more("<a><b></a></b>")), Refuse("line")),
        ("bare_less", bytes(more("<a b='<'/>")), Refuse("line")),
        ("twice", bytes(more("<a b='1' b='2'/>")), Refuse("line")),
        ("large", vec![b' '; 17 << 20], Refuse("at most 16 MB")),
        (
            "comment",
            bytes(more(&format!("<!--{}-->", "<a b='c'>".repeat(1_100_000)))),
            Load(2),
        ),
        (
            "cdata",
            bytes(more(&format!("<![CDATA[{}]]>", "<a>".repeat(3_000_000)))),
            Load(2),
        ),
        (
            "characters",
            bytes(more(&"&#65;&amp;".repeat(1_000_000))),
            Load(2),
        ),
        (
            "unclosed_comments",
            robot("<!--".repeat(1_000_000)),
            Refuse("line"),
        ),
        (
            "nested",
            robot("<a>".repeat(1_000_000) + &"</a>".repeat(1_000_000)),
            Refuse("nest deeper"),
        ),
        (
            "nested_links",
            robot("<link name='a'>".repeat(500_000)),
            Refuse("nest deeper"),
        ),
        ("flat", million("<a/>"), Refuse("more than 300000 elements")),
        (
            "comments",
            million("<!---->"),
            Refuse("more than 300000 elements"),
        ),
        (
            "instructions",
            million("<?a?>"),
            Refuse("more than 300000 elements"),
        ),
        (
            "sections",
            million("<![CDATA[]]>"),
            Refuse("more than 300000 elements"),
        ),
        (
            "attributes",
            bytes(more(&format!(
                "<a {}/>",
                (0..100_000)
                    .map(|i| format!("b{i}='' "))
                    .collect::<String>()
            ))),
            Refuse("more than 64 attributes"),
        ),
        (
            "namespaces",
            bytes(more(
                &(0..1000)
                    .map(|i| format!("<a xmlns:n{i}='u{i}'/>"))
                    .collect::<String>(),
            )),
            Refuse("more than 256 namespaces"),
        ),
        (
            "namespaced",
            bytes(more("<x:a xmlns:x='u'/>").replace("<robot", "<robot xmlns='http://ros.org'")),
            Load(2),
        ),
        (
            "just_within",
            robot("<a b='' c=''/>".repeat(299_000)),
            Refuse("no links"),
        ),
        (
            "bomb",
            bytes(format!(
                "<!DOCTYPE r [<!ENTITY a 'aaaaaaaa'>{}]>{}",
                (1..12)
                    .map(|i| format!("<!ENTITY a{i} '&a{0};&a{0};&a{0};&a{0};'>", i - 1))
                    .collect::<String>(),
                more("&a11;")
            )),
            Refuse("document type"),
        ),
        (
            "outside_entity",
            bytes(format!(
                "<!DOCTYPE r [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>{}",
                more("&a;")
            )),
            Refuse("document type"),
        ),
        (
            "declaration",
            bytes(more(&format!("<!ELEMENT a>{}", "<a>".repeat(1_000_000)))),
            Refuse("line"),
        ),
        (
            "late_doctype",
            bytes(more("<!DOCTYPE r>")),
            Refuse("document type"),
        ),
        (
            "unknown",
            bytes(more(&format!(
                "<gazebo>{}{}</gazebo>",
                "<p>".repeat(50),
                "</p>".repeat(50)
            ))),
            Load(2),
        ),
    ]
}

/// Robots that contradict themselves, and some that only look so.
fn robots() -> Vec<(&'static str, Vec<u8>, Must)> {
    let mimic = |leader: &str| format!("<mimic joint=\"{leader}\"/>");
    let follow = |gain: &str| {
        let gain = gain.to_owned();
        chain(20_000, "", move |i| match i {
            1 => String::new(),
            _ => format!(
                "<mimic joint=\"j{}\" multiplier=\"{gain}\" offset=\"0\"/>",
                i - 1
            ),
        })
    };
    let shape = r#"<collision><geometry><sphere radius="1"/></geometry></collision>"#;
    let all: Vec<(&'static str, String, Must)> = vec![
        (
            "mimic_ring",
            more(&format!(
                "<link name=\"b\"/><link name=\"c\"/><link name=\"d\"/>{}{}{}",
                joint("x", "continuous", "arm", "b", &mimic("y")),
                joint("y", "continuous", "b", "c", &mimic("z")),
                joint("z", "continuous", "c", "d", &mimic("x"))
            )),
            Refuse("comes back to itself"),
        ),
        (
            "own_parent",
            more(&format!(
                "<link name=\"b\"/>{}",
                joint("x", "fixed", "b", "b", "")
            )),
            Refuse("cycle"),
        ),
        (
            "child_twice",
            more(&joint("x", "fixed", "base", "arm", "")),
            Refuse("two parents"),
        ),
        (
            "joint_as_link",
            more("").replace("shoulder", "arm"),
            Load(2),
        ),
        ("no_name", more("<link name=\"\"/>"), Refuse("empty `name`")),
        (
            "only_fixed",
            more("").replace("revolute", "fixed"),
            Refuse("no joint that moves"),
        ),
        (
            "slashes",
            more("").replace("\"arm\"", "\"a/b \u{e9} \u{1f916}\""),
            Load(2),
        ),
        (
            "quotes",
            more("").replace("\"arm\"", "\"&quot;/>&lt;link name='evil'/&gt;&amp;\""),
            Load(2),
        ),
        (
            "newline",
            more("").replace("\"arm\"", "\"a&#10;b\""),
            Refuse("control character"),
        ),
        (
            "escape",
            more("").replace("\"arm\"", "\"a&#27;[2Jb\""),
            Refuse("line"),
        ),
        (
            "long_link",
            more("").replace("\"arm\"", &format!("\"{}\"", "a".repeat(1 << 20))),
            Refuse("bytes"),
        ),
        (
            "long_robot",
            more("").replace("\"r\"", &format!("\"{}\"", "a".repeat(1 << 20))),
            Refuse("bytes"),
        ),
        (
            "huge",
            limits(r#"lower="-1" upper="1e400" velocity="1""#),
            Refuse("1e400"),
        ),
        (
            "hex",
            limits(r#"lower="-1" upper="0x1p3" velocity="1""#),
            Refuse("0x1p3"),
        ),
        (
            "comma",
            limits(r#"lower="-1" upper="1,5" velocity="1""#),
            Refuse("1,5"),
        ),
        (
            "infinite",
            limits(r#"lower="-inf" upper="inf" velocity="1""#),
            Refuse("inf"),
        ),
        (
            "minus_zero",
            limits(r#"lower="-0" upper="0" velocity="1""#),
            Load(2),
        ),
        (
            "largest",
            limits(r#"lower="-1.7e308" upper="1.7e308" velocity="1e308" effort="1e308""#),
            Load(2),
        ),
        (
            "words",
            limits(r#"lower="-1" upper="one" velocity="1""#),
            Refuse("one"),
        ),
        (
            "soft",
            arm(
                "",
                &format!("{LIMIT}<safety_controller soft_lower_limit=\"nan\" k_velocity=\"1\"/>"),
                "",
            ),
            Refuse("nan"),
        ),
        (
            "versioned",
            limits(r#"velocity="1""#).replace("name=\"r\"", "name=\"r\" version=\"1.2\""),
            Refuse("<limit> without `lower`"),
        ),
        (
            "quaternion",
            arm(
                "",
                &format!("<origin quat_xyzw=\"nan nan nan nan\"/>{LIMIT}"),
                "",
            )
            .replace("name=\"r\"", "name=\"r\" version=\"1.1\""),
            Refuse("quat_xyzw"),
        ),
        ("foreign", arm("<sensor/>", LIMIT, ""), Load(2)),
        (
            "turned",
            arm("", &format!("<origin rpy=\"0 0 1\"/>{LIMIT}"), "")
                .replace("name=\"r\"", "name=\"r\" version=\"1.1\""),
            Load(2),
        ),
        (
            "far",
            arm("", &format!("<origin xyz=\"1e308 0 0\"/>{LIMIT}"), ""),
            Refuse("numbers within"),
        ),
        (
            "long_axis",
            arm("", &format!("<axis xyz=\"0 0 1e-300\"/>{LIMIT}"), ""),
            Refuse("length zero"),
        ),
        (
            "heavy",
            inertial("1e30", ["1", "1", "1"]),
            Refuse("numbers within"),
        ),
        (
            "negative",
            inertial("-1", ["1", "1", "1"]),
            Still("has no mass"),
        ),
        (
            "denormal",
            inertial("5e-324", ["1e-320", "1e-320", "1e-320"]),
            Still("moves an inertia"),
        ),
        (
            "point",
            inertial("1", ["0", "0", "0"]),
            Still("moves an inertia"),
        ),
        (
            "indefinite",
            inertial("1", ["1", "-1", "1"]),
            Refuse("line 4: inertia is not positive semidefinite"),
        ),
        (
            "thin",
            inertial("1", ["1", "1", "5"]),
            Still("link `arm`, line 4: principal moments"),
        ),
        (
            "two_shapes",
            collision(r#"<box size="1 1 1"/><sphere radius="nan"/>"#),
            Load(2),
        ),
        (
            "scaled_away",
            collision(r#"<mesh filename="a.stl" scale="1 0 1"/>"#),
            Refuse("scaled by 0"),
        ),
        (
            "many_shapes",
            arm(&shape.repeat(2000), LIMIT, ""),
            Refuse("2000 shapes"),
        ),
        (
            "many_meshes",
            chain(5000, "", |_| String::new()).replace(
                "\"></link>",
                "\"><collision><geometry><mesh filename=\"FILE\"/></geometry></collision></link>",
            ),
            Refuse("more than 4096 meshes"),
        ),
        (
            "snake",
            chain(
                20_000,
                r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#,
                |_| "<origin xyz=\"0 0 0.1\"/>".into(),
            ),
            Load(20_000),
        ),
        (
            "too_long_a_snake",
            chain(30_001, "", |_| String::new()),
            Refuse("30001 links"),
        ),
        (
            "longest_snake",
            chain(30_000, "", |_| String::new()),
            Load(30_000),
        ),
        (
            "fixed_snake",
            chain(20_000, shape, |_| {
                "<origin xyz=\"0 0 0.1\" rpy=\"1 2 3\"/>".into()
            })
            .replacen("continuous", "revolute", 1)
            .replace("continuous", "fixed")
            .replacen("revolute", "continuous", 1),
            Load(20_000),
        ),
        (
            "misspelt",
            chain(2, &shape.replace("collision", "colision"), |_| {
                String::new()
            }),
            Refuse("<colision>, expected <collision>"),
        ),
        (
            "misspelt_axis",
            chain(2, shape, |_| "<axes xyz=\"0 1 0\"/>".into()),
            Refuse("<axes>, expected <axis>"),
        ),
        // A thousand shapes on each of six links: fifteen million pairs of them.
        (
            "shapes_by_shapes",
            chain(6, &shape.repeat(1000), |_| String::new()),
            Load(6),
        ),
        // The longest that can be checked against itself, and one that cannot: 300 links have 4.5 million joints between all pairs.
        (
            "shaped_snake",
            chain(288, shape, |_| String::new()),
            Load(288),
        ),
        (
            "long_shaped_snake",
            chain(300, shape, |_| String::new()),
            Load(300),
        ),
        (
            "star",
            more(
                &(0..20_000)
                    .map(|i| {
                        format!(
                            "<link name=\"s{i}\"/>{}",
                            joint(&format!("k{i}"), "continuous", "base", &format!("s{i}"), "")
                        )
                    })
                    .collect::<String>(),
            ),
            Load(20_002),
        ),
        ("followers", follow("1"), Load(20_000)),
        ("growing", follow("10"), Refuse("chain of mimics")),
    ];
    all.into_iter()
        .map(|(name, text, must)| {
            let mut text = text;
            // Every mesh another.
            let mut n = 0;
            while name == "many_meshes" && text.contains("FILE") && n == 0 {
                let parts: Vec<&str> = text.split("FILE").collect();
                text = parts
                    .iter()
                    .enumerate()
                    .map(|(i, p)| {
                        format!(
                            "{}{p}",
                            if i > 0 {
                                format!("m{i}.stl")
                            } else {
                                String::new()
                            }
                        )
                    })
                    .collect();
                n += 1;
            }
            (name, text.into_bytes(), must)
        })
        .collect()
}

#[test]
fn whatever_is_wrong_is_told_within_bounds_of_memory() {
    let base = tempfile::tempdir().unwrap();
    std::fs::write(base.path().join("secret.stl"), "solid secret").unwrap();
    let folder = base.path().join("robot");
    std::fs::create_dir(&folder).unwrap();
    let cases: Vec<_> = [meshes(&folder), ways_out(&folder), texts(), robots()]
        .into_iter()
        .flatten()
        .collect();
    assert!(cases.len() >= 39, "{}", cases.len());
    let mut most = 0;
    for (name, content, must) in cases {
        let file = folder.join(format!("{name}.urdf"));
        std::fs::write(&file, content).unwrap();
        let told = load(&file);
        println!("{name}: {} MB, {:.1?}", told.memory / 1000, told.time);
        most = most.max(told.memory);
        let refused = told.refused.clone().unwrap_or_default();
        assert!(
            refused.len() < 2000,
            "{name}: {} bytes of error",
            refused.len()
        );
        let fits = match must {
            Refuse(why) => refused.contains(why),
            Load(links) => told.refused.is_none() && told.links == links,
            Unread(why) => told.refused.is_none() && told.missing[0].contains(why),
            Still(why) => told.refused.is_none() && told.missing[1].contains(why),
        };
        assert!(fits, "{name}: {told:?}");
        assert!(
            name != "shaped_snake" || told.uncheckable.is_empty(),
            "{told:?}"
        );
        assert!(
            name != "long_shaped_snake" || told.uncheckable.contains("at most 4000000"),
            "{told:?}"
        );
        assert!(
            name != "shapes_by_shapes" || told.uncheckable.contains("pairs of shapes"),
            "{told:?}"
        );
        // The second shape of a geometry is not read, for it was not looked at.
        assert!(name != "two_shapes" || told.shapes == 1, "{told:?}");
        // Told as the file's, wherever in it the fault is.
        assert!(
            refused.is_empty() || refused.contains(&format!("{name}.urdf")),
            "{refused}"
        );
        std::fs::remove_file(&file).unwrap();
    }
    println!("at most {} MB", most / 1000);
    assert!(most < MOST_MEMORY);
}

#[test]
fn hostile_files_get_what_their_manifest_says() {
    let Some(folder) = shared("hostile URDFs") else {
        return;
    };
    let folder = folder.join("hostile");
    let manifest = std::fs::read_to_string(folder.join("manifest.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(manifest.as_bytes());
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 24);
    for row in &rows {
        let (name, expected) = (&row[0], &row[2]);
        let told = load(&folder.join(name));
        println!("{name}: {told:?}");
        let loaded = told.refused.is_none();
        let [collision, dynamics] = &told.missing;
        let fits = match name {
            // Kinematics do without the mesh, and what is outside is not read.
            "46_mesh_traversal.urdf" => loaded && collision.contains("leads out of the folders"),
            "49_mesh_missing.urdf" => loaded && collision.contains("no such file"),
            "51_mesh_lying_stl.urdf" => !loaded,
            _ if expected.starts_with("load") => loaded,
            _ if expected.starts_with("kinematics ok") || expected.contains("singular") => {
                loaded && dynamics.contains("link `")
            }
            _ => !loaded,
        };
        assert!(fits, "{name}, {expected}: {told:?}");
    }
}

#[test]
fn what_is_no_file_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    assert!(Robot::open(folder.path()).is_err());
    assert!(Robot::open(&folder.path().join("none.urdf")).is_err());
    #[cfg(unix)]
    for endless in ["/dev/zero", "/dev/null"] {
        assert!(Robot::open(Path::new(endless)).is_err(), "{endless}");
    }
}

#[test]
fn mended_inertias_are_said_and_make_dynamics_possible() {
    let options = LoadOptions {
        inertia: Inconsistent::Mend,
        ..LoadOptions::default()
    };
    for diagonal in [["1", "1", "5"], ["1", "-1", "1"]] {
        let text = inertial("1", diagonal);
        let robot = Robot::load(&text, &options).unwrap();
        robot.require_dynamics().unwrap();
        let notes = robot.notes().join("\n");
        assert!(
            notes.contains("link `arm`") && notes.contains("mended"),
            "{notes}"
        );
        let kept = Robot::from_urdf(&text).and_then(|robot| robot.require_dynamics());
        assert!(kept.is_err());
    }
    // A sound one stays as it is.
    let text = inertial("1", ["1", "2", "3"]);
    let moments = |options: &LoadOptions| {
        let robot = Robot::load(&text, options).unwrap();
        robot.bodies()[1].inertial.clone().unwrap()
    };
    assert_eq!(moments(&options), moments(&LoadOptions::default()));
}

#[test]
fn a_negative_scale_mirrors() {
    let folder = tempfile::tempdir().unwrap();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(folder.path().join("a.obj"), corners).unwrap();
    let file = folder.path().join("r.urdf");
    let text = collision(r#"<mesh filename="a.obj" scale="-1 0.5 2"/>"#);
    std::fs::write(&file, text).unwrap();
    let robot = Robot::open(&file).unwrap();
    let undulate::Shape::Hull(hull) = &robot.bodies()[1].collision[0].shape else {
        panic!("a mesh becomes a hull");
    };
    let mut found: Vec<[f64; 3]> = hull.vertices().iter().map(|v| v.coords.into()).collect();
    found.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let expected = [
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 6.0],
        [0.0, 1.0, 0.0],
    ];
    assert_eq!(found, expected);
    assert!((hull.volume() - 1.0).abs() < 1e-12);
}
