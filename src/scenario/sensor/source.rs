//! The sources of error one by one: what each is called, whether a sensor has it, and a sensor that
//! has it alone or not.
//!
//! For error budgets. What a source does to position over time is `navigation::closed_form`.

use super::error_law::{ErrorLaw, Shape};
use super::terms::alike;
use super::{Sense, Sensor, SensorTerm};

/// Terms that are errors by themselves.
const ERRORS: usize = SensorTerm::COUNT - alike(ErrorLaw::Shape(Shape::Memory), SensorTerm::COUNT);

/// A source of error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorSource {
    /// Resonance, damping and nonlinear springs of the proof mass: the reading is not the force.
    Mechanics,
    /// Brownian force on the proof mass.
    ForceNoise,
    /// An error of the reading.
    Term(SensorTerm),
}

impl ErrorSource {
    /// All of them: the proof mass, then the terms of the table.
    pub const ALL: [Self; 2 + ERRORS] = {
        let mut all = [Self::Mechanics; 2 + ERRORS];
        all[1] = Self::ForceNoise;
        let (mut term, mut place) = (0, 2);
        while term < SensorTerm::COUNT {
            if !SensorTerm::ALL[term].is_shape() {
                all[place] = Self::Term(SensorTerm::ALL[term]);
                place += 1;
            }
            term += 1;
        }
        all
    };

    /// Name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mechanics => "proof-mass mechanics",
            Self::ForceNoise => "Brownian force noise",
            Self::Term(term) => term.row().name,
        }
    }

    /// Returns whether it is a gyro's, whose error reaches position through tilt.
    pub fn is_gyro(self) -> bool {
        matches!(self, Self::Term(term) if term.sense() == Sense::Gyro)
    }

    /// Returns whether "alone" means nothing for it; such a source is judged by switching it off.
    pub fn needs_the_others(self) -> bool {
        matches!(self, Self::Term(term) if term.law().acts_on_the_reading())
    }

    /// The power of time by which it makes position drift, where it is one power.
    pub fn position_exponent(self) -> Option<f64> {
        match self {
            Self::Mechanics => None,
            Self::ForceNoise => Some(1.5),
            Self::Term(term) => term.position_exponent(),
        }
    }

    /// Returns whether this sensor has it.
    pub fn is_on(self, sensor: &Sensor) -> bool {
        match self {
            Self::Mechanics => sensor.proof_mass.is_some(),
            Self::ForceNoise => sensor.proof_mass.is_some_and(|p| p.force_noise_m_s_rts != 0.0),
            Self::Term(term) => sensor.error(term) != term.law().neutral(),
        }
    }

    /// The same sensor without this source.
    pub fn off(self, sensor: &Sensor) -> Sensor {
        let mut without = *sensor;
        match self {
            Self::Mechanics => without.proof_mass = None,
            Self::ForceNoise => {
                if let Some(mass) = &mut without.proof_mass {
                    mass.force_noise_m_s_rts = 0.0;
                }
            }
            Self::Term(term) => return without.with_error(term, term.law().neutral()),
        }
        without
    }

    /// A sensor with this source alone. Force noise acts through the mechanics, so it keeps them.
    pub fn alone(self, sensor: &Sensor) -> Sensor {
        let keeps = |other: Self| other == self || self == Self::ForceNoise && other == Self::Mechanics;
        Self::ALL.into_iter().filter(|other| !keeps(*other)).fold(*sensor, |rest, other| other.off(&rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::ProofMass;

    fn full() -> Sensor {
        let proof_mass = ProofMass {
            natural_frequency_rad_s: 10.0,
            damping_ratio: 0.5,
            force_noise_m_s_rts: 1.0,
            ..ProofMass::default()
        };
        let bare = Sensor { proof_mass: Some(proof_mass), ..Sensor::default() };
        SensorTerm::ALL.into_iter().fold(bare, |sensor, term| sensor.with_error(term, 1.0))
    }

    #[test]
    fn every_source_can_be_had_alone_and_left_out() {
        assert!(ErrorSource::ALL.into_iter().all(|s| s.is_on(&full()) && !s.is_on(&Sensor::default())));
        for source in ErrorSource::ALL {
            let alone: Vec<ErrorSource> =
                ErrorSource::ALL.into_iter().filter(|s| s.is_on(&source.alone(&full()))).collect();
            let expected =
                if source == ErrorSource::ForceNoise { vec![ErrorSource::Mechanics, source] } else { vec![source] };
            assert_eq!(alone, expected);
            assert!(!source.is_on(&source.off(&full())));
        }
    }
}
