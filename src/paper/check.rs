//! A claim as a number that can be wrong: what was expected, what was got, how far apart they may
//! lie.

use serde::Serialize;

/// One machine check. It holds exactly when `got` lies within `tolerance` of `expected`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Quantity that is compared, with its unit.
    pub name: String,
    /// Expected number, from the source stated.
    pub expected: f64,
    /// Computed number.
    pub got: f64,
    /// Largest difference between the two at which the check holds.
    pub tolerance: f64,
    /// The verdict; NaN never holds.
    pub holds: bool,
    /// Source of the expected number and of the tolerance.
    #[serde(skip)]
    pub because: String,
    /// States whether the claim is a range, from `expected − tolerance` to `expected + tolerance`.
    #[serde(skip)]
    pub range: bool,
}

impl Check {
    /// `got` must lie within `tolerance` of `expected`.
    pub fn near(name: &str, because: &str, expected: f64, got: f64, tolerance: f64) -> Self {
        let holds = (got - expected).abs() <= tolerance;
        Self { name: name.into(), expected, got, tolerance, holds, because: because.into(), range: false }
    }

    /// `got` must lie from `low` to `high`: near their middle, within half their distance.
    pub fn between(name: &str, because: &str, low: f64, high: f64, got: f64) -> Self {
        Self { range: true, ..Self::near(name, because, 0.5 * (low + high), got, 0.5 * (high - low)) }
    }
}

/// Origin of a figure's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Provenance {
    /// Computed from a model.
    Simulated,
    /// Computed from a real recording.
    Recorded,
}

/// One figure of the paper and what is checked about it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exhibit {
    /// Number in the paper.
    pub figure: u32,
    /// Title of the figure, in our words.
    pub title: String,
    /// Origin of its numbers.
    pub source: Provenance,
    /// Checks of the figure.
    pub checks: Vec<Check>,
}

impl Exhibit {
    /// A figure computed from a model.
    pub fn simulated(figure: u32, title: &str, checks: Vec<Check>) -> Self {
        Self { figure, title: title.into(), source: Provenance::Simulated, checks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_can_fail_and_nan_never_holds() {
        assert!(Check::near("", "", 1.0, 1.05, 0.1).holds);
        assert!(!Check::near("", "", 1.0, 1.2, 0.1).holds);
        assert!(!Check::near("", "", 1.0, f64::NAN, 0.1).holds);
        assert!(Check::between("", "", 2.0, 4.0, 3.9).holds);
        assert!(!Check::between("", "", 2.0, 4.0, 4.1).holds);
    }
}
