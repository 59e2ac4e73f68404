//! The covariance of the linear error model, source by source, in f64: what the ensemble's spread must be as long as errors
//! are small, and where it comes from.
//!
//! Left out, and said: rounding, saturation and the proof mass' own lag and springs, which no linear model has.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::family::{Column, Family, Gain, Process};
use super::held;
use super::linear::{Drive, Model, Square, Step};
use crate::kernel::cpu::navigate::roll_pitch_heading;
use crate::kernel::flicker;
use crate::kernel::flight::{Flight, Vertical};
use crate::motion::mechanisation;
use crate::parallel;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::source::ErrorSource;
use crate::sensor::{Sense, SensorTerm, coupling, mechanics};
use crate::study::in_motion::InMotion;
use crate::units::key::Key;

/// Where an error comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cause {
    /// A sensor on each axis.
    Sensor(ErrorSource),
    /// What a reading takes from other axes or instruments.
    Coupling(&'static Key),
    /// The heading at the start, and without a still start the tilt.
    Alignment,
    /// The navigator itself, on perfect readings.
    Mechanisation,
}

impl Cause {
    /// Its name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sensor(source) => source.name(),
            Self::Coupling(key) => key.name,
            Self::Alignment => "initial attitude",
            Self::Mechanisation => "navigator's integration",
        }
    }
}

/// What one cause does.
#[derive(Debug, Clone)]
pub struct Part {
    /// Which.
    pub cause: Cause,
    /// Per report time, position (m), velocity (m/s), and roll, pitch and heading (rad): mean of each.
    pub mean: Vec<[f64; 9]>,
    /// Variance of each.
    pub variance: Vec<[f64; 9]>,
}

/// The covariance at the report times.
#[derive(Debug, Clone)]
pub struct Covariance {
    /// Cause by cause.
    pub parts: Vec<Part>,
    /// Causes that it has no place for.
    pub left_out: Vec<Cause>,
}

impl Covariance {
    /// Variance of one of the nine at a report time, all causes together.
    pub fn variance(&self, report: usize, quantity: usize) -> f64 {
        self.parts.iter().map(|part| part.variance[report][quantity]).sum()
    }

    /// Mean of the squared horizontal distance from the truth that one cause alone makes, m².
    pub fn horizontal_m2(&self, part: &Part, report: usize) -> f64 {
        (0..2).map(|axis| part.variance[report][axis] + part.mean[report][axis].powi(2)).sum()
    }

    /// Its fraction of that of all causes.
    pub fn fraction(&self, part: &Part, report: usize) -> f64 {
        let all: f64 = self.parts.iter().map(|part| self.horizontal_m2(part, report)).sum();
        if all > 0.0 { self.horizontal_m2(part, report) / all } else { 0.0 }
    }

    /// Its mean.
    pub fn mean(&self, report: usize, quantity: usize) -> f64 {
        self.parts.iter().map(|part| part.mean[report][quantity]).sum()
    }
}

/// What the navigator errs by on perfect readings, at the report samples of a flight: no spread, the same for every member. The
/// ensemble, which integrates errors about the truth, does not have it.
pub fn own_error(motion: &InMotion, flight: &Flight) -> Part {
    let errors = mechanisation::own_error(&flight.course.earth, motion.mechanisation, &flight.course.truth);
    let clock = flight.clock();
    let at = |report: &u64| {
        let sample = report - clock.still_samples;
        let Some(error) = errors.get(sample as usize) else { return [0.0; 9] };
        let turn = roll_pitch_heading(error.attitude_rad, flight.heading_rad(sample));
        let mut all: [f64; 9] = std::array::from_fn(|i| [error.position_m, error.velocity_m_s, turn][i / 3][i % 3]);
        if flight.vertical == Vertical::Held {
            (all[2], all[5]) = (0.0, 0.0);
        }
        all
    };
    let mean: Vec<[f64; 9]> = clock.report_samples.iter().map(at).collect();
    Part { cause: Cause::Mechanisation, variance: vec![[0.0; 9]; mean.len()], mean }
}

/// Fewest steps of a run, so that a step resolves it.
const FEWEST_STEPS: u64 = 1500;
/// Largest turn of the body in a step, rad.
const MOST_TURN_RAD: f64 = 0.1;
/// Phases over which a held process is averaged.
const PHASES: u64 = 8;

/// What a still start makes of mean reading errors.
struct Found {
    seconds: f64,
    /// Errors at its end per unit of mean.
    state: Drive,
    /// What is taken off per unit of mean.
    taken: SMatrix<f64, 6, 6>,
    /// What is taken off the gyros per radian of heading error.
    heading: Vector3<f64>,
}

