//! Decides whether a mode next to the modelled resonance, or a second mass on the first, is a
//! second resonance: two bodies that each ring.

use crate::driven::base::ZETA;
use crate::driven::identification::fit::Fit;
use crate::physics::library::Term;

/// Damping ratio from which a body does not ring: both poles are real.
pub(super) const APERIODIC: f64 = 1.0;

/// Returns whether a law states that there is a second resonance.
pub(super) fn is_second_resonance(term: &Term) -> bool {
    matches!(term, Term::ParasiticMode(_) | Term::CoupledMode(_))
}

/// Returns whether the first resonance is still one. Where the base model has become a creep, the
/// mode has taken its place.
pub(super) fn is_beside_the_first(fit: &Fit) -> bool {
    fit.point[ZETA] < APERIODIC
}
