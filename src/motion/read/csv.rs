//! Moves from CSV: a column of times, a column a joint, and where they are known its velocities and accelerations.

use super::{Error, ErrorKind, Reason, Result, Waypoints};
use crate::fourier::Joints;
use crate::motion::waypoints::{Rows, Waypoint};
use crate::table::{Row, Table};

/// What the column of times may be called.
const TIMES: [&str; 2] = ["time_s", "time_from_start"];

/// What follows the joint's name in the columns of its derivatives.
const DERIVATIVES: [&str; 2] = ["/velocity", "/acceleration"];

impl Waypoints {
    /// Reads a CSV text: times in seconds in a column `time_s` or `time_from_start`, and for each joint a column of its
    /// name with positions \[rad, m\]. Columns `JOINT/velocity` and `JOINT/acceleration` may follow, for all joints or for
    /// none; a row in which all of them are empty has none. With `degrees`, all columns of joints are in degrees.
    ///
    /// ```
    /// use undulate::Waypoints;
    ///
    /// let text = "time_s,elbow,elbow/velocity\n0,0,0\n1,0.5,0\n";
    /// let waypoints = Waypoints::from_csv("nod.csv", text.as_bytes(), false)?;
    /// assert_eq!(waypoints.get(1).velocities, Some(&[0.0][..]));
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// Names line and column of whatever is not such a table, and those of [`Waypoints::new`].
    pub fn from_csv(name: &str, text: &[u8], degrees: bool) -> Result<Self> {
        parse(text, degrees).map_err(|e| e.at(name))
    }
}

