//! A recording of any length, sample by sample on a uniform clock: short holes bridged, long ones announced.
//!
//! For what needs a whole column at once, see `recording::read`.

use std::path::Path;
use std::sync::mpsc::{self, SyncSender};
use std::thread;

use super::rows::Rows;
use super::{FILL_LIMIT, Request, checked_rate};
use crate::error::{Error, Result};
use crate::progress;
use crate::signal;

/// Holes up to this many samples are bridged by straight lines.
const BRIDGED: usize = 10;
/// Samples handed on at once: what work is divided over threads must outweigh waking them.
const BLOCK: usize = 8192;
/// Blocks read before they are worked on.
const AHEAD: usize = 2;
/// Rows looked at to learn the rate from a time column.
const LOOKED_AT: usize = 1000;

/// Samples in a row, none missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// One per column, all of one length.
    pub columns: Vec<Vec<f64>>,
    /// Too much is missing behind them to bridge.
    pub broken_off: bool,
}

/// What is known of a file once it has been streamed.
#[derive(Debug, Clone, PartialEq)]
pub struct Streamed {
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Sampling rate.
    pub rate_hz: f64,
    /// Samples given.
    pub samples: usize,
    /// What was found and survived.
    pub findings: Vec<String>,
}

/// Opens a file as [`read`] will stream it: the headings of its columns, without the clock.
///
/// # Errors
/// As [`Rows::open`].
pub fn headings(path: &Path, request: &Request) -> Result<Vec<String>> {
    let names = Rows::open(path, &request.columns)?.names().to_vec();
    Ok(names.into_iter().filter(|n| Some(n) != request.time.as_ref()).collect())
}

