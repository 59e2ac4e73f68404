//! Tests what a model leaves: of the samples that were fitted, and of those outside, which `--test` or
//! `[split]` names. A law that was found in one recording need not hold in another.

use std::ops::Range;

use crate::detection::Predictability;
use crate::driven::base::OFFSET;
use crate::driven::identification::fit::{Fit, Search};
use crate::driven::intake::data::Data;
use crate::driven::selection::held_out::{LEAD, with_state_at};
use crate::driven::selection::judged::Judged;
use crate::driven::selection::noise_character::disturbance_by_chance;
use crate::driven::selection::residual_structure::{EVEN, Residual, of_noise, power_structure};
use crate::driven::simulation::run::{Run, trace};
use crate::driven::simulation::structure::coordinates;
use crate::gate::Gate;
use crate::physics::scales::Scales;
use crate::remainder::{REAL, Remainder, Size, Test};
use crate::trace::Step;

/// Share of the innovations' variance that may be predicted before they are no longer called white.
pub(crate) const WHITE: f64 = 0.02;
/// A residual with less structure than this fraction, with no candidate that earns a name, is too
/// faint to show that the library fails.
const FAINT: f64 = 0.05;
/// Questions that are asked of the residual: structure in the innovations, structure in their
/// power, a disturbance.
pub(super) const QUESTIONS: f64 = 3.0;

/// Tests how much of a residual its past, the input and the state foretell.
pub(crate) fn remembers(left: &Predictability) -> Test {
    Test { p_value: QUESTIONS * left.p_value, size: Size::of(left.r_squared, WHITE, FAINT) }
}

/// The three questions asked of what a model leaves.
pub(super) fn of_what_was_fitted(data: &Data, model: &Judged, after: &Residual) -> Remainder {
    let structure = remembers(&after.structure);
    // Noise of the sensor's own keeps its strength whatever the sensor does; what does not is a
    // stand-in for physics.
    let power = model.fit.structure.is_noisy().then(|| power_structure(data, &model.fit));
    let kept = |t: &Test, step: Step| t.found() == Size::Negligible || data.trace.acts(step);
    let power = power.and_then(|p| {
        let test = Test { p_value: QUESTIONS * p.p_value, size: Size::of(p.r_squared, EVEN, f64::INFINITY) };
        let step = Step::of(Gate::NoisePower, "noise", "remainder").measured(p.r_squared, EVEN);
        kept(&test, step).then_some(test)
    });
    // A disturbance does not show that the library fails.
    let errors = &model.fit.linear.residual;
    let fresh = after.coloured.as_ref().map(|c| c.whitened(errors));
    let by_chance = QUESTIONS * disturbance_by_chance(fresh.as_ref().unwrap_or(errors));
    let disturbance = Test { p_value: by_chance, size: Size::Faint };
    let step = Step::of(Gate::Disturbance, "noise", "faint remainder").measured(by_chance, REAL);
    let disturbance = kept(&disturbance, step).then_some(disturbance);
    Remainder::of([structure].into_iter().chain(disturbance).chain(power))
}

/// Tests the residual of each range outside, with the offset and the beginning that fit there; noise
/// where there is none, and where the response is chaotic, as no simulation of it lasts.
pub(super) fn of_what_was_not(data: &Data, fit: &Fit, scales: &Scales) -> Remainder {
    if !data.own_test || data.windows.is_some() {
        return Remainder::of([]);
    }
    let ranges: Vec<&Range<usize>> = data.test.iter().filter(|r| is_outside(data, r)).collect();
    let several = ranges.len() as f64;
    let test = |range: &&Range<usize>| {
        let left = remembers(&of_noise_there(data, fit, scales, range));
        Test { p_value: several * left.p_value, ..left }
    };
    Remainder::of(ranges.iter().map(test))
}

/// Returns the structure that the innovations of a range outside give away.
fn of_noise_there(data: &Data, fit: &Fit, scales: &Scales, range: &Range<usize>) -> Predictability {
    let mut free = fit.structure.beginnings();
    free.push(OFFSET);
    let run = Run { range: range.clone(), steps: fit.steps, corrected: false };
    let search = Search {
        data,
        structure: &fit.structure,
        point: with_state_at(data, fit, scales, range),
        free,
        coordinates: coordinates(&fit.structure, scales),
        run: run.clone(),
        rows: vec![range.clone()],
    };
    let point = search.minimise(10).map_or_else(|| search.point.clone(), |m| search.point(&m.z));
    let (mut innovations, mut states) = trace(data, &fit.structure, &point, &Run { corrected: true, ..run });
    let lead = LEAD.min(range.len() / 4);
    innovations.drain(..lead);
    states.x.drain(..lead);
    states.v.drain(..lead);
    let here = range.start + lead..range.end;
    let there = Data { hull: here.clone(), breaks: Vec::new(), train: vec![here], ..data.clone() };
    of_noise(&there, fit, (innovations, states)).structure
}

fn is_outside(data: &Data, range: &Range<usize>) -> bool {
    range.start >= data.hull.end || range.end <= data.hull.start
}
