//! A recording of any length, sample by sample on a uniform clock: short holes bridged, long ones
//! announced.
//!
//! For what needs a whole column at once, see `recording::read`.

use std::ops::Range;
use std::path::Path;
use std::sync::mpsc::{self, SyncSender};
use std::thread;

use super::clock::place::{Place, Placer};
use super::clock::timeline::SetBack;
use super::clock::{Kind, Question};
use super::clock_column;
use super::dropped::{Dropped, Reason, Tally};
use super::finding::{Finding, Uneven};
use super::limits::FILL_LIMIT;
use super::plan::{self, Plan};
use super::request::Request;
use super::run::Run;
use super::walk::{Next, Passed, walk_runs};
use crate::error::{Error, Result};

/// Holes up to this many samples are bridged by straight lines.
const BRIDGED: usize = 10;
/// Samples handed on at once: what work is divided over threads must outweigh waking them.
const BLOCK: usize = 8192;
/// Blocks read before they are worked on.
const AHEAD: usize = 2;

/// Samples in a row, none missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// One per column, all of one length; NaN where a slow column holds nothing.
    pub columns: Vec<Vec<f64>>,
    /// Per sample the row of the file that holds it, counted from zero after the header; `None`
    /// where a straight line stands in for a row.
    pub rows: Vec<Option<usize>>,
    /// Too much is missing behind them to bridge.
    pub broken_off: bool,
}

/// Holds what is known of a file once it has been streamed.
#[derive(Debug, Clone, PartialEq)]
pub struct Streamed {
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Data rows in the file.
    pub rows: usize,
    /// Rows that were not used, and why.
    pub dropped: Vec<Dropped>,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Samples handed on so far.
    pub samples: usize,
    /// Holds what was found and survived.
    pub findings: Vec<Finding>,
}

/// Opens a file as [`read`] will stream it: the headings of its columns, without the clock, and
/// their units.
///
/// # Errors
/// As `Rows::open`.
pub fn headings(path: &Path, request: &Request) -> Result<(Vec<String>, Vec<Option<String>>)> {
    let (request, _) = clock_column::settled(path, request)?;
    let rows = plan::open(path, &request)?;
    Ok((rows.names().to_vec(), rows.units().to_vec()))
}

