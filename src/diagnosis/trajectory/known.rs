//! Tells what a motion next to its reference can know of an IMU and its place, what it finds, and the same
//! of its halves.
//!
//! Everything that nearly every unit has is fitted at once, next to what was named, so that nothing is
//! held at zero because it was too small to be named. Errors are those of slow waves of the recording
//! (`slow`): what the reference errs by lasts.

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::blocks::{BLOCKS, Linear};
use super::candidate::{self, Term};
use super::conclusion::Found;
use super::log::Log;
use super::parameters::{
    DRIFT, FORCE_BIAS, FORCE_MATRIX, FORCE_PLACES, FORCE_SCALE, G_SENSITIVITY, GYRO_BIAS, GYRO_MISALIGNMENT,
    GYRO_OFF_DIAGONAL, GYRO_SCALE, LEVER_ARM, MOUNTING, OFFSET, Point,
};
use super::plausible;
use super::published;
use super::scatter;
use super::slow::{self, deviation};
use crate::repeatability::information::{Information, Known};
use crate::repeatability::parameter::{Element, Estimate, Named, Parameter, Role};
use crate::repeatability::run::{Halves, Motion, Remedy, Run, Split};
use crate::sensor::Sense;
use crate::units::STANDARD_GRAVITY_M_S2;

/// Degrees of freedom of an error: as many as there are waves.
const FREEDOM: f64 = 8.0;
/// Sizes that are plausible before anything is recorded, where neither a data sheet nor the library says:
/// seconds between two clocks, and their rates.
const CLOCK: (f64, f64) = (0.1, 1e-3);
/// Width of the bins that rates are averaged over in the fit, s.
const AVERAGED_S: f64 = 0.05;

/// Parameters that are told, and those that are fitted next to them.
struct Question {
    library: Vec<&'static Term>,
    /// Those that are told first.
    active: Vec<usize>,
    told: usize,
    tolerance: Vec<f64>,
    /// States about which axes the body turns: elsewhere the gyro reads its own noise, and the fit would take
    /// that for turns.
    turns: [bool; 3],
    widths: Point,
}

/// Checks a motion.
pub(super) fn check(found: &Found<'_>, findings: Vec<String>) -> Run {
    let question = Question::of(found);
    let linear = &found.fit.linear;
    let (information, estimate) = question.answered(linear);
    let halves = |split: Split, first: &dyn Fn(usize) -> bool| {
        let each = [linear.part(first), linear.part(|block| !first(block))];
        Halves { split, each: each.map(|half| question.answered(&half).1) }
    };
    let divisions = [
        halves(Split::FirstAndSecond, &|block| 2 * block < BLOCKS),
        halves(Split::Alternating { parts: BLOCKS }, &|block| block % 2 == 0),
    ];
    let halves = Halves::least_lost(&estimate, divisions.into_iter());
    let motion = moved(found);
    let remedies = remedies(&motion, &estimate);
    Run { information, estimate, halves, motion: Some(motion), remedies, findings, besides: Vec::new() }
}

impl Question {
    fn of(found: &Found<'_>) -> Self {
        let halves = found.case.motion.halves;
        let library = candidate::terms(halves);
        let has = |p: &usize| library.iter().any(|t| t.parameters.contains(p));
        let base = found.selection.active();
        let usual = published::usual(&base, found.selection);
        // A mounting only where it was named: next to free axes of the gyro no motion tells it.
        let more = G_SENSITIVITY.filter(has).filter(|p| !usual.contains(p));
        let all: Vec<usize> = usual.iter().copied().chain(more).collect();
        let ranges = [
            GYRO_BIAS,
            FORCE_BIAS,
            GYRO_SCALE,
            GYRO_MISALIGNMENT,
            G_SENSITIVITY,
            OFFSET..OFFSET + 1,
            DRIFT..DRIFT + 1,
            MOUNTING,
            LEVER_ARM,
            FORCE_MATRIX.start..if halves.attitude { FORCE_MATRIX.end } else { FORCE_MATRIX.start },
        ];
        let mut active: Vec<usize> = ranges.into_iter().flatten().filter(|p| all.contains(p)).collect();
        let told = active.len();
        active.extend(all.into_iter().filter(|p| !active.contains(p)).collect::<Vec<_>>());
        let turns = turns(found.log);
        let widths = found.fit.linear.widths;
        let mut question = Self { library, active, told, tolerance: Vec::new(), turns, widths };
        question.tolerance = question.active.iter().map(|p| question.plausible(*p)).collect();
        question
    }

