//! A first look at a file: its parts, the clock, what each column holds, and when an inertial
//! sensor lay still.
//!
//! Not for judging: what the numbers mean is for `noise` and `diagnosis`.

mod given;
mod rest;
mod sensors;

pub use rest::{Leaps, Stretch, leaps};

use std::path::Path;

use super::dropped::Dropped;
use super::finding::{self, Finding};
use super::formats::{self, Found};
use super::health::Watch;
use super::plan;
use super::reader::Part;
use super::request::Request;
use super::roles;
use super::stream::{self, Streamed};
use super::unit::Quantity;
use crate::error::{Error, Kind, Result};
use rest::{Rest, Still};
use sensors::Sensors;

/// Contents of one column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading of the column.
    pub name: String,
    /// Its unit, as the file states it or its heading ends in.
    pub stated: Option<String>,
    /// Quantity that it measures, where its name or unit tells.
    pub quantity: Quantity,
    /// Temperature or the like: the surroundings of a sensor, not its readings.
    pub is_environment: bool,
    /// Smallest value.
    pub lowest: f64,
    /// Largest value.
    pub highest: f64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// Step that its numbers are rounded to.
    pub step: Option<f64>,
}

/// Holds what a file contains: format, columns, clock, ranges, still stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// Name of the format.
    pub format: &'static str,
    /// Topics, messages or arrays; empty for one table of text.
    pub parts: Vec<Part>,
    /// The one that was looked through.
    pub part: Option<String>,
    /// The clock's heading.
    pub clock: Option<String>,
    /// The rows; none where no part could be chosen.
    pub rows: Option<Rows>,
    /// Why no part, or no clock, could be chosen.
    pub obstacle: Option<Error>,
}

/// Holds what the rows of a part hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// States how many, and how many samples came of them.
    pub rows: usize,
    /// Number of samples after repeats and gaps are resolved.
    pub samples: usize,
    /// Sampling rate; none without a clock.
    pub rate_hz: Option<f64>,
    /// Rows that were not used.
    pub dropped: Vec<Dropped>,
    /// Findings while reading.
    pub findings: Vec<Finding>,
    /// Every column of numbers but the clock.
    pub columns: Vec<Column>,
    /// Columns of an inertial sensor, if they are one's: gyros and accelerometers.
    pub sensors: [Vec<usize>; 2],
    /// Column of a rate or an acceleration that was given to the sensor, as by a turntable.
    pub given: Option<usize>,
    /// States whether the rows are poses: positions or attitudes of a body, as a reference has
    /// them.
    pub is_pose: bool,
    /// When the sensor lay still.
    pub still: Vec<Stretch>,
    /// Directions of gravity in which it lay still.
    pub poses: usize,
}

/// Looks through a file.
///
/// # Errors
/// A file that cannot be read, Ctrl-C. One of which no part or no clock can be chosen is none: that
/// stands in the result.
pub fn inspect(path: &Path, request: &Request) -> Result<Inspection> {
    let (format, parts) = match formats::find(path)? {
        Found::Text(_) => ("text", Vec::new()),
        Found::Log { format, log, .. } => (format.name, log.parts().to_vec()),
    };
    plan::against_clock(path, request)?;
    let mut seen = Inspection { format, parts, part: None, clock: None, rows: None, obstacle: None };
    match formats::open(path, request.topic.as_deref()) {
        Ok(opened) => seen.part = opened.part().map(|p| p.name.clone()).filter(|n| !n.is_empty()),
        Err(error) => {
            seen.obstacle = Some(error);
            return Ok(seen);
        }
    }
    match rows(path, request) {
        Ok((found, clock)) => (seen.rows, seen.clock) = (Some(found), clock),
        Err(error) if error.kind == Kind::Interrupted => return Err(error),
        Err(error) => {
            // Without a clock the numbers can still be looked at, row by row.
            let counted = Request { rate_hz: Some(1.0), force_rate: true, time: None, ..request.clone() };
            match rows(path, &counted) {
                Ok((mut found, _)) => {
                    found.findings.retain(|f| !matches!(f, Finding::RateForced { .. }));
                    seen.rows = Some(Rows { rate_hz: None, still: Vec::new(), ..found });
                }
                Err(error) if error.kind == Kind::Interrupted => return Err(error),
                Err(_) => {}
            }
            seen.obstacle = Some(error);
        }
    }
    Ok(seen)
}

