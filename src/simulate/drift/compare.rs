//! The first comparison of simulation and recording: the Allan deviation of a static log next to
//! that of simulated sensors, and, where the study asks for windows, its drift next to theirs.
//!
//! Each axis of the log is simulated with the study's sensor (or the axis' own sections) at rest,
//! as often as the kernel has lanes, for as long as the log lasts. Not a diagnosis: it says where
//! the two leave each other, `diagnose` says why.

use super::windows::{self, Cut, Drifted};
use crate::backend::cpu;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::kernel::cpu::lanes::LANES;
use crate::kernel::job::Job;
use crate::numerics::allan::{Accumulator, curve};
use crate::numerics::order;
use crate::parallel;
use crate::recording::roles::{self, Stated};
use crate::recording::scale::Named;
use crate::recording::unit::{Quantity, Unit};
use crate::recording::{self, Recording};
use crate::sensor::Sense;
use crate::statistics::Statistics;
use crate::study::Study;
use crate::study::file::{Axis, Compare};
use crate::units::{DEGREE, MILLI_G};

/// Allan deviations of one axis in SI units, recorded and simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeness {
    /// Heading in the log.
    pub column: String,
    /// Says whether the column is an accelerometer or a gyro.
    pub sense: Sense,
    /// Averaging times of the deviations below, s.
    pub tau_s: Vec<f64>,
    /// Allan deviation of the log, one per averaging time.
    pub recorded: Vec<f64>,
    /// 5 %, 50 % and 95 % of the simulated members.
    pub simulated: [Vec<f64>; 3],
}

/// A stretch of averaging times where the log lies outside the simulated band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Shortest averaging time of the departure, s.
    pub from_s: f64,
    /// Longest averaging time of the departure, s.
    pub to_s: f64,
    /// Recorded over simulated median, where it is farthest from one.
    pub ratio: f64,
}

/// Result of a study's `[compare]`.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The study has no `[compare]`.
    NotAsked,
    /// The log is not on this machine.
    Absent(String),
    /// The log was compared with the simulation.
    Compared(Box<Comparison>),
}

/// A log next to the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The log, as the study names it.
    pub file: String,
    /// SHA-256 of the file, hexadecimal.
    pub sha256: String,
    /// Number of samples in the log.
    pub samples: usize,
    /// Sampling rate of the log, Hz.
    pub rate_hz: f64,
    /// Allan deviations, axis by axis.
    pub axes: Vec<Likeness>,
    /// Drift in windows, axis by axis; empty where the study asks for none.
    pub windows: Vec<Drifted>,
    /// Findings of reading the log, and the windows that are disturbed.
    pub findings: Vec<String>,
}

impl Likeness {
    /// Stretches of averaging times outside all departures: how long an integration may be, or must
    /// be, for its error to be as simulated. The Allan deviation at τ is that of a mean over τ,
    /// from which drift over τ comes.
    pub fn trusted(&self) -> Vec<[f64; 2]> {
        let departures = self.departures();
        let outside = |t: f64| departures.iter().any(|d| (d.from_s..=d.to_s).contains(&t));
        let mut found: Vec<[f64; 2]> = Vec::new();
        let mut open = false;
        for t in &self.tau_s {
            match (outside(*t), found.last_mut()) {
                (true, _) => open = false,
                (false, Some(last)) if open => last[1] = *t,
                (false, _) => {
                    found.push([*t, *t]);
                    open = true;
                }
            }
        }
        // One averaging time alone is chance, as one outside is.
        found.retain(|[from, to]| from < to);
        found
    }

