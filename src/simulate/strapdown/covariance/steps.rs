//! The run in steps that resolve the motion, and mean and covariance of the errors carried through
//! them.

use nalgebra::{Matrix3, SVector, Vector3};

use crate::kernel::aiding::{self, Fix};
use crate::kernel::cpu::navigate::roll_pitch_heading;
use crate::kernel::flight::Flight;
use crate::parallel;
use crate::strapdown::family::{Column, Family};
use crate::strapdown::gains::Gains;
use crate::strapdown::linear::{Model, Square, Step};

/// Largest turn of the body in a step, rad.
const MOST_TURN_RAD: f64 = 0.1;
/// Samples of a step, so that a run has `fewest` steps at least: a power of four, so that held
/// processes are renewed at its beginnings.
pub fn stride(flight: &Flight, fewest: u64) -> u64 {
    let clock = flight.clock();
    let samples = clock.samples - clock.still_samples;
    let fastest = flight.course.truth.samples.iter().map(|s| s.rate_rad_s.norm()).fold(1e-12, f64::max);
    let most = (samples / fewest).min((MOST_TURN_RAD / (fastest * clock.sample_s())) as u64).max(1);
    4u64.pow(most.ilog(4))
}

/// One step of the run, or the beginning of one as far as a report.
pub struct Stop {
    /// The number of the step.
    number: u64,
    /// Says whether it begins where the step does.
    begins: bool,
    /// Time at which it begins, s.
    begin_s: f64,
    step: Step,
    /// Heading of the report, rad, where the step is only looked at.
    report_heading_rad: Option<f64>,
    /// Says whether the run goes on from its end.
    goes_on: bool,
    /// The fix at its end, by its number.
    fix: Option<usize>,
}

impl Stop {
    /// Returns what the errors do over it.
    pub(in crate::strapdown) fn step(&self) -> &Step {
        &self.step
    }

    /// Time at which it begins, s.
    pub(in crate::strapdown) fn begin_s(&self) -> f64 {
        self.begin_s
    }

    /// The number of the step that it is part of.
    pub(in crate::strapdown) fn number(&self) -> u64 {
        self.number
    }

    /// Returns whether it begins where its step does.
    pub(in crate::strapdown) fn begins(&self) -> bool {
        self.begins
    }

    /// Returns whether the run goes on from its end.
    pub(in crate::strapdown) fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// The number of the fix at its end; `None` where there is none, or it is only looked at.
    pub(in crate::strapdown) fn fix(&self) -> Option<usize> {
        self.fix
    }
}

/// The steps of a flight, in order.
pub fn steps(flight: &Flight, stride: u64) -> Vec<Stop> {
    let clock = flight.clock();
    let sample_s = clock.sample_s();
    let reports: Vec<u64> = clock.report_samples.iter().map(|n| n - clock.still_samples).collect();
    let heading = |n: u64| flight.heading_rad(n);
    let count = (clock.samples - clock.still_samples).div_ceil(stride);
    let make = |number: usize| -> Vec<Stop> {
        let number = number as u64;
        let (begin, end) = (number * stride, (number + 1) * stride);
        let due = &flight.fixes[aiding::next(&flight.fixes, begin)..aiding::next(&flight.fixes, end)];
        let mut cuts: Vec<u64> = due.iter().map(|fix| fix.sample).filter(|at| *at < end).collect();
        cuts.push(end);
        let mut all = Vec::new();
        let mut from = begin;
        for until in cuts {
            let stop = |to: u64, report_heading_rad, goes_on: bool| Stop {
                number,
                begins: from == begin,
                begin_s: from as f64 * sample_s,
                step: Step::new(Model::over(&flight.course, flight.vertical, from, to), (to - from) as f64 * sample_s),
                report_heading_rad,
                goes_on,
                fix: aiding::at(&flight.fixes, to).filter(|_| goes_on).map(|(number, _)| number),
            };
            let inside = reports.iter().filter(|r| from < **r && **r < until);
            all.extend(inside.map(|r| stop(*r, Some(heading(*r)), false)));
            all.push(stop(until, reports.contains(&until).then(|| heading(until)), true));
            from = until;
        }
        all
    };
    parallel::map_indices(count as usize, make).into_iter().flatten().collect()
}

