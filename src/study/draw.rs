//! Members of the ensemble: tolerances drawn, mechanics derived.

use super::second::Seeds;
use super::tolerances::Tolerances;
use crate::excitation::plan::Variation;
use crate::excitation::{self, MemberSine};
use crate::kernel::job::Member;
use crate::physics::coefficients::Coefficients;
use crate::sensor::error_law::{ErrorLaw, Shape};
use crate::sensor::{ProofMass, Sensor, SensorTerm, mechanics};
use crate::units::key::Key;
use crate::units::number::Number;

/// Draws members: which numbers are given is found out once.
#[derive(Clone)]
pub(super) struct Drawer {
    all: Tolerances,
    variation: Variation,
    seeds: Seeds,
    /// The terms that are given, with their keys, and phases that go with them.
    terms: Vec<Given>,
}

/// A term that is given.
#[derive(Debug, Clone)]
struct Given {
    term: SensorTerm,
    key: &'static Key,
    phases: Vec<SensorTerm>,
}

impl Drawer {
    pub(super) fn new(all: &Tolerances, variation: Variation, seeds: Seeds) -> Self {
        let phases = |term: SensorTerm| term.shapes().filter(|s| s.law() == ErrorLaw::Shape(Shape::Phase)).collect();
        let given = |term: SensorTerm| Some(Given { term, key: all.given(term)?, phases: phases(term) });
        let terms = SensorTerm::ALL.into_iter().filter_map(given).collect();
        Self { all: all.clone(), variation, seeds, terms }
    }

    /// A member; a pure function of its index.
    pub(super) fn member(&self, member: u64) -> Member {
        let (all, seeds) = (&self.all, self.seeds.member(member));
        let probability = |key: &Key| seeds.probability(key, 0);
        let draw = |key: &Key| all.draw(key, probability);
        let excitation_gain = if self.variation == Variation::Gain { draw(&excitation::SIZE) } else { 1.0 };
        let mut sensor = Sensor { proof_mass: proof_mass(all, &draw), excitation_gain, ..Sensor::default() };
        for Given { term, key, phases } in &self.terms {
            term.set(&mut sensor.accelerometer, &mut sensor.gyro, draw(key));
            for phase in phases {
                let anywhere = Number::Uniform { min: 0.0, max: 360.0 };
                let key = &phase.row().keys[0];
                let drawn = all.draw_or(key, anywhere, probability);
                phase.set(&mut sensor.accelerometer, &mut sensor.gyro, drawn);
            }
        }
        let sine = (self.variation == Variation::Sine).then(|| MemberSine {
            amplitude_m_s2: draw(&excitation::SIZE),
            frequency_hz: draw(&excitation::FREQUENCY),
            phase_rad: draw(&excitation::PHASE),
        });
        Member { sensor, sine }
    }
}

/// The proof mass, from its modes or from the paper's m, D₀, k, ε: ω₀² = k/m, 2ζω₀ = D₀/m, β = ε/m.
fn proof_mass(all: &Tolerances, draw: &dyn Fn(&Key) -> f64) -> Option<ProofMass> {
    use mechanics::*;
    if all[&MASS].is_none() && all[&RESONANCE].is_none() {
        return None;
    }
    let mut laws = Coefficients::given(draw);
    let (natural_frequency_rad_s, damping_ratio) = if all[&MASS].is_some() {
        let (mass_kg, stiffness_n_m) = (draw(&MASS), draw(&STIFFNESS));
        laws = laws.with(&CUBIC_STIFFNESS, draw(&CUBIC_SPRING) / mass_kg);
        ((stiffness_n_m / mass_kg).sqrt(), draw(&DAMPING) / (2.0 * (stiffness_n_m * mass_kg).sqrt()))
    } else {
        (draw(&RESONANCE), draw(&DAMPING_RATIO))
    };
    Some(ProofMass { natural_frequency_rad_s, damping_ratio, laws, force_noise_m_s_rts: draw(&FORCE_NOISE) })
}
