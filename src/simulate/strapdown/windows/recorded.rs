//! A recorded flight: the readings of its IMU on the clock of the reference, as far as the two
//! overlap.

use std::ops::Range;
use std::path::Path;

use nalgebra::Vector3;

use super::accord::{self, Beside};
use super::finding::Finding;
use crate::error::{Error, Result};
use crate::motion::Finding as Posed;
use crate::motion::sources::file::{Whole, whole};
use crate::motion::{Section, Trajectory};
use crate::number::rounded;
use crate::recording::inertial;
use crate::study::flown::Flown;
use crate::study::in_motion::InMotion;

/// A recorded flight: log, reference and their common time.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The log, as the study names it.
    pub imu: String,
    /// SHA-256 of the log, hexadecimal.
    pub sha256: String,
    /// Motion of the reference.
    pub trajectory: Trajectory,
    /// Stamps of the readings within the overlap, s on the reference's clock.
    pub time_s: Vec<f64>,
    /// Rows of the log that they stand in; of one that was made up, the row before.
    pub row: Vec<usize>,
    /// Angular rates, rad/s.
    pub rate_rad_s: Vec<Vector3<f64>>,
    /// Specific forces, m/s².
    pub force_m_s2: Vec<Vector3<f64>>,
    /// From one reading to the next, s.
    pub interval_s: f64,
    /// Stretches without a hole.
    pub pieces: Vec<Range<usize>>,
    /// When the reference is known as well as in its middle, s on its clock.
    pub inside_s: [f64; 2],
    /// Findings that were survived.
    pub findings: Vec<Finding>,
}

/// Intervals of a hole that a straight line bridges, and from which on it is one.
const BRIDGED: f64 = 5.5;
const HOLE: f64 = 1.5;
/// Knots from the ends of the reference's spline to where it is known nearly as well as in the middle: a least-squares
/// spline of this order through noise has 20 to 30 times the error of velocity at its ends, and 1.2 times three knots
/// inside.
const EDGE_KNOTS: f64 = 3.0;
const DAY_S: f64 = 86_400.0;
const YEAR_S: f64 = 365.25 * DAY_S;

impl Recorded {
    /// Reads a log and its reference and lays them next to each other.
    ///
    /// # Errors
    /// Files that cannot be read, clocks that do not overlap, readings that cannot be those of this
    /// motion.
    pub fn read(imu: &Path, reference: &Section, flown: &Flown, motion: &InMotion) -> Result<Self> {
        let Whole { trajectory, start, extent_s } = whole(reference)?;
        let shown = imu.display().to_string();
        let poses = reference.file.as_ref().map_or_else(String::new, |file| file.display().to_string());
        let fail =
            |cause: String, hint: &str| Error::new(format!("could not compare {shown} with {poses}"), cause, hint);
        for finding in &trajectory.findings {
            if let Posed::Slow { rate_hz } = finding {
                let cause = format!("the reference's poses come at {} Hz", rounded(*rate_hz, 3));
                return Err(fail(
                    cause,
                    "velocity and attitude at a window's ends take poses ten times as often as it turns",
                ));
            }
        }
        let log = inertial::read(imu, None)?;
        let Some(start) = start else {
            return Err(fail(
                "the reference has no time stamps".into(),
                "give poses with stamps on the IMU's clock, e.g. as a TUM file",
            ));
        };
        let offset_s = log.start.since(&start) - reference.from_s.unwrap_or_default();
        let ends = [offset_s, offset_s + log.time_s.last().copied().unwrap_or_default()];
        if ends[1] <= extent_s[0] || ends[0] >= extent_s[1] {
            return Err(apart(&fail, ends, extent_s));
        }
        let edge_s = EDGE_KNOTS * trajectory.knot_s();
        let mut all = Self {
            imu: shown.clone(),
            sha256: log.sha256.clone(),
            trajectory,
            time_s: Vec::new(),
            row: Vec::new(),
            rate_rad_s: Vec::new(),
            force_m_s2: Vec::new(),
            interval_s: log.interval_s,
            pieces: Vec::new(),
            inside_s: [extent_s[0] + edge_s, extent_s[1] - edge_s],
            findings: Vec::new(),
        };
        all.gather(&log, offset_s, extent_s);
        if all.time_s.len() < 2 {
            return Err(fail("they share no two readings".into(), "are these of one flight?"));
        }
        let beside = Beside {
            trajectory: &all.trajectory,
            time_s: &all.time_s,
            rate_rad_s: &all.rate_rad_s,
            force_m_s2: &all.force_m_s2,
        };
        let found = accord::check(beside, flown, motion).map_err(|(cause, hint)| fail(cause, hint))?;
        all.findings.extend(found);
        Ok(all)
    }

