//! One inertial sensor in SI units: what an accelerometer and its gyro do to the truth.
//!
//! This is a single concrete sensor, after tolerances have been drawn; what may vary is described
//! by `study`. Zero switches a term off (`range_m_s2`: infinity). White levels are two-sided
//! coefficients N as in IEEE 952: N = n/√2 for a one-sided density n, and a white sequence at rate
//! f has σ = N√f.

pub mod coupling;
pub mod error_law;
pub mod estimated;
pub mod mechanics;
pub mod sense;
pub mod source;
pub mod terms;

pub use sense::Sense;
pub use terms::{Accelerometer, Gyro, SensorTerm};

use crate::physics::coefficients::Coefficients;
use crate::physics::dimension::Units;
use crate::physics::study::Given;
use crate::physics::{stiffness_drift, warm_stiffness};
use crate::units::key::Key;

/// The proof mass: x″ + 2ζω₀x′ + ω₀²x + βx³ = f (paper's eq. 6; eq. 4 is β = 0), with whatever
/// further laws of `physics` a diagnosis may have found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProofMass {
    /// Undamped natural frequency ω₀.
    pub natural_frequency_rad_s: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// Coefficients of the laws that it follows next to the linear one.
    pub laws: Coefficients,
    /// Random-walk coefficient of Brownian force noise per unit mass, m/s²·√s (two-sided).
    pub force_noise_m_s_rts: f64,
}

impl ProofMass {
    /// Cubic stiffness β, 1/(m² s²).
    pub fn cubic_per_m2_s2(&self) -> f64 {
        self.laws.of(&mechanics::CUBIC_STIFFNESS)
    }

    /// The fastest rate of its motion, rad/s: in contact with its end stops and with its further
    /// modes, where it has any.
    pub fn fastest_rad_s(&self) -> f64 {
        let si = Units { y: 1.0, u: 1.0, s: 1.0 };
        let added: f64 = self.laws.acting().map(|law| law.term.stiffens(&self.laws.values(law, &si))).sum();
        self.natural_frequency_rad_s.hypot(added.sqrt())
    }

    /// The same with its spring as stiff as it becomes within so long of the run, between these
    /// temperatures above their reference.
    pub fn at_its_stiffest(mut self, time_s: f64, warmer_k: [f64; 2]) -> Self {
        let of = |given: &[Given]| self.laws.of(&given[0].key);
        let [cold, warm] = warmer_k.map(|kelvins| of(warm_stiffness::GIVEN) * kelvins);
        let growth = (of(stiffness_drift::GIVEN) * time_s).max(0.0) + cold.max(warm).max(0.0);
        self.natural_frequency_rad_s *= (1.0 + growth).sqrt();
        self
    }

    /// Returns whether there is anything beyond the linear and the cubic spring.
    pub fn has_further_terms(&self) -> bool {
        self.laws.acting().any(|law| law.given()[0].key.slot != mechanics::CUBIC_STIFFNESS.slot)
    }

    /// One as hard to step as either: higher resonance, lower damping, stronger further terms.
    pub fn stiffer(&self, other: &Self) -> Self {
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        Self {
            natural_frequency_rad_s: self.natural_frequency_rad_s.max(other.natural_frequency_rad_s),
            damping_ratio: self.damping_ratio.min(other.damping_ratio),
            laws: self.laws.zip(&other.laws, larger),
            force_noise_m_s_rts: larger(self.force_noise_m_s_rts, other.force_noise_m_s_rts),
        }
    }

    /// The same proof mass with another coefficient of one law, SI.
    pub fn with(mut self, key: &Key, value: f64) -> Self {
        self.laws = self.laws.with(key, value);
        self
    }
}

/// One member of an ensemble: a sensor and how strongly it is excited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Mechanics; `None` is an ideal proof mass (x follows f at once).
    pub proof_mass: Option<ProofMass>,
    /// Reading errors of the accelerometer.
    pub accelerometer: Accelerometer,
    /// Reading errors of the gyro, which become tilt.
    pub gyro: Gyro,
    /// Factor on the study's shared excitation.
    pub excitation_gain: f64,
}

/// Without any error, excited as the study says.
impl Default for Sensor {
    fn default() -> Self {
        Self { proof_mass: None, accelerometer: Accelerometer::default(), gyro: Gyro::default(), excitation_gain: 1.0 }
    }
}

impl Sensor {
    /// The coefficient of an error term, SI.
    pub fn error(&self, term: SensorTerm) -> f64 {
        term.of(&self.accelerometer, &self.gyro)
    }

    /// The same sensor with another coefficient of one error term, SI.
    pub fn with_error(mut self, term: SensorTerm, coefficient: f64) -> Self {
        term.set(&mut self.accelerometer, &mut self.gyro, coefficient);
        self
    }
}
