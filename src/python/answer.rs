//! States what a computation gives to Python.

use pyo3::prelude::*;

/// A finished computation, as Python sees it.
#[pyclass(frozen, module = "proofmass._proofmass")]
pub struct Answer {
    /// The JSON document, as the command prints it.
    #[pyo3(get)]
    pub json: String,
    /// The repaired sensor as a study, where there is one.
    #[pyo3(get)]
    pub repaired: Option<String>,
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
