//! A recording too long to be fitted at once: its loudest stretch stands for the whole, and that is
//! reported.
//!
//! A model's errors and their derivatives are held in memory, some kilobytes per sample; and what
//! half a million samples cannot show, more of the same will hardly show. Ranges that a model file
//! names are kept as far as they lie in that stretch and next to it. Not for what is wrong with
//! such ranges: they are left to be refused (`prepare`).

use std::ops::Range;

use crate::model;
use crate::numerics::moments::mean_sd;
use crate::recording::{Column, Recording};

use super::input::REACH;
use super::stretches::{Stretches, merged, minus, sorted};

/// Most samples that are fitted at once, and that judge.
pub(crate) const LONGEST: usize = 500_000;
/// Places of the stretch that are compared.
const PLACES: usize = 32;

/// Part of a recording, as a recording of its own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub recording: Recording,
    /// The model, its ranges counted from the first of them.
    pub model: model::Driven,
    /// A sentence about what was kept.
    pub said: String,
    /// Doubt that a reader of the verdict must know, where ranges that the model names were not
    /// used whole.
    pub doubt: Option<String>,
}

/// Returns the part of a long recording that is judged; `None` where it can be used whole.
pub(super) fn excerpt(recording: &Recording, model: &model::Driven) -> Option<Part> {
    let samples = recording.samples();
    let split = &model.split;
    let named = !(split.train.is_empty() && split.test.is_empty());
    if samples <= LONGEST || split.train.iter().chain(&split.test).any(|[from, to]| from >= to || *to > samples) {
        return None;
    }
    let test = merged(sorted(&split.test));
    let train = if split.train.is_empty() {
        minus(std::slice::from_ref(&(0..samples)), &test)
    } else {
        merged(sorted(&split.train))
    };
    let span = hull(&train)?;
    if span.len().max(length(&test)) <= LONGEST || minus(&test, &train) != test {
        return None;
    }
    let reading = recording.column(&model.columns.output)?;
    let fitted = within(&train, &loudest(reading, &train, span)?);
    let judging = nearest(&test, &hull(&fitted)?);
    let mut kept = hull(&[fitted.as_slice(), judging.as_slice()].concat())?;
    if named {
        // The ends of a recording are not fitted.
        kept = kept.start.saturating_sub(REACH)..(kept.end + REACH).min(samples);
    }
    let part = cut(recording, &kept);
    let (said, doubt) = if named {
        let of = |used: &Stretches, all: &Stretches| format!("{} of {}", length(used), length(all));
        let places =
            |all: &Stretches| all.iter().map(|r| format!("[{}, {})", r.start, r.end)).collect::<Vec<_>>().join(", ");
        let mut clause = format!("of [split] only {} samples were fitted", of(&fitted, &train));
        let mut places_used = format!("fitted were {}", places(&fitted));
        if !test.is_empty() {
            clause += &format!(" and {} used for validation", of(&judging, &test));
            places_used += &format!(", and {} for validation", places(&judging));
        }
        let said = format!(
            "{clause}, the loudest {LONGEST} in a row and as many next to them: {places_used}; samples and times count from sample {}",
            kept.start
        );
        (said, Some(clause))
    } else {
        let said = format!(
            "of {samples} samples the loudest {LONGEST} in a row were used, from sample {}; samples and times count \
            from there",
            kept.start
        );
        (said, None)
    };
    let moved = |all: Stretches| all.iter().map(|r| [r.start - kept.start, r.end - kept.start]).collect();
    let mut model = model.clone();
    if named {
        model.split = model::Split { train: moved(fitted), test: moved(judging) };
    }
    Some(Part { recording: part, model, said, doubt })
}

/// The stretch of the longest length within `span` in which the samples to be fitted hold most
/// power.
fn loudest(reading: &[f64], train: &Stretches, span: Range<usize>) -> Option<Range<usize>> {
    if span.len() <= LONGEST {
        return Some(span);
    }
    let windows = (0..PLACES).map(|i| span.start + (span.len() - LONGEST) * i / (PLACES - 1)).map(|a| a..a + LONGEST);
    let power = |window: &Range<usize>| {
        let rows: Vec<f64> = within(train, window).into_iter().flat_map(|r| &reading[r]).copied().collect();
        mean_sd(&rows).1.powi(2) * rows.len() as f64
    };
    windows.max_by(|a, b| power(a).total_cmp(&power(b)))
}

/// Returns as many samples as may judge, those nearest to what is fitted.
fn nearest(test: &Stretches, fitted: &Range<usize>) -> Stretches {
    let about = |reach: usize| within(test, &(fitted.start.saturating_sub(reach)..fitted.end.saturating_add(reach)));
    let (mut least, mut most) = (0, test.last().map_or(0, |r| r.end).max(fitted.start) + 1);
    if length(test) <= LONGEST {
        return test.clone();
    }
    while most - least > 1 {
        let middle = usize::midpoint(least, most);
        if length(&about(middle)) <= LONGEST { least = middle } else { most = middle }
    }
    about(least)
}

