//! A spring that seems to change with the amplitude, in a motion that dies away by itself: the
//! amplitude is a course of time there, and a spring that changes with time is told from the other by
//! the shape of each swing alone. Each is held against the other with its form free. Where the chosen
//! one departs from its stated form, some course of time may do the same, and the two are tied.

use crate::driven::identification::fit::{Fit, fit};
use crate::driven::intake::data::Data;
use crate::driven::intake::work::Budget;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::physics::stiffness_drift::StiffnessDrift;

use super::earned::{ITERATIONS, earned};
use super::forms::{IMMATERIAL, freed};
use super::held_out::compare;
use super::judged::{Departing, Rival, Selection, judge};
use super::rivals::TIE;

/// Which spring could be mistaken for this one in a ring-down.
fn counterpart(term: &Term) -> Option<Term> {
    match term {
        Term::CubicStiffness(_) | Term::QuadraticStiffness(_) => {
            Some(Term::StiffnessDrift(StiffnessDrift { environment: None }))
        }
        Term::StiffnessDrift(StiffnessDrift { environment: None }) => Some(Term::CubicStiffness(Default::default())),
        _ => None,
    }
}

/// The other spring takes the place of the one chosen where its free form does better, and is tied
/// with it where it does as well, or where the one chosen departs from its stated form.
pub(super) fn settle_ring_down(data: &Data, selection: &mut Selection, scales: &Scales, budget: Budget) {
    let here = selection.departing.as_ref().map_or(&selection.chosen, |d| &d.judged);
    let [term] = selection.chosen.fit.structure.terms[..] else { return };
    let Some(other) = counterpart(&term).filter(|_| data.input.is_none() && here.fit.structure.terms.len() == 1) else {
        return;
    };
    if data.work.is_spent(budget) {
        selection.rivals_left_out = true;
        return;
    }
    let base = &selection.base.fit;
    let Some(start) = other.starts(scales).first().cloned() else { return };
    let (structure, point) = base.with(other, &start);
    let stated = Fit { structure, point, ..base.clone() };
    let found = freed(data, &stated, 0, scales, false).filter(|found| !found.at_bound(scales));
    let found = found.map(|found| Departing { judged: judge(data, found, scales), index: 0 });
    let lead = found.as_ref().map_or(f64::NEG_INFINITY, |found| found.judged.score() - here.score());
    if lead <= TIE {
        if lead >= -TIE || selection.departing.is_some() {
            let Some(stated) = fit(data, &stated.structure, &stated.point, scales, ITERATIONS) else { return };
            selection.rivals.resize_with(1, Vec::new);
            selection.rivals[0].push(Rival { judged: judge(data, stated, scales), id: other.id() });
        }
        return;
    }
    let Some(found) = found else { return };
    let Some(judged) = found.as_stated(data, &stated, scales) else { return };
    let gain = compare(&judged.held_out, &found.judged.held_out).gain;
    let departs = gain >= IMMATERIAL && earned(data, &judged, &found.judged, scales, selection.tried).is_some();
    (selection.chosen, selection.rivals) = (judged, vec![Vec::new()]);
    selection.departing = departs.then_some(found);
}
