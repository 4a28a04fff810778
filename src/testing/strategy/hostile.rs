//! Texts that are no longer what they were.

use std::fmt;
use std::ops::Deref;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

/// What stands where a number stood.
const NUMBERS: [&str; 12] = [
    "",
    "0",
    "-0",
    "-1",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "1e999",
    "1e-999",
    "18446744073709551616",
    "999999999999",
];

/// What is put anywhere: control characters, byte order marks, letters that change direction or case, quotes, ends of lines.
const ODDITIES: [&str; 14] = [
    "\0",
    "\u{1}",
    "\u{1b}",
    "\u{feff}",
    "\u{202e}",
    "\u{130}",
    "\u{1f600}",
    "\"",
    "'",
    "\\",
    "\r",
    "\n",
    "\t",
    "&",
];

/// What opens something, put many times.
const OPENINGS: [&str; 7] = ["[", "{", "(", "<a>", "[[", "{\"a\":", "- "];

/// As deep as parsers that call themselves do not go.
const DEEPEST: usize = 50_000;

/// Of a text that is longer, this many characters from either end are printed.
const PRINTED: usize = 1000;

/// A text, or bytes, to which something has happened. It prints what that was, and of long texts both ends.
#[derive(Clone)]
pub struct Hostile<T> {
    value: T,
    /// What happened, in words.
    damages: Vec<String>,
}

impl<T: Deref> Deref for Hostile<T> {
    type Target = T::Target;
    fn deref(&self) -> &T::Target {
        &self.value
    }
}

impl<T: fmt::Debug> fmt::Debug for Hostile<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text: Vec<char> = format!("{:?}", self.value).chars().collect();
        let from = |range: &[char]| range.iter().collect::<String>();
        write!(f, "{}: ", self.damages.join(", then "))?;
        if text.len() <= 2 * PRINTED {
            return f.write_str(&from(&text));
        }
        let (head, rest) = text.split_at(PRINTED);
        let (middle, tail) = rest.split_at(rest.len() - PRINTED);
        write!(f, "{} ({} more) {}", from(head), middle.len(), from(tail))
    }
}

/// One thing that happens to a text.
#[derive(Debug, Clone)]
enum Damage {
    Truncated(Index),
    LineTwice(Index),
    LineGone(Index),
    Number(Index, usize),
    Odd(Index, usize),
    /// So many times.
    Nested(Index, usize, usize),
}

impl Damage {
    /// What it does to the text, in words.
    fn apply(&self, text: &mut String) -> String {
        let place = |at: &Index, text: &str| {
            let places: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
            places
                .get(at.index(places.len() + 1))
                .copied()
                .unwrap_or(text.len())
        };
        match self {
            Self::Truncated(at) => {
                text.truncate(place(at, text));
                format!("cut off after {} bytes", text.len())
            }
            Self::LineTwice(at) | Self::LineGone(at) => {
                let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
                if lines.is_empty() {
                    return "no line to change".to_owned();
                }
                let line = at.index(lines.len());
                let done = if matches!(self, Self::LineTwice(_)) {
                    lines.insert(line, lines[line]);
                    "twice"
                } else {
                    lines.remove(line);
                    "gone"
                };
                *text = lines.concat();
                format!("line {} {done}", line + 1)
            }
            Self::Number(at, which) => {
                let numbers = numbers(text);
                if numbers.is_empty() {
                    return "no number to change".to_owned();
                }
                let (range, new) = (numbers[at.index(numbers.len())].clone(), NUMBERS[*which]);
                let old = text[range.clone()].to_owned();
                text.replace_range(range.clone(), new);
                format!("`{old}` at byte {} made `{new}`", range.start)
            }
            Self::Odd(at, which) => {
                let (place, odd) = (place(at, text), ODDITIES[*which]);
                text.insert_str(place, odd);
                format!("{odd:?} put in at byte {place}")
            }
            Self::Nested(at, which, times) => {
                let (place, opening) = (place(at, text), OPENINGS[*which]);
                text.insert_str(place, &opening.repeat(*times));
                format!("`{opening}` put in {times} times at byte {place}")
            }
        }
    }
}

