//! States what a computation gives to Python.

use pyo3::prelude::*;

/// A finished computation, as Python sees it.
#[pyclass(frozen, module = "proofmass._proofmass")]
pub struct Answer {
    /// The JSON document, as the command prints it.
    #[pyo3(get)]
    pub json: String,
    /// TOML that a study takes of it, where there is any: the repaired sensor, or the sensor with its spread.
    #[pyo3(get)]
    pub toml: Option<String>,
    /// Draws the report page as HTML.
    pub draw: Box<dyn Fn() -> String + Send + Sync>,
}

#[pymethods]
impl Answer {
    /// The report as one self-contained page of HTML.
    fn page(&self, py: Python<'_>) -> String {
        py.detach(|| (self.draw)())
    }
}
