//! One member of the ensemble: tolerances drawn, mechanics derived.

use super::tolerances::Tolerances;
use crate::excitation::plan::Variation;
use crate::excitation::{self, MemberSine};
use crate::kernel::job::Member;
use crate::physics::coefficients::{self, Coefficients};
use crate::sensor::error_law::{ErrorLaw, Shape};
use crate::sensor::{ProofMass, Sensor, SensorTerm, mechanics};
use crate::units::key::Key;
use crate::units::number::Number;

/// Draws a member; a pure function of seed and index.
pub(super) fn member(all: &Tolerances, variation: Variation, seed: u64, member: u64) -> Member {
    let draw = |key: &Key| all.draw(key, seed, member);
    let excitation_gain = if variation == Variation::Gain { draw(&excitation::SIZE) } else { 1.0 };
    let mut sensor = Sensor { proof_mass: proof_mass(all, &draw), excitation_gain, ..Sensor::default() };
    for term in SensorTerm::ALL {
        if let Some(key) = all.given(term) {
            sensor = sensor.with_error(term, draw(key));
            for phase in term.shapes().filter(|shape| shape.law() == ErrorLaw::Shape(Shape::Phase)) {
                let anywhere = Number::Uniform { min: 0.0, max: 360.0 };
                let key = &phase.row().keys[0];
                sensor = sensor.with_error(phase, all.draw_or(key, anywhere, seed, member));
            }
        }
    }
    let sine = (variation == Variation::Sine).then(|| MemberSine {
        amplitude_m_s2: draw(&excitation::SIZE),
        frequency_hz: draw(&excitation::FREQUENCY),
        phase_rad: draw(&excitation::PHASE),
    });
    Member { sensor, sine }
}

/// The proof mass, from its modes or from the paper's m, D₀, k, ε: ω₀² = k/m, 2ζω₀ = D₀/m, β = ε/m.
fn proof_mass(all: &Tolerances, draw: &dyn Fn(&Key) -> f64) -> Option<ProofMass> {
    use mechanics::*;
    let mut laws = Coefficients::default();
    for key in coefficients::keys() {
        laws = laws.with(key, draw(key));
    }
    let (natural_frequency_rad_s, damping_ratio) = if all[&MASS].is_some() {
        let (mass_kg, stiffness_n_m) = (draw(&MASS), draw(&STIFFNESS));
        laws = laws.with(&CUBIC_STIFFNESS, draw(&CUBIC_SPRING) / mass_kg);
        ((stiffness_n_m / mass_kg).sqrt(), draw(&DAMPING) / (2.0 * (stiffness_n_m * mass_kg).sqrt()))
    } else if all[&RESONANCE].is_some() {
        (draw(&RESONANCE), draw(&DAMPING_RATIO))
    } else {
        return None;
    };
    Some(ProofMass { natural_frequency_rad_s, damping_ratio, laws, force_noise_m_s_rts: draw(&FORCE_NOISE) })
}
