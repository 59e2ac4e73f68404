//! From a study to a decision: which value of a key meets a requirement, which parts of a catalogue
//! do, how an answer moves along one or two keys, and how many members it takes to state it to so
//! many digits. `variance` and `risk` ask about one error of one study: whose it is, and how probable
//! one beyond a limit is.
//!
//! All of it simulates the same members at every value (common random numbers), so that differences
//! between values are not noise. `watched` → `statistic` → `values` → `panel` → `require` → `parts`
//! → `document`. Not for showing anything: `report` does.

pub mod chain;
pub mod digits;
pub mod document;
pub mod further;
pub mod panel;
pub mod parts;
pub mod require;
pub mod risk;
pub mod statistic;
pub mod summarised;
pub mod sweep;
pub mod sweep_document;
pub mod values;
pub mod variance;
pub mod watched;