    /// Takes over the readings within the reference's time, and finds the holes in them.
    fn gather(&mut self, log: &inertial::Inertial, offset_s: f64, extent_s: [f64; 2]) {
        let vector = |v: &[f64; 3]| Vector3::from(*v);
        let (mut bridged, mut holes, mut longest_s) = (0, 0, 0.0f64);
        let mut begin = 0;
        for (k, time_s) in log.time_s.iter().map(|t| t + offset_s).enumerate() {
            if time_s < extent_s[0] || time_s > extent_s[1] {
                continue;
            }
            let (rate, force) = (vector(&log.rate_rad_s[k]), vector(&log.force_m_s2[k]));
            if let Some(before) = self.time_s.last().copied() {
                let step = (time_s - before) / log.interval_s;
                if step > BRIDGED {
                    (holes, longest_s) = (holes + 1, longest_s.max(time_s - before));
                    self.pieces.push(begin..self.time_s.len());
                    begin = self.time_s.len();
                } else if step > HOLE {
                    let missing = step.round() as usize - 1;
                    let (last, from) = (self.time_s.len() - 1, before);
                    for m in 1..=missing {
                        let share = m as f64 / (missing + 1) as f64;
                        let between = |a: Vector3<f64>, b: Vector3<f64>| a + share * (b - a);
                        let reading = (between(self.rate_rad_s[last], rate), between(self.force_m_s2[last], force));
                        self.push(from + share * (time_s - from), self.row[last], reading);
                    }
                    bridged += missing;
                }
            }
            self.push(time_s, log.row[k], (rate, force));
        }
        self.pieces.push(begin..self.time_s.len());
        if let (Some(first), Some(last)) = (self.row.first().copied(), self.row.last().copied()) {
            let seconds = self.time_s[self.time_s.len() - 1] - self.time_s[0];
            let outside = log.rows - (last - first + 1);
            self.findings.push(Finding::Overlap { seconds, rows: [first, last], outside });
        }
        let left_out = log.first_left_out.map(|first_row| Finding::LeftOut { rows: log.left_out, first_row });
        self.findings.extend(left_out);
        if bridged > 0 {
            self.findings.push(Finding::Bridged { readings: bridged });
        }
        if holes > 0 {
            self.findings.push(Finding::Holes { holes, longest_s });
        }
        if !log.findings.is_empty() {
            self.findings.push(Finding::UnitsTaken);
        }
    }

    fn push(&mut self, time_s: f64, row: usize, (rate, force): (Vector3<f64>, Vector3<f64>)) {
        self.time_s.push(time_s);
        self.row.push(row);
        self.rate_rad_s.push(rate);
        self.force_m_s2.push(force);
    }

    /// Returns the duration of the readings within the overlap, s.
    pub fn seconds(&self) -> f64 {
        self.time_s.last().copied().unwrap_or_default() - self.time_s.first().copied().unwrap_or_default()
    }
}

/// Clocks that do not overlap.
fn apart(fail: &dyn Fn(String, &str) -> Error, log: [f64; 2], reference: [f64; 2]) -> Error {
    let (gap_s, side) = match log[1] <= reference[0] {
        true => (reference[0] - log[1], "ends"),
        false => (log[0] - reference[1], "begins"),
    };
    let when = if side == "ends" { "before the reference begins" } else { "after the reference ends" };
    let gap = match gap_s {
        s if s > YEAR_S => format!("{:.1} years", s / YEAR_S),
        s if s > DAY_S => format!("{:.1} days", s / DAY_S),
        s => format!("{s:.3} s"),
    };
    let hint = match gap_s > DAY_S {
        true => {
            "their stamps count from different moments: put both on one clock, or find the other file of this flight"
        }
        false => "give the log and the reference of one flight, with stamps on one clock",
    };
    fail(format!("they do not overlap: the log {side} {gap} {when}"), hint)
}