/// Streams the columns of `request` into `take`, after a first pass over the clock: one thread
/// reads while this one works on what was read.
///
/// # Errors
/// As [`super::read`](fn@super::read), except that gaps of any length are survived.
pub fn read(path: &Path, request: &Request, mut take: impl FnMut(&Block)) -> Result<Streamed> {
    let (request, clock) = &clock_column::settled(path, request)?;
    let mut plan = plan::make(path, request, false)?;
    plan.findings.splice(..0, clock.clone());
    thread::scope(|scope| {
        let (send, receive) = mpsc::sync_channel(AHEAD);
        let reader = thread::Builder::new()
            .spawn_scoped(scope, move || hand_on(path, request, plan, &send))
            .map_err(|e| Error::io("start a thread that reads", path, &e))?;
        receive.iter().for_each(|block| take(&block));
        reader.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Reads to the end, in blocks.
fn hand_on(path: &Path, request: &Request, plan: Plan, send: &SyncSender<Block>) -> Result<Streamed> {
    let mut table = plan::open(path, request)?;
    let heading = table.time().unwrap_or_default().to_owned();
    let question = Question { path, heading: &heading, rate_hz: request.rate_hz };
    let is_slow: Vec<bool> = table.names().iter().map(|name| request.slow.contains(name)).collect();
    let mut bridge = Bridge::new(is_slow, send);
    let mut placer = plan.clock.as_ref().map(Placer::new);
    let mut row = vec![0.0; table.names().len()];
    let mut dropped = Tally::default();
    walk_runs(path, &request.control, &mut table, &plan.rows, |passed| {
        let table = match passed {
            Passed::Row(table) => table,
            Passed::Run(run) => {
                pass(run, placer.as_mut(), &mut bridge, &mut dropped).map_err(|back| question.set_back(&back))?;
                return Ok(Next::Go);
            }
        };
        if let Some(placer) = &mut placer {
            let place = placer.place(table.row(), table.stamp()?, table.is_alike());
            match place.map_err(|back| question.set_back(&back))? {
                Place::Kept { missing, .. } => bridge.missing = bridge.missing.saturating_add(missing),
                Place::Dropped(reason) => {
                    dropped.add(reason, table.row());
                    return Ok(Next::Go);
                }
            }
        }
        table.values(&mut row)?;
        if !bridge.push(&row, table.row()) {
            dropped.add(Reason::MissingReading, table.row());
        }
        Ok(Next::Go)
    })?;
    bridge.send(false);
    let source = table.finish()?;
    plan::check_end(path, request, &plan, &source)?;
    plan::drop_outside(&mut dropped, request, &plan.rows, source.rows);
    dropped.join(&source.dropped);
    let dropped = dropped.all();
    let mut findings = source.findings;
    findings.extend(plan.findings.iter().cloned());
    findings.extend(plan::cut_finding(request, &plan.rows, source.rows));
    findings.extend(dropped.iter().filter(|d| plan::is_said(d)).map(|d| Finding::Dropped(*d)));
    if let Some(Kind::Uneven { share }) = plan.clock.as_ref().map(|c| c.kind) {
        let treatment = Uneven::TakenAsEven;
        findings.push(Finding::UnevenClock { share, rate_hz: plan.rate_hz, treatment });
    }
    let samples = bridge.given;
    bridge.judge(path, source.rows, &mut findings)?;
    Ok(Streamed { sha256: source.sha256, rows: source.rows, dropped, rate_hz: plan.rate_hz, samples, findings })
}

/// Hands many rows on: as they lie, as far as each is the next sample.
fn pass(
    run: &Run<'_>,
    placer: Option<&mut Placer>,
    bridge: &mut Bridge<'_>,
    dropped: &mut Tally,
) -> Result<(), SetBack> {
    let Some(placer) = placer else {
        bridge.push_run(run, run.rows.clone(), dropped);
        return Ok(());
    };
    let mut from = run.rows.start;
    for at in run.rows.clone() {
        let row = run.first + at - run.rows.start;
        let place = placer.place(row, run.stamp(at), run.is_alike(at))?;
        if matches!(place, Place::Kept { missing: 0, .. }) {
            continue;
        }
        bridge.push_run(run, from..at, dropped);
        from = at;
        match place {
            Place::Kept { missing, .. } => bridge.missing = bridge.missing.saturating_add(missing),
            Place::Dropped(reason) => {
                dropped.add(reason, row);
                from = at + 1;
            }
        }
    }
    bridge.push_run(run, from..run.rows.end, dropped);
    Ok(())
}

/// Bridges short holes, announces long ones and hands blocks on.
struct Bridge<'a> {
    send: &'a SyncSender<Block>,
    columns: Vec<Vec<f64>>,
    /// Columns that may be written in a few rows only.
    is_slow: Vec<bool>,
    rows: Vec<Option<usize>>,
    last: Vec<f64>,
    missing: usize,
    given: usize,
    filled: usize,
    bridges: usize,
    breaks: usize,
}

impl<'a> Bridge<'a> {
    fn new(is_slow: Vec<bool>, send: &'a SyncSender<Block>) -> Self {
        let (columns, last) = (vec![Vec::new(); is_slow.len()], vec![0.0; is_slow.len()]);
        Self { send, columns, is_slow, rows: Vec::new(), last, missing: 0, given: 0, filled: 0, bridges: 0, breaks: 0 }
    }

    /// The next row and its number; false where it lacks a reading and was not used.
    fn push(&mut self, values: &[f64], row: usize) -> bool {
        if values.iter().zip(&self.is_slow).any(|(v, slow)| v.is_nan() && !slow) {
            self.missing = self.missing.saturating_add(1);
            return false;
        }
        if self.given > 0 && self.missing > BRIDGED {
            self.breaks += 1;
            self.send(true);
        } else if self.given > 0 {
            for k in 1..=self.missing {
                let share = k as f64 / (self.missing + 1) as f64;
                for ((column, from), value) in self.columns.iter_mut().zip(&self.last).zip(values) {
                    column.push(from + share * (value - from));
                }
            }
            self.rows.extend(std::iter::repeat_n(None, self.missing));
            self.filled += self.missing;
            self.bridges += usize::from(self.missing > 0);
            self.given += self.missing;
        }
        self.missing = 0;
        self.given += 1;
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
        self.rows.push(Some(row));
        self.last.copy_from_slice(values);
        self.send_full();
        true
    }

    /// The rows of a part of a run; those that lack a reading are not used.
    fn push_run(&mut self, run: &Run<'_>, part: Range<usize>, dropped: &mut Tally) {
        let mut row = vec![0.0; run.columns.len()];
        let mut from = part.start;
        while from < part.end {
            let to = part.end.min(from + BLOCK - self.columns.first().map_or(0, Vec::len));
            let needed = || run.columns.iter().zip(&self.is_slow).filter(|(_, slow)| !**slow);
            let is_whole = |row: &usize| needed().all(|(column, _)| !column[*row].is_nan());
            let to = if self.missing == 0 { (from..to).find(|row| !is_whole(row)).unwrap_or(to) } else { from };
            if to > from {
                for ((column, last), values) in self.columns.iter_mut().zip(&mut self.last).zip(run.columns) {
                    column.extend_from_slice(&values[from..to]);
                    *last = values[to - 1];
                }
                let number = |at: usize| run.first + at - run.rows.start;
                self.rows.extend((from..to).map(|at| Some(number(at))));
                self.given += to - from;
                from = to;
                self.send_full();
                continue;
            }
            row.iter_mut().zip(run.columns).for_each(|(value, column)| *value = column[from]);
            let number = run.first + from - run.rows.start;
            if !self.push(&row, number) {
                dropped.add(Reason::MissingReading, number);
            }
            from += 1;
        }
    }

    /// Hands on a block that is full.
    fn send_full(&mut self) {
        if self.columns.first().is_some_and(|c| c.len() >= BLOCK) {
            self.send(false);
        }
    }

    /// Hands on what has gathered.
    fn send(&mut self, broken_off: bool) {
        let room = self.columns.iter().map(|c| Vec::with_capacity(c.len())).collect();
        let columns = std::mem::replace(&mut self.columns, room);
        let rows = std::mem::take(&mut self.rows);
        // Nobody listens only when the other side has panicked, and then that is what the user
        // hears.
        let _ = self.send.send(Block { columns, rows, broken_off });
    }

    fn judge(self, path: &Path, rows: usize, findings: &mut Vec<Finding>) -> Result<()> {
        let fail =
            |cause: String, hint: &str| Err(Error::new(format!("could not use {}", path.display()), cause, hint));
        if self.given < 2 {
            let hint = "a recording needs at least two rows under its header, and several thousand to be useful";
            return fail(format!("{} of {rows} data rows hold numbers in every column", self.given), hint);
        }
        if self.filled as f64 > FILL_LIMIT * self.given as f64 {
            let cause = format!("{} of {} samples are missing in short gaps", self.filled, self.given);
            return fail(
                cause,
                "cut the recording to a stretch without gaps, or name only the columns that were logged; if the rows \
                 alternate between sensors, write one file per sensor",
            );
        }
        if self.filled > 0 {
            findings.push(Finding::GapsFilled { samples: self.filled, gaps: self.bridges });
        }
        if self.breaks > 0 {
            findings.push(Finding::Breaks { gaps: self.breaks });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_join_to_the_whole_and_break_off_only_at_long_holes() {
        // More rows than two blocks hold; one value is missing in row 9000, more than can be
        // bridged from row 12,000 on.
        let rows = 20_000;
        let lost = |i: usize| i == 9000 || (12_000..12_000 + BRIDGED + 1).contains(&i);
        let lines: String = (0..rows).map(|i| if lost(i) { "\"\"\n".to_owned() } else { format!("{i}\n") }).collect();
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("log.csv");
        std::fs::write(&path, format!("a\n{lines}")).expect("write");
        let request = Request { rate_hz: Some(100.0), columns: vec!["a".into()], ..Request::default() };
        let mut parts = vec![Vec::new()];
        let mut of_row = Vec::new();
        let streamed = read(&path, &request, |block| {
            of_row.extend_from_slice(&block.rows);
            parts.last_mut().expect("one at least").extend_from_slice(&block.columns[0]);
            if block.broken_off {
                parts.push(Vec::new());
            }
        })
        .expect("a log with holes is read");
        let whole = |range: std::ops::Range<usize>| range.map(|i| i as f64).collect::<Vec<f64>>();
        assert_eq!(parts, [whole(0..12_000), whole(12_000 + BRIDGED + 1..rows)], "a straight line bridges row 9000");
        // Every value is the number of its row.
        let values = parts.concat();
        let told = |(row, value): (&Option<usize>, &f64)| row.map_or(*value == 9000.0, |row| row as f64 == *value);
        assert!(of_row.len() == values.len() && of_row.iter().zip(&values).all(told));
        assert_eq!((streamed.samples, streamed.rate_hz), (rows - BRIDGED - 1, 100.0));
        assert_eq!(streamed.findings.len(), 3, "{:?}", streamed.findings);
        let lost: usize = streamed.dropped.iter().map(|d| d.rows).sum();
        assert_eq!((streamed.rows, lost), (rows, BRIDGED + 2));
    }

    // More than a megabyte, so that its rows are parsed in pieces; with every cell in quotation
    // marks they are read one by one.
    #[test]
    fn rows_that_lack_a_reading_are_the_same_in_pieces_and_one_by_one() {
        let folder = tempfile::tempdir().expect("folder");
        let lost = |i: usize| i % 9001 == 7 || (60_000..60_200).contains(&i);
        let read_as = |mark: &str, odd: usize| {
            let cell = |i: usize| if lost(i) { String::new() } else { format!("{mark}0.{:06}{mark}", i + odd) };
            let lines: String = (0..90_000).map(|i| format!("{mark}{i}.25{mark},{}\n", cell(i))).collect();
            let path = folder.path().join("log.csv");
            std::fs::write(&path, format!("a,b\n{lines}")).expect("write");
            let columns = vec!["a".into(), "b".into()];
            let request = Request { rate_hz: Some(100.0), columns, ..Request::default() };
            let mut all: Vec<(bool, Vec<f64>)> = Vec::new();
            let streamed = read(&path, &request, |block| all.push((block.broken_off, block.columns.concat())));
            let streamed = streamed.expect("a log with holes is read");
            let joined: Vec<u64> = all.iter().flat_map(|(_, values)| values).map(|v| v.to_bits()).collect();
            let breaks = all.iter().filter(|(broken, _)| *broken).count();
            (streamed.rows, streamed.samples, streamed.dropped, breaks, joined)
        };
        let pieces = read_as("", 0);
        assert!(pieces == read_as("\"", 0), "{:?}", (pieces.0, pieces.1, pieces.2, pieces.3));
        assert!(pieces != read_as("\"", 1), "control: other numbers are another recording");
    }
}
