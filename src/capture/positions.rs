//! Positions of shoulder, elbow and hand over time, as a table, to the four angles that they determine.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::arm::{ArmMotion, Pose};
use super::note::CaptureNote;
use super::skeleton::Side;
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::table::{Row, Table};

/// The sine of an elbow's flexion, 6 deg, below which the plane of the arm is noise of the positions.
const STRAIGHT: f64 = 0.1;

/// Positions beyond this, in any unit, and times \[s\] are of no person.
const FARTHEST: f64 = 1e9;

/// Points nearer to each other than this, in any unit, have no direction.
const NEAREST: f64 = 1e-9;

/// Samples nearer to each other than this \[s\] have no rate.
const SOONEST: f64 = 1e-9;

/// What a table of positions does not say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionOptions {
    /// Which arm it is.
    pub side: Side,
    /// Where the shoulder is, for tables without.
    pub shoulder: Option<[f64; 3]>,
}

/// Of a point its three columns, or where it stays.
#[derive(Clone, Copy)]
enum Point {
    Columns([usize; 3]),
    Fixed(Vector3<f64>),
}

/// Shoulder, elbow, hand, and of the trunk the other shoulder and the middle of the hips.
struct Points {
    arm: [Point; 3],
    trunk: Option<[Point; 2]>,
}

/// Where an arm points in the frame of the thorax, mirrored if it is a left one: upper arm and forearm.
type Directions = [Vector3<f64>; 2];

impl ArmMotion {
    /// An arm from a CSV of positions: `time_s` \[s\], and `_x`, `_y`, `_z` of `shoulder`, `elbow` and `hand` in metres (or any one
    /// unit: angles do not depend on it), X to the person's left, Y up, Z forward. The hand is its wrist.
    ///
    /// With `other_shoulder` and `pelvis`, the middle of the hips, angles are relative to the trunk, whose Y is along the spine; else
    /// the trunk is taken to stand as the table's axes do. Rows with an empty field are gaps.
    ///
    /// What positions determine are shoulder_flexion, shoulder_abduction, shoulder_rotation and elbow_flexion: how the forearm is
    /// turned about itself and how the hand is bent they do not say, and the carrying angle counts as 0. How the upper arm is turned
    /// about itself is told by the plane of a bent elbow; where it is straight, the plane is carried along without twist.
    ///
    /// # Errors
    /// Names line and column of whatever is not a finite number; when a column is missing, points coincide, or the elbow
    /// never bends.
    pub fn from_positions(text: &[u8], options: PositionOptions) -> Result<Self> {
        let table = Table::new(
            text,
            "a header `time_s,elbow_x,elbow_y,elbow_z,hand_x,..` and one row a sample",
        )?;
        let time = table
            .column("time_s")
            .map_err(|e| e.help("the column of times in seconds is called `time_s`"))?;
        let points = Points::new(&table, options.shoulder)?;
        let mut times: Vec<f64> = Vec::new();
        let mut directions: Vec<Directions> = Vec::new();
        table.rows(|row| {
            let t = row.number(time, "a time in seconds")?;
            if t.abs() > FARTHEST {
                return Err(Error::new(ErrorKind::Value, format!("time {t} s"))
                    .because(Reason::OutOfRange)
                    .expected(format!("at most {FARTHEST}")));
            }
            if let Some(before) = times.last()
                && t - before < SOONEST
            {
                return Err(Error::new(
                    ErrorKind::Value,
                    format!("time {t} s does not come after {before} s"),
                )
                .expected("strictly increasing times, a nanosecond apart at least"));
            }
            if let Some(found) = points.directions(row, options.side)? {
                times.push(t);
                directions.push(found);
            }
            Ok(())
        })?;
        if times.len() < 2 {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} samples with all positions", times.len()),
            )
            .expected("at least two"));
        }
        let (axes, straight) = elbow_axes(&directions)?;
        let poses = directions.iter().zip(axes).map(|([upper, forearm], axis)| {
            let humerus = Matrix3::from_columns(&[-axis, -upper, axis.cross(upper)]);
            Pose {
                humerus,
                forearm: humerus.transpose() * forearm,
                hand: None,
            }
        });
        let notes = (straight > 0).then_some(CaptureNote::Straight {
            samples: straight,
            of: times.len(),
        });
        Ok(Self {
            side: options.side,
            poses: poses.collect(),
            times,
            hinge_roll: 0.0,
            notes: notes.into_iter().collect(),
        })
    }
}

