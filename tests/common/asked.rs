//! Observations of all kinds, and the rows and values that they are over x: made from the definition of the chart and the branch
//! centres in the model file, not by the library.

use std::f64::consts::TAU;

use serde_json::Value;
use undulate::{Coordinate, FourierMovementPrimitive, LinearObservation, Observation, stream};

/// The rows and values that quantities have in a chart, by its definition and the branch centres in the model file.
struct Chart {
    joints: Vec<String>,
    harmonics: usize,
    /// The joint to which the phases of others are relative, if any.
    reference: Option<usize>,
    centres: Vec<f64>,
    /// signed, or the sign of what has a logarithm.
    offsets: Vec<String>,
}

impl Chart {
    fn of(primitive: &FourierMovementPrimitive) -> Self {
        let file: Value = serde_json::from_str(&primitive.to_json()).unwrap();
        let joints: Vec<String> = serde_json::from_value(file["joints"].clone()).unwrap();
        let harmonics = primitive.chart().harmonics();
        let relative = file["phases"].get("relative");
        Self {
            reference: relative
                .map(|r| joints.iter().position(|j| r["reference"] == j.as_str()))
                .map(Option::unwrap),
            centres: relative.map_or_else(
                || vec![0.0; joints.len() * harmonics],
                |r| serde_json::from_value(r["centres_rad"].clone()).unwrap(),
            ),
            offsets: serde_json::from_value(file["offsets"].clone()).unwrap(),
            joints,
            harmonics,
        }
    }

    fn modulus(&self, joint: usize, k: usize) -> Vec<(usize, f64)> {
        vec![(joint * self.harmonics + k - 1, 1.0)]
    }

    fn phase(&self, joint: usize, k: usize) -> Vec<(usize, f64)> {
        let entry = |d: usize| (self.centres.len() + d * self.harmonics + k - 1, 1.0);
        let reference = self.reference.filter(|d| *d != joint);
        [Some(joint), reference]
            .into_iter()
            .flatten()
            .map(entry)
            .collect()
    }

    fn offset(&self, joint: usize) -> Vec<(usize, f64)> {
        vec![(2 * self.centres.len() + joint, 1.0)]
    }

    /// The representative of an angle nearest to the centre of the row's branch.
    fn branch(&self, row: &[(usize, f64)], angle: f64) -> f64 {
        let centres = row
            .iter()
            .map(|(i, c)| c * self.centres[i - self.centres.len()]);
        angle - TAU * ((angle - centres.sum::<f64>()) / TAU).round()
    }
}

fn combined(terms: &[(f64, Vec<(usize, f64)>)]) -> Vec<(usize, f64)> {
    let entries = terms
        .iter()
        .flat_map(|(f, row)| row.iter().map(move |(i, c)| (*i, f * c)));
    entries.collect()
}

/// An observation, and the row and value that it is by the definition of the chart.
pub type Asked = (Observation, LinearObservation);

/// One hundred independent observations: of each of 20 harmonics a modulus, a phase, a ratio, a relative phase, and a linear
/// sum (or, of five harmonics, an offset). The values are those of a draw; `deviation` (of the i-th) is a share of what is learned as a logarithm (a modulus, a ratio, some offsets), else rad.
pub fn asked(primitive: &FourierMovementPrimitive, deviation: impl Fn(usize) -> f64) -> Vec<Asked> {
    let chart = Chart::of(primitive);
    let x = primitive.gaussian().sample(&mut stream(1, 0));
    let at = |row: &[(usize, f64)]| row.iter().map(|(i, c)| c * x[*i]).sum::<f64>();
    (0..5 * chart.harmonics.min(20))
        .map(|i| {
            let (kind, k, deviation) = (i % 5, i / 5 + 1, deviation(i));
            let joint = |after: usize| (k + after) % chart.joints.len();
            let name = |after: usize| chart.joints[joint(after)].as_str();
            let modulus = |after| chart.modulus(joint(after), k);
            let phase = |after| chart.phase(joint(after), k);
            let (observation, row, value) = match kind {
                0 => {
                    let row = modulus(0);
                    let value = at(&row).exp();
                    let observation = Observation::modulus(name(0), k, value);
                    (observation.within(deviation * value), row, value.ln())
                }
                1 => {
                    let row = phase(1);
                    let value = at(&row);
                    let charted = chart.branch(&row, value);
                    let observation = Observation::phase(name(1), k, value);
                    (observation.within(deviation), row, charted)
                }
                2 => {
                    let row = combined(&[(1.0, modulus(2)), (-1.0, modulus(3))]);
                    let value = at(&row).exp();
                    let ratio = Coordinate::ratio(name(2), name(3), k);
                    let observation = Observation::of(ratio, value);
                    (observation.within(deviation * value), row, value.ln())
                }
                3 => {
                    let row = combined(&[(1.0, phase(3)), (-1.0, phase(4))]);
                    let value = at(&row) + 2.0 * TAU;
                    let charted = chart.branch(&row, value);
                    let lead = Coordinate::relative_phase(name(3), name(4), k);
                    (Observation::of(lead, value).within(deviation), row, charted)
                }
                _ if k <= 5 => {
                    let row = chart.offset(joint(0));
                    let charted = at(&row);
                    let (value, size) = match chart.offsets[joint(0)].as_str() {
                        "signed" => (charted, 1.0),
                        "positive" => (charted.exp(), charted.exp()),
                        "negative" => (-charted.exp(), charted.exp()),
                        other => panic!("{other}"),
                    };
                    let observation = Observation::offset(name(0), value);
                    (observation.within(deviation * size), row, charted)
                }
                _ => {
                    let row = combined(&[(0.5, modulus(4)), (-1.5, phase(2)), (2.0, modulus(1))]);
                    let value = at(&row);
                    let terms = vec![
                        (0.5, Coordinate::modulus(name(4), k)),
                        (-1.5, Coordinate::phase(name(2), k)),
                        (2.0, Coordinate::modulus(name(1), k)),
                    ];
                    (Observation::sum(terms, value).within(deviation), row, value)
                }
            };
            let linear = LinearObservation {
                row,
                value,
                deviation,
            };
            (observation, linear)
        })
        .collect()
}