/// Works it out at the report samples of a flight.
pub fn of(motion: &InMotion, flight: &Flight) -> Covariance {
    let found = (flight.clock().still_samples > 0).then(|| found(flight));
    let mut causes: Vec<(Cause, Vec<Column>, Vec<Family>)> = Vec::new();
    let mut left_out = Vec::new();
    let stride = stride(flight);
    let step_s = stride as f64 * flight.clock().sample_s();
    for source in ErrorSource::ALL {
        let Some(given) = Given::of(source, motion) else { continue };
        match given.built(flight, found.as_ref(), stride, step_s) {
            Some((columns, families)) => causes.push((Cause::Sensor(source), columns, families)),
            None => left_out.push(Cause::Sensor(source)),
        }
    }
    for key in coupling::KEYS {
        let columns = couplings(key, motion, found.as_ref(), flight);
        if !columns.is_empty() {
            causes.push((Cause::Coupling(key), columns, Vec::new()));
        }
    }
    let alignment = alignment(flight, found.as_ref());
    if !alignment.is_empty() {
        causes.push((Cause::Alignment, alignment, Vec::new()));
    }
    let steps = steps(flight, stride);
    let part = |(cause, columns, families): &(Cause, Vec<Column>, Vec<Family>)| {
        let (mean, variance) = propagated(&steps, columns.clone(), families.clone());
        Part { cause: *cause, mean, variance }
    };
    Covariance { parts: parallel::map(&causes, part), left_out }
}

/// Samples of a step: a power of four, so that held processes are renewed at its beginnings.
fn stride(flight: &Flight) -> u64 {
    let clock = flight.clock();
    let samples = clock.samples - clock.still_samples;
    let fastest = flight.course.truth.samples.iter().map(|s| s.rate_rad_s.norm()).fold(1e-12, f64::max);
    let most = (samples / FEWEST_STEPS).min((MOST_TURN_RAD / (fastest * clock.sample_s())) as u64).max(1);
    4u64.pow(most.ilog(4))
}

/// One step of the run, or the beginning of one as far as a report.
struct Stop {
    /// The number of the step.
    number: u64,
    /// Time at which it begins, s.
    begin_s: f64,
    step: Step,
    /// Whether it is only looked at, for the report with this heading, rad.
    report_heading_rad: Option<f64>,
    /// Whether the run goes on from its end.
    goes_on: bool,
}

fn steps(flight: &Flight, stride: u64) -> Vec<Stop> {
    let clock = flight.clock();
    let sample_s = clock.sample_s();
    let reports: Vec<u64> = clock.report_samples.iter().map(|n| n - clock.still_samples).collect();
    let heading = |n: u64| flight.heading_rad(n);
    let count = (clock.samples - clock.still_samples).div_ceil(stride);
    let make = |number: usize| -> Vec<Stop> {
        let number = number as u64;
        let (from, until) = (number * stride, (number + 1) * stride);
        let stop = |to: u64, report_heading_rad, goes_on| Stop {
            number,
            begin_s: from as f64 * sample_s,
            step: Step::new(Model::over(&flight.course, flight.vertical, from, to), (to - from) as f64 * sample_s),
            report_heading_rad,
            goes_on,
        };
        let inside = reports.iter().filter(|r| from < **r && **r < until).map(|r| stop(*r, Some(heading(*r)), false));
        let mut all: Vec<Stop> = inside.collect();
        all.push(stop(until, reports.contains(&until).then(|| heading(until)), true));
        all
    };
    parallel::map_indices(count as usize, make).into_iter().flatten().collect()
}

/// Mean and variance of the nine at every report.
fn propagated(steps: &[Stop], mut columns: Vec<Column>, mut families: Vec<Family>) -> (Vec<[f64; 9]>, Vec<[f64; 9]>) {
    let (mut means, mut variances) = (Vec::new(), Vec::new());
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
        if let Some(heading_rad) = stop.report_heading_rad {
            let (mean, variance) = summed(columns, families, heading_rad);
            means.push(mean);
            variances.push(variance);
        }
    }
    (means, variances)
}

/// Mean and variance of position, velocity and roll, pitch and heading.
fn summed(columns: &[Column], families: &[Family], heading_rad: f64) -> ([f64; 9], [f64; 9]) {
    let mut mean = SMatrix::<f64, 9, 1>::zeros();
    let mut all = Square::zeros();
    for column in columns {
        mean += column.state * column.mean;
        all += column.state * column.state.transpose() * column.variance;
    }
    families.iter().for_each(|family| all += family.errors * family.share);
    let turn =
        Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(|v| roll_pitch_heading(v, heading_rad)));
    let mut about = Square::zeros();
    about.fixed_view_mut::<3, 3>(6, 0).copy_from(&turn);
    about.fixed_view_mut::<3, 3>(3, 3).copy_from(&Matrix3::identity());
    about.fixed_view_mut::<3, 3>(0, 6).copy_from(&Matrix3::identity());
    let (mean, all) = (about * mean, about * all * about.transpose());
    (std::array::from_fn(|i| mean[i]), std::array::from_fn(|i| all[(i, i)].max(0.0)))
}

