//! Fits the laws that an input cannot tell from a named one in its place, so that each of them stands in the
//! verdict with its own numbers, and can be simulated under another input.

use crate::control::{Control, Stopped};
use crate::driven::intake::data::Data;
use crate::driven::selection::candidates_round::round;
use crate::driven::selection::earned::without;
use crate::driven::selection::judged::{Judged, Rival, Selection};
use crate::physics::library::Term;
use crate::physics::scales::Scales;

use super::conclude::Conclusion;

/// Adds them to the rivals of each named law. One whose best fit ends at the edge of what it may be is none.
///
/// # Errors
/// Stopped.
pub(in crate::driven) fn fitted(
    data: &Data,
    selection: &Selection,
    mut c: Conclusion,
    scales: &Scales,
    control: &Control,
) -> Result<Conclusion, Stopped> {
    let class = selection.reach.class(&c.model.fit.structure.terms);
    let is_alone = c.model.fit.structure.terms.len() == 1;
    for named in &mut c.named {
        let own = c.model.fit.structure.terms[named.index].id();
        let is_known = |id: &str| c.model.has(id) || named.rivals.iter().any(|r| r.id == id);
        let open: Vec<Term> =
            Term::all().into_iter().filter(|t| class.contains(&t.id()) && !is_known(t.id())).collect();
        if !class.contains(&own) || open.is_empty() {
            continue;
        }
        let reduced: Option<Judged> =
            if is_alone { Some(c.base.clone()) } else { without(data, &c.model, named.index, scales) };
        let Some(reduced) = reduced else { continue };
        for trial in round(data, &reduced, &open, scales, open.len(), control)? {
            let place = reduced.fit.structure.terms.len();
            let found = trial.judged.filter(|j| !j.fit.term_at_bound(place, scales));
            named.rivals.extend(found.map(|judged| Rival { judged, id: trial.term.id() }));
        }
    }
    Ok(c)
}
