//! What is assumed when learning, as arguments.

use clap::{Args, ValueEnum};

use super::output;
use crate::primitive::{
    Estimator, Example, LearnOptions, OffsetEvidence, OffsetForm, Offsets, PhaseForm,
};

/// How waves become a distribution.
#[derive(Args)]
pub(super) struct Assumptions {
    /// Algorithm 1 of the paper to the letter: principal phases, signed offsets, maximum likelihood.
    #[arg(long, conflicts_with_all = ["phases", "offsets", "estimator", "align"])]
    paper: bool,
    /// How phases enter: `relative` to the strongest joint, `recentred` about their circular mean, or `principal` values.
    #[arg(long, value_name = "FORM", default_value_t)]
    phases: PhaseForm,
    /// How offsets enter: as they are, by their logarithm where all have one sign, or by data, which explains itself.
    #[arg(long, value_enum, default_value_t = OffsetChoice::Signed)]
    offsets: OffsetChoice,
    /// How the covariance is estimated: kronecker (weight chosen on the data), kronecker:WEIGHT, low-rank, ledoit-wolf, oas or ml;
    /// `undulate compare-estimators` shows what each costs.
    #[arg(long, value_name = "ESTIMATOR", default_value_t)]
    pub estimator: Estimator,
    /// Start every demonstration at the same phase of its strongest harmonic first.
    #[arg(long)]
    align: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum OffsetChoice {
    Signed,
    Log,
    ByData,
}

impl Assumptions {
    pub fn is_paper(&self) -> bool {
        self.paper
    }

    pub fn aligns(&self) -> bool {
        self.align
    }

    pub fn options(&self) -> LearnOptions {
        if self.paper {
            return LearnOptions::paper();
        }
        LearnOptions {
            phases: self.phases,
            offsets: match self.offsets {
                OffsetChoice::Signed => Offsets::Signed,
                OffsetChoice::Log => Offsets::Logarithmic,
                OffsetChoice::ByData => Offsets::ByData,
            },
            estimator: self.estimator,
            align: self.align,
            residual: false,
        }
    }
}

/// Why each offset is taken as it is, or by its logarithm.
pub(super) fn offset_table(examples: &[Example], forms: &[OffsetForm]) -> String {
    let rows: Vec<Vec<String>> = OffsetEvidence::of(examples)
        .iter()
        .zip(forms)
        .map(|(evidence, form)| {
            let why = match evidence.logarithmic {
                None => "both signs: no logarithm".to_owned(),
                Some(_) if evidence.advantage > 0.0 => {
                    format!("logarithm more probable by {:.2} nats", evidence.advantage)
                }
                Some(_) => format!("as it is more probable by {:.2} nats", -evidence.advantage),
            };
            vec![
                evidence.joint.clone(),
                format!(
                    "{} .. {}",
                    output::degrees(evidence.lowest),
                    output::degrees(evidence.highest)
                ),
                why,
                match form {
                    OffsetForm::Signed => "as it is".to_owned(),
                    _ => "logarithm".to_owned(),
                },
            ]
        })
        .collect();
    output::table(
        &["joint", "offsets [deg]", "the data say", "learned"],
        &rows,
    )
}