fn rows(path: &Path, request: &Request) -> Result<(Rows, Option<String>)> {
    let (names, stated) = stream::headings(path, request)?;
    let sensors = Sensors::of(&names, &stated);
    let mut meters: Vec<Meter> = names.iter().map(|n| Meter::new(n)).collect();
    let mut rest = Rest::default();
    let is_slow = |place: &usize| {
        let beside_a_sensor = sensors.places.iter().any(|places| !places.is_empty());
        let is_reading = sensors.places.iter().any(|places| places.contains(place));
        roles::is_environment(&names[*place], stated[*place].as_deref()) || beside_a_sensor && !is_reading
    };
    let slow: Vec<String> = (0..names.len()).filter(is_slow).map(|place| names[place].clone()).collect();
    // A column alone is what there is to look at.
    let slow = if slow.len() < names.len() { slow } else { Vec::new() };
    let mut streamed = stream::read(path, &Request { slow, ..request.clone() }, |block| {
        meters.iter_mut().zip(&block.columns).for_each(|(meter, values)| meter.push(values, &block.rows));
        rest.push(block, &sensors.places);
    })?;
    let used = meters.iter().map(|meter| meter.count).fold(0.0, f64::max);
    let written = |place: &usize| meters[*place].count > 0.0;
    if !(0..names.len()).all(|place| written(&place)) {
        let columns = (0..names.len()).filter(written).map(|place| names[place].clone()).collect();
        let (mut rows, clock) = self::rows(path, &Request { columns, ..request.clone() })?;
        let empty = meters.iter().filter(|meter| meter.count == 0.0);
        rows.findings.extend(empty.filter_map(|meter| meter.written_in_few(used)));
        return Ok((rows, clock));
    }
    streamed.findings.extend(meters.iter().filter_map(|meter| meter.written_in_few(used)));
    streamed.findings.extend(meters.iter().flat_map(|m| m.watch.findings()));
    finding::settle(&mut streamed.findings);
    let clock = streamed.findings.iter().find_map(|f| match f {
        Finding::ClockFound { heading, .. } => Some(heading.clone()),
        _ => None,
    });
    let scaled = sensors.scaled(&names, &rest, streamed.rate_hz);
    let Still { stretches: still, poses } = rest.still(streamed.rate_hz, scaled.si);
    streamed.findings.extend(scaled.findings);
    let is_pose =
        roles::is_pose(&names) || streamed.findings.iter().any(|f| matches!(f, Finding::TrajectoryRecognised { .. }));
    let columns = meters.into_iter().enumerate().map(|(place, meter)| {
        let text = stated[place].as_deref();
        Column {
            stated: roles::unit_words(&names[place], text),
            quantity: sensors.quantity(place),
            is_environment: roles::is_environment(&names[place], text),
            ..meter.column()
        }
    });
    let columns = columns.collect();
    let clock = clock.or_else(|| request.time.clone());
    let Streamed { sha256, rows, samples, rate_hz, dropped, findings } = streamed;
    let (sensors, given) = (sensors.places, sensors.given);
    let rate_hz = Some(rate_hz);
    let rows =
        Rows { sha256, rows, samples, rate_hz, dropped, findings, columns, sensors, given, is_pose, still, poses };
    Ok((rows, clock))
}

/// Sums over a column; deviations from its first value, so that little is lost of a small one.
struct Meter {
    name: String,
    watch: Watch,
    count: f64,
    origin: f64,
    sum: f64,
    squares: f64,
    lowest: f64,
    highest: f64,
}

impl Meter {
    fn new(name: &str) -> Self {
        let (lowest, highest) = (f64::INFINITY, f64::NEG_INFINITY);
        let watch = Watch::new(name);
        Self { name: name.to_owned(), watch, count: 0.0, origin: 0.0, sum: 0.0, squares: 0.0, lowest, highest }
    }

    fn push(&mut self, values: &[f64], rows: &[Option<usize>]) {
        for (value, row) in values.iter().zip(rows).filter(|(value, _)| !value.is_nan()) {
            if self.count == 0.0 {
                self.origin = *value;
            }
            match row {
                Some(_) => self.watch.push(*value),
                None => self.watch.skip(),
            }
            let off = value - self.origin;
            self.count += 1.0;
            self.sum += off;
            self.squares += off * off;
            self.lowest = self.lowest.min(*value);
            self.highest = self.highest.max(*value);
        }
    }

    fn written_in_few(&self, used: f64) -> Option<Finding> {
        let few =
            || Finding::WrittenInFew { column: self.name.clone(), readings: self.count as usize, rows: used as usize };
        (self.count < used).then(few)
    }

    fn column(self) -> Column {
        let mean = self.sum / self.count.max(1.0);
        let variance = (self.squares / self.count.max(1.0) - mean * mean).max(0.0);
        Column {
            name: self.name,
            stated: None,
            quantity: Quantity::Unknown,
            is_environment: false,
            lowest: self.lowest,
            highest: self.highest,
            mean: self.origin + mean,
            deviation: variance.sqrt(),
            step: self.watch.step(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_and_motion_are_told_apart() {
        // Ten seconds at rest, ten in motion, ten at rest, at 100 Hz, with noise of 0.001 rad/s and
        // 0.01 m/s².
        let noise = |k: usize| ((k * 7919 + k * k * 104_729) % 1009) as f64 / 504.5 - 1.0;
        let rows: String = (0..3000)
            .map(|k| {
                let turn = if (1000..2000).contains(&k) { (k as f64 * 0.05).sin() } else { 0.0 };
                let [a, b, c] = [0, 1, 2].map(|axis| 1e-3 * noise(k + 31 * axis) + turn);
                let [d, e, f] = [3, 4, 5].map(|axis| 1e-2 * noise(k + 31 * axis) + turn);
                format!("{:.2},{a},{b},{c},{d},{e},{}\n", k as f64 * 0.01, f + 9.8)
            })
            .collect();
        let file = tempfile::NamedTempFile::new().expect("file");
        std::fs::write(file.path(), format!("t_s,gx,gy,gz,ax,ay,az\n{rows}")).expect("written");
        let seen = inspect(file.path(), &Request::default()).expect("readable");
        let rows = seen.rows.expect("rows");
        assert_eq!(
            (seen.clock.as_deref(), rows.columns.len(), rows.still.len()),
            (Some("t_s"), 6, 2),
            "{:?}",
            rows.still
        );
        let near = |a: f64, b: f64| (a - b).abs() < 1.1;
        assert!(near(rows.still[0].to_s, 10.0) && near(rows.still[1].from_s, 20.0), "{:?}", rows.still);
        assert!((rows.columns[5].mean - 9.8).abs() < 0.1 && rows.rate_hz.is_some_and(|r| (r - 100.0).abs() < 1e-6));
    }
}