/// Mean and covariance of position (m), velocity (m/s), and roll, pitch and heading (rad).
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    /// Mean of the nine errors, SI.
    pub mean: SVector<f64, 9>,
    /// Covariance of the nine errors, squared SI units.
    pub covariance: Square,
}

impl Errors {
    /// Means and variances as separate lists.
    pub fn apart(all: &[Self]) -> (Vec<[f64; 9]>, Vec<[f64; 9]>) {
        let mean = |e: &Self| std::array::from_fn(|i| e.mean[i]);
        let variance = |e: &Self| std::array::from_fn(|i| e.covariance[(i, i)].max(0.0));
        (all.iter().map(mean).collect(), all.iter().map(variance).collect())
    }
}

/// The errors at every report, corrected by these fixes.
pub fn propagated(steps: &[Stop], fixes: &[Fix], mut columns: Vec<Column>, mut families: Vec<Family>) -> Vec<Errors> {
    let gains: Vec<Gains> = fixes.iter().map(Gains::of).collect();
    let mut all = Vec::new();
    let mut renewed = None;
    for stop in steps {
        if renewed != Some(stop.number) {
            renewed = Some(stop.number);
            families.iter_mut().for_each(|family| family.renew(stop.number));
        }
        let (mut c, mut f);
        let (columns, families) = match stop.goes_on {
            true => (&mut columns, &mut families),
            false => {
                (c, f) = (columns.clone(), families.clone());
                (&mut c, &mut f)
            }
        };
        columns.iter_mut().for_each(|column| column.advance(&stop.step, stop.begin_s));
        families.iter_mut().for_each(|family| family.advance(&stop.step));
        if let Some(gains) = stop.fix.and_then(|number| gains.get(number)) {
            columns.iter_mut().for_each(|column| column.correct(gains));
            families.iter_mut().for_each(|family| family.correct(gains));
        }
        if let Some(heading_rad) = stop.report_heading_rad {
            all.push(summed(columns, families, heading_rad));
        }
    }
    all
}

/// Returns what each column has become at the last report, per unit of its constant.
pub fn responses(steps: &[Stop], mut columns: Vec<Column>) -> Vec<SVector<f64, 9>> {
    let mut last = Vec::new();
    for stop in steps {
        let mut looked_at;
        let columns = match stop.goes_on {
            true => &mut columns,
            false => {
                looked_at = columns.clone();
                &mut looked_at
            }
        };
        columns.iter_mut().for_each(|column| column.advance(&stop.step, stop.begin_s));
        if let Some(heading_rad) = stop.report_heading_rad {
            let about = about(heading_rad);
            last = columns.iter().map(|column| about * column.state).collect();
        }
    }
    last
}

/// Columns and families together.
fn summed(columns: &[Column], families: &[Family], heading_rad: f64) -> Errors {
    let mut mean = SVector::<f64, 9>::zeros();
    let mut all = Square::zeros();
    for column in columns {
        mean += column.state * column.mean;
        all += column.state * column.state.transpose() * column.variance;
    }
    families.iter().for_each(|family| all += family.errors * family.share);
    let about = about(heading_rad);
    Errors { mean: about * mean, covariance: about * all * about.transpose() }
}

/// From the states of the model to position, velocity, and roll, pitch and heading.
fn about(heading_rad: f64) -> Square {
    let turn =
        Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(|v| roll_pitch_heading(v, heading_rad)));
    let mut about = Square::zeros();
    about.fixed_view_mut::<3, 3>(6, 0).copy_from(&turn);
    about.fixed_view_mut::<3, 3>(3, 3).copy_from(&Matrix3::identity());
    about.fixed_view_mut::<3, 3>(0, 6).copy_from(&Matrix3::identity());
    about
}
