//! A recording diagnosed as a whole and by its halves: whether the same physics is named twice, with the same
//! numbers.
//!
//! For kinds whose parameters are those of the laws that are named: proof masses and resonators. A number is
//! compared where every side has it. Of such numbers no correlations are stated, so that all together are
//! judged by the least likely difference.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use crate::answer::Answer;
use crate::error::Error;
use crate::recording::{Column, Recording};
use crate::repeatability::information::{Information, Known};
use crate::repeatability::parameter::{Estimate, Named, Parameter};
use crate::repeatability::run::{Halves, Run, Split};

/// Standard deviations from the middle to the end of a 95 % interval.
const TO_THE_END: f64 = 1.96;
/// Degrees of freedom that stand for a known variance.
const MANY: f64 = 1e6;

/// States whether a number is a law's, its name and its unit; the base model's come first.
type Key = (bool, String, String);

/// Verdict of a side, the laws that it names, and its numbers with their standard errors.
struct Told {
    verdict: &'static str,
    laws: Vec<String>,
    numbers: BTreeMap<Key, (f64, f64)>,
}

/// One recording: the whole, and the halves where both can be diagnosed, else why not.
pub(crate) struct Twice {
    whole: Told,
    halves: Result<[Told; 2], Error>,
    findings: Vec<String>,
}

impl Twice {
    /// Diagnoses a recording and its halves; `diagnose` also takes parts of it.
    ///
    /// # Errors
    /// As `diagnose` of the whole; when stopped.
    pub(crate) fn of(
        recording: &Recording,
        diagnose: impl Fn(&Recording) -> Result<Answer, Error>,
    ) -> Result<Self, Error> {
        let answer = diagnose(recording)?;
        let samples = recording.columns.first().map_or(0, |c| c.values.len());
        let half = |from: usize, to: usize| diagnose(&part(recording, from, to)).map(|a| Told::of(&a));
        let halves = half(0, samples / 2).and_then(|first| Ok([first, half(samples / 2, samples)?]));
        Ok(Self { whole: Told::of(&answer), halves, findings: answer.findings })
    }

    fn sides(&self) -> impl Iterator<Item = &Told> {
        std::iter::once(&self.whole).chain(self.halves.iter().flatten())
    }
}

/// The recordings as runs, with one order of parameters for all of them.
pub(crate) fn runs(all: &[Twice]) -> Vec<Run> {
    let mut keys: Vec<&Key> = all.iter().flat_map(Twice::sides).flat_map(|told| told.numbers.keys()).collect();
    keys.sort();
    keys.dedup();
    let run = |twice: &Twice| {
        let mut findings = twice.findings.clone();
        findings.push(format!("the whole of it: {}", twice.whole.words()));
        let is_one_model = matches!(&twice.halves, Ok([first, second]) if first.laws == second.laws);
        match &twice.halves {
            Ok([first, second]) => {
                let apart = "; these are two models, so that numbers of the base model are not compared";
                let apart = if is_one_model { "" } else { apart };
                findings.push(format!("its first half: {}; its second half: {}{apart}", first.words(), second.words()));
            }
            Err(error) => findings.push(format!("its halves were not compared: {}", error.cause)),
        }
        let estimate = twice.whole.estimate(&keys, true);
        let halves = twice.halves.as_ref().ok().map(|halves| Halves {
            split: Split::FirstAndSecond,
            each: halves.each_ref().map(|half| half.estimate(&keys, is_one_model)),
        });
        let information = Information { known: estimate.known.clone(), undetermined: Vec::new() };
        Run { information, estimate, halves, motion: None, remedies: Vec::new(), findings }
    };
    all.iter().map(run).collect()
}

impl Told {
    fn of(answer: &Answer) -> Self {
        let base = answer.base.iter().map(|e| (true, e.name.clone(), e));
        let laws = answer
            .effects
            .iter()
            .flat_map(|effect| effect.parameters.iter().map(|e| (false, format!("{} {}", effect.id, e.name), e)));
        let numbers = base.chain(laws).filter_map(|(is_base, name, e)| {
            let error = (e.ci95[1] - e.ci95[0]) / (2.0 * TO_THE_END);
            let is_told = e.value.is_finite() && error.is_finite() && error > 0.0;
            // The base model's numbers come first.
            is_told.then(|| ((!is_base, name, e.unit.clone()), (e.value, error)))
        });
        let mut laws: Vec<String> = answer.effects.iter().map(|effect| effect.id.clone()).collect();
        laws.sort();
        laws.dedup();
        Self { verdict: answer.outcome.name(), laws, numbers: numbers.collect() }
    }

    fn words(&self) -> String {
        std::iter::once(self.verdict).chain(self.laws.iter().map(String::as_str)).collect::<Vec<_>>().join(", ")
    }

    /// Its numbers; without the base model's where those are not of one model with what they are compared with.
    fn estimate(&self, keys: &[&Key], is_one_model: bool) -> Estimate {
        let of = |key: &&Key| self.numbers.get(*key).copied().filter(|_| is_one_model || key.0);
        let errors: Vec<f64> = keys.iter().map(|key| of(key).map_or(0.0, |n| n.1)).collect();
        let parameter = |key: &&Key| Named { name: key.1.clone(), unit: key.2.clone(), factor: 1.0 };
        Estimate {
            parameters: keys.iter().map(parameter).map(Parameter::Named).collect(),
            tolerance: vec![f64::INFINITY; keys.len()],
            value: keys.iter().map(|key| of(key).map_or(f64::NAN, |n| n.0)).collect(),
            covariance: DMatrix::from_fn(
                keys.len(),
                keys.len(),
                |i, j| if i == j { errors[i] * errors[i] } else { 0.0 },
            ),
            has_correlations: false,
            freedom: vec![MANY; keys.len()],
            known: keys.iter().map(|key| if of(key).is_some() { Known::Determined } else { Known::Not }).collect(),
        }
    }
}

/// Samples of a recording from one to another.
fn part(recording: &Recording, from: usize, to: usize) -> Recording {
    let cut = |c: &Column| Column { name: c.name.clone(), values: c.values[from..to].to_vec() };
    let within = |r: &std::ops::Range<usize>| r.start.max(from)..r.end.min(to);
    let filled = recording.filled.iter().map(within).filter(|r| !r.is_empty());
    Recording {
        columns: recording.columns.iter().map(cut).collect(),
        filled: filled.map(|r| r.start - from..r.end - from).collect(),
        ..recording.clone()
    }
}
