//! Tests what a model leaves: of the samples that were fitted, and of those outside, which `--test` or
//! `[split]` names. A law that was found in one recording need not hold in another.

use std::ops::Range;

use crate::detection::Predictability;
use crate::driven::identification::fit::{Fit, fit as fitted};
use crate::driven::intake::data::Data;
use crate::driven::selection::held_out::LEAD;
use crate::driven::selection::judged::Judged;
use crate::driven::selection::noise_character::disturbance_by_chance;
use crate::driven::selection::residual_structure::{Residual, of_noise};
use crate::driven::simulation::filter::States;
use crate::driven::simulation::run::trace;
use crate::gate::Gate;
use crate::physics::scales::Scales;
use crate::remainder::{REAL, Remainder, Size, Test};
use crate::trace::Step;

/// Share of the innovations' variance that may be predicted before they are no longer called white.
pub(crate) const WHITE: f64 = 0.02;
/// A residual with less structure than this fraction, with no candidate that earns a name, is too
/// faint to show that the library fails.
const FAINT: f64 = 0.05;
/// Questions that are asked of the residual: structure in the innovations, a disturbance.
pub(super) const QUESTIONS: f64 = 2.0;

/// Iterations of the fit to all samples.
const ITERATIONS: usize = 20;

/// Tests how much of a residual its past, the input and the state foretell.
pub(crate) fn remembers(left: &Predictability) -> Test {
    Test { p_value: QUESTIONS * left.p_value, size: Size::of(left.r_squared, WHITE, FAINT) }
}

/// The two questions asked of what a model leaves.
pub(super) fn of_what_was_fitted(data: &Data, model: &Judged, after: &Residual) -> Remainder {
    let structure = remembers(&after.structure);
    // A disturbance does not show that the library fails.
    let errors = &model.fit.linear.residual;
    let fresh = after.coloured.as_ref().map(|c| c.whitened(errors));
    let by_chance = QUESTIONS * disturbance_by_chance(fresh.as_ref().unwrap_or(errors));
    let disturbance = Test { p_value: by_chance, size: Size::Faint };
    let step = Step::of(Gate::Disturbance, "noise", "faint remainder").measured(by_chance, REAL);
    let is_heard = disturbance.found() == Size::Negligible || data.trace.acts(step);
    Remainder::of([structure].into_iter().chain(is_heard.then_some(disturbance)))
}

/// Tests what the model leaves of each range outside when it is fitted to those as well: what one
/// recording leaves open another may settle, and what both cannot share is left. Noise where there is
/// no such range, and where the response is chaotic, as no simulation of it lasts.
pub(super) fn of_what_was_not(data: &Data, fit: &Fit, scales: &Scales) -> Remainder {
    let outside: Vec<&Range<usize>> = data.test.iter().filter(|r| is_outside(data, r)).collect();
    if !data.own_test || data.windows.is_some() || outside.is_empty() {
        return Remainder::of([]);
    }
    let together = with_all(data, &outside);
    let Some(joint) = fitted(&together, &fit.structure, &fit.point, scales, ITERATIONS) else {
        return Remainder::of([Test { p_value: 0.0, size: Size::Material }]);
    };
    let run = joint.run(&together, true);
    let (innovations, states) = trace(&together, &joint.structure, &joint.point, &run);
    let several = outside.len() as f64;
    let test = |range: &&Range<usize>| {
        let here = range.start + LEAD.min(range.len() / 4)..range.end;
        let rows = here.start - together.hull.start..here.end - together.hull.start;
        let at = States { x: states.x[rows.clone()].to_vec(), v: states.v[rows.clone()].to_vec() };
        let there = Data { hull: here.clone(), breaks: Vec::new(), train: vec![here], ..data.clone() };
        let left = of_noise(&there, &joint, (innovations[rows].to_vec(), at)).structure;
        // What is faint does not say that both recordings differ.
        Test { p_value: several * QUESTIONS * left.p_value, size: Size::of(left.r_squared, FAINT, FAINT) }
    };
    Remainder::of(outside.iter().map(test))
}

/// All samples to be fitted, those of each range outside with an offset and a beginning of their own.
fn with_all(data: &Data, outside: &[&Range<usize>]) -> Data {
    let mut train: Vec<Range<usize>> = data.train.iter().cloned().chain(outside.iter().map(|r| (*r).clone())).collect();
    train.sort_by_key(|r| r.start);
    let mut starts: Vec<usize> =
        data.recordings().iter().map(|r| r.start).chain(outside.iter().map(|r| r.start)).collect();
    starts.sort_unstable();
    let hull = starts[0]..train.iter().map(|r| r.end).max().unwrap_or(data.hull.end).max(data.hull.end);
    Data { hull, breaks: starts.split_off(1), train, ..data.clone() }
}

fn is_outside(data: &Data, range: &Range<usize>) -> bool {
    range.start >= data.hull.end || range.end <= data.hull.start
}
