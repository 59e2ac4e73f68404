//! A measured input that was recorded AC-coupled, as a piezoelectric force cell or a charge amplifier
//! gives it: what moved the mass has a slow part that the record lacks.
//!
//! With τu′ + u = τf′, the force is f = u + q/τ with q′ = u − u₀, where u₀ is what the record shows of
//! no force. Neither u₀ nor what q begins with is a parameter: next to a linear mass of which only velocity or
//! acceleration is read, no recording shows them.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::readout_highpass::{time_constant, time_constants_s};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, Lanes, MOST_STAGED, MOST_VALUES};

/// τu′ + u = τf′.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InputHighpass;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "input-highpass",
    kind: Kind::Driven,
    statement: "The measured input is AC-coupled: its slow part moved the mass and was not recorded.",
    equation: "τu′ + u = τf′, x″ + 2ζω₀x′ + ω₀²x = g·f",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 1e4) }],
    acts: "measured input",
    signature: "the response grows towards low frequencies, and lags there by up to a quarter of a cycle",
    confusable_with: &["readout-delay", "parasitic-mode", "feedthrough"],
    reference: "ISO 7626-2 (force transducers); Ljung, System Identification, 1999, ch. 4",
};

impl Law for InputHighpass {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![time_constant(s), Coordinate::Linear(0.1 * s.input / s.omega_rad_s), Coordinate::Linear(0.1 * s.input)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        time_constants_s(s).map(|tau| vec![tau, 0.0, 0.0]).to_vec()
    }
    fn states(&self) -> usize {
        1
    }
    /// Returns two: what q begins with, and u₀.
    fn unknown_beginnings(&self) -> usize {
        2
    }
    fn begin(&self, _: &Lanes, _: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        own[0] = p[1];
    }
    fn needs_input(&self) -> bool {
        true
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        own: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        fma::<T, FMA>(at.gain / p[0], own[0], sum)
    }
    #[inline(always)]
    fn rates<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
    ) -> [T; MOST_STAGED] {
        let mut rates = [T::of(0.0); MOST_STAGED];
        rates[0] = at.input - p[2];
        rates
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A force sin t leaves u = τ(τ sin t + cos t)/(1 + τ²) in the record once its beginning has faded; u and
    // its integral −τ(τ cos t − sin t)/(1 + τ²), over τ, make it again.
    #[test]
    fn record_and_its_integral_make_the_force_again() {
        for (tau, rest) in [(0.4, 0.0), (3.0, 0.7)] {
            let mut p = [0.0; MOST_VALUES];
            (p[0], p[2]) = (tau, rest);
            let part = tau / (1.0 + tau * tau);
            for t in [0.3_f64, 1.1, 2.9, 4.4] {
                let (sin, cos) = t.sin_cos();
                let mut own = [0.0; MOST_STAGED];
                own[0] = part * (sin - tau * cos);
                let at = Instant { input: part * (tau * sin + cos) + rest, gain: 5.0, ..Instant::default() };
                let rate = InputHighpass.rates::<f64, false>(&at, &p, &own)[0];
                assert!((rate - part * (tau * sin + cos)).abs() < 1e-12, "{rate}");
                // The base model has added g·u, of which the rest is the offset's.
                let force = InputHighpass.force::<f64, false>(&at, &p, &own, 5.0 * (at.input - rest));
                assert!((force - 5.0 * sin).abs() < 1e-12, "{tau} {t}: {force}");
            }
        }
    }
}
