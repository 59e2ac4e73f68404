//! States what a motion does not determine: candidates that it tells nothing of, and elements of a named one.

use super::account::{Hidden, Manoeuvre};
use super::blocks::Linear;
use super::candidate::Term;
use super::fit::Fit;
use super::judgement::Standing;
use super::parameters::{FORCE_MATRIX, GYRO_MISALIGNMENT, GYRO_SCALE, MOUNTING};
use super::selection::Named;
use super::shown;
use crate::numerics::special::normal_quantile;
use crate::sensor::Sense;

/// Half an interval over the smallest size that matters, beyond which the motion tells nothing of
/// it.
const WIDE: f64 = 10.0;

/// Parameters of axes about which nothing turns, of mounting, scale and misalignment: the readings that they
/// multiply are noise, which has no information of them, however much of it there is. `own` are N² of gyro and
/// accelerometer, SI.
pub(super) fn open(fit: &Fit, own: [f64; 2]) -> Vec<usize> {
    let silent = |p: &usize| {
        fit.residuals.iter().all(|r| shown::noise_in((&r.rows, r.half, r.width_s), own, *p) > shown::MOST_NOISE)
    };
    MOUNTING.chain(GYRO_SCALE).chain(GYRO_MISALIGNMENT).chain(FORCE_MATRIX).filter(silent).collect()
}

/// Part of the prior's standard deviation that is left of a parameter which the motion tells: what is known no better
/// was known before.
const LEARNT: f64 = 0.5;

/// Those of the parameters of a model that it determines next to all others: a fit of the rest would go astray, and
/// what is linear about that point is not about the true one.
pub(super) fn told(linear: &Linear, active: &[usize], library: &[&'static Term]) -> Vec<usize> {
    let covariance = linear.solve(active, |_| true).covariance;
    let is_told = |(i, p): &(usize, &usize)| {
        let deviation = covariance[(*i, *i)].max(0.0).sqrt();
        let half = normal_quantile(0.975) * deviation;
        let is_learnt = deviation < LEARNT * linear.widths[**p];
        let is_shown = shown::shows(linear, **p, deviation * deviation) && is_learnt;
        library.iter().find(|t| t.parameters.contains(p)).is_none_or(|term| is_shown && term.knows(half))
    };
    active.iter().enumerate().filter(is_told).map(|(_, p)| *p).collect()
}

/// Says which numbers of a named term the motion does not determine, and that none is given for them.
pub(super) fn elements(named: &Named) -> Option<String> {
    let names = named.standing.undetermined();
    let phrase = named.standing.term.phrase();
    (!names.is_empty()).then(|| {
        format!("this motion does not determine {} of {phrase}, and no number is given for it", names.join(", "))
    })
}

/// A term whose interval is so wide that the recording says nothing of it.
pub(super) fn hidden(standing: &Standing) -> Option<Hidden> {
    let term = standing.term;
    let widest = term.size(standing.half_widths.iter().copied().fold(0.0, f64::max));
    let elements = standing.undetermined();
    (widest > WIDE * term.smallest).then(|| Hidden {
        term,
        elements: if elements.len() < term.names.len() { elements } else { Vec::new() },
        half_width: widest * term.unit.per_si,
        manoeuvre: match (term.id(), term.sensor) {
            ("earth-rate", _) => Manoeuvre::Longer,
            ("lever-arm", _) => Manoeuvre::FigureEight,
            ("g-sensitivity", _) | (_, Some(Sense::Accelerometer)) => Manoeuvre::SixPositions,
            (_, Some(Sense::Gyro)) => Manoeuvre::TurnEveryAxis,
            _ => Manoeuvre::FigureEight,
        },
    })
}
