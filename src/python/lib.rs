//! The Python module `proofmass._proofmass`: what the package under `src/python/proofmass` is built
//! on.
//!
//! Functions take what Python holds, work without its lock, and give an [`answer::Answer`]: the
//! command's JSON document and its page. Not for what users see: names, defaults, attributes and
//! tables are the package's.

mod answer;
mod arrays;
mod functions;
mod value;
mod work;

/// The native half of the package `proofmass`.
#[pyo3::pymodule]
mod _proofmass {
    #[pymodule_export]
    use super::answer::Answer;
    #[pymodule_export]
    use super::functions::{allan, check, diagnose, main, plan, simulate, study};
}
