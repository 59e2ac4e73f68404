//! Questions about one error of a study, answered next to its drift: on a terminal and on a page.

use super::{risk, variance};
use crate::html::Page;
use proofmass_simulate::decision::further::Further;

/// The answers for a terminal, one text each.
pub fn terminal(further: &Further) -> Vec<String> {
    let variance = further.variance.as_ref().map(variance::terminal);
    variance.into_iter().chain(further.risk.as_ref().map(risk::terminal)).collect()
}

/// Adds to the section of a page that says which error is to blame.
pub(crate) fn blame(page: &mut Page, further: &Further) {
    further.variance.iter().for_each(|shared| variance::append(page, shared));
}

/// Adds to the section of a page that says how far it drifts.
pub(crate) fn drift(page: &mut Page, further: &Further) {
    further.risk.iter().for_each(|found| risk::append(page, found));
}
