//! [`Grouping`]: which demonstration is of which kind.

use nalgebra::DMatrix;
use rand::seq::SliceRandom;

use super::expectation::{Maximum, maximize};
use super::starts::{Distances, sorted};
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::chart::ChartForm;
use crate::primitive::example::Example;
use crate::primitive::scatter::Charted;
use crate::primitive::stream;

/// Of the demonstrations one in so many is left out at a time, to choose the number of kinds.
const FOLDS: usize = 10;
/// So many times as many starts find what is kept: in many dimensions each comes to an end of its own.
const MORE: u64 = 10;

/// How many kinds there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kinds {
    /// So many.
    Number(usize),
    /// The smallest number, of at most so many, that makes left-out demonstrations as probable as any other does, within one standard error.
    UpTo(usize),
}

/// How kinds are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GroupingOptions {
    /// How many there are.
    pub kinds: Kinds,
    /// From how many starts each number of them is sought; the most probable outcome counts.
    pub starts: u64,
    /// Of the starts.
    pub seed: u64,
}

impl Default for GroupingOptions {
    fn default() -> Self {
        Self {
            kinds: Kinds::UpTo(5),
            starts: 20,
            seed: 0,
        }
    }
}

/// How probable so many kinds make demonstrations that were left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOutKinds {
    /// How many.
    pub kinds: usize,
    /// Mean ln density \[nats a dimension\].
    pub density: f64,
    /// That of the best number less this one, and its standard error over the demonstrations.
    pub less_than_best: f64,
    #[allow(missing_docs)]
    pub error: f64,
}

/// Kinds of demonstrations, and the probability that each demonstration is of each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Grouping {
    names: Vec<String>,
    responsibilities: DMatrix<f64>,
    log_likelihoods: Vec<f64>,
    held_out: Vec<HeldOutKinds>,
}

impl Grouping {
    /// Finds kinds by expectation maximisation; they are called `a`, `b` and so on, from the most frequent on.
    ///
    /// # Errors
    /// When the demonstrations make no primitive, or not so many kinds: each needs effectively more than two demonstrations.
    pub fn find(examples: &[Example], form: &ChartForm, options: &GroupingOptions) -> Result<Self> {
        let charted = Charted::of(examples, form)?;
        let all = vec![true; examples.len()];
        match options.kinds {
            Kinds::Number(kinds) => {
                let maximum = search(&charted, &all, kinds, &last(options))?;
                Ok(Self::of(maximum, Vec::new()))
            }
            Kinds::UpTo(most) => {
                let held_out = numbers(&charted, most, options)?;
                let chosen = held_out
                    .iter()
                    .find(|h| h.less_than_best <= h.error)
                    .map_or(1, |h| h.kinds);
                let maximum = search(&charted, &all, chosen, &last(options))?;
                Ok(Self::of(maximum, held_out))
            }
        }
    }

    /// Expectation maximisation from a guess: responsibilities, M rows of C.
    ///
    /// # Errors
    /// When the guess is none of these demonstrations, or a kind comes down to two demonstrations or fewer.
    pub fn refine(examples: &[Example], form: &ChartForm, guess: DMatrix<f64>) -> Result<Self> {
        let charted = Charted::of(examples, form)?;
        let is_share = |row: nalgebra::DVector<f64>| {
            row.iter().all(|r| (0.0..=1.0).contains(r)) && (row.sum() - 1.0).abs() < 1e-9
        };
        let are_shares = guess.row_iter().all(|row| is_share(row.transpose()));
        if guess.nrows() != examples.len() || guess.ncols() == 0 || !are_shares {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} x {} responsibilities", guess.nrows(), guess.ncols()),
            )
            .expected(format!(
                "{} rows, each of probabilities that sum to 1",
                examples.len()
            )));
        }
        let maximum = maximize(&charted, &vec![true; examples.len()], guess)?;
        Ok(Self::of(maximum, Vec::new()))
    }

    /// Kinds that are known: a label a demonstration. Nothing is estimated.
    ///
    /// # Errors
    /// When there are no labels, or a hundred kinds and more.
    pub fn labelled<S: AsRef<str>>(labels: &[S]) -> Result<Self> {
        let mut names: Vec<String> = Vec::new();
        for label in labels {
            if !names.iter().any(|name| name == label.as_ref()) {
                names.push(label.as_ref().to_owned());
            }
        }
        if !(1..=super::MOST_COMPONENTS).contains(&names.len()) {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} kinds", names.len()))
                    .expected(format!("from 1 to {}", super::MOST_COMPONENTS)),
            );
        }
        let responsibilities = DMatrix::from_fn(labels.len(), names.len(), |m, c| {
            f64::from(u8::from(names[c] == labels[m].as_ref()))
        });
        Ok(Self {
            names,
            responsibilities,
            log_likelihoods: Vec::new(),
            held_out: Vec::new(),
        })
    }

    fn of(maximum: Maximum, held_out: Vec<HeldOutKinds>) -> Self {
        let found = &maximum.responsibilities;
        let mut order: Vec<usize> = (0..found.ncols()).collect();
        order.sort_by(|a, b| found.column(*b).sum().total_cmp(&found.column(*a).sum()));
        Self {
            names: (0..order.len()).map(letters).collect(),
            responsibilities: found.select_columns(&order),
            log_likelihoods: maximum.log_likelihoods,
            held_out,
        }
    }

    /// A name a kind.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// M x C: the probability that each demonstration is of each kind; rows sum to 1.
    pub fn responsibilities(&self) -> &DMatrix<f64> {
        &self.responsibilities
    }

    /// The kind that demonstration `m` is of most probably, by number; panics when there is no such demonstration, as slices do.
    pub fn kind(&self, m: usize) -> usize {
        self.responsibilities.row(m).transpose().imax()
    }

    /// ln of the density of all demonstrations after each step of the search that counts \[nats\]; it never falls. Empty for labels.
    pub fn log_likelihoods(&self) -> &[f64] {
        &self.log_likelihoods
    }

    /// How probable left-out demonstrations are by number of kinds, where the number was chosen.
    pub fn held_out(&self) -> &[HeldOutKinds] {
        &self.held_out
    }
}

