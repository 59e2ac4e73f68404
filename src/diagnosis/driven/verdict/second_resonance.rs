//! Whether a mode beside the modelled resonance, or a second mass on the first, is a second resonance:
//! two bodies that each ring, and under a misfit of anything else, two peaks that can be told apart.

use crate::driven::base::{OMEGA, ZETA};
use crate::driven::identification::fit::Fit;
use crate::physics::library::Term;

/// Damping ratio from which a body does not ring: both poles are real.
pub(super) const APERIODIC: f64 = 1.0;
/// Damping ratio from which a frequency response has no peak, 1/√2.
const NO_PEAK: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Whether a law says that there is a second resonance.
pub(super) fn is_second_resonance(term: &Term) -> bool {
    matches!(term, Term::ParasiticMode(_) | Term::CoupledMode(_))
}

/// Whether the first resonance is still one. Where the base model has become a creep, the mode has
/// taken its place.
pub(super) fn is_beside_the_first(fit: &Fit) -> bool {
    fit.point[ZETA] < APERIODIC
}

/// Whether the mode at this place has a peak that stands apart from the first: further than both
/// half-widths at half power, ζω (Ewins, Modal Testing, 2nd ed., 2000, §2.4).
pub(super) fn is_resolved(fit: &Fit, index: usize) -> bool {
    let (omega, zeta) = (fit.point[OMEGA], fit.point[ZETA]);
    let [_, second_omega, second_zeta, ..] = fit.structure.of(index, &fit.point) else { return false };
    let widths = zeta * omega + second_zeta * second_omega;
    let apart = match fit.structure.terms[index] {
        Term::CoupledMode(_) => pair(omega, fit.structure.of(index, &fit.point)),
        _ => (second_omega - omega).abs(),
    };
    zeta.max(*second_zeta) < NO_PEAK && apart > widths
}

/// By how much the two frequencies of coupled masses differ, rad/s: their squares sum up to ω₀² +
/// (1 + μ)ω₂² and multiply to ω₀²ω₂² (Den Hartog, Mechanical Vibrations, 4th ed., 1956, §3.2).
fn pair(omega: f64, coupled: &[f64]) -> f64 {
    let [ratio, own, ..] = coupled else { return 0.0 };
    let (sum, product) = (omega * omega + (1.0 + ratio) * own * own, omega * own);
    // (a − b)² = a² + b² − 2ab.
    (sum - 2.0 * product).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    // Tuned alike, ω = 2: λ² − (8 + 4μ)λ + 16 = 0; with μ = 0.5 the squares are 8 and 2.
    #[test]
    fn a_tuned_pair_stands_apart_by_its_coupling() {
        assert!((pair(2.0, &[0.5, 2.0, 0.0]) - (8f64.sqrt() - 2f64.sqrt())).abs() < 1e-12);
        assert!((pair(2.0, &[0.0, 5.0, 0.0]) - 3.0).abs() < 1e-12, "without coupling each is its own");
    }
}
