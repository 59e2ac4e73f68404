//! Says which experiment comes next, in words for a terminal, as a page and as JSON.
//!
//! Chain: words → sentences; document; figure; page.

mod document;
mod figure;
mod page;
mod sentences;
mod words;

use proofmass_diagnosis::plan::confirm::Confirmed;
use proofmass_diagnosis::plan::search::Planned;

pub use document::{Document, document};
pub use page::page;

/// The text of a terminal, a sentence a line, the answer first.
pub fn terminal(planned: &Planned, wish: f64, confirmed: &[Confirmed]) -> String {
    sentences::all(planned, wish, confirmed).iter().map(|sentence| format!("{sentence}\n")).collect()
}