fn parse(text: &[u8], degrees: bool) -> Result<Waypoints> {
    let table = Table::new(text, "a header `time_s,joint,..` and one row a waypoint")?;
    let columns = table.columns();
    let times: Vec<&str> = TIMES.into_iter().filter(|t| columns.contains(t)).collect();
    let &[time] = times.as_slice() else {
        return Err(
            Error::new(ErrorKind::Name, format!("{} columns of times", times.len()))
                .because(Reason::WrongSize)
                .expected("one, `time_s` or `time_from_start`, in seconds")
                .at("line 1"),
        );
    };
    let time_column = table
        .column(time)
        .map_err(|e| e.because(Reason::WrongSize))?;
    let names: Vec<&str> = columns
        .iter()
        .copied()
        .filter(|c| *c != time && !DERIVATIVES.iter().any(|d| c.ends_with(d)))
        .collect();
    let joints = Joints::new(names.iter().copied())
        .map_err(|e| e.because(Reason::MissingJoint).at("line 1"))?;
    let picked = |suffix: &str| {
        names
            .iter()
            .map(|n| table.column(&format!("{n}{suffix}")))
            .collect::<Result<Vec<_>>>()
    };
    let positions = picked("")?;
    let mut derivatives = Vec::new();
    let mut count = 1 + names.len();
    for suffix in DERIVATIVES {
        if columns.iter().any(|c| c.ends_with(suffix)) {
            derivatives.push(picked(suffix).map_err(|e| {
                e.because(Reason::WrongSize)
                    .help(format!("give `JOINT{suffix}` for all joints or for none"))
            })?);
            count += names.len();
        } else {
            derivatives.push(Vec::new());
        }
    }
    if count != columns.len() {
        return Err(Error::new(
            ErrorKind::Name,
            format!(
                "{} columns, of which {count} belong to a joint or to time",
                columns.len()
            ),
        )
        .because(Reason::UnknownJoint)
        .expected("derivatives of joints that have a column of positions")
        .at("line 1"));
    }
    let unit = if degrees { 1f64.to_radians() } else { 1.0 };
    let read = |row: &Row<'_>, columns: &[usize], values: &mut Vec<f64>| {
        values.clear();
        for &column in columns {
            values.push(row.number(column, "a number")? * unit);
        }
        Ok(())
    };
    let mut rows = Rows::new(joints);
    let mut values = [const { Vec::new() }; 3];
    table.rows(|row| {
        let [q, v, a] = &mut values;
        read(row, &positions, q)?;
        let mut given = [false; 2];
        for ((columns, values), given) in derivatives.iter().zip([v, a]).zip(&mut given) {
            if columns.iter().any(|c| !row.is_empty(*c)) {
                read(row, columns, values)?;
                *given = true;
            }
        }
        rows.push(Waypoint {
            time: row.number(time_column, "a time in seconds")?,
            positions: &values[0],
            velocities: given[0].then_some(&values[1]),
            accelerations: given[1].then_some(&values[2]),
        })
    })?;
    rows.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Waypoints> {
        Waypoints::from_csv("m.csv", text.as_bytes(), false)
    }

    #[test]
    fn derivatives_are_found_by_name_in_any_order_and_may_be_left_out_in_a_row() {
        let text = "b/velocity,time_from_start,a, b ,a/velocity,a/acceleration,b/acceleration\n\
                    -1,0,1,2,3,4,5\n,1,1,2,,,\n# a remark\n0.5,2,1,2,0.25,,\n";
        let waypoints = read(text).unwrap();
        let [first, second, third] = [0, 1, 2].map(|i| waypoints.get(i));
        assert_eq!(waypoints.joints().listed(), "a, b");
        assert_eq!(first.velocities, Some(&[3.0, -1.0][..]));
        assert_eq!(first.accelerations, Some(&[4.0, 5.0][..]));
        assert_eq!((second.velocities, second.accelerations), (None, None));
        assert_eq!(third.velocities, Some(&[0.25, 0.5][..]));
        assert_eq!(third.accelerations, None);
        let degrees = Waypoints::from_csv("m.csv", b"time_s,a,a/velocity\n0,180,-90\n", true);
        let (pi, row) = (std::f64::consts::PI, degrees.unwrap());
        assert_eq!(row.get(0).positions, [pi]);
        assert_eq!(row.get(0).velocities, Some(&[-pi / 2.0][..]));
    }

    #[test]
    fn each_bad_table_gets_its_place_and_reason() {
        for (text, expected, reason) in [
            ("", "m.csv: the file is empty", Reason::WrongSize),
            (
                "a,b\n0,0\n",
                "line 1: 0 columns of times",
                Reason::WrongSize,
            ),
            (
                "time_s,time_from_start\n",
                "2 columns of times",
                Reason::WrongSize,
            ),
            (
                "time_s,time_s,a\n",
                "two columns `time_s`",
                Reason::WrongSize,
            ),
            ("time_s\n0\n", "no joints", Reason::MissingJoint),
            (
                "time_s,a,a\n",
                "joint `a` is named twice",
                Reason::MissingJoint,
            ),
            (
                "time_s,a,b,a/velocity\n",
                "no column `b/velocity`",
                Reason::WrongSize,
            ),
            (
                "time_s,a,a/velocity,x/velocity\n",
                "4 columns, of which 3",
                Reason::UnknownJoint,
            ),
            ("time_s,a\n", "no waypoint", Reason::NoDuration),
            (
                "time_s,a\n0,1\n0,1\n",
                "line 3: time 0 s",
                Reason::TimesNotIncreasing,
            ),
            (
                "time_s,a\n0,NaN\n",
                "line 2, column `a`: found `NaN`",
                Reason::NotFinite,
            ),
            (
                "time_s,a\n0,\n",
                "line 2, column `a`: found ``",
                Reason::NotFinite,
            ),
            (
                "time_s,a\n,0\n",
                "line 2, column `time_s`",
                Reason::NotFinite,
            ),
            (
                "time_s,a\n0,1e10\n",
                "line 2, joint `a`: 10000000000",
                Reason::OutOfRange,
            ),
            ("time_s,a\n0,1,2\n", "line 2: 3 fields", Reason::WrongSize),
            (
                "time_s,a,b,a/velocity,b/velocity\n0,1,2,3,\n",
                "line 2, column `b/velocity`",
                Reason::NotFinite,
            ),
            (
                "time_s,a,a/acceleration\n0,1,2\n",
                "line 2: accelerations without velocities",
                Reason::WrongSize,
            ),
            (
                "time_s;a\n0;1\n",
                "columns are separated by ';'",
                Reason::Unreadable,
            ),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.to_string().contains(expected), "{text:?}: {error}");
            assert_eq!(Reason::of(&error), reason, "{error}");
        }
    }

    #[test]
    fn a_header_without_end_takes_no_square_of_its_length() {
        let names: Vec<String> = (0..300_000).map(|i| format!("joint{i}")).collect();
        let error = read(&format!("time_s,{}\n0,1\n", names.join(","))).unwrap_err();
        assert_eq!(Reason::of(&error), Reason::WrongSize);
    }

    #[test]
    fn a_table_without_end_is_refused_when_it_is_too_long() {
        // A thousand joints, so that two thousand rows are enough.
        let mut text = "time_s".to_owned();
        for joint in 0..1000 {
            text.push_str(&format!(",{joint}"));
        }
        for row in 0..2001 {
            text.push_str(&format!("\n{row}"));
            text.push_str(&",0".repeat(1000));
        }
        let error = read(&text).unwrap_err();
        assert_eq!(error.reason(), Some(Reason::TooLarge), "{error}");
    }
}
