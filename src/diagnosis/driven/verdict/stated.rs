//! The model that a verdict states: the base model with the named terms and nothing else.
//!
//! The repaired model may hold more, so that what has no name does not bias what has one. Its errors
//! are no evidence for the names. Not for which terms have one (`conclude`).

use crate::driven::identification::fit::fit;
use crate::driven::intake::data::Data;
use crate::driven::selection::earned::ITERATIONS;
use crate::driven::selection::held_out::held_out;
use crate::driven::selection::judged::Judged;
use crate::physics::scales::Scales;

use super::conclude::Conclusion;

/// Ids of the terms that are in the repaired model without a name, where anything is named.
pub(super) fn unnamed(c: &Conclusion) -> Vec<String> {
    let terms = c.model.fit.structure.terms.iter().enumerate();
    let nameless = terms.filter(|(i, _)| !c.named.is_empty() && c.named.iter().all(|n| n.index != *i));
    nameless.map(|(_, term)| term.id().to_owned()).collect()
}

/// The model with the named terms alone, fitted to the same samples and judged on the same; `None`
/// where it cannot be fitted.
pub(super) fn stated(data: &Data, c: &Conclusion, scales: &Scales) -> Option<Judged> {
    if unnamed(c).is_empty() {
        return Some(c.model.clone());
    }
    let mut kept: Vec<usize> = c.named.iter().map(|n| n.index).collect();
    kept.sort_unstable();
    let (structure, point) = c.model.fit.only(&kept);
    let scales = Scales { fineness: c.fineness, ..scales.clone() };
    let fit = fit(data, &structure, &point, &scales, ITERATIONS)?;
    Some(Judged { held_out: held_out(data, &fit, &scales, &data.test), fit })
}
