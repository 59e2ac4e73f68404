//! Measures how far a named law of a decay departs from the form that its name states.

use crate::driven::verdict::form::Split;
use crate::engine::evidence::Gain;
use crate::engine::fit::Fitted;
use crate::engine::kind::Kind;
use crate::numerics::moments::rms;
use crate::numerics::order;
use crate::physics::free_form::{Argument, VALUES};
use crate::physics::library::Term;
use crate::verdict::Form;

use super::searched::Decay;

/// Places of the curve that is kept.
const PLACES: usize = 41;
/// Visits that the departure is weighed by.
const VISITS: usize = 400;

/// The free form that `freed` has instead of a law of the final model; `None` where it is not one
/// of displacement or velocity.
pub(super) fn form(decay: &Decay, freed: &Fitted, gain: Gain) -> Option<Form> {
    let law = freed.set.iter().position(|l| !decay.found.model.set.contains(l))?;
    let Term::FreeForm(form) = decay.system.members[freed.set[law]].term else { return None };
    if form.law.argument() != Argument::Displacement && form.law.argument() != Argument::Velocity {
        return None;
    }
    let states = decay.passed(freed);
    let mut visited = if form.law.argument() == Argument::Velocity { states.v } else { states.x };
    visited.retain(|v| v.is_finite());
    order::sort(&mut visited);
    let last = visited.len().checked_sub(1)?;
    let at: Vec<f64> = (0..VISITS).map(|i| visited[last * i / (VISITS - 1)]).collect();
    let mut values =
        decay.system.shared_values(&freed.set, &freed.point)[decay.system.coordinates(&freed.set, law)].to_vec();
    values.resize(VALUES, 0.0);
    let curve = |at: &[f64]| -> Vec<f64> { at.iter().map(|a| form.curve::<f64, false>(&values, *a)).collect() };
    let whole = curve(&at);
    let split = Split::of(&form, &values, &at, &whole)?;
    let departure = rms(split.rest.iter().copied()) / rms(split.stated.iter().copied()).max(1e-300);
    if !departure.is_finite() {
        return None;
    }
    // A departure is a square root of what it gains.
    let half = departure / gain.errors.max(1.0);
    let (from, to) = (visited[0], visited[last]);
    let places: Vec<f64> = (0..PLACES).map(|i| from + (to - from) * i as f64 / (PLACES - 1) as f64).collect();
    Some(Form {
        law: form.law,
        stated: form.law.stated().to_owned(),
        departure,
        ci95: [(departure - half).max(0.0), departure + half],
        curve: curve(&places).iter().zip(&places).map(|(f, a)| [*a, f - split.base(*a)]).collect(),
        stated_curve: places.iter().map(|a| [*a, split.stated_at(*a)]).collect(),
        departs: true,
    })
}