/// What levelling and the gyros' mean make of mean errors.
fn found(flight: &Flight) -> Found {
    let course = &flight.course;
    let start = course.truth.samples.first();
    let (turn, gravity) = start.map_or((Matrix3::identity(), 1.0), |s| {
        (s.attitude.to_rotation_matrix().into_inner(), course.standing()[0].norm())
    });
    // The levelled attitude turns an error to the north into a tilt about east.
    let tilt = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0) / gravity * turn;
    let earth = course.earth.rate_rad_s(course.place(0));
    let unseen = -turn.transpose() * earth.cross_matrix();
    let down = turn.transpose() * Matrix3::from_diagonal(&Vector3::z()) * turn;
    let mut state = Drive::zeros();
    state.fixed_view_mut::<3, 3>(0, 0).copy_from(&tilt);
    let mut taken = SMatrix::<f64, 6, 6>::zeros();
    taken.fixed_view_mut::<3, 3>(0, 0).copy_from(&down);
    taken.fixed_view_mut::<3, 3>(3, 0).copy_from(&(unseen * tilt));
    taken.fixed_view_mut::<3, 3>(3, 3).copy_from(&Matrix3::identity());
    let seconds = flight.clock().still_samples as f64 * flight.clock().sample_s();
    Found { seconds, state, taken, heading: unseen * Vector3::z() }
}

/// A constant that begins with what the still start has found of it.
fn column(gain: Gain, (mean, variance): (f64, f64), found: Option<&Found>, flight: &Flight) -> Column {
    let mut column = Column { state: SMatrix::zeros(), taken: SMatrix::zeros(), gain, mean, variance };
    if let Some(found) = found {
        // Over the still start a straight line has the value of its middle.
        let inputs = gain.inputs(&flight.course.standing(), -0.5 * found.seconds);
        column.state = found.state * inputs;
        column.taken = found.taken * inputs;
    }
    column
}

/// The attitude at the start.
fn alignment(flight: &Flight, found: Option<&Found>) -> Vec<Column> {
    let misalignment = flight.misalignment;
    let axes = [misalignment.tilt_sd_rad, misalignment.tilt_sd_rad, misalignment.heading_sd_rad];
    let given = axes.into_iter().enumerate().filter(|(axis, sd)| *sd > 0.0 && (*axis == 2 || found.is_none()));
    let column = |(axis, sd): (usize, f64)| {
        let mut column = column(Gain::None, (0.0, sd * sd), None, flight);
        column.state[axis] = 1.0;
        if let Some(found) = found {
            (0..3).for_each(|i| column.taken[3 + i] = found.heading[i]);
        }
        column
    };
    given.map(column).collect()
}

/// What readings take from elsewhere.
fn couplings(key: &'static Key, motion: &InMotion, found: Option<&Found>, flight: &Flight) -> Vec<Column> {
    let mut columns = Vec::new();
    for axis in 0..3 {
        let moments = motion.between[axis].moments(key);
        if moments == (0.0, 0.0) {
            continue;
        }
        for from in 0..3 {
            let gain = if *key == coupling::ACCELEROMETER_MISALIGNMENT && from < axis {
                Gain::Force(axis, from, 1)
            } else if *key == coupling::G_SENSITIVITY {
                Gain::Force(3 + axis, from, 1)
            } else if *key == coupling::GYRO_SCALE_FACTOR && from == axis
                || *key == coupling::GYRO_MISALIGNMENT && from != axis
            {
                Gain::Rate(3 + axis, from)
            } else {
                continue;
            };
            columns.push(column(gain, moments, found, flight));
        }
    }
    columns
}

/// What the axes have of one source: moments of its coefficient, SI.
struct Given {
    source: ErrorSource,
    moments: [(f64, f64); 3],
}

impl Given {
    fn of(source: ErrorSource, motion: &InMotion) -> Option<Self> {
        let moments = motion.tolerances.each_ref().map(|all| match source {
            ErrorSource::Mechanics => {
                (if all[&mechanics::RESONANCE].is_some() || all[&mechanics::MASS].is_some() { 1.0 } else { 0.0 }, 0.0)
            }
            ErrorSource::ForceNoise => all.moments(&mechanics::FORCE_NOISE),
            ErrorSource::Term(term) => all.given(term).map_or((0.0, 0.0), |key| all.moments(key)),
        });
        moments.iter().any(|m| *m != (0.0, 0.0)).then_some(Self { source, moments })
    }