impl Points {
    fn new(table: &Table<'_>, shoulder: Option<[f64; 3]>) -> Result<Self> {
        let named = |name: &str| -> Result<Point> {
            let [x, y, z] = ["x", "y", "z"].map(|axis| table.column(&format!("{name}_{axis}")));
            Ok(Point::Columns([x?, y?, z?]))
        };
        let shoulder = match shoulder {
            Some(point) if point.iter().all(|x| x.abs() <= FARTHEST) => {
                Point::Fixed(Vector3::from(point))
            }
            Some(point) => {
                return Err(
                    Error::new(ErrorKind::Setting, format!("shoulder at {point:?}"))
                        .expected("three finite numbers"),
                );
            }
            None => named("shoulder")
                .map_err(|e| e.help("say with --shoulder X,Y,Z where it is, if it stays there"))?,
        };
        const TRUNK: [&str; 2] = ["other_shoulder", "pelvis"];
        let columns = table.columns();
        let about_trunk = |column: &&str| TRUNK.iter().any(|name| column.starts_with(name));
        let trunk = if columns.iter().any(about_trunk) {
            Some([named(TRUNK[0])?, named(TRUNK[1])?])
        } else {
            None
        };
        Ok(Self {
            arm: [shoulder, named("elbow")?, named("hand")?],
            trunk,
        })
    }

    /// `None` where the row lacks one of them.
    fn directions(&self, row: &Row<'_>, side: Side) -> Result<Option<Directions>> {
        let mut points = self.arm.iter().chain(self.trunk.iter().flatten());
        if points.any(|point| point.is_missing(row)) {
            return Ok(None);
        }
        let [shoulder, elbow, hand] = [
            self.arm[0].place(row)?,
            self.arm[1].place(row)?,
            self.arm[2].place(row)?,
        ];
        let to_thorax = match &self.trunk {
            Some([other, pelvis]) => {
                let (other, pelvis) = (other.place(row)?, pelvis.place(row)?);
                let up = direction(&pelvis, &(0.5 * (shoulder + other)), "pelvis to shoulders")?;
                let across = direction(&shoulder, &other, "shoulder to other_shoulder")?;
                let left = -side.sign() * across;
                let left = left - up * left.dot(&up);
                let left = direction(&Vector3::zeros(), &left, "shoulders, across the spine")?;
                Matrix3::from_columns(&[left, up, left.cross(&up)]).transpose()
            }
            None => Matrix3::identity(),
        };
        let upper = to_thorax * direction(&shoulder, &elbow, "shoulder to elbow")?;
        let forearm = to_thorax * direction(&elbow, &hand, "elbow to hand")?;
        Ok(Some([side.as_right(upper), side.as_right(forearm)]))
    }
}

impl Point {
    fn is_missing(&self, row: &Row<'_>) -> bool {
        match self {
            Self::Columns(columns) => columns.iter().any(|column| row.is_empty(*column)),
            Self::Fixed(_) => false,
        }
    }

    fn place(&self, row: &Row<'_>) -> Result<Vector3<f64>> {
        let columns = match self {
            Self::Columns(columns) => columns,
            Self::Fixed(point) => return Ok(*point),
        };
        let mut place = Vector3::zeros();
        for (x, column) in place.iter_mut().zip(columns) {
            *x = row.number(*column, "a position in metres, or nothing")?;
        }
        if place.amax() > FARTHEST {
            return Err(
                Error::new(ErrorKind::Value, format!("a position of {}", place.amax()))
                    .because(Reason::OutOfRange)
                    .expected(format!("at most {FARTHEST}")),
            );
        }
        Ok(place)
    }
}

fn direction(from: &Vector3<f64>, to: &Vector3<f64>, what: &str) -> Result<Vector3<f64>> {
    (to - from).try_normalize(NEAREST).ok_or_else(|| {
        Error::new(ErrorKind::Value, format!("no direction from {what}"))
            .expected("points apart from each other")
    })
}

/// The axis about which the elbow bends, in each sample, and how many of them are carried.
fn elbow_axes(directions: &[Directions]) -> Result<(Vec<Vector3<f64>>, usize)> {
    let mut axes: Vec<Option<Vector3<f64>>> = directions
        .iter()
        .map(|[upper, forearm]| upper.cross(forearm).try_normalize(STRAIGHT))
        .collect();
    let straight = axes.iter().filter(|axis| axis.is_none()).count();
    let Some(first) = axes.iter().position(Option::is_some) else {
        return Err(Error::new(ErrorKind::Infeasible, "the elbow never bends")
            .expected("by more than 6 deg at some time: its plane says how the upper arm is turned")
            .help("record markers of the hand too, and give a BVH file"));
    };
    let forward = (first..directions.len().saturating_sub(1)).map(|n| (n, n + 1));
    let backward = (0..first).rev().map(|n| (n + 1, n));
    for (from, to) in forward.chain(backward) {
        if axes[to].is_none() {
            axes[to] = axes[from].map(|axis| {
                // Straight back within one sample: any way round is the shortest, and the axis may stay.
                let turn = Rotation3::rotation_between(&directions[from][0], &directions[to][0]);
                turn.unwrap_or_default() * axis
            });
        }
    }
    let axes = axes.into_iter().flatten().zip(directions);
    // What is carried far loses its right angle to rounding.
    let axes = axes.map(|(axis, [upper, _])| (axis - upper * axis.dot(upper)).normalize());
    Ok((axes.collect(), straight))
}
