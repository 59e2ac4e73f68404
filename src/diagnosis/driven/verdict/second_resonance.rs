//! Whether a mode beside the modelled resonance is a second resonance: two bodies that each ring,
//! and under a misfit of anything else, two peaks that can be told apart.

use crate::diagnosis::driven::base::{OMEGA, ZETA};
use crate::diagnosis::driven::identification::fit::Fit;

/// Damping ratio from which a body does not ring: both poles are real.
const APERIODIC: f64 = 1.0;
/// Damping ratio from which a frequency response has no peak, 1/√2.
const NO_PEAK: f64 = std::f64::consts::FRAC_1_SQRT_2;

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
    zeta.max(*second_zeta) < NO_PEAK && (second_omega - omega).abs() > widths
}
