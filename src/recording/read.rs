//! A recording into memory, on a uniform clock: the second pass over the file.

use std::io::Write as _;
use std::ops::Range;
use std::path::Path;

use super::clock::place::{Place, Placer};
use super::clock::{Clock, Kind, Question, resample};
use super::clock_column;
use super::dropped::{Reason, Tally};
use super::finding::{self, Finding, Uneven};
use super::in_memory::{Averaged, Column, Recording};
use super::limits::FILL_LIMIT;
use super::plan::{self, Plan};
use super::repeats::{Meaning, Repeats};
use super::request::Request;
use super::series::{Keep, Series};
use super::walk::{Next, walk};
use crate::error::{Error, Result};
use crate::escape;
use crate::numerics::order;

/// A gap is long when it lasts this share of the rows, and this many samples.
const LONG_GAP: (f64, f64) = (0.01, 10.0);
/// A recording that takes more than this is announced, bytes.
const MUCH_MEMORY: usize = 400 << 20;

/// Reads the columns asked for onto a uniform clock.
///
/// Missing cells and short gaps are filled by straight lines, repeated rows dropped, uneven clocks
/// resampled; at a long gap (more than 1 % of the rows) the longer part is kept. Each is said in
/// `findings`, rows not used stand in `dropped`.
///
/// # Errors
/// A file that cannot be read as a table of numbers, a column that is not there (the nearest is
/// named), a clock that cannot be gone by (`clock::judge`), a clock and a rate that disagree, or
/// more than 5 % of the values missing.
pub fn read(path: &Path, request: &Request) -> Result<Recording> {
    let (request, clock) = &clock_column::settled(path, request)?;
    let mut plan = plan::make(path, request, true)?;
    plan.findings.splice(..0, clock.clone());
    let used = plan.rows.clone();
    if let Some((part, finding)) = plan.clock.as_ref().and_then(|c| longest_part(c, &plan.rows)) {
        plan.samples = plan.samples.min(part.len());
        plan.rows = part;
        plan.findings.push(finding);
    }
    let mut table = plan::open(path, request)?;
    let mut gathered = Gathered::new(table.names(), request, &plan);
    announce(path, &gathered, table.names().len());
    let mut row = vec![f64::NAN; table.names().len()];
    let mut placer = plan.clock.as_ref().map(Placer::new);
    let mut repeats = plan.repeated.map(|repeated| (repeated.meaning, Repeats::default()));
    let heading = table.time().unwrap_or_default().to_owned();
    let question = Question { path, heading: &heading, rate_hz: request.rate_hz };
    walk(path, &request.control, &mut table, &plan.rows, |table| {
        let index = table.row();
        let place = match &mut placer {
            Some(placer) => {
                placer.place(index, table.stamp()?, table.is_alike()).map_err(|back| question.set_back(&back))?
            }
            None => Place::Kept { missing: 0, elapsed_s: 0.0 },
        };
        table.values(&mut row)?;
        let repeated = repeats.as_mut().is_some_and(|(_, repeats)| repeats.push(&row));
        match (place, repeats.as_ref().filter(|_| repeated).map(|r| r.0)) {
            (Place::Dropped(reason), _) => gathered.dropped.add(reason, index),
            (_, Some(Meaning::WrittenTwice)) => gathered.dropped.add(Reason::WrittenTwice, index),
            (_, Some(Meaning::Lost)) => {
                gathered.dropped.add(Reason::HoldsPlace, index);
                gathered.hold_place();
            }
            (Place::Kept { missing, elapsed_s }, None) => gathered.push(index, missing, elapsed_s, &row),
        }
        Ok(Next::Go)
    })?;
    let (names, units) = (table.names().to_vec(), table.units().to_vec());
    let source = table.finish()?;
    plan::check_end(path, request, &plan, &source)?;
    let mut dropped = std::mem::take(&mut gathered.dropped);
    let inside = used.start.min(source.rows)..used.end.min(source.rows);
    let part = plan.rows.start.max(inside.start)..plan.rows.end.min(inside.end);
    dropped.add_all(Reason::BeyondGap, inside.start..part.start);
    dropped.add_all(Reason::BeyondGap, part.end..inside.end);
    plan::drop_outside(&mut dropped, request, &used, source.rows);
    dropped.join(&source.dropped);
    if gathered.kept < 2 {
        return Err(plan::too_few(path, gathered.kept));
    }
    let mut findings = source.findings;
    findings.append(&mut plan.findings);
    findings.extend(plan::cut_finding(request, &used, source.rows));
    let dropped = dropped.all();
    findings.extend(dropped.iter().filter(|d| plan::is_said(d)).map(|d| Finding::Dropped(*d)));
    let mut series = gathered.finish(path, &plan, &mut findings)?;
    let filled_by_column: Vec<Vec<Range<usize>>> = series.iter_mut().map(|s| std::mem::take(&mut s.filled)).collect();
    let mut filled = filled_by_column.concat();
    order::sort_by_key(&mut filled, |r| r.start as f64);
    filled.dedup();
    for one in &series {
        findings.extend(one.watch.findings());
    }
    finding::settle(&mut findings);
    let first_sample = request.samples.as_ref().map_or(0, |s| s.start.min(series.first().map_or(0, Series::total)));
    let averaged = (series.first().map_or(1, |s| s.together()) > 1).then(|| Averaged {
        together: series[0].together(),
        samples: series[0].kept(),
        steps: series.iter().map(|s| s.watch.step()).collect(),
    });
    let columns = names.into_iter().zip(series).map(|(name, s)| Column { name, values: s.values }).collect();
    Ok(Recording {
        path: path.into(),
        sha256: source.sha256,
        rows: source.rows,
        dropped,
        first_row: plan.rows.start,
        first_sample,
        rate_hz: plan.rate_hz,
        columns,
        units,
        averaged,
        findings,
        filled,
        filled_by_column,
    })
}

