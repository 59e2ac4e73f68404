//! The recordings of one sensor that a diagnosis is given: those that are fitted together, and
//! those that only judge.

use crate::recording::Recording;

/// Recordings of one sensor, in the order given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recordings<'a> {
    /// Fitted, each with its own initial state and offset; at least one.
    pub train: &'a [Recording],
    /// Recordings used for validation only.
    pub test: &'a [Recording],
}

impl<'a> Recordings<'a> {
    /// A single recording, without others for validation.
    pub fn one(recording: &'a Recording) -> Self {
        Self { train: std::slice::from_ref(recording), test: &[] }
    }

    /// The only recording, where there is but one.
    pub fn only(&self) -> Option<&'a Recording> {
        match (self.train, self.test) {
            ([only], []) => Some(only),
            _ => None,
        }
    }

    /// Fitted recordings first, then those for validation.
    pub fn all(&self) -> impl Iterator<Item = &'a Recording> {
        self.train.iter().chain(self.test)
    }
}
