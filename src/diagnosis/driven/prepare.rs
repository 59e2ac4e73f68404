//! From a recording and its model to what can be fitted: columns found, ranges checked, defects said.

use std::ops::Range;

use crate::diagnosis::model;
use crate::error::{Error, Result, nearest};
use crate::recording::Recording;

use super::fit::{BASE, Data};
use super::input::{Input, Interpolation, REACH};
use super::start::spread;
use super::work::Work;

/// Half-open ranges of samples, ascending.
type Stretches = Vec<Range<usize>>;

/// Blocks that a stretch is cut into when the model does not say which samples judge; every third one judges. Many, so that
/// what happens once is seen by both kinds.
const BLOCKS: usize = 72;
/// Recordings longer than this are searched on a stretch only.
const LONG: usize = 40_000;
/// Samples of that stretch.
const STRETCH: usize = 12_288;
/// Fewer samples than this cannot carry a base model and a judgement on it.
const FEWEST: usize = 20 * BASE;

/// What can be fitted, and what was noticed on the way.
#[derive(Debug)]
pub struct Prepared {
    /// The data.
    pub data: Data,
    /// Whether the model file named its own test samples.
    pub own_test: bool,
    /// In words.
    pub findings: Vec<String>,
}

/// Checks and arranges.
///
/// # Errors
/// A column that is not there, values that are not numbers, a reading that never changes, too few samples, ranges outside
/// the recording.
pub fn prepare(recording: &Recording, model: &model::Driven) -> Result<Prepared> {
    let mut findings = recording.findings.clone();
    let reading = column(recording, &model.columns.output)?.to_vec();
    let samples = reading.len();
    if samples < FEWEST + 2 * REACH {
        return Err(refuse(
            recording,
            format!("{samples} samples; the base model alone has {BASE} parameters"),
            "give at least some hundred samples, better some thousands",
        ));
    }
    if spread(&reading).1 <= 1e-12 * spread(&reading).0.abs() {
        return Err(refuse(
            recording,
            format!("the output {} never changes: a dead channel", model.columns.output),
            "check the wiring and the name of the column",
        ));
    }
    let input = match &model.columns.input {
        Some(name) => {
            let values = column(recording, name)?.to_vec();
            if spread(&values).1 <= 1e-12 * spread(&values).0.abs() {
                findings.push(format!("the input {name} never changes, so the recording is read as a free ring-down"));
                None
            } else {
                Some(Input::new(values, Interpolation::BandLimited))
            }
        }
        None => None,
    };
    let mut environment = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for name in &model.columns.environment {
        let values = column(recording, name)?;
        let mean = spread(values).0;
        columns.push(values.iter().map(|v| v - mean).collect());
    }
    columns.retain(|c| spread(c).1 > 0.0);
    for k in 0..samples {
        environment.extend(columns.iter().map(|c| c[k]));
    }
    let ends = REACH..samples - REACH;
    let (train, test) = ranges(recording, &model.split, &ends, &mut findings)?;
    let own_test = !test.is_empty();
    let hull = train.first().map_or(0, |r| r.start)..train.last().map_or(0, |r| r.end);
    let (fitted, validation) = interleaved(&train);
    let test = if own_test { test } else { validation.clone() };
    let data = Data {
        reading,
        input,
        environment,
        environments: columns.len(),
        rate_hz: recording.rate_hz,
        hull,
        train: fitted,
        validation,
        test,
        work: Work::default(),
    };
    if data.train_len() < FEWEST / 2 {
        return Err(refuse(
            recording,
            format!("{} samples to fit; the base model alone has {BASE} parameters", data.train_len()),
            "widen [split] train",
        ));
    }
    Ok(Prepared { data, own_test, findings })
}

fn refuse(recording: &Recording, cause: String, hint: &str) -> Error {
    Error::new(format!("could not diagnose {}", recording.path.display()), cause, hint)
}

fn column<'a>(recording: &'a Recording, name: &str) -> Result<&'a [f64]> {
    let Some(values) = recording.column(name) else {
        let known = recording.columns.iter().map(|c| c.name.as_str());
        let hint = nearest(name, known)
            .map_or_else(|| "name a column of the file".to_owned(), |known| format!("did you mean \"{known}\"?"));
        return Err(refuse(recording, format!("there is no column \"{name}\""), &hint));
    };
    match values.iter().position(|v| !v.is_finite()) {
        Some(row) => Err(refuse(
            recording,
            format!("row {row} of {name} is not a number"),
            "fill or cut the gap; reading the file through the tool fills short ones",
        )),
        None => Ok(values),
    }
}

