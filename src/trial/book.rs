//! The verdict book: a fixed corpus of cases, one line for each verdict on it, and what changed
//! between two books.
//!
//! The corpus are cases of the second generator at one seed, copies of ring-downs at lower rates, and
//! real recordings with what is known of them. Whoever changes a rule of the diagnosis writes a book
//! before and after: each verdict that changed stands in the comparison, with exact odds.
//!
//! Imports run `corpus` → `entry` → `run` → `against` → `ablation`.

pub mod ablation;
pub mod against;
pub mod corpus;
pub mod entry;
pub mod run;
