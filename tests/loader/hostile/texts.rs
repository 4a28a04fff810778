//! Texts of no robot.

use super::Must::{self, Load, Refuse};
use super::more;

/// Texts that are no XML of a robot, or too much of it.
pub fn texts() -> Vec<(&'static str, Vec<u8>, Must)> {
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