/// Says beforehand what a recording will take that is not averaged.
fn announce(path: &Path, gathered: &Gathered, columns: usize) {
    let bytes = gathered.keep.expected * columns * size_of::<f64>();
    if bytes > MUCH_MEMORY {
        let sentence = format!(
            "reading {}: {} samples of {columns} columns are held in memory, {:.1} GB",
            path.display(),
            gathered.keep.expected,
            bytes as f64 / 1e9
        );
        // Where nobody can be told, the reading goes on.
        let _ = writeln!(std::io::stderr(), "{}", escape::terminal(&sentence));
    }
}

/// Rows on their way into columns.
struct Gathered {
    keep: Keep,
    series: Vec<Series>,
    dropped: Tally,
    /// Samples with and without a row.
    samples: usize,
    kept: usize,
    missing: usize,
    gaps: usize,
    /// Set where the clock is uneven: times, and columns as they are in the file.
    uneven: Option<(Vec<f64>, Vec<Vec<f64>>)>,
}

impl Gathered {
    fn new(names: &[String], request: &Request, plan: &Plan) -> Self {
        let window = request.samples.clone().unwrap_or(0..usize::MAX);
        let samples = plan.samples.min(window.end).saturating_sub(window.start);
        let together = request.at_most.map_or(1, |most| samples.div_ceil(most.max(1)).max(1));
        // Vectors that double their room would take up to three times what a long recording needs.
        let expected = (samples + samples / 50) / together + 1;
        let keep = Keep { window, together, expected };
        let uneven = matches!(plan.clock, Some(Clock { kind: Kind::Uneven { .. }, .. }));
        Self {
            series: names.iter().map(|n| Series::new(n, &keep).slow(request.slow.contains(n))).collect(),
            keep,
            dropped: Tally::default(),
            samples: 0,
            kept: 0,
            missing: 0,
            gaps: 0,
            uneven: uneven.then(|| (Vec::new(), vec![Vec::new(); names.len()])),
        }
    }

    fn push(&mut self, row: usize, missing: usize, elapsed_s: f64, values: &[f64]) {
        self.kept += 1;
        if missing > 0 {
            self.missing = self.missing.saturating_add(missing);
            self.gaps += 1;
        }
        if let Some((times, columns)) = &mut self.uneven {
            times.push(elapsed_s);
            columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
            return;
        }
        // A log in bursts may lack thousands of samples for every row; it is refused at the end,
        // and not filled before.
        if self.missing <= self.kept {
            (0..missing).for_each(|_| self.hold_place());
        }
        if !self.keep.window.contains(&self.samples) {
            self.dropped.add(Reason::OutsideSplit, row);
        }
        self.samples += 1;
        self.series.iter_mut().zip(values).for_each(|(series, value)| series.push(*value));
    }

