//! The sources of error one by one: what each is called, whether a sensor has it, and a sensor that has it alone or not.
//!
//! For error budgets. What a source does to position over time is `navigation::closed_form`.

use super::Sensor;

/// One source of error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Source {
    /// Resonance, damping and nonlinear springs of the proof mass: the reading is not the force.
    Mechanics,
    /// Brownian force on the proof mass.
    ForceNoise,
    /// Constant accelerometer bias.
    AccelerometerBias,
    /// Scale-factor error.
    ScaleFactor,
    /// Second-order nonlinearity.
    Nonlinearity,
    /// White noise of the accelerometer.
    VelocityRandomWalk,
    /// Flicker of the accelerometer's bias.
    AccelerometerBiasInstability,
    /// Wandering accelerometer bias.
    AccelerationRandomWalk,
    /// Rounding of the reading.
    Quantisation,
    /// Readings beyond full scale.
    Range,
    /// Constant gyro bias.
    GyroBias,
    /// White noise of the gyro.
    AngleRandomWalk,
    /// Flicker of the gyro's bias.
    GyroBiasInstability,
    /// Wandering gyro bias.
    RateRandomWalk,
}

impl Source {
    /// All of them, accelerometer first.
    pub const ALL: [Self; 14] = [
        Self::Mechanics,
        Self::ForceNoise,
        Self::AccelerometerBias,
        Self::ScaleFactor,
        Self::Nonlinearity,
        Self::VelocityRandomWalk,
        Self::AccelerometerBiasInstability,
        Self::AccelerationRandomWalk,
        Self::Quantisation,
        Self::Range,
        Self::GyroBias,
        Self::AngleRandomWalk,
        Self::GyroBiasInstability,
        Self::RateRandomWalk,
    ];

