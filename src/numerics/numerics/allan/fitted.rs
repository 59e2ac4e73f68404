//! States what a fit of an Allan curve found.

use super::law;

/// A fit is called bad below this probability.
pub const BAD: f64 = 0.01;

/// A fitted noise coefficient (not squared) with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// Estimate; zero where the best fit does without.
    pub value: f64,
    /// 95 % interval; begins at zero where the term is not supported.
    pub ci95: [f64; 2],
    /// Probability of an estimate this large without the term.
    pub p_value: f64,
}

impl Coefficient {
    /// Returns whether the data need this term.
    pub fn supported(&self) -> bool {
        self.ci95[0] > 0.0
    }
}

/// A fitted Allan curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Coefficients in the order of [`TERMS`](law::TERMS).
    pub coefficients: [Coefficient; 5],
    /// Covariance of the squared coefficients by least squares, as if none could reach zero; zero for
    /// those that are zero.
    pub covariance: [[f64; 5]; 5],
    /// Probability of deviations as large as these if the five terms were all there is.
    pub p_value: f64,
    /// Shortest averaging time fitted, s.
    pub from_s: f64,
    /// Longest averaging time fitted, s.
    pub to_s: f64,
    /// Averaging time at which the curve leaves the fit most, and measured over fitted deviation
    /// there.
    pub worst: (f64, f64),
    /// Departure of the curve from any sum of the laws beyond chance, as a share of the deviation;
    /// zero for a good fit. The intervals allow for it.
    pub discrepancy: f64,
    /// Variance that a filter takes, times τ², unit²·s²; zero where there is none.
    pub filtered: f64,
}

impl Fit {
    /// The squared coefficients Q², N², B², K², R².
    pub fn squares(&self) -> [f64; 5] {
        self.coefficients.map(|c| c.value * c.value)
    }

    /// Squared coefficients of the terms that the data support, 0 of the others.
    pub fn supported_squares(&self) -> [f64; 5] {
        self.coefficients.map(|c| if c.supported() { c.value * c.value } else { 0.0 })
    }

    /// Allan deviation of the terms that the data support, less what a filter takes.
    pub fn deviation(&self, tau_s: f64) -> f64 {
        (law::variance(&self.supported_squares(), tau_s) - self.filtered / (tau_s * tau_s)).max(0.0).sqrt()
    }

    /// Returns whether the five terms describe the curve.
    pub fn good(&self) -> bool {
        self.p_value >= BAD
    }
}