/// a .. z, aa ..
fn letters(mut number: usize) -> String {
    let mut name = String::new();
    loop {
        name.insert(0, char::from(b'a' + (number % 26) as u8));
        if number < 26 {
            return name;
        }
        number = number / 26 - 1;
    }
}

/// With more starts, for what is kept.
fn last(options: &GroupingOptions) -> GroupingOptions {
    GroupingOptions {
        starts: MORE * options.starts,
        ..*options
    }
}

/// The most probable outcome of all starts.
fn search(
    charted: &Charted,
    present: &[bool],
    kinds: usize,
    options: &GroupingOptions,
) -> Result<Maximum> {
    let refuse = |what: String| {
        Error::new(ErrorKind::Infeasible, what)
            .expected("more than two demonstrations in each kind")
            .help("look for fewer kinds, or record more of each")
    };
    let taking_part = present.iter().filter(|p| **p).count();
    if kinds == 0 || options.starts == 0 {
        return Err(Error::new(ErrorKind::Setting, "no kinds, or no starts").expected("at least 1"));
    }
    if kinds > super::MOST_COMPONENTS || (kinds > 1 && kinds * 3 > taking_part) {
        return Err(refuse(format!(
            "{kinds} kinds of {taking_part} demonstrations"
        )));
    }
    if kinds == 1 {
        let own = |m: usize, _| f64::from(u8::from(present[m]));
        return maximize(charted, present, DMatrix::from_fn(present.len(), 1, own));
    }
    let distances = Distances::new(charted, present);
    let mut best: Option<Maximum> = None;
    let mut last = None;
    for number in 0..options.starts {
        let Some(start) = distances.start(kinds, options.seed, number) else {
            continue;
        };
        match maximize(charted, present, start) {
            Err(error) => last = Some(error),
            Ok(found) => {
                let reached = |m: &Maximum| m.log_likelihoods[m.log_likelihoods.len() - 1];
                if best.as_ref().is_none_or(|b| reached(&found) > reached(b)) {
                    best = Some(found);
                }
            }
        }
    }
    best.ok_or_else(|| {
        let from = format!("from each of {} starts", options.starts);
        last.map_or_else(
            || refuse(format!("fewer than {kinds} demonstrations that differ")),
            |e| e.at(from),
        )
    })
}

/// 1, 2 and so on as long as there are enough demonstrations of each kind, each scored by demonstrations that were left out.
fn numbers(charted: &Charted, most: usize, options: &GroupingOptions) -> Result<Vec<HeldOutKinds>> {
    let count = charted.vectors.len();
    let mut order = sorted(charted);
    // From the end, so that no start uses the same numbers.
    order.shuffle(&mut stream(options.seed, u64::MAX));
    let folds = FOLDS.min(count);
    let mut scores: Vec<Vec<f64>> = Vec::new();
    // Of two, one that is left out leaves no primitive.
    for kinds in 1..=most.max(1) {
        let mut of_number = vec![0.0; count];
        let mut fails = count < 3;
        for fold in 0..folds {
            let mut present = vec![true; count];
            for m in order.iter().skip(fold).step_by(folds) {
                present[*m] = false;
            }
            match search(charted, &present, kinds, options) {
                Err(error) if kinds == 1 => return Err(error),
                Err(_) => fails = true,
                Ok(found) => {
                    for m in (0..count).filter(|m| !present[*m]) {
                        of_number[m] = found.log_densities[m];
                    }
                }
            }
            if fails {
                break;
            }
        }
        if fails {
            break;
        }
        scores.push(of_number);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count as f64;
    let best = scores.iter().map(|s| mean(s)).enumerate().fold(
        None,
        |best: Option<(usize, f64)>, next| match best {
            Some(best) if best.1 >= next.1 => Some(best),
            _ => Some(next),
        },
    );
    let dimension = charted.chart.dimension() as f64;
    let Some((best, _)) = best else {
        return Ok(Vec::new());
    };
    Ok(scores
        .iter()
        .enumerate()
        .map(|(i, own)| {
            let differences: Vec<f64> = scores[best].iter().zip(own).map(|(b, o)| b - o).collect();
            let centre = mean(&differences);
            let squares: f64 = differences.iter().map(|d| (d - centre).powi(2)).sum();
            let count = count as f64;
            HeldOutKinds {
                kinds: i + 1,
                density: mean(own) / dimension,
                less_than_best: centre / dimension,
                error: (squares / (count - 1.0) / count).sqrt() / dimension,
            }
        })
        .collect())
}