    /// A sample without a row.
    fn hold_place(&mut self) {
        self.samples += 1;
        self.series.iter_mut().for_each(Series::push_hole);
    }

    fn finish(mut self, path: &Path, plan: &Plan, findings: &mut Vec<Finding>) -> Result<Vec<Series>> {
        let ticks = self.kept + self.missing;
        if self.missing as f64 > FILL_LIMIT * ticks as f64 {
            return Err(Error::new(
                format!("could not assign times to {}", path.display()),
                format!("{} of {ticks} samples are missing, in {} gaps", self.missing, self.gaps),
                "use a stretch without gaps: --from-s, --to-s, or rows = [[a, b]] in the model",
            ));
        }
        if self.missing > 0 {
            findings.push(Finding::GapsFilled { samples: self.missing, gaps: self.gaps });
        }
        if let (Some((times, columns)), Some(clock)) = (self.uneven.take(), &plan.clock) {
            self.even_out(&times, columns, clock, findings);
        }
        for series in &mut self.series {
            findings.extend(series.finish(path)?);
        }
        Ok(self.series)
    }

    fn even_out(&mut self, times_s: &[f64], mut columns: Vec<Vec<f64>>, clock: &Clock, findings: &mut Vec<Finding>) {
        let tick_s = 1.0 / clock.rate_hz;
        self.series.iter_mut().zip(&mut columns).for_each(|(series, column)| series.bridge(column));
        let even = resample::near_even(times_s, tick_s) && resample::samples_are_even(times_s, tick_s, &columns);
        let treatment = if even { Uneven::SamplesEven } else { Uneven::Resampled };
        if let Kind::Uneven { share } = clock.kind {
            findings.push(Finding::UnevenClock { share, rate_hz: clock.rate_hz, treatment });
        }
        for (series, column) in self.series.iter_mut().zip(columns) {
            let values = if even { column } else { resample::even(times_s, tick_s, &column) };
            values.iter().for_each(|v| series.push(*v));
            if !even {
                series.filled.extend(resample::gaps(times_s, tick_s));
            }
        }
    }
}

