//! Says whether a recording can be trusted, in words for a terminal, as a page and as JSON.
//!
//! Chain: words → values → sentences; table; document; figure; page.

mod document;
mod figure;
mod page;
mod sentences;
mod table;
mod values;
mod words;

use std::fmt::Write as _;

use proofmass_diagnosis::check::Checked;

pub use document::{Document, document};
pub use page::page;

/// The answer in a sentence or two.
pub fn answer(files: &[String], checked: &Checked) -> String {
    sentences::answer(files, checked)
}

/// The text of a terminal: the answer, what each recording can know, the parameters, and what to do
/// next.
pub fn terminal(files: &[String], checked: &Checked) -> String {
    let mut out = format!("{}\n", sentences::answer(files, checked));
    for (file, run) in files.iter().zip(&checked.runs) {
        let _ = writeln!(out, "\n{file}");
        sentences::of_run(run).iter().for_each(|s| {
            let _ = writeln!(out, "  {s}");
        });
    }
    let _ = writeln!(out, "\n{}", table::of(files, checked));
    sentences::of_agreement(checked).iter().for_each(|s| {
        let _ = writeln!(out, "{s}");
    });
    sentences::next(files, checked).iter().for_each(|s| {
        let _ = writeln!(out, "next: {s}");
    });
    out
}
