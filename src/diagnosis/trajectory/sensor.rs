//! From what was named to the sensor that a study runs.

use nalgebra::Vector3;

use super::candidate::{AXIS_SWAP, REFERENCE_NOISE, SATURATION, Term};
use super::conclusion::{Examined, Found};
use super::course::vector;
use super::parameters::{
    DRIFT, EARTH_RATE, FORCE_BIAS, FORCE_WANDER, G_SENSITIVITY, GYRO_BIAS, GYRO_MISALIGNMENT, GYRO_SCALE, GYRO_WANDER,
    LEVER_ARM, OFFSET,
};
use super::permutation::Permutation;
use super::published::Fitted;
use super::repaired::{Along, Repaired};
use super::scatter;
use super::vibration::Vibration;
use crate::diagnosis::model::Noise;

/// The sensor with what was named: biases as the base model has them, with clock and mounting free;
/// the rest as chosen. `errs`: whether the reference was found to err.
pub(super) fn repaired(
    examined: &Examined<'_>,
    found: &Found<'_>,
    [chosen, seated]: [&Fitted; 2],
    errs: bool,
) -> Repaired {
    let motion = found.case.motion;
    let three = |fitted: &Fitted, start: usize| [0, 1, 2].map(|i| fitted.drawn(start + i));
    let of = |start: usize| chosen.point[start];
    let misaligned = |row: usize| [0, 1].map(|n| of(GYRO_MISALIGNMENT.start + 2 * row + n));
    let sensitive = |row: usize| [0, 1, 2].map(|n| of(G_SENSITIVITY.start + 3 * row + n));
    let rate_hz = 1.0 / found.log.interval_s;
    let density = |stated: Option<Noise>, vibration: &Option<Vibration>, readings: &[Vector3<f64>]| match vibration {
        Some(vibration) => vibration.density,
        None => stated.map_or_else(|| scatter::floor(readings, rate_hz).sqrt(), |noise| noise.density),
    };
    let ends_s = [motion.time_s.first(), motion.time_s.last()].map(|t| t.copied().unwrap_or_default() + motion.zero_s);
    Repaired {
        along: Along {
            reference: found.reference.clone(),
            whole: motion.has_position,
            ends_s,
            place: found.place,
            earth_turns: EARTH_RATE.clone().any(|p| chosen.has(p)),
        },
        gyro_bias: three(seated, GYRO_BIAS.start),
        force_bias: three(seated, FORCE_BIAS.start),
        gyro_scale: three(chosen, GYRO_SCALE.start),
        gyro_misalignment: [0, 1, 2].map(misaligned),
        g_sensitivity: [0, 1, 2].map(sensitive),
        time_offset: chosen.drawn(OFFSET),
        density: [
            density(examined.stated.gyro, &examined.vibration[0], &found.log.rate),
            density(examined.stated.accelerometer, &examined.vibration[1], &found.log.force),
        ],
        range_m_s2: examined.limits[1].iter().map(|limit| limit.value).reduce(f64::min),
        mounting: found.case.mounting(&chosen.point),
        lever_arm_m: vector(&chosen.point, LEVER_ARM.start).into(),
        not_expressible: not_expressible(examined, found, errs),
    }
}

/// What was named and has no key in a study.
fn not_expressible(examined: &Examined<'_>, found: &Found<'_>, errs: bool) -> Vec<String> {
    let without = [DRIFT, GYRO_WANDER.start, FORCE_WANDER.start];
    let lacks = |term: &&Term| {
        without.contains(&term.parameters.start) || (term.parameters == EARTH_RATE && found.place.is_none())
    };
    let terms = found.selection.named.iter().map(|n| n.standing.term);
    let mut all: Vec<String> =
        terms.filter(lacks).map(|t| format!("{} ({})", t.phrase(), t.candidate.equation)).collect();
    if [found.start.gyro, found.start.accelerometer].iter().any(|p| *p != Permutation::NONE) {
        all.push(format!("{}: its axes are taken as they ought to be", AXIS_SWAP.id));
    }
    if !examined.limits[0].is_empty() {
        all.push(format!("{} of the gyro: a study limits the accelerometer alone", SATURATION.id));
    }
    if errs {
        all.push(format!("{}: the study takes the reference for the truth", REFERENCE_NOISE.id));
    }
    all
}
