//! A first look at a file: its parts, the clock, what each column holds, and when an inertial
//! sensor lay still.
//!
//! Not for judging: what the numbers mean is for `noise` and `diagnosis`.

use std::path::Path;

use super::dropped::Dropped;
use super::finding::{self, Finding};
use super::formats::{self, Found};
use super::health::Watch;
use super::reader::Part;
use super::request::Request;
use super::roles::{self, Roles};
use super::stream::{self, Block, Streamed};
use super::unit::{Quantity, Unit};
use crate::error::{Error, Kind, Result};
use crate::numerics::order;

/// Length of the windows that are judged still or moving, s.
const WINDOW_S: f64 = 1.0;
/// Fewer samples in a window tell nothing of its variance.
const FEWEST: usize = 8;
const SHORTEST: usize = 2;
/// A window is still whose variance is at most this many times that of the quietest ones.
const QUIET: f64 = 5.0;
/// Standard deviations of a sensor at rest are below these, rad/s and m/s²: a hovering drone's are
/// not.
const RESTLESS: [f64; 2] = [0.05, 0.3];

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading of the column.
    pub name: String,
    /// Its unit, as the file states it.
    pub stated: Option<String>,
    /// What it measures, where its name or unit tells.
    pub quantity: Quantity,
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

/// A stretch of time since the first sample, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Beginning of the stretch, s.
    pub from_s: f64,
    /// End of the stretch, s.
    pub to_s: f64,
}

/// What a file contains: format, columns, clock, ranges, still stretches.
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

/// What the rows of a part hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// How many, and how many samples came of them.
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
    /// Whether its columns are an inertial sensor's.
    pub roles: Roles,
    /// When that lay still.
    pub still: Vec<Stretch>,
}