fn length(all: &Stretches) -> usize {
    all.iter().map(Range::len).sum()
}

fn hull(all: &[Range<usize>]) -> Option<Range<usize>> {
    Some(all.iter().map(|r| r.start).min()?..all.iter().map(|r| r.end).max()?)
}

/// Returns the part of `all` that lies in `window`.
fn within(all: &[Range<usize>], window: &Range<usize>) -> Stretches {
    let inside = |r: &Range<usize>| r.start.max(window.start)..r.end.min(window.end);
    all.iter().map(inside).filter(|r| r.start < r.end).collect()
}

fn cut(recording: &Recording, range: &Range<usize>) -> Recording {
    let of = |c: &Column| Column { name: c.name.clone(), values: c.values[range.clone()].to_vec() };
    let part = |filled: &Vec<Range<usize>>| -> Stretches {
        within(filled, range).into_iter().map(|f| f.start - range.start..f.end - range.start).collect()
    };
    Recording {
        path: recording.path.clone(),
        sha256: recording.sha256.clone(),
        rows: recording.rows,
        dropped: recording.dropped.clone(),
        first_row: recording.first_row,
        first_sample: recording.first_sample + range.start,
        rate_hz: recording.rate_hz,
        columns: recording.columns.iter().map(of).collect(),
        units: recording.units.clone(),
        averaged: None,
        findings: recording.findings.clone(),
        filled: part(&recording.filled),
        filled_by_column: recording.filled_by_column.iter().map(part).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driven(split: &str) -> model::Driven {
        match toml::from_str(&format!("rate_hz = 1.0\n[columns]\noutput = 'y'\n{split}")) {
            Ok(model) => model,
            Err(error) => unreachable!("{error}"),
        }
    }

    /// Louder towards its end.
    fn recording(samples: usize) -> Recording {
        Recording {
            path: "y.csv".into(),
            rate_hz: 1.0,
            columns: vec![Column {
                name: "y".into(),
                values: (0..samples).map(|k| ((k * k) % 977) as f64 * k as f64).collect(),
            }],
            filled: vec![0..3, samples - 4..samples - 1],
            ..Recording::default()
        }
    }

    #[test]
    fn the_loud_end_of_a_long_recording_is_taken_and_a_short_one_left_whole() {
        let plain = driven("");
        assert_eq!(excerpt(&recording(LONGEST), &plain), None);
        let long = recording(3 * LONGEST);
        let Some(Part { recording: part, model, said, doubt: None }) = excerpt(&long, &plain) else {
            unreachable!("used whole")
        };
        assert_eq!(part.columns[0].values, long.columns[0].values[2 * LONGEST..]);
        assert_eq!(part.filled, vec![LONGEST - 4..LONGEST - 1]);
        assert!(said.contains("from sample 1000000"), "{said}");
        assert_eq!(model, plain);
    }

    #[test]
    fn named_ranges_are_cut_to_what_memory_holds_and_short_or_wrong_ones_left_alone() {
        let long = recording(3 * LONGEST);
        for left in [
            "train = [[0, 9]]",
            "train = [[0, 500000]]\ntest = [[1000000, 1500000]]",
            "train = [[0, 600000]]\ntest = [[500000, 1500000]]",
            "train = [[0, 600000]]\ntest = [[600000, 1500001]]",
        ] {
            assert_eq!(excerpt(&long, &driven(&format!("[split]\n{left}\n"))), None, "{left}");
        }
        // Fitted: the loudest window of the first 800,000; judged: what follows it at once.
        let split = driven("[split]\ntrain = [[0, 800000]]\ntest = [[800000, 1500000]]\n");
        let Some(Part { recording: part, model, said, doubt: Some(doubt) }) = excerpt(&long, &split) else {
            unreachable!("used whole")
        };
        assert_eq!(part.samples(), 2 * LONGEST + 2 * REACH);
        assert_eq!(part.columns[0].values, long.columns[0].values[300_000 - REACH..1_300_000 + REACH]);
        assert_eq!(model.split.train, [[REACH, REACH + LONGEST]]);
        assert_eq!(model.split.test, [[REACH + LONGEST, REACH + 2 * LONGEST]]);
        assert_eq!(
            doubt,
            "of [split] only 500000 of 800000 samples were fitted and 500000 of 700000 used for validation"
        );
        assert!(
            said.contains("[300000, 800000), and [800000, 1300000) for validation") && said.contains("299976"),
            "{said}"
        );
        // Two short ranges far from each other span too much: the louder one is fitted.
        let split = driven("[split]\ntrain = [[0, 9000], [1400000, 1409000]]\n");
        let Some(Part { model, recording: part, .. }) = excerpt(&long, &split) else { unreachable!("used whole") };
        assert_eq!((model.split.train, part.samples()), (vec![[REACH, REACH + 9000]], 9000 + 2 * REACH));
    }
}
