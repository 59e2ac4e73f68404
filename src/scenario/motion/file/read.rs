//! Rows of a file of poses, in order of time, in the file's own reference.

use std::path::Path;

use nalgebra::Vector3;

use super::finding::Finding;
use super::layout::Layout;
use super::refusal::{Refusal, refusal};
use super::span::Span;
use crate::error::{Error, Result};
use crate::number::rounded;
use crate::recording::clock::instant::{Instant, unit_by_size};
use crate::recording::clock::stamp::Stamp;
use crate::recording::rows::{Rows, Wanted};
use crate::recording::time_unit::TimeUnit;

/// Content of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// Its number, counted from zero after the header.
    pub row: usize,
    /// Since the file's first pose, s.
    pub time_s: f64,
    /// Position in the file's own reference, m.
    pub position_m: Vector3<f64>,
    /// Numbers of its attitude.
    pub attitude: Vec<f64>,
}

/// Rows of a stretch, and what was found about them.
#[derive(Debug, Clone)]
pub(super) struct Read {
    /// In order of time.
    pub rows: Vec<Row>,
    /// When the file's first pose was, where its stamps say it.
    pub start: Option<Instant>,
    /// Findings that were survived.
    pub findings: Vec<Finding>,
}

/// Reads the rows of a stretch, and one or two beyond each end, so that poses lie on both sides of
/// it.
///
/// # Errors
/// A file that cannot be read, stamps that run backwards, no times.
pub(super) fn rows(path: &Path, layout: &Layout, times: Option<&Path>, span: &Span) -> Result<Read> {
    let fail = |r: Refusal| Error::new(format!("could not read the poses of {}", path.display()), r.cause, r.hint);
    let times = match (&layout.time, times) {
        (Some(_), None) => None,
        (_, Some(times)) => Some(seconds(times)?),
        (None, None) => {
            let cause = format!("a {} file has no times", layout.format.name());
            let hint = format!("give the file that has them: {} = \"times.txt\"", span.key("times"));
            return Err(fail(refusal(cause, hint)));
        }
    };
    let time = if times.is_some() { None } else { layout.time.as_ref().map(|(name, _)| name.as_str()) };
    let mut table = Rows::open_wanted(path, &Wanted { time, columns: &layout.columns, ..Wanted::default() })?;
    let mut values = vec![0.0; layout.columns.len()];
    let mut clock = Clock::new(layout.time.as_ref().and_then(|(_, unit)| *unit));
    let (mut all, mut missing, mut repeated) = (Vec::<Row>::new(), (0, None), (0, None));
    let miss = |count: &mut (usize, Option<usize>), row: usize| {
        count.0 += 1;
        count.1.get_or_insert(row);
    };
    while table.next(&mut values)? {
        let row = table.row();
        let time_s = match &times {
            Some(times) => times.get(row).copied().ok_or_else(|| {
                let cause = format!("row {row} has no time: the file of times has {} rows", times.len());
                fail(refusal(cause, "every pose needs its time"))
            })?,
            None => clock.seconds(table.stamp()?),
        };
        let (position, attitude) = values.split_at(layout.numbers_of_position());
        if !time_s.is_finite()
            || values.iter().any(|x| !x.is_finite())
            // Three angles may all be zero; a quaternion or a matrix of zeros is none.
            || (attitude.len() > 3 && attitude.iter().all(|x| *x == 0.0))
        {
            miss(&mut missing, row);
            continue;
        }
        if let Some(last) = all.last() {
            let step = time_s - last.time_s;
            if step < 0.0 {
                let back = rounded(-step, 3);
                let cause = format!("the stamps run backwards: by {back} s from row {} to row {row}", last.row);
                return Err(fail(refusal(cause, "sort the file by time, or split it where the clock was set")));
            }
            if step == 0.0 {
                miss(&mut repeated, row);
                continue;
            }
        }
        all.push(Row { row, time_s, position_m: vector(position), attitude: attitude.to_vec() });
    }
    // All rows are read first: stamps that run backwards say that something is wrong with the file,
    // wherever it is.
    let [from_s, to_s] = span.ends_s(clock.first, all.last().map_or(0.0, |r| r.time_s));
    let from = all.partition_point(|r| r.time_s < from_s).saturating_sub(2);
    let to = (all.partition_point(|r| r.time_s <= to_s) + 2).min(all.len());
    let used = all.get(from..to).unwrap_or_default().to_vec();
    let found = [
        missing.1.map(|first_row| Finding::Dropped { rows: missing.0, first_row }),
        repeated.1.map(|first_row| Finding::Repeated { rows: repeated.0, first_row }),
    ];
    if missing.0 > all.len() {
        let cause = format!("{} rows hold no pose (NaN or empty), {} do", missing.0, all.len());
        return Err(fail(refusal(cause, "are these the right columns, and is the file whole?")));
    }
    Ok(Read { rows: used, start: clock.first, findings: found.into_iter().flatten().collect() })
}

/// Three numbers, or none where the file has none.
fn vector(numbers: &[f64]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| numbers.get(i).copied().unwrap_or_default())
}

/// Stamps to seconds since the first of them.
struct Clock {
    unit: Option<TimeUnit>,
    first: Option<Instant>,
}

impl Clock {
    fn new(unit: Option<TimeUnit>) -> Self {
        Self { unit, first: None }
    }

    fn seconds(&mut self, stamp: Stamp) -> f64 {
        if stamp.is_missing() {
            return f64::NAN;
        }
        let at = Instant::new(stamp, *self.unit.get_or_insert_with(|| unit_by_size(&stamp)));
        at.since(self.first.get_or_insert(at))
    }
}

/// A file of times alone, one in each row, s; since the first.
fn seconds(path: &Path) -> Result<Vec<f64>> {
    let mut table = Rows::open(path, &["1".to_owned()])?;
    let (mut all, mut value) = (Vec::new(), [0.0]);
    while table.next(&mut value)? {
        all.push(value[0]);
    }
    let first = all.first().copied().unwrap_or_default();
    Ok(all.into_iter().map(|t| t - first).collect())
}
