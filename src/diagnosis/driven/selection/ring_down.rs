//! A spring that seems to change with the amplitude, in a motion that dies away by itself: the
//! amplitude is a course of time there, and a spring that changes with time is told from the other by
//! the shape of each swing alone. Each is held against the other with its form free.

use crate::diagnosis::driven::identification::fit::Fit;
use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::intake::work::Budget;
use crate::physics::library::Term;
use crate::physics::scales::Scales;
use crate::physics::stiffness_drift::StiffnessDrift;

use super::earned::earned;
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
/// with it where it does as well.
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
    let Some(found) = freed(data, &stated, 0, scales, false) else { return };
    let found = Departing { judged: judge(data, found, scales), index: 0 };
    let lead = found.judged.score() - here.score();
    if lead < -TIE || found.judged.fit.at_bound(scales) {
        return;
    }
    let Some(judged) = found.as_stated(data, &stated, scales) else { return };
    if lead <= TIE {
        selection.rivals.resize_with(1, Vec::new);
        selection.rivals[0].push(Rival { judged, id: other.id() });
        return;
    }
    let gain = compare(&judged.held_out, &found.judged.held_out).gain;
    let departs = gain >= IMMATERIAL && earned(data, &judged, &found.judged, scales, selection.tried).is_some();
    (selection.chosen, selection.rivals) = (judged, vec![Vec::new()]);
    selection.departing = departs.then_some(found);
}
