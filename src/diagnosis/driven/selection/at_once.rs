//! The base form of a reading that follows its input at once, as that of a gyro on a turntable: the
//! resonance is far above what was recorded, and only gain/ω₀², the sensitivity, can be known.
//!
//! Laws of the spring are those of a nonlinear reading here, and nothing shows of the damping: neither
//! is tried.

use crate::driven::base::{GAIN, INITIAL, OMEGA, OMEGAS_PER_SAMPLE, ZETA};
use crate::driven::identification::fit::{Fit, fit};
use crate::driven::identification::start;
use crate::driven::intake::data::Data;
use crate::driven::intake::observed::Observed;
use crate::model::Output;
use crate::physics::law::{Noise, Place, Role};
use crate::physics::library::Term;
use crate::physics::scales::Scales;

/// Log-likelihood below which ω₀ and ζ add nothing: by chance two numbers gain more in one of 160,000
/// recordings, exp(−12), as half of χ² with two degrees of freedom does.
const WORTH: f64 = 12.0;
/// Conventional damping ratio.
const DAMPING: f64 = 0.7;

/// The base model in this form, if it explains the reading as well as the best oscillator does, and leaves
/// so little that no resonance can hide in it.
pub(super) fn found(data: &Data, (oscillator, scales): &(Fit, Scales)) -> Option<(Fit, Scales)> {
    if data.input.is_none() || data.windows.is_some() || data.observed.output != Output::Displacement {
        return None;
    }
    let conventional = OMEGAS_PER_SAMPLE[1] * data.rate_hz;
    let mut point = oscillator.point.clone();
    point[GAIN] *= (conventional / point[OMEGA]).powi(2);
    (point[OMEGA], point[ZETA], point[INITIAL], point[INITIAL + 1]) = (conventional, DAMPING, 0.0, 0.0);
    let scales =
        Scales { gain: point[GAIN], omega_rad_s: conventional, zeta: DAMPING, at_once: true, ..scales.clone() };
    let data = Data { observed: Observed { at_once: true, ..data.observed }, ..data.clone() };
    let found = fit(&data, &oscillator.structure, &point, &scales, 25)?;
    let rows = found.linear.residual.len() as f64;
    let gain = 0.5 * rows * (found.variance / oscillator.variance).ln();
    (gain < WORTH && found.variance < start::POOR * scales.output.powi(2)).then_some((found, scales))
}

/// States what it means.
pub(super) const WORDS: &str = "the reading follows the input at once and shows no resonance: laws of a spring or of damping \
                                cannot be told from a nonlinear reading here, and are not tried";

/// Returns whether a law shows in this form, with numbers that do not hang on the resonance.
pub(in crate::driven) fn shows(term: &Term) -> bool {
    match term.role() {
        // Shares of the stiffness and of the input.
        Role::Force => matches!(term, Term::StiffnessDrift(_) | Term::DriveNonlinearity(_)),
        Role::Friction | Role::Mode | Role::Noise(Noise::Force) | Role::Readout(Place::Input) => false,
        _ => true,
    }
}
