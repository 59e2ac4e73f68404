//! Says which experiment comes next, in words for a terminal and as JSON.
//!
//! Chain: words → sentences; document.

mod document;
mod sentences;
mod words;

use proofmass_diagnosis::plan::confirm::Confirmed;
use proofmass_diagnosis::plan::search::Planned;

pub use document::document;

/// The text of a terminal, a sentence a line, the answer first.
pub fn terminal(planned: &Planned, wish: f64, confirmed: &[Confirmed]) -> String {
    sentences::all(planned, wish, confirmed).iter().map(|sentence| format!("{sentence}\n")).collect()
}