/// The rows of the longest part between long gaps, if there are any.
fn longest_part(clock: &Clock, rows: &Range<usize>) -> Option<(Range<usize>, Finding)> {
    let limit = clock.tick * (LONG_GAP.0 * clock.stamped as f64).max(LONG_GAP.1);
    let seconds = clock.unit.seconds();
    let long: Vec<_> = clock.breaks.iter().filter(|b| b.step > limit).collect();
    let first = long.first()?;
    let mut parts = Vec::with_capacity(long.len() + 1);
    let (mut from, mut stamped, mut from_s) = (rows.start, 0, 0.0);
    for gap in &long {
        parts.push((from..gap.row, gap.stamped - stamped, from_s));
        (from, stamped, from_s) = (gap.row, gap.stamped, (gap.after + gap.step) * seconds);
    }
    parts.push((from..rows.end, clock.stamped - stamped, from_s));
    // Of equally long ones the first.
    let (part, used, from_s) = parts.into_iter().rev().max_by_key(|p| p.1).filter(|p| p.1 >= 2)?;
    let finding = Finding::LongGaps {
        gaps: long.len(),
        first_s: first.step * seconds,
        after_s: first.after * seconds,
        rows: used,
        of: clock.stamped,
        from_s,
    };
    Some((part, finding))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what comes of a file with a time column `t` and one channel that follows it.
    fn judge(heading: &str, times: &[f64], rate_hz: Option<f64>) -> Result<Recording> {
        let lines: String = times.iter().map(|t| format!("{t},{}\n", (3.0 * t).sin())).collect();
        from(&format!("{heading},a\n{lines}"), heading, rate_hz)
    }

    fn from(text: &str, heading: &str, rate_hz: Option<f64>) -> Result<Recording> {
        let file = tempfile::NamedTempFile::new().expect("file");
        std::fs::write(file.path(), text).expect("write");
        let (columns, time) = (vec!["a".into()], Some(heading.into()));
        let recording = read(file.path(), &Request { columns, rate_hz, time, ..Request::default() })?;
        let dropped: usize = recording.dropped.iter().map(|d| d.rows).sum();
        assert!(dropped < recording.rows && recording.rows == text.lines().count() - 1);
        Ok(recording)
    }

    fn even(count: usize) -> Vec<f64> {
        (0..count).map(|i| (500 + i) as f64 / 100.0).collect()
    }

    #[test]
    fn an_even_clock_passes_untouched() {
        let recording = judge("t", &even(1000), Some(100.0)).expect("even");
        assert!((recording.rate_hz - 100.0).abs() < 1e-6 && recording.findings.is_empty(), "{:?}", recording.findings);
        assert_eq!(recording.columns[0].values, even(1000).iter().map(|t| (3.0 * t).sin()).collect::<Vec<f64>>());
    }

    #[test]
    fn a_short_gap_is_filled_by_a_straight_line_and_a_repeat_dropped() {
        let mut times = even(1000);
        times.drain(400..403);
        times.insert(100, times[100]);
        let recording = judge("t", &times, None).expect("survivable");
        assert_eq!((recording.samples(), recording.findings.len()), (1000, 2), "{:?}", recording.findings);
        let off = |(got, t): (&f64, f64)| (got - (3.0 * t).sin()).abs();
        assert!(recording.columns[0].values.iter().zip(even(1000)).map(off).all(|d| d < 2e-3));
        assert_eq!(recording.filled, vec![400..403]);
        assert_eq!(
            recording.dropped,
            [super::super::dropped::Dropped { reason: Reason::WrittenTwice, rows: 1, first_row: 101 }]
        );
    }

    #[test]
    fn at_a_long_gap_the_longer_part_is_kept() {
        let mut times = even(1000);
        times.iter_mut().skip(300).for_each(|t| *t += 60.0);
        let recording = judge("t", &times, None).expect("survivable");
        assert_eq!((recording.samples(), recording.first_row), (700, 300));
        assert!(matches!(recording.findings[0], Finding::LongGaps { rows: 700, of: 1000, .. }));
    }

    #[test]
    fn units_are_recognised_and_a_heading_is_believed() {
        let in_ms: Vec<f64> = even(100).iter().map(|t| t * 1e3).collect();
        let recording = judge("t", &in_ms, Some(100.0)).expect("the rate tells the unit");
        assert!((recording.rate_hz - 100.0).abs() < 1e-6);
        assert!(matches!(recording.findings[0], Finding::TimeUnit { .. }));
        assert!(judge("t_ms", &in_ms, None).expect("named").findings.is_empty());
        assert!(judge("t_s", &in_ms, Some(100.0)).expect_err("wrong heading").hint.contains("ms"));
    }

    #[test]
    fn a_clock_that_runs_backwards_or_stands_still_is_refused_with_its_row() {
        let mut backwards = even(100);
        backwards.swap(50, 51);
        assert!(judge("t", &backwards, None).expect_err("backwards").cause.contains("row 51"));
        let mut stuck = even(5000);
        stuck[1000..].fill(15.0);
        let refused = judge("t", &stuck, None).expect_err("stands still");
        assert!(refused.cause.contains("stands still for 4000 of 5000 rows from data row 1000"), "{refused}");
    }

    #[test]
    fn a_log_in_bursts_is_refused_before_its_gaps_are_filled() {
        // Pairs of rows 500 ticks apart: below the 1 % of the rows that cut a recording, yet 250
        // ticks missing for each row; filled first, they would take gigabytes.
        let times: Vec<f64> = (0..100_000).map(|i| (i / 2 * 501 + i % 2) as f64 / 100.0).collect();
        let refused = judge("t", &times, None).expect_err("nearly all of it is missing");
        assert!(refused.cause.contains("49999 gaps"), "{refused}");
    }

    #[test]
    fn an_uneven_clock_is_resampled_and_said() {
        let times: Vec<f64> = (0..1000).map(|i| f64::from(i) / 10.0 + if i % 3 == 1 { 0.04 } else { 0.0 }).collect();
        let recording = judge("t_s", &times, None).expect("survivable");
        assert!(matches!(recording.findings[0], Finding::UnevenClock { treatment: Uneven::Resampled, .. }));
        // Stamps that a busy logger wrote late, of samples that were not.
        let lines: String =
            times.iter().enumerate().map(|(i, t)| format!("{t},{}\n", (0.4 * i as f64).sin())).collect();
        let recording = from(&format!("t_s,a\n{lines}"), "t_s", None).expect("survivable");
        assert!(matches!(recording.findings[0], Finding::UnevenClock { treatment: Uneven::SamplesEven, .. }));
    }
}
