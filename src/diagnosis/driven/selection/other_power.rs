//! Whether a stop is told from a spring of another power than the library's.

use crate::diagnosis::driven::intake::data::Data;
use crate::diagnosis::driven::intake::work::Budget;
use crate::physics::free_form::{Extent, FreeForm};
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::forms::freed;
use super::judged::{Rival, Selection, judge};
use super::rivals::TIE;

/// A mass that hardly reaches its stop shows no corner: where a spring of some other power than the
/// cube does as well as the stop, the recording tells neither from the other.
pub(super) fn settle_stop(data: &Data, selection: &mut Selection, scales: &Scales, budget: Budget) {
    let chosen = &selection.chosen;
    let is_stop = matches!(chosen.fit.structure.terms.as_slice(), [Term::EndStop(_)]);
    if !is_stop || selection.departing.is_some() || data.work.is_spent(budget) {
        return;
    }
    let mut alone = selection.alone.iter().filter_map(|t| t.judged.as_ref());
    let spring = alone.find(|j| matches!(j.fit.structure.terms.as_slice(), [Term::CubicStiffness(_)]));
    let Some(spring) = spring.cloned() else { return };
    let id = spring.fit.structure.terms[0].id();
    let known = selection.rivals.first().is_some_and(|rivals| rivals.iter().any(|r| r.id == id));
    if known {
        return;
    }
    // Of one power and no more: a form with more freedom would bend where the stop does.
    let is_power = |terms: &[Term]| matches!(terms, [Term::FreeForm(FreeForm { extent: Extent::Narrow, .. })]);
    let found = freed(data, &spring.fit, 0, scales, false).filter(|found| is_power(&found.structure.terms));
    if found.is_some_and(|found| judge(data, found, scales).score() > chosen.score() - TIE) {
        selection.rivals.resize_with(selection.rivals.len().max(1), Vec::new);
        selection.rivals[0].push(Rival { judged: spring, id });
    }
}