    /// Returns where simulation and recording leave each other: stretches of two or more
    /// neighbouring averaging times outside the band, since one in ten single points lies outside
    /// by chance.
    pub fn departures(&self) -> Vec<Departure> {
        let outside = |k: usize| self.recorded[k] < self.simulated[0][k] || self.recorded[k] > self.simulated[2][k];
        let mut found: Vec<Departure> = Vec::new();
        let mut k = 0;
        while k < self.tau_s.len() {
            let end = (k..self.tau_s.len()).find(|j| !outside(*j)).unwrap_or(self.tau_s.len());
            if end >= k + 2 {
                let ratio = (k..end)
                    .map(|j| self.recorded[j] / self.simulated[1][j])
                    .max_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()))
                    .unwrap_or(1.0);
                found.push(Departure { from_s: self.tau_s[k], to_s: self.tau_s[end - 1], ratio });
            }
            k = end.max(k + 1);
        }
        found
    }
}

/// Compares, if the study asks for it and the log is there. `simulate` integrates the ensembles of
/// the windows.
///
/// # Errors
/// A log that is there and cannot be read, columns that are not in it, a log too short for its
/// windows, Ctrl-C.
pub fn run(
    study: &Study,
    control: &Control,
    simulate: &mut dyn FnMut(&Job, &str) -> Result<Statistics>,
) -> Result<Outcome> {
    let Some(compare) = &study.compare else { return Ok(Outcome::NotAsked) };
    let Some(Read { log, cuts, scaled }) = log(study, compare, control)? else {
        return Ok(Outcome::Absent(compare.file.display().to_string()));
    };
    let progress = control.stage("comparing", scaled.len() as u64);
    let axes: Result<Vec<Likeness>> = parallel::map(&scaled, |axis| {
        let likeness = likeness(study, axis, &log, control);
        progress.step();
        likeness
    })
    .into_iter()
    .collect();
    drop(progress);
    let axes = axes?;
    let mut drifted = Vec::new();
    for axis in scaled.iter().filter(|_| !cuts.is_empty()) {
        drifted.push(windows::drifted(study, axis, &log, &cuts, &mut *simulate)?);
    }
    let mut findings: Vec<String> = log.findings.iter().map(ToString::to_string).collect();
    findings.extend(drifted.iter().flat_map(Drifted::findings));
    Ok(Outcome::Compared(Box::new(Comparison {
        file: compare.file.display().to_string(),
        sha256: log.sha256.clone(),
        samples: log.samples(),
        rate_hz: log.rate_hz,
        axes,
        windows: drifted,
        findings,
    })))
}

/// A log that is there, how it is cut, and its axes with their scales.
struct Read {
    log: Recording,
    cuts: Vec<Cut>,
    scaled: Vec<Axis>,
}

/// The log, where it is there.
fn log(study: &Study, compare: &Compare, control: &Control) -> Result<Option<Read>> {
    let path = study.folder.join(&compare.file);
    if !path.exists() {
        return Ok(None);
    }
    let columns = compare.axis.iter().map(|a| a.column.clone()).collect();
    let (topic, rate_hz, time) = (compare.topic.clone(), compare.rate_hz, compare.time.clone());
    let control = control.clone();
    let force_rate = compare.force_rate;
    let request =
        recording::Request { topic, columns, rate_hz, force_rate, time, control, ..recording::Request::default() };
    let log = recording::read(&path, &request)?;
    // Refused before the work, not after it.
    let scaled = compare.axis.iter().map(|axis| scaled(axis, &log)).collect::<Result<_>>()?;
    let cuts = windows::cuts(study, compare, &log)?;
    Ok(Some(Read { log, cuts, scaled }))
}

/// The axis with the scale that it is given, else with the unit that the log states for its column.
///
/// # Errors
/// A scale that contradicts the log, or none anywhere.
fn scaled(axis: &Axis, log: &Recording) -> Result<Axis> {
    let given = match (axis.scale_mg, axis.scale_deg_s) {
        (Some(mg), _) => Some((format!("scale_mg = {mg}"), "scale_mg", Quantity::Accelerometer, mg * MILLI_G)),
        (None, Some(deg_s)) => Some((format!("scale_deg_s = {deg_s}"), "scale_deg_s", Quantity::Gyro, deg_s * DEGREE)),
        (None, None) => None,
    };
    let stated = log.stated(&axis.column);
    if let Some((name, option, quantity, si)) = given {
        Named { name: &axis.column, stated, quantity, option }.check(Some(&Unit { quantity, si, name }))?;
        return Ok(axis.clone());
    }
    let Some(Stated::Inertial(unit)) = roles::stated(&axis.column, stated) else {
        return Err(Error::new(
            format!("could not compare the column `{}` of {}", axis.column, log.path.display()),
            "neither the file nor the study states its unit",
            "give scale_mg = … for an accelerometer, scale_deg_s = … for a gyro: the value of one unit of the column",
        ));
    };
    Ok(match unit.quantity {
        Quantity::Gyro => Axis { scale_deg_s: Some(unit.si / DEGREE), ..axis.clone() },
        _ => Axis { scale_mg: Some(unit.si / MILLI_G), ..axis.clone() },
    })
}