/// Streams the columns of `request` (`rows` is ignored) into `take`: one thread reads while this one works on what was read.
///
/// # Errors
/// As [`super::read`], except that gaps of any length are survived.
pub fn read(path: &Path, request: &Request, mut take: impl FnMut(&Block)) -> Result<Streamed> {
    let mut wanted = headings(path, request)?;
    wanted.splice(0..0, request.time.clone());
    let timed = request.time.is_some();
    let rate_hz = match timed {
        true => rate_of(path, &wanted, request.rate_hz)?,
        false => checked_rate(path, request.rate_hz)?,
    };
    let reading = Reading { path, table: Rows::open(path, &wanted)?, rate_hz, timed };
    thread::scope(|scope| {
        let (send, receive) = mpsc::sync_channel(AHEAD);
        let reader = thread::Builder::new()
            .spawn_scoped(scope, move || hand_on(reading, &send))
            .map_err(|e| Error::io("start a thread that reads", path, &e))?;
        receive.iter().for_each(|block| take(&block));
        reader.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// A file about to be read.
struct Reading<'a> {
    path: &'a Path,
    table: Rows,
    rate_hz: f64,
    /// Its first column is the clock.
    timed: bool,
}

/// Reads to the end, in blocks.
fn hand_on(reading: Reading<'_>, send: &SyncSender<Block>) -> Result<Streamed> {
    let Reading { path, mut table, rate_hz, timed } = reading;
    let mut clock = timed.then_some(Clock { rate_hz, before: None, repeats: 0 });
    let mut row = vec![0.0; table.names().len()];
    let mut bridge = Bridge::new(row.len() - usize::from(timed), send);
    let bar = progress::bar("reading", table.length_bytes());
    let mut index = 0usize;
    while table.next(&mut row)? {
        index += 1;
        if index.is_multiple_of(65_536) {
            bar.set_position(table.bytes_read());
            if signal::interrupted() {
                return Err(Error::interrupted(format!("could not read {}", path.display()), "start it again"));
            }
        }
        let values = match &mut clock {
            None => &row[..],
            Some(clock) => {
                match clock.missing(row[0]).map_err(|e| e.at(path, index))? {
                    None => continue,
                    Some(missing) => bridge.missing += missing,
                }
                &row[1..]
            }
        };
        bridge.push(values);
    }
    bridge.send(false);
    bar.finish_and_clear();
    let source = table.finish()?;
    let mut findings = source.findings;
    if let Some(clock) = clock.filter(|c| c.repeats > 0) {
        findings.push(format!("{} rows repeat the time stamp before them and were dropped", clock.repeats));
    }
    let samples = bridge.given;
    bridge.judge(path, index, &mut findings)?;
    Ok(Streamed { sha256: source.sha256, rate_hz, samples, findings })
}

fn rate_of(path: &Path, wanted: &[String], stated: Option<f64>) -> Result<f64> {
    let mut table = Rows::open(path, wanted)?;
    let mut row = vec![0.0; wanted.len()];
    let mut times = Vec::with_capacity(LOOKED_AT);
    while times.len() < LOOKED_AT && table.next(&mut row)? {
        times.push(row[0]);
    }
    let found = super::clock::ticks(path, &times, stated)?.rate_hz;
    Ok(stated.unwrap_or(found))
}

struct Clock {
    rate_hz: f64,
    before: Option<f64>,
    repeats: usize,
}

struct Backwards {
    from: f64,
    to: f64,
}

impl Backwards {
    fn at(self, path: &Path, row: usize) -> Error {
        Error::new(
            format!("could not place {} in time", path.display()),
            format!("time runs backwards in data row {row}: {} s, then {} s", self.from, self.to),
            "sort the rows, or cut the file where the clock was reset",
        )
    }
}

impl Clock {
    /// Samples missing before this time; `None` for a row to be dropped.
    fn missing(&mut self, time: f64) -> Result<Option<usize>, Backwards> {
        let Some(before) = self.before else {
            self.before = Some(time).filter(|t| !t.is_nan());
            return Ok(self.before.map(|_| 0));
        };
        if time < before {
            return Err(Backwards { from: before, to: time });
        }
        if time == before || time.is_nan() {
            self.repeats += 1;
            return Ok(None);
        }
        self.before = Some(time);
        Ok(Some((((time - before) * self.rate_hz + 0.25).floor() as usize).saturating_sub(1)))
    }
}

/// Bridges short holes, announces long ones and hands blocks on.
struct Bridge<'a> {
    send: &'a SyncSender<Block>,
    columns: Vec<Vec<f64>>,
    last: Vec<f64>,
    missing: usize,
    given: usize,
    filled: usize,
    breaks: usize,
}

impl<'a> Bridge<'a> {
    fn new(width: usize, send: &'a SyncSender<Block>) -> Self {
        let (columns, last) = (vec![Vec::new(); width], vec![0.0; width]);
        Self { send, columns, last, missing: 0, given: 0, filled: 0, breaks: 0 }
    }

    fn push(&mut self, values: &[f64]) {
        if values.iter().any(|v| v.is_nan()) {
            self.missing += 1;
            return;
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
            self.filled += self.missing;
            self.given += self.missing;
        }
        self.missing = 0;
        self.given += 1;
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
        self.last.copy_from_slice(values);
        if self.columns.first().is_some_and(|c| c.len() >= BLOCK) {
            self.send(false);
        }
    }

    /// Hands on what has gathered.
    fn send(&mut self, broken_off: bool) {
        let room = self.columns.iter().map(|c| Vec::with_capacity(c.len())).collect();
        let columns = std::mem::replace(&mut self.columns, room);
        // Nobody listens only when the other side has panicked, and then that is what the user hears.
        let _ = self.send.send(Block { columns, broken_off });
    }

    fn judge(self, path: &Path, rows: usize, findings: &mut Vec<String>) -> Result<()> {
        let fail =
            |cause: String, hint: &str| Err(Error::new(format!("could not use {}", path.display()), cause, hint));
        if self.given < 2 {
            let hint = "a recording needs at least two rows under its header, and some thousands to be worth judging";
            return fail(format!("{} of {rows} data rows hold numbers in every column", self.given), hint);
        }
        if self.filled as f64 > FILL_LIMIT * self.given as f64 {
            let cause = format!("{} of {} samples are missing in short gaps", self.filled, self.given);
            return fail(
                cause,
                "cut the recording to a stretch without gaps, or name only the columns that were logged",
            );
        }
        if self.filled > 0 {
            findings.push(format!("{} missing samples in short gaps were filled by straight lines", self.filled));
        }
        if self.breaks > 0 {
            findings.push(format!("{} long gaps: no averaging time reaches across one", self.breaks));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_join_to_the_whole_and_break_off_only_at_long_holes() {
        // More rows than two blocks hold; one value is missing in row 9000, more than can be bridged from row 12,000 on.
        let rows = 20_000;
        let lost = |i: usize| i == 9000 || (12_000..12_000 + BRIDGED + 1).contains(&i);
        let lines: String = (0..rows).map(|i| if lost(i) { "\"\"\n".to_owned() } else { format!("{i}\n") }).collect();
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("log.csv");
        std::fs::write(&path, format!("a\n{lines}")).expect("write");
        let request = Request { rate_hz: Some(100.0), columns: vec!["a".into()], ..Request::default() };
        let mut parts = vec![Vec::new()];
        let streamed = read(&path, &request, |block| {
            parts.last_mut().expect("one at least").extend_from_slice(&block.columns[0]);
            if block.broken_off {
                parts.push(Vec::new());
            }
        })
        .expect("a log with holes is read");
        let whole = |range: std::ops::Range<usize>| range.map(|i| i as f64).collect::<Vec<f64>>();
        assert_eq!(parts, [whole(0..12_000), whole(12_000 + BRIDGED + 1..rows)], "a straight line bridges row 9000");
        assert_eq!((streamed.samples, streamed.rate_hz), (rows - BRIDGED - 1, 100.0));
        assert_eq!(streamed.findings.len(), 2, "{:?}", streamed.findings);
    }
}
