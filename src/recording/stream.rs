//! A recording of any length, sample by sample on a uniform clock: short holes bridged, long ones announced.
//!
//! For what needs a whole column at once, see `recording::read`.

use std::path::Path;

use super::rows::Rows;
use super::{FILL_LIMIT, Request, checked_rate};
use crate::error::{Error, Result};
use crate::progress;

/// Holes up to this many samples are bridged by straight lines.
const BRIDGED: usize = 10;
/// Rows looked at to learn the rate from a time column.
const LOOKED_AT: usize = 1000;

/// What comes next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event<'a> {
    /// A sample: one value per column, none missing.
    Sample(&'a [f64]),
    /// Too much is missing to bridge.
    Break,
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

/// Streams the columns of `request` (`rows` is ignored) into `take`.
///
/// # Errors
/// As [`super::read`], except that gaps of any length are survived.
pub fn read(path: &Path, request: &Request, mut take: impl FnMut(Event<'_>)) -> Result<Streamed> {
    let names = headings(path, request)?;
    let mut wanted = names.clone();
    wanted.splice(0..0, request.time.clone());
    let rate_hz = match &request.time {
        Some(_) => rate_of(path, &wanted, request.rate_hz)?,
        None => checked_rate(path, request.rate_hz)?,
    };
    let mut table = Rows::open(path, &wanted)?;
    let mut row = vec![0.0; wanted.len()];
    let mut bridge = Bridge::new(names.len());
    let mut clock = request.time.as_ref().map(|_| Clock { rate_hz, before: None, repeats: 0 });
    let bar = progress::bar("reading", table.length_bytes());
    let mut index = 0usize;
    while table.next(&mut row)? {
        index += 1;
        if index.is_multiple_of(65_536) {
            bar.set_position(table.bytes_read());
            if progress::interrupted() {
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
        bridge.push(values, &mut take);
    }
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

/// Bridges short holes and announces long ones.
struct Bridge {
    last: Vec<f64>,
    between: Vec<f64>,
    begun: bool,
    missing: usize,
    given: usize,
    filled: usize,
    breaks: usize,
}

impl Bridge {
    fn new(width: usize) -> Self {
        let (last, between) = (vec![0.0; width], vec![0.0; width]);
        Self { last, between, begun: false, missing: 0, given: 0, filled: 0, breaks: 0 }
    }

    fn push(&mut self, values: &[f64], take: &mut impl FnMut(Event<'_>)) {
        if values.iter().any(|v| v.is_nan()) {
            self.missing += 1;
            return;
        }
        if self.begun && self.missing > BRIDGED {
            self.breaks += 1;
            take(Event::Break);
        } else if self.begun {
            for k in 1..=self.missing {
                let share = k as f64 / (self.missing + 1) as f64;
                for ((to, from), value) in self.between.iter_mut().zip(&self.last).zip(values) {
                    *to = from + share * (value - from);
                }
                take(Event::Sample(&self.between));
            }
            self.filled += self.missing;
            self.given += self.missing;
        }
        self.missing = 0;
        self.begun = true;
        self.given += 1;
        take(Event::Sample(values));
        self.last.copy_from_slice(values);
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
