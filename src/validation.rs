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

/// One check.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Row {
    /// What was checked, where, and the source of the expected number.
    pub what: String,
    /// Expected number.
    pub expected: f64,
    /// Number found.
    pub got: f64,
    /// Largest difference that is let pass.
    pub tolerance: f64,
    /// Whether it holds. A control holds when the check it repeats on purpose on wrong input fails.
    pub holds: bool,
}

impl Row {
    /// `got` must be within `tolerance` of `expected`.
    pub fn near(what: impl Into<String>, got: f64, expected: f64, tolerance: f64) -> Self {
        let holds = (got - expected).abs() <= tolerance;
        Self { what: what.into(), expected, got, tolerance, holds }
    }

    /// `got` must be at most `most`.
    pub fn at_most(what: impl Into<String>, got: f64, most: f64) -> Self {
        Self::near(what, got, 0.0, most)
    }

    /// The same check on wrong input: it must fail.
    pub fn control(self) -> Self {
        Self { what: format!("control, must fail: {}", self.what), holds: !self.holds, ..self }
    }
}

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
