//! The five noise terms of IEEE 952: their Allan variance and how their integrals correlate.
//!
//! | term | Allan variance | one-sided density of the signal |
//! |---|---|---|
//! | Q quantisation | 3 Q²/τ² | 2 (2πf)² Q² τ₀ |
//! | N white (angle or velocity random walk) | N²/τ | 2 N² |
//! | B flicker (bias instability) | (2 ln 2/π) B² | B²/(πf) |
//! | K random walk of the signal | K² τ/3 | 2 K²/(2πf)² |
//! | R ramp | R² τ²/2 | – |
//!
//! N is the two-sided coefficient: a datasheet's one-sided density n is √2 N.

use std::f64::consts::{LN_2, PI};

/// A noise term of IEEE 952.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// Q: white noise of the integral, unit·s.
    Quantisation,
    /// N: white noise of the signal, unit·√s.
    White,
    /// B: flicker noise, unit; its floor is 0.664 B.
    Flicker,
    /// K: random walk, unit/√s.
    Walk,
    /// R: a straight line in time, unit/s.
    Ramp,
}

/// All terms, as coefficients are ordered everywhere.
pub const TERMS: [Term; 5] = [Term::Quantisation, Term::White, Term::Flicker, Term::Walk, Term::Ramp];

/// Minimum Allan deviation over B: √(2 ln 2/π).
pub const FLICKER_FLOOR: f64 = 0.664282470268;

impl Term {
    /// Letter in IEEE 952.
    pub fn symbol(self) -> &'static str {
        ["Q", "N", "B", "K", "R"][self as usize]
    }

    /// Allan variance of this term with coefficient one.
    pub fn variance(self, tau_s: f64) -> f64 {
        match self {
            Term::Quantisation => 3.0 / (tau_s * tau_s),
            Term::White => 1.0 / tau_s,
            Term::Flicker => 2.0 * LN_2 / PI,
            Term::Walk => tau_s / 3.0,
            Term::Ramp => tau_s * tau_s / 2.0,
        }
    }

    /// Generalised autocovariance of the integral at this lag, coefficient one: second differences
    /// of it are true covariances. Zero for the ramp, which is no noise.
    pub(super) fn integral_covariance(self, lag_s: f64) -> f64 {
        let lag = lag_s.abs();
        match self {
            Term::Quantisation if lag == 0.0 => 1.0,
            Term::Quantisation | Term::Ramp => 0.0,
            Term::White => -lag / 2.0,
            Term::Flicker if lag == 0.0 => 0.0,
            Term::Flicker => lag * lag * lag.ln() / (2.0 * PI),
            Term::Walk => lag.powi(3) / 12.0,
        }
    }
}

/// Allan variance of the sum of all terms; `squares` are squared coefficients in the order of
/// [`TERMS`].
pub fn variance(squares: &[f64; 5], tau_s: f64) -> f64 {
    TERMS.iter().zip(squares).map(|(term, square)| square * term.variance(tau_s)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_differences_of_the_integral_give_the_allan_variance() {
        assert!((FLICKER_FLOOR - Term::Flicker.variance(1.0).sqrt()).abs() < 1e-9);
        for term in [Term::Quantisation, Term::White, Term::Flicker, Term::Walk] {
            for tau in [0.01, 3.0, 500.0] {
                let s = |lag: f64| term.integral_covariance(lag * tau);
                let got = (6.0 * s(0.0) - 8.0 * s(1.0) + 2.0 * s(2.0)) / (2.0 * tau * tau);
                assert!((got / term.variance(tau) - 1.0).abs() < 1e-9, "{term:?} at {tau}");
            }
        }
    }
}