/// The ensembles that [`run`] asks for, in its order.
///
/// # Errors
/// As [`run`], of the log and its windows.
pub fn jobs(study: &Study, control: &Control) -> Result<Vec<Job>> {
    let Some(compare) = study.compare.as_ref().filter(|c| c.windows_s.is_some()) else { return Ok(Vec::new()) };
    let found = log(study, compare, control)?.filter(|read| !read.cuts.is_empty());
    let Some(Read { log, cuts, scaled }) = found else { return Ok(Vec::new()) };
    scaled.iter().map(|axis| windows::ensemble(study, axis, &log, &cuts)).collect()
}

fn likeness(study: &Study, axis: &Axis, log: &Recording, control: &Control) -> Result<Likeness> {
    let (sense, scale) = axis.unit();
    let values: Vec<f64> = log.column(&axis.column).unwrap_or_default().iter().map(|v| v * scale).collect();
    let still = study.at_rest(axis, 1.0 / log.rate_hz, values.len() as u64, LANES as u64)?;
    let job = still.job(still.integrator()?.integrator, vec![still.clock.samples]);
    let mut members = vec![Accumulator::new(); LANES];
    cpu::readings::<f32>(&job, 0, control, |seen| {
        let lane = if sense == Sense::Accelerometer { seen.accelerometer } else { seen.gyro };
        members.iter_mut().zip(&lane.0).for_each(|(member, value)| member.push(f64::from(*value)));
    })
    .map_err(|e| e.within("could not finish the comparison with the recording", "run it again"))?;
    let recorded = curve(&values, log.rate_hz);
    let curves: Vec<Vec<f64>> =
        members.iter().map(|m| m.points(log.rate_hz).iter().map(|p| p.variance.sqrt()).collect()).collect();
    // The log and the members are of one length: their curves have the same averaging times.
    let quantile = |k: usize, p: f64| {
        let mut at: Vec<f64> = curves.iter().filter_map(|c| c.get(k).copied()).collect();
        order::sort(&mut at);
        order::quantile(&at, p)
    };
    let column = |p: f64| (0..recorded.len()).map(|k| quantile(k, p)).collect();
    Ok(Likeness {
        column: axis.column.clone(),
        sense,
        tau_s: recorded.iter().map(|p| p.tau_s).collect(),
        recorded: recorded.iter().map(|p| p.variance.sqrt()).collect(),
        simulated: [column(0.05), column(0.5), column(0.95)],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_point_outside_is_chance_and_a_stretch_is_a_departure() {
        let likeness = Likeness {
            column: "ax".into(),
            sense: Sense::Accelerometer,
            tau_s: (1..=6).map(f64::from).collect(),
            recorded: vec![1.0, 2.0, 1.0, 1.0, 0.5, 0.25],
            simulated: [vec![0.9; 6], vec![1.0; 6], vec![1.1; 6]],
        };
        assert_eq!(likeness.departures(), [Departure { from_s: 5.0, to_s: 6.0, ratio: 0.25 }]);
        assert_eq!(likeness.trusted(), [[1.0, 4.0]]);
        let apart = Likeness { recorded: vec![2.0; 6], ..likeness };
        assert!(apart.trusted().is_empty(), "{:?}", apart.trusted());
    }
}
