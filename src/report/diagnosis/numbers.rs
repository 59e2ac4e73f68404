//! Probabilities, estimates and units as the diagnosis sets them in print.

use proofmass_base::number::{significant, with_uncertainty};
use proofmass_diagnosis::verdict::Estimate;

/// A probability as words say it.
pub(crate) fn chance(p: f64) -> String {
    if p < 1e-6 { "below one in a million".into() } else { significant(p, 2) }
}

/// Value and half the width of its interval, both rounded to what they are worth.
pub(super) fn estimate(e: &Estimate) -> String {
    let (below, above) = (e.value - e.ci95[0], e.ci95[1] - e.value);
    // A size that was chosen, by which others are measured.
    if below == 0.0 && above == 0.0 {
        return significant(e.value, 3);
    }
    if below > 0.0 && above > 0.0 && (below / above).max(above / below) < 1.5 {
        with_uncertainty(e.value, 0.5 * (below + above))
    } else {
        format!("{} ({} to {})", significant(e.value, 3), significant(e.ci95[0], 3), significant(e.ci95[1], 3))
    }
}

/// A unit as it is set in print.
pub(crate) fn formula(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace("sqrt(s)", "√s")
}