    /// Its name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mechanics => "proof-mass mechanics",
            Self::ForceNoise => "Brownian force noise",
            Self::AccelerometerBias => "accelerometer bias",
            Self::ScaleFactor => "scale factor",
            Self::Nonlinearity => "nonlinearity K₂",
            Self::VelocityRandomWalk => "velocity random walk",
            Self::AccelerometerBiasInstability => "accelerometer bias instability",
            Self::AccelerationRandomWalk => "acceleration random walk",
            Self::Quantisation => "quantisation",
            Self::Range => "range limit",
            Self::GyroBias => "gyro bias",
            Self::AngleRandomWalk => "angle random walk",
            Self::GyroBiasInstability => "gyro bias instability",
            Self::RateRandomWalk => "rate random walk",
        }
    }

    /// Whether it depends on the others or on the reading as a whole, so that "alone" means nothing: rounding is a
    /// constant without noise and white with it, saturation needs the full reading. Such a source is judged by switching it off.
    pub fn needs_the_others(self) -> bool {
        matches!(self, Self::Quantisation | Self::Range)
    }

    /// The power of time by which it makes position drift, where it is one power.
    pub fn position_exponent(self) -> Option<f64> {
        match self {
            Self::VelocityRandomWalk | Self::ForceNoise => Some(1.5),
            Self::AccelerometerBias => Some(2.0),
            Self::AccelerationRandomWalk | Self::AngleRandomWalk => Some(2.5),
            Self::GyroBias => Some(3.0),
            Self::RateRandomWalk => Some(3.5),
            _ => None,
        }
    }

    /// Whether this sensor has it.
    pub fn is_on(self, sensor: &Sensor) -> bool {
        let (a, g) = (&sensor.accelerometer, &sensor.gyro);
        match self {
            Self::Mechanics => sensor.proof_mass.is_some(),
            Self::ForceNoise => sensor.proof_mass.is_some_and(|p| p.force_noise_m_s_rts != 0.0),
            Self::AccelerometerBias => a.bias_m_s2 != 0.0,
            Self::ScaleFactor => a.scale_factor != 0.0,
            Self::Nonlinearity => a.k2_per_m_s2 != 0.0,
            Self::VelocityRandomWalk => a.velocity_random_walk_m_s_rts != 0.0,
            Self::AccelerometerBiasInstability => a.bias_instability_m_s2 != 0.0,
            Self::AccelerationRandomWalk => a.acceleration_random_walk_m_s2_rts != 0.0,
            Self::Quantisation => a.quantisation_m_s2 != 0.0,
            Self::Range => a.range_m_s2.is_finite(),
            Self::GyroBias => g.bias_rad_s != 0.0,
            Self::AngleRandomWalk => g.angle_random_walk_rad_rts != 0.0,
            Self::GyroBiasInstability => g.bias_instability_rad_s != 0.0,
            Self::RateRandomWalk => g.rate_random_walk_rad_s_rts != 0.0,
        }
    }

    /// The same sensor without this source.
    pub fn off(self, sensor: &Sensor) -> Sensor {
        let mut without = *sensor;
        let (a, g) = (&mut without.accelerometer, &mut without.gyro);
        match self {
            Self::Mechanics => without.proof_mass = None,
            Self::ForceNoise => {
                if let Some(mass) = &mut without.proof_mass {
                    mass.force_noise_m_s_rts = 0.0;
                }
            }
            Self::AccelerometerBias => a.bias_m_s2 = 0.0,
            Self::ScaleFactor => a.scale_factor = 0.0,
            Self::Nonlinearity => a.k2_per_m_s2 = 0.0,
            Self::VelocityRandomWalk => a.velocity_random_walk_m_s_rts = 0.0,
            Self::AccelerometerBiasInstability => a.bias_instability_m_s2 = 0.0,
            Self::AccelerationRandomWalk => a.acceleration_random_walk_m_s2_rts = 0.0,
            Self::Quantisation => a.quantisation_m_s2 = 0.0,
            Self::Range => a.range_m_s2 = f64::INFINITY,
            Self::GyroBias => g.bias_rad_s = 0.0,
            Self::AngleRandomWalk => g.angle_random_walk_rad_rts = 0.0,
            Self::GyroBiasInstability => g.bias_instability_rad_s = 0.0,
            Self::RateRandomWalk => g.rate_random_walk_rad_s_rts = 0.0,
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
    use crate::sensor::{Accelerometer, Gyro, ProofMass};

    fn full() -> Sensor {
        let proof_mass = ProofMass {
            natural_frequency_rad_s: 10.0,
            damping_ratio: 0.5,
            cubic_per_m2_s2: 0.0,
            quadratic_per_m_s2: 0.0,
            quadratic_damping_per_m: 0.0,
            squeeze_film_per_m2_s: 0.0,
            coulomb_m_s2: 0.0,
            force_noise_m_s_rts: 1.0,
        };
        Sensor {
            proof_mass: Some(proof_mass),
            accelerometer: Accelerometer {
                bias_m_s2: 1.0,
                scale_factor: 1.0,
                k2_per_m_s2: 1.0,
                velocity_random_walk_m_s_rts: 1.0,
                bias_instability_m_s2: 1.0,
                acceleration_random_walk_m_s2_rts: 1.0,
                quantisation_m_s2: 1.0,
                range_m_s2: 1.0,
            },
            gyro: Gyro {
                bias_rad_s: 1.0,
                angle_random_walk_rad_rts: 1.0,
                bias_instability_rad_s: 1.0,
                rate_random_walk_rad_s_rts: 1.0,
            },
            excitation_gain: 1.0,
        }
    }

    #[test]
    fn every_source_can_be_had_alone_and_left_out() {
        assert!(Source::ALL.into_iter().all(|s| s.is_on(&full()) && !s.is_on(&Sensor::default())));
        for source in Source::ALL {
            let alone: Vec<Source> = Source::ALL.into_iter().filter(|s| s.is_on(&source.alone(&full()))).collect();
            let expected = if source == Source::ForceNoise { vec![Source::Mechanics, source] } else { vec![source] };
            assert_eq!(alone, expected);
            assert!(!source.is_on(&source.off(&full())));
        }
    }
}