/// Looks through a file.
///
/// # Errors
/// A file that cannot be read, Ctrl-C. One of which no part or no clock can be chosen is none: that stands
/// in the result.
pub fn inspect(path: &Path, request: &Request) -> Result<Inspection> {
    let (format, parts) = match formats::find(path)? {
        Found::Text(_) => ("text", Vec::new()),
        Found::Log { format, log, .. } => (format.name, log.parts().to_vec()),
    };
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
            let counted = Request { rate_hz: Some(1.0), time: None, ..request.clone() };
            match rows(path, &counted) {
                Ok((found, _)) => seen.rows = Some(Rows { rate_hz: None, still: Vec::new(), ..found }),
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
    let roles = roles::of(&names);
    let mut meters: Vec<Meter> = names.iter().map(|n| Meter::new(n)).collect();
    let mut rest = Rest::default();
    let mut streamed = stream::read(path, request, |block| {
        meters.iter_mut().zip(&block.columns).for_each(|(meter, values)| meter.push(values));
        rest.push(block, &roles);
    })?;
    streamed.findings.extend(meters.iter().flat_map(|m| m.watch.findings()));
    finding::settle(&mut streamed.findings);
    let clock = streamed.findings.iter().find_map(|f| match f {
        Finding::ClockFound { heading, .. } => Some(heading.clone()),
        _ => None,
    });
    let scale = |place: usize, usual: f64| {
        roles::unit(&names[place], stated[place].as_deref()).map_or(Some(usual), |unit| unit.map(|u| u.si))
    };
    let scales = [roles.gyro, roles.accelerometer].map(|places| places.and_then(|p| scale(p[0], 1.0)));
    let still = rest.stretches(streamed.rate_hz, scales);
    let quantity = |place: usize| {
        let among = |places: Option<[usize; 3]>| places.is_some_and(|p| p.contains(&place));
        match (among(roles.gyro), among(roles.accelerometer)) {
            (true, _) => Quantity::Gyro,
            (_, true) => Quantity::Accelerometer,
            _ => stated[place].as_deref().and_then(Unit::of_file).map_or(Quantity::Unknown, |u| u.quantity),
        }
    };
    let columns =
        meters.into_iter().enumerate().map(|(place, meter)| meter.column(stated[place].clone(), quantity(place)));
    let columns = columns.collect();
    let clock = clock.or_else(|| request.time.clone());
    let Streamed { sha256, rows, samples, rate_hz, dropped, findings } = streamed;
    Ok((Rows { sha256, rows, samples, rate_hz: Some(rate_hz), dropped, findings, columns, roles, still }, clock))
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

    fn push(&mut self, values: &[f64]) {
        for value in values {
            if self.count == 0.0 {
                self.origin = *value;
            }
            self.watch.push(*value);
            let off = value - self.origin;
            self.count += 1.0;
            self.sum += off;
            self.squares += off * off;
            self.lowest = self.lowest.min(*value);
            self.highest = self.highest.max(*value);
        }
    }

    fn column(self, stated: Option<String>, quantity: Quantity) -> Column {
        let mean = self.sum / self.count.max(1.0);
        let variance = (self.squares / self.count.max(1.0) - mean * mean).max(0.0);
        Column {
            name: self.name,
            stated,
            quantity,
            lowest: self.lowest,
            highest: self.highest,
            mean: self.origin + mean,
            deviation: variance.sqrt(),
            step: self.watch.step(),
        }
    }
}

/// Variances of an inertial sensor in windows.
#[derive(Default)]
struct Rest {
    /// Samples that fill the window at hand, sensor by sensor and axis by axis, and how many.
    held: [[[f64; Rest::WIDTH]; 3]; 2],
    count: usize,
    /// Per window of [`Rest::WIDTH`] samples, the variance of each sensor, all axes together.
    variances: Vec<[f64; 2]>,
}

impl Rest {
    /// Samples of the shortest window; windows of a second are joined of them.
    const WIDTH: usize = FEWEST;

    fn push(&mut self, block: &Block, roles: &Roles) {
        let sensors = [roles.gyro, roles.accelerometer];
        if sensors == [None, None] {
            return;
        }
        let length = block.columns.first().map_or(0, Vec::len);
        let mut from = 0;
        while from < length {
            let to = length.min(from + Self::WIDTH - self.count);
            let window = self.count..self.count + to - from;
            for (held, places) in self.held.iter_mut().zip(sensors) {
                for (axis, place) in held.iter_mut().zip(places.into_iter().flatten()) {
                    axis[window.clone()].copy_from_slice(&block.columns[place][from..to]);
                }
            }
            (from, self.count) = (to, window.end);
            if self.count == Self::WIDTH {
                // Of a sensor that is not there, zeros.
                self.variances.push(self.held.each_ref().map(variance));
                self.count = 0;
            }
        }
    }

    /// When all sensors there are were still.
    fn stretches(&self, rate_hz: f64, scales: [Option<f64>; 2]) -> Vec<Stretch> {
        let together = ((WINDOW_S * rate_hz / Self::WIDTH as f64).round() as usize).max(1);
        let windows: Vec<[f64; 2]> = self
            .variances
            .chunks_exact(together)
            .map(|part| [0, 1].map(|s| part.iter().map(|v| v[s]).sum::<f64>() / part.len() as f64))
            .collect();
        if windows.is_empty() || scales == [None, None] {
            return Vec::new();
        }
        let limits = [0, 1].map(|s| {
            let mut all: Vec<f64> = windows.iter().map(|w| w[s]).collect();
            order::sort(&mut all);
            let quiet = QUIET * all[all.len() / 100];
            scales[s].map_or(f64::INFINITY, |si| quiet.min((RESTLESS[s] / si).powi(2)))
        });
        let still = |w: &[f64; 2]| w[0] <= limits[0] && w[1] <= limits[1];
        let window_s = (together * Self::WIDTH) as f64 / rate_hz;
        let mut out: Vec<Stretch> = Vec::new();
        let mut begin = None;
        for k in 0..=windows.len() {
            match (begin, windows.get(k).is_some_and(still)) {
                (None, true) => begin = Some(k),
                (Some(from), false) => {
                    if k - from >= SHORTEST {
                        out.push(Stretch { from_s: from as f64 * window_s, to_s: k as f64 * window_s });
                    }
                    begin = None;
                }
                _ => {}
            }
        }
        out
    }
}

/// Variance about the mean, the three axes together.
fn variance(axes: &[[f64; Rest::WIDTH]; 3]) -> f64 {
    let n = Rest::WIDTH as f64;
    let [a, b, c] = axes.each_ref().map(|axis| {
        let mean = axis.iter().sum::<f64>() / n;
        axis.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)
    });
    a + b + c
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
