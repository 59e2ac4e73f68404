//! The tool put to the test: laws, closed forms, precision, orders of convergence and parities, as a table that a user
//! can read on the machine at hand.
//!
//! Not for the diagnosis, which `trial` proves. Each expected number says where it comes from; each family of checks has
//! a control that must fail, so that a check that cannot fail is noticed.

use crate::error::Result;

pub mod closed_form;
pub mod jobs;
pub mod order;
pub mod parity;
pub mod precision;
pub mod randomness;
mod row;

pub use row::Row;

/// All checks on the backends given; `progress` is told before each family.
///
/// # Errors
/// A backend that fails, Ctrl-C.
pub fn run(backends: &mut [jobs::Place], mut progress: impl FnMut(&str)) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    progress("random numbers");
    rows.extend(randomness::rows());
    for place in backends.iter_mut() {
        progress(&format!("closed forms, {}", place.name));
        rows.extend(closed_form::rows(place)?);
    }
    progress("orders of convergence");
    rows.extend(order::rows()?);
    progress("precision");
    rows.extend(precision::rows()?);
    for place in backends.iter_mut().filter(|p| p.is_gpu) {
        progress("parity of CPU and GPU");
        rows.extend(parity::rows(place)?);
    }
    Ok(rows)
}