    /// Mean squares of the coefficients at the inputs of a sense.
    fn squares(&self, sense: Sense) -> [f64; 6] {
        let first = if sense == Sense::Gyro { 3 } else { 0 };
        let mut squares = [0.0; 6];
        (0..3).for_each(|axis| squares[first + axis] = self.moments[axis].0.powi(2) + self.moments[axis].1);
        squares
    }

    /// The columns and families of the source; `None` where it has no place in a linear model.
    fn built(
        &self,
        flight: &Flight,
        found: Option<&Found>,
        stride: u64,
        step_s: f64,
    ) -> Option<(Vec<Column>, Vec<Family>)> {
        let constants = |gain: &dyn Fn(usize) -> Gain| -> (Vec<Column>, Vec<Family>) {
            let axis = |axis: usize| column(gain(axis), self.moments[axis], found, flight);
            ((0..3).map(axis).collect(), Vec::new())
        };
        let (term, sense) = match self.source {
            ErrorSource::Mechanics => return None,
            ErrorSource::ForceNoise => {
                return Some((Vec::new(), vec![white(self.squares(Sense::Accelerometer), found)]));
            }
            ErrorSource::Term(term) => (term, term.sense()),
        };
        let first = if sense == Sense::Gyro { 3 } else { 0 };
        Some(match term.law() {
            ErrorLaw::Rounding | ErrorLaw::FullScale => return None,
            ErrorLaw::Constant | ErrorLaw::Offset => constants(&|axis| Gain::One(first + axis)),
            ErrorLaw::Proportional(power) => constants(&|axis| match sense {
                Sense::Accelerometer => Gain::Force(axis, axis, power as i32),
                Sense::Gyro => Gain::Rate(3 + axis, axis),
            }),
            ErrorLaw::Force(power) => constants(&|axis| Gain::Force(first + axis, axis, power as i32)),
            ErrorLaw::Ramp => constants(&|axis| Gain::Time(first + axis, found.map_or(0.0, |f| f.seconds))),
            ErrorLaw::White(_) => (Vec::new(), vec![white(self.squares(sense), found)]),
            ErrorLaw::Walk(_) => (Vec::new(), vec![walk(self.squares(sense), found)]),
            ErrorLaw::Flicker(_) => (Vec::new(), self.flicker(term, flight, found, stride, step_s)),
        })
    }

    /// The terms of a bias instability.
    fn flicker(
        &self,
        term: SensorTerm,
        flight: &Flight,
        found: Option<&Found>,
        stride: u64,
        step_s: f64,
    ) -> Vec<Family> {
        let squares = self.squares(term.sense());
        let sample_s = flight.clock().sample_s();
        let mut families = Vec::new();
        let mut fast = [0.0; 6];
        for j in 0..flicker::terms(flight.clock().samples) {
            let variance = squares.map(|b| b * flicker::amplitude(j).powi(2));
            let hold = 4u64.pow(j as u32);
            if hold < stride {
                // White over a step: the sum of its covariances over all lags.
                let kept = (-1.0f64).exp();
                let seconds = hold as f64 * sample_s * (1.0 + kept) / (1.0 - kept);
                fast.iter_mut().zip(variance).for_each(|(f, v)| *f += v * seconds);
                continue;
            }
            let every = hold / stride;
            let (_, firsts) = flicker::hold_and_firsts(j, PHASES);
            for first in &firsts {
                // First renewals count from the beginning of the run, steps from the end of the still start.
                let first = (first + hold - flight.clock().still_samples % hold) % hold / stride;
                let process = Process::Held { every, first, variance };
                let mut family = Family::new(process, 1.0 / firsts.len() as f64);
                if let Some(found) = found {
                    let [of_mean, with_end] = held::mean_and_end(every, first, found.seconds / step_s);
                    let (mean, cross) = (variance.map(|v| v * of_mean), variance.map(|v| v * with_end));
                    family.found(&mean, &cross, &found.state, &found.taken);
                }
                families.push(family);
            }
        }
        if fast.iter().any(|f| *f > 0.0) {
            families.push(white(fast, found));
        }
        families
    }
}

/// White noise of these densities, N².
fn white(density: [f64; 6], found: Option<&Found>) -> Family {
    let mut family = Family::new(Process::White(density), 1.0);
    if let Some(found) = found {
        family.found(&density.map(|q| q / found.seconds), &[0.0; 6], &found.state, &found.taken);
    }
    family
}

/// Random walks with these K²: over a still start of T the mean has variance K²T/3, the end K²T, and both K²T/2.
fn walk(squares: [f64; 6], found: Option<&Found>) -> Family {
    let mut family = Family::new(Process::Walk(squares), 1.0);
    if let Some(found) = found {
        let by = |share: f64| squares.map(|k| k * found.seconds * share);
        family.found(&by(1.0 / 3.0), &by(0.5), &found.state, &found.taken);
        family.began(&by(1.0));
    }
    family
}