    fn term(&self, p: usize) -> Option<&'static Term> {
        self.library.iter().copied().find(|t| t.parameters.contains(&p))
    }

    /// Size that a parameter may have: that of the widest data sheet or of the library, else that of its
    /// prior.
    fn plausible(&self, p: usize) -> f64 {
        match p {
            OFFSET => CLOCK.0,
            DRIFT => CLOCK.1,
            p => plausible::bias(p)
                .or_else(|| self.term(p).map(Term::largest))
                .filter(|size| size.is_finite() && *size > 0.0)
                .unwrap_or_else(|| self.widths[p]),
        }
    }

    fn parameter(&self, p: usize) -> Parameter {
        let element = |sensor, role, axis, of| Parameter::Element(Element { sensor, role, axis, of, is_si: true });
        let within = |range: &std::ops::Range<usize>| p - range.start;
        match p {
            _ if GYRO_BIAS.contains(&p) => element(Sense::Gyro, Role::Bias, within(&GYRO_BIAS), None),
            _ if FORCE_BIAS.contains(&p) => element(Sense::Accelerometer, Role::Bias, within(&FORCE_BIAS), None),
            _ if GYRO_SCALE.contains(&p) => element(Sense::Gyro, Role::Scale, within(&GYRO_SCALE), None),
            _ if GYRO_MISALIGNMENT.contains(&p) => {
                let (i, j) = GYRO_OFF_DIAGONAL[within(&GYRO_MISALIGNMENT)];
                element(Sense::Gyro, Role::Misalignment, i, Some(j))
            }
            _ if FORCE_SCALE.contains(&p) => element(Sense::Accelerometer, Role::Scale, within(&FORCE_SCALE), None),
            _ if FORCE_MATRIX.contains(&p) => {
                let (i, j) = FORCE_PLACES[within(&FORCE_MATRIX)];
                element(Sense::Accelerometer, Role::Misalignment, i, Some(j))
            }
            _ if G_SENSITIVITY.contains(&p) => {
                let n = within(&G_SENSITIVITY);
                element(Sense::Gyro, Role::GSensitivity, n / 3, Some(n % 3))
            }
            _ => self.named(p),
        }
    }

    /// A parameter of the setup, and of no sensor, as the library names it.
    fn named(&self, p: usize) -> Parameter {
        let axis = |start: usize| ["x", "y", "z"][(p - start).min(2)];
        let (name, unit, factor) = match (p, self.term(p)) {
            (OFFSET, _) => ("time offset".to_owned(), "ms", 1e3),
            (DRIFT, _) => ("clock drift".to_owned(), "ppm", 1e6),
            (_, Some(term)) => {
                let name = format!("{} {}", term.id().replace('-', " "), axis(term.parameters.start));
                (name, term.unit.name, term.unit.per_si)
            }
            (p, None) => (format!("parameter {p}"), "SI", 1.0),
        };
        Parameter::Named(Named { name, unit: unit.to_owned(), factor })
    }

    /// Knowledge and estimates of some of the blocks.
    fn answered(&self, linear: &Linear) -> (Information, Estimate) {
        let Self { active, told, tolerance, turns, .. } = self;
        let solved = linear.solve(active, |_| true);
        let apart = slow::apart(linear, active, &solved);
        let mut information = Information::of(&linear.information(active), tolerance);
        let white = |i: usize| solved.covariance[(i, i)].max(0.0).sqrt();
        let error = |i: usize| deviation(&|point| point[active[i]], &solved.point, &apart).max(white(i));
        let errors: Vec<f64> = (0..*told).map(error).collect();
        information.without_from(*told);
        for (i, known) in information.known.iter_mut().enumerate() {
            let by_error = Known::by_error(errors[i] / tolerance[i]);
            let is_shown = of_turns_about(active[i]).is_none_or(|axis| turns[axis]);
            *known = (*known).max(if is_shown { by_error } else { Known::Not });
        }
        let covariance = DMatrix::from_fn(*told, *told, |i, j| {
            solved.covariance[(i, j)] / (white(i) * white(j)).max(f64::MIN_POSITIVE) * errors[i] * errors[j]
        });
        let is_scale = |p: &usize| GYRO_SCALE.contains(p) || FORCE_SCALE.contains(p);
        let value = |p: &usize| if is_scale(p) { 1.0 + solved.point[*p] } else { solved.point[*p] };
        let estimate = Estimate {
            parameters: active[..*told].iter().map(|p| self.parameter(*p)).collect(),
            tolerance: tolerance[..*told].to_vec(),
            value: active[..*told].iter().map(value).collect(),
            covariance,
            freedom: vec![FREEDOM; *told],
            known: information.known.clone(),
        };
        (information, estimate)
    }
}

