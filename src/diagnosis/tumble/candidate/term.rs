//! A candidate as the fit takes it: which parameters it frees in which sensor, and the residual that judges it.

use std::ops::Range;

use crate::diagnosis::tumble::rows::Group;
use crate::sensor::Sense;

/// A candidate in one of the two sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Library id.
    pub id: &'static str,
    /// Where it acts.
    pub sensor: Sense,
    /// Parameters it frees.
    pub parameters: &'static [Range<usize>],
    /// The residual it is judged by.
    pub judged: Group,
}

impl Term {
    /// Indices of the parameters it frees.
    pub fn active(&self) -> impl Iterator<Item = usize> {
        self.parameters.iter().cloned().flatten()
    }
}