/// Where digits stand, with sign, point and exponent.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let is_part = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    let mut found = Vec::new();
    let mut start = None;
    for (i, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match (start, is_part(c)) {
            (None, true) => start = Some(i),
            (Some(from), false) => {
                if text[from..i].contains(|c: char| c.is_ascii_digit()) {
                    found.push(from..i);
                }
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Texts with one to three damages: cut off, a line twice or gone, a number replaced (by nothing, by nan, by 1e999, by a count that no memory holds), an odd
/// character put somewhere, or up to fifty thousand openings of something. What comes of it may be valid still. They shrink to fewer damages, of the kinds
/// that come first here, to fewer openings, and as the text does.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::FourierMovementPrimitive;
/// use undulate::testing::{hostile, primitives};
///
/// let files = primitives(1..=2, 1..=3, 2).prop_map(|primitive| primitive.to_json());
/// proptest!(|(text in hostile(files))| {
///     // Refused, or read: no panic.
///     let _ = FourierMovementPrimitive::from_json(&text);
/// });
/// ```
pub fn hostile(text: impl Strategy<Value = String>) -> impl Strategy<Value = Hostile<String>> {
    (text, vec(damage(), 1..=3)).prop_map(|(mut value, damages)| {
        let damages = damages.iter().map(|damage| damage.apply(&mut value));
        let damages = damages.collect();
        Hostile { value, damages }
    })
}

fn damage() -> impl Strategy<Value = Damage> {
    let at = any::<Index>;
    prop_oneof![
        at().prop_map(Damage::Truncated),
        at().prop_map(Damage::LineTwice),
        at().prop_map(Damage::LineGone),
        (at(), 0..NUMBERS.len()).prop_map(|(at, which)| Damage::Number(at, which)),
        (at(), 0..ODDITIES.len()).prop_map(|(at, which)| Damage::Odd(at, which)),
        (at(), 0..OPENINGS.len(), 1..=DEEPEST)
            .prop_map(|(at, which, times)| Damage::Nested(at, which, times)),
    ]
}

/// The texts of [`hostile`] as bytes, half of them with up to four bytes that are replaced, so that most of these are no UTF-8: for what reads
/// bytes. They shrink to text.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::hostile_bytes;
/// use undulate::{CsvOptions, Recording};
///
/// let files = Just("t,a\n0,1\n0.5,2\n".to_owned());
/// proptest!(|(bytes in hostile_bytes(files))| {
///     let _ = Recording::from_csv("hostile.csv", &bytes, &CsvOptions::default());
/// });
/// ```
pub fn hostile_bytes(
    text: impl Strategy<Value = String>,
) -> impl Strategy<Value = Hostile<Vec<u8>>> {
    let replaced = prop_oneof![Just(Vec::new()), vec((any::<Index>(), any::<u8>()), 1..=4)];
    (hostile(text), replaced).prop_map(|(text, replaced)| {
        let Hostile { value, mut damages } = text;
        let mut value = value.into_bytes();
        for (at, byte) in replaced {
            if !value.is_empty() {
                let i = at.index(value.len());
                value[i] = byte;
                damages.push(format!("byte {i} made {byte:#04x}"));
            }
        }
        Hostile { value, damages }
    })
}

#[cfg(test)]
mod tests {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    use super::*;

    #[test]
    fn what_happened_is_told_in_words() {
        // What an index shrinks to is the first.
        let mut tree = any::<Index>()
            .new_tree(&mut TestRunner::deterministic())
            .unwrap();
        while tree.simplify() {}
        let first = tree.current();
        let mut text = "a=1.5\nb\n".to_owned();
        let told: Vec<String> = [
            Damage::Number(first, 4),
            Damage::LineTwice(first),
            Damage::Odd(first, 0),
            Damage::Nested(first, 0, 3),
        ]
        .iter()
        .map(|damage| damage.apply(&mut text))
        .collect();
        assert_eq!(text, "[[[\0a=nan\na=nan\nb\n");
        let damages = told;
        let told = format!(
            "{:?}",
            Hostile {
                value: text,
                damages
            }
        );
        assert_eq!(
            told,
            "`1.5` at byte 2 made `nan`, then line 1 twice, then \"\\0\" put in at byte 0, then `[` put in 3 times at byte 0: \
             \"[[[\\0a=nan\\na=nan\\nb\\n\""
        );
    }

    #[test]
    fn numbers_are_found_whole() {
        let text = "a=-1.5e3, b 7.\n- .e +2";
        let found: Vec<&str> = numbers(text).into_iter().map(|r| &text[r]).collect();
        assert_eq!(found, ["-1.5e3", "7.", "+2"]);
    }
}