/// The axis whose turns show a parameter of the gyro.
fn of_turns_about(p: usize) -> Option<usize> {
    match p {
        p if GYRO_SCALE.contains(&p) => Some(p - GYRO_SCALE.start),
        p if GYRO_MISALIGNMENT.contains(&p) => Some(GYRO_OFF_DIAGONAL[p - GYRO_MISALIGNMENT.start].1),
        _ => None,
    }
}

/// Returns the axes that the body turns about. At least half the variance of such a rate, averaged as in the fit, is
/// neither white noise nor proportional to the other two rates: a misaligned axis reads those as well.
fn turns(log: &Log) -> [bool; 3] {
    let rate_hz = 1.0 / log.interval_s;
    let bin = ((AVERAGED_S * rate_hz) as usize).max(1);
    let noise = scatter::floor(&log.rate, rate_hz) * rate_hz / (2 * bin) as f64;
    let means: Vec<Vector3<f64>> =
        log.rate.chunks_exact(bin).map(|rates| rates.iter().sum::<Vector3<f64>>() / rates.len() as f64).collect();
    let count = means.len().max(1) as f64;
    let centre = means.iter().sum::<Vector3<f64>>() / count;
    let apart = |mean: &Vector3<f64>| (mean - centre) * (mean - centre).transpose() / count;
    let covariance = means.iter().map(apart).sum::<Matrix3<f64>>() + Matrix3::identity() * f64::MIN_POSITIVE.sqrt();
    // What the others leave of a variance is one over the diagonal of the inverse.
    let inverse = covariance.try_inverse().unwrap_or_else(Matrix3::identity);
    [0, 1, 2].map(|axis| 1.0 / inverse[(axis, axis)] > 2.0 * noise)
}

/// Angles turned through, and the specific force along each axis.
fn moved(found: &Found<'_>) -> Motion {
    let log = found.log;
    let bias = found.fit.linear.point;
    let bias = Vector3::new(bias[GYRO_BIAS.start], bias[GYRO_BIAS.start + 1], bias[GYRO_BIAS.start + 2]);
    let turned: Vector3<f64> = log.rate.iter().map(|rate| (rate - bias).abs() * log.interval_s).sum();
    let end = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
        log.force.iter().map(|f| f[axis] / STANDARD_GRAVITY_M_S2).fold(from, pick)
    };
    let reached = [0, 1, 2].map(|axis| [end(axis, f64::min, f64::INFINITY), end(axis, f64::max, f64::NEG_INFINITY)]);
    Motion { poses: None, left_out: Vec::new(), turned_rad: Some(turned.into()), reached }
}

/// Turns that would tell the scale of each axis that is not determined as well as that of the best.
fn remedies(motion: &Motion, estimate: &Estimate) -> Vec<Remedy> {
    let scale = |axis: usize| {
        let is_it =
            |p: &Parameter| p.element().is_some_and(|e| (e.sensor, e.role, e.axis) == (Sense::Gyro, Role::Scale, axis));
        estimate.parameters.iter().position(is_it)
    };
    let errors = (0..3).filter_map(|axis| Some((axis, scale(axis)?)));
    let told = errors.clone().filter(|(_, p)| estimate.determines(*p));
    let best = told.map(|(axis, p)| (axis, estimate.deviation(p))).min_by(|a, b| a.1.total_cmp(&b.1));
    let (Some((other, to)), Some(turned_rad)) = (best, motion.turned_rad) else { return Vec::new() };
    let missing = errors.filter(|(_, p)| !estimate.determines(*p));
    missing.map(|(axis, _)| Remedy::AsAbout { axis, other, turned_rad: turned_rad[other], to }).collect()
}
