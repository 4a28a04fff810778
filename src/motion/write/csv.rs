//! Moves as CSV.

use super::Waypoints;
use crate::error::{Error, ErrorKind, Result};

impl Waypoints {
    /// The text that [`from_csv`](Self::from_csv) reads back, every number bit for bit: `time_s`, a column a joint, and `JOINT/velocity`
    /// and `JOINT/acceleration` where any waypoint has them. SI units.
    ///
    /// # Errors
    /// When a joint's name is that of a column of another kind.
    pub fn to_csv(&self) -> Result<Vec<u8>> {
        let fail = |e: csv::Error| Error::new(ErrorKind::Io, e.to_string());
        let given = [
            true,
            self.iter().any(|w| w.velocities.is_some()),
            self.iter().any(|w| w.accelerations.is_some()),
        ];
        let suffixes = ["", "/velocity", "/acceleration"];
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut record = vec!["time_s".to_owned()];
        for (suffix, _) in suffixes.iter().zip(given).filter(|(_, given)| *given) {
            record.extend(self.joints().iter().map(|joint| format!("{joint}{suffix}")));
        }
        writer.write_record(&record).map_err(fail)?;
        for waypoint in self.iter() {
            record.clear();
            record.push(format!("{:?}", waypoint.time));
            let rows = [
                Some(waypoint.positions),
                waypoint.velocities,
                waypoint.accelerations,
            ];
            for (row, _) in rows.iter().zip(given).filter(|(_, given)| *given) {
                record.extend((0..self.joints().len()).map(|j| match row {
                    Some(row) => format!("{:?}", row[j]),
                    None => String::new(),
                }));
            }
            writer.write_record(&record).map_err(fail)?;
        }
        let text = writer
            .into_inner()
            .map_err(|e| Error::new(ErrorKind::Io, e.to_string()))?;
        let read = Self::from_csv("written", &text, false);
        self.held(text, read, "CSV")
    }
}
