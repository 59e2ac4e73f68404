//! Recordings: columns of numbers from a CSV file, with what is wrong with them found and said.
//!
//! [`read`] brings the columns asked for into memory on a uniform clock; [`stream`] passes a file of any length. Not
//! for judging physics: a gap or a clipped rail is reported here, what it means is `diagnosis`' business.

pub mod clock;
pub mod format;
pub mod glitch;
pub mod health;
pub mod noise;
pub mod repeats;
pub mod rows;
pub mod stream;
pub mod unit;

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::numerics::order;
use crate::progress;
use crate::signal;

/// A named column in the recording's own unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading in the file.
    pub name: String,
    /// One value per row.
    pub values: Vec<f64>,
}

/// A recording in memory, on a uniform clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Where it came from.
    pub path: PathBuf,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Sampling rate.
    pub rate_hz: f64,
    /// The columns asked for, all of the same length, without NaN.
    pub columns: Vec<Column>,
    /// What was found and survived, in words for the report: gaps filled, samples dropped, rails touched.
    pub findings: Vec<String>,
    /// Samples that were not recorded but filled in some column, ascending; they may overlap.
    pub filled: Vec<Range<usize>>,
}

impl Recording {
    /// Values of the column with this heading.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.columns.first().map_or(0, |c| c.values.len())
    }
}

/// What to read of a file, and what its clock is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// Headings, in the order wanted; without a header, "1", "2", … Empty: every column but the clock.
    pub columns: Vec<String>,
    /// Sampling rate, where rows are evenly spaced by construction.
    pub rate_hz: Option<f64>,
    /// Heading of a time column in s. Where both are given, the column must agree with the rate.
    pub time: Option<String>,
    /// Data rows wanted, counted from zero after the header; absent means all. Later indices count from its start.
    pub rows: Option<Range<usize>>,
}

/// Share of a recording that may be missing and is then filled by straight lines; more is an error.
pub const FILL_LIMIT: f64 = 0.05;

/// Reads the columns asked for onto a uniform clock.
///
/// Missing cells and short gaps are filled by straight lines, repeated time stamps dropped, uneven clocks resampled; at a
/// long gap (more than 1 % of the rows) the longer part is kept. Each is said in `findings`.
///
/// # Errors
/// A file that cannot be read as a table of numbers, a column that is not there (the nearest is named), time that runs
/// backwards, a clock and a rate that disagree, or more than 5 % of the values missing.
pub fn read(path: &Path, request: &Request) -> Result<Recording> {
    let (names, mut columns, source) = collect(path, request)?;
    let mut findings = source.findings;
    let rows = columns.first().map_or(0, Vec::len);
    if rows < 2 {
        return Err(Error::new(
            format!("could not use {}", path.display()),
            format!("{rows} data rows"),
            "a recording needs at least two rows under its header, and some thousands to be worth judging",
        ));
    }
    let mut holes = Vec::new();
    let rate_hz = match &request.time {
        Some(_) => {
            let times = columns.remove(0);
            let mut ticks = clock::ticks(path, &times, request.rate_hz)?;
            ticks.settle(&columns);
            findings.extend(ticks.findings.iter().cloned());
            for values in &mut columns {
                *values = ticks.resample(values);
            }
            holes.extend(ticks.filled.iter().cloned());
            ticks.rate_hz
        }
        None => {
            let mended = repeats::mend(&mut columns);
            holes.extend(mended.filled);
            findings.extend(mended.finding);
            checked_rate(path, request.rate_hz)?
        }
    };
    let names = if request.time.is_some() { &names[1..] } else { &names[..] };
    let mut filled = Vec::new();
    for (name, mut values) in names.iter().cloned().zip(columns) {
        holes.extend(health::holes(&values));
        findings.extend(health::fill(path, &name, &mut values)?);
        filled.push(Column { name, values });
    }
    for column in &filled {
        findings.extend(health::Watch::of(&column.name, &column.values).findings());
    }
    order::sort_by_key(&mut holes, |r| r.start as f64);
    Ok(Recording { path: path.into(), sha256: source.sha256, rate_hz, columns: filled, findings, filled: holes })
}

fn collect(path: &Path, request: &Request) -> Result<(Vec<String>, Vec<Vec<f64>>, rows::Source)> {
    let mut wanted = request.columns.clone();
    if let Some(time) = &request.time {
        if wanted.is_empty() {
            wanted = rows::Rows::open(path, &[])?.names().iter().filter(|n| *n != time).cloned().collect();
        }
        wanted.insert(0, time.clone());
    }
    let mut table = rows::Rows::open(path, &wanted)?;
    let names = table.names().to_vec();
    let range = request.rows.clone().unwrap_or(0..usize::MAX);
    let mut columns = vec![Vec::new(); names.len()];
    let mut row = vec![f64::NAN; names.len()];
    let bar = progress::bar("reading", table.length_bytes());
    let mut index = 0;
    while table.next(&mut row)? {
        if range.contains(&index) {
            for (column, value) in columns.iter_mut().zip(&row) {
                column.push(*value);
            }
        }
        index += 1;
        if index == 65_536 {
            // Vectors that double their room would take up to three times what a long recording needs.
            let read = table.bytes_read().max(1) as f64;
            let rows = 1.02 * index as f64 * (table.length_bytes() as f64 / read) - index as f64;
            let rows = (rows.max(0.0) as usize).min(range.end.saturating_sub(index));
            columns.iter_mut().for_each(|c| c.reserve_exact(rows));
        }
        if index.is_multiple_of(65_536) {
            bar.set_position(table.bytes_read());
            if signal::interrupted() {
                return Err(Error::interrupted(format!("could not read {}", path.display()), "start it again"));
            }
        }
    }
    bar.finish_and_clear();
    if request.rows.is_some() && columns.first().is_some_and(Vec::is_empty) {
        return Err(Error::new(
            format!("could not use rows {}..{} of {}", range.start, range.end, path.display()),
            format!("the file has {index} data rows"),
            "rows are counted from zero after the header; the end is exclusive",
        ));
    }
    Ok((names, columns, table.finish()?))
}

/// Slowest and fastest sampling that is one: from a sample in thirty years to a terahertz, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 1e-9..=1e12;

fn checked_rate(path: &Path, rate_hz: Option<f64>) -> Result<f64> {
    match rate_hz {
        Some(rate) if RATES_HZ.contains(&rate) => Ok(rate),
        Some(rate) => Err(Error::new(
            format!("could not place {} in time", path.display()),
            format!("a sampling rate of {rate:?} Hz"),
            "give samples per second, e.g. 100.0",
        )),
        None => Err(Error::new(
            format!("could not place {} in time", path.display()),
            "neither a sampling rate nor a time column was given",
            "give the rate in Hz, or name the column that holds the time in s",
        )),
    }
}
