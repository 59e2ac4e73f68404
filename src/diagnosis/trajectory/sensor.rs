//! From what was named to the sensor that a study runs.

use std::ops::Range;

use super::candidate::{AXIS_SWAP, REFERENCE_NOISE, Term};
use super::clipping::Limit;
use super::course::{Case, vector};
use super::fitted::Fitted;
use super::parameters::{
    DRIFT, EARTH_RATE, FORCE_BIAS, FORCE_MISALIGNMENT, FORCE_PLACES, FORCE_SCALE, FORCE_WANDER, G_SENSITIVITY,
    GYRO_BIAS, GYRO_MISALIGNMENT, GYRO_SCALE, GYRO_WANDER, LEVER_ARM, LOWPASS, OFFSET,
};
use super::permutation::Permutation;
use super::repaired::{Along, Repaired};
use super::selection::{Named, Selection};
use super::start::Start;
use crate::by_axis::Drawn;
use crate::model::Reference;

/// Holds what the sensor is made from.
pub(super) struct Diagnosed<'a> {
    /// The log and its reference.
    pub case: &'a Case<'a>,
    /// Axes that the search began with.
    pub start: &'a Start,
    /// Holds what was named.
    pub selection: &'a Selection,
    /// The chosen model.
    pub chosen: &'a Fitted,
    /// The same with clock and mounting free, from which biases are taken.
    pub seated: &'a Fitted,
    /// The reference as the model names it.
    pub reference: &'a Reference,
    /// Latitude, °, and height, m, where they are stated.
    pub place: Option<(f64, f64)>,
    /// Limits of gyro and accelerometer.
    pub limits: &'a [Vec<Limit>; 2],
    /// One-sided noise densities of gyro and accelerometer in motion, unit/√Hz.
    pub density: [f64; 2],
    /// States whether the reference was found to err.
    pub errs: bool,
}

impl Diagnosed<'_> {
    /// The sensor with what was named.
    pub(super) fn repaired(&self) -> Repaired {
        let (motion, chosen) = (self.case.motion, self.chosen);
        let three = |fitted: &Fitted, start: usize| [0, 1, 2].map(|i| fitted.drawn(start + i));
        let of = |start: usize| chosen.point[start];
        let misaligned = |row: usize| [0, 1].map(|n| of(GYRO_MISALIGNMENT.start + 2 * row + n));
        let sensitive = |row: usize| [0, 1, 2].map(|n| of(G_SENSITIVITY.start + 3 * row + n));
        // What is free next to positions alone is not judged, and no study has it.
        let named = |range: Range<usize>| {
            let is_it = |n: &&Named| n.standing.term.parameters == range;
            self.selection.named.iter().find(is_it).map(|_| range.clone())
        };
        let askew = |row: usize| {
            let all = FORCE_MISALIGNMENT.filter(|p| FORCE_PLACES[p - FORCE_SCALE.start].0 == row);
            named(FORCE_MISALIGNMENT).map_or(Vec::new(), |_| all.map(of).collect())
        };
        let ends = [motion.time_s.first(), motion.time_s.last()];
        Repaired {
            along: Along {
                reference: self.reference.clone(),
                lacks: motion.halves.lacks(),
                ends_s: ends.map(|t| t.copied().unwrap_or_default() + motion.zero_s),
                place: self.place,
                earth_turns: EARTH_RATE.clone().any(|p| chosen.has(p)),
            },
            gyro_bias: three(self.seated, GYRO_BIAS.start),
            force_bias: three(self.seated, FORCE_BIAS.start),
            force_scale: named(FORCE_SCALE).map_or([Drawn::default(); 3], |range| three(chosen, range.start)),
            force_misalignment: [1, 2].map(askew),
            gyro_scale: three(chosen, GYRO_SCALE.start),
            gyro_misalignment: [0, 1, 2].map(misaligned),
            g_sensitivity: [0, 1, 2].map(sensitive),
            // With the lag of a low-pass, which a study has no other key for.
            time_offset: chosen.drawn(OFFSET),
            clock_drift: chosen.drawn(DRIFT),
            middle_s: motion.middle_s() + motion.zero_s,
            density: self.density,
            range: [0, 1].map(|kind| self.limits[kind].iter().map(|limit| limit.value).reduce(f64::min)),
            mounting: self.case.mounting(&chosen.point),
            lever_arm_m: vector(&chosen.point, LEVER_ARM.start).into(),
            not_expressible: self.not_expressible(),
        }
    }

    /// Returns what was named and has no key in a study.
    fn not_expressible(&self) -> Vec<String> {
        let without = [GYRO_WANDER.start, FORCE_WANDER.start, LOWPASS];
        let lacks = |term: &&Term| {
            without.contains(&term.parameters.start) || (term.parameters == EARTH_RATE && self.place.is_none())
        };
        let terms = self.selection.named.iter().map(|n| n.standing.term);
        let but = |t: &Term| if t.parameters.contains(&LOWPASS) { "; its lag is in time_offset_us" } else { "" };
        let mut all: Vec<String> =
            terms.filter(lacks).map(|t| format!("{} ({}){}", t.phrase(), t.candidate.equation, but(t))).collect();
        if [self.start.gyro, self.start.accelerometer].iter().any(|p| *p != Permutation::NONE) {
            all.push(format!("{}: its axes are taken as they ought to be", AXIS_SWAP.id));
        }
        if self.errs {
            all.push(format!("{}: the study takes the reference for the truth", REFERENCE_NOISE.id));
        }
        all
    }
}