/// Fitted and judging ranges as the model file states them; the whole recording where it states nothing.
fn ranges(
    recording: &Recording,
    split: &model::Split,
    ends: &Range<usize>,
    findings: &mut Vec<String>,
) -> Result<(Stretches, Stretches)> {
    let samples = recording.samples();
    for [from, to] in split.train.iter().chain(&split.test) {
        if from >= to || *to > samples {
            return Err(refuse(
                recording,
                format!("the range [{from}, {to}) does not lie in the {samples} samples"),
                "ranges are half-open, counted from zero: [[0, 10000]]",
            ));
        }
    }
    let clip = |ranges: &[[usize; 2]]| -> Vec<Range<usize>> {
        let mut all: Vec<Range<usize>> =
            ranges.iter().map(|[a, b]| (*a).max(ends.start)..(*b).min(ends.end)).filter(|r| r.start < r.end).collect();
        all.sort_by_key(|r| r.start);
        merged(all)
    };
    let (mut train, test) = (clip(&split.train), clip(&split.test));
    if train.is_empty() {
        train = minus(std::slice::from_ref(ends), &test);
    }
    let apart = minus(&test, &train);
    let lost = test.iter().map(Range::len).sum::<usize>() - apart.iter().map(Range::len).sum::<usize>();
    if lost > 0 {
        findings.push(format!("{lost} samples stand in both train and test; they are fitted and do not judge"));
    }
    let apart: Vec<Range<usize>> = apart.into_iter().filter(|r| r.len() >= 200).collect();
    if !split.test.is_empty() && apart.is_empty() {
        findings.push("no test samples are left, so every third block of the train samples judges".to_owned());
    }
    Ok((train, apart))
}

fn merged(sorted: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for r in sorted {
        match all.last_mut() {
            Some(last) if r.start <= last.end => last.end = last.end.max(r.end),
            _ => all.push(r),
        }
    }
    all
}

fn minus(from: &[Range<usize>], take: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut left = from.to_vec();
    for t in take {
        left = left
            .into_iter()
            .flat_map(|r| [r.start..r.end.min(t.start.max(r.start)), r.start.max(t.end.min(r.end))..r.end])
            .filter(|r| r.start < r.end)
            .collect();
    }
    left
}

/// The loudest stretch of a long recording, to choose terms on; the terms chosen are fitted to everything afterwards.
/// `None` where the recording is short enough to be used whole.
pub fn loudest(data: &Data) -> Option<Data> {
    if data.hull.len() <= LONG {
        return None;
    }
    let power = |r: &Range<usize>| spread(&data.reading[r.clone()]).1;
    let windows = (0..=8).map(|i| data.hull.start + (data.hull.len() - STRETCH) * i / 8).map(|a| a..a + STRETCH);
    let hull = windows.max_by(|a, b| power(a).total_cmp(&power(b)))?;
    let (fitted, validation) = interleaved(std::slice::from_ref(&hull));
    Some(Data { hull, train: fitted, test: validation.clone(), validation, ..data.clone() })
}

/// Every third block apart.
fn interleaved(train: &[Range<usize>]) -> (Vec<Range<usize>>, Vec<Range<usize>>) {
    let total: usize = train.iter().map(Range::len).sum();
    let block = (total / BLOCKS).max(1);
    let (mut fitted, mut validation) = (Vec::new(), Vec::new());
    let mut index = 0;
    for range in train {
        let count = (range.len() / block).max(1);
        for b in 0..count {
            let r = range.start + range.len() * b / count..range.start + range.len() * (b + 1) / count;
            if index % 3 == 1 {
                validation.push(r)
            } else {
                fitted.push(r)
            }
            index += 1;
        }
    }
    (merged(fitted), validation)
}

/// Two other ways to part the samples that are fitted and validated: halves of what is fitted judge in turn.
pub fn turned(data: &Data) -> [(Stretches, Stretches); 2] {
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for r in &data.train {
        let middle = usize::midpoint(r.start, r.end);
        first.push(r.start..middle);
        second.push(middle..r.end);
    }
    let with_validation = |half: &Stretches| {
        let mut all: Stretches = half.iter().chain(&data.validation).cloned().collect();
        all.sort_by_key(|r| r.start);
        merged(all)
    };
    let trains = [with_validation(&second), with_validation(&first)];
    let [a, b] = trains;
    [(a, first), (b, second)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_taken_apart_without_loss() {
        let one = |r: Range<usize>| std::slice::from_ref(Box::leak(Box::new(r)));
        assert_eq!(minus(&[0..10, 20..30], one(5..25)), vec![0..5, 25..30]);
        assert_eq!(minus(one(0..10), one(20..25)), one(0..10));
        let (fitted, validation) = interleaved(one(0..1200));
        assert_eq!(fitted.iter().chain(&validation).map(Range::len).sum::<usize>(), 1200);
        assert_eq!(validation.len(), BLOCKS / 3);
    }
}
