//! The tool put to the test: laws, closed forms, precision, orders of convergence and parities, as
//! a table that a user can read on the machine at hand.
//!
//! Not for the diagnosis, which `trial` proves. Each expected number says where it comes from; each
//! family of checks has a control that must fail, so that a check that cannot fail is noticed.

use crate::control::Control;
use crate::error::Result;

pub mod closed_form;
pub mod jobs;
pub mod order;
pub mod parity;
pub mod precision;
pub mod randomness;
mod row;

pub use row::Row;

/// All checks on the backends given.
///
/// # Errors
/// A backend that fails, stopped.
pub fn run(backends: &mut [jobs::Place], control: &Control) -> Result<Vec<Row>> {
    let progress = control.stage("validating", 0);
    let mut rows = Vec::new();
    progress.rename("random numbers");
    rows.extend(randomness::rows());
    for place in backends.iter_mut() {
        progress.rename(&format!("closed forms, {}", place.name));
        rows.extend(closed_form::rows(place)?);
    }
    progress.rename("orders of convergence");
    rows.extend(order::rows()?);
    progress.rename("precision");
    rows.extend(precision::rows(control)?);
    for place in backends.iter_mut().filter(|p| p.is_gpu) {
        progress.rename("parity of CPU and GPU");
        rows.extend(parity::rows(place, control)?);
    }
    Ok(rows)
}
