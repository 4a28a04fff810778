//! Robots of the right grammar.

use super::Must::{self, Load, Refuse, Still};
use super::{LIMIT, arm, chain, collision, inertial, joint, limits, more};

/// Robots that contradict themselves, and some that only look so.
pub fn robots() -> Vec<(&'static str, Vec<u8>, Must)> {
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
