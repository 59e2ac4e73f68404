//! One check of a table: what was expected, what was found, and whether that holds.

/// One check: expected number, found number, tolerance.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Row {
    /// Description of the check: its place and the source of the expected number.
    pub what: String,
    /// Expected number.
    pub expected: f64,
    /// Number found.
    pub got: f64,
    /// Largest difference that is let pass.
    pub tolerance: f64,
    /// Says whether it holds. A control holds when the check it repeats on purpose on wrong input
    /// fails.
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
