//! The question that an experiment shall answer: a sensor, the laws that it may follow, and what of them
//! is to be known.

use std::f64::consts::TAU;

use crate::driven::base::OMEGA;
use crate::physics::library::Term;

/// A linear proof mass and the noise of its reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Parameters of the base model, at rest at the beginning.
    pub base: Vec<f64>,
    /// Standard deviation of the noise of one reading.
    pub noise: f64,
}

impl Sensor {
    /// Natural frequency, Hz.
    pub fn resonance_hz(&self) -> f64 {
        self.base[OMEGA] / TAU
    }
}

/// A law with all its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The law.
    pub term: Term,
    /// Its parameters, then where its states begin.
    pub values: Vec<f64>,
    /// Two more sets of values, if the parameters are known by intervals: together with the first they have the
    /// intervals' variance. Empty if the strength is given.
    pub likely: Vec<Vec<f64>>,
    /// The sensor where it follows this law, if another one than where it follows the first.
    pub sensor: Option<Sensor>,
}

impl Known {
    /// The law with each of its other likely values.
    pub(super) fn each_likely(&self) -> Vec<Self> {
        self.likely.iter().map(|values| Self { values: values.clone(), ..self.clone() }).collect()
    }
}

/// Strength of a law that is to be shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Strength {
    /// Its first parameter.
    Value(f64),
    /// Its largest force over that of the spring, at the largest motion within the limits.
    Share(f64),
}

/// A law's first parameter and half the width of its 95 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Symbol of the parameter.
    pub parameter: String,
    /// Unit of it.
    pub unit: String,
    /// Half the width.
    pub half_width: f64,
    /// Length of the recording that gave it, s.
    pub seconds: f64,
}

/// Purpose of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub enum Purpose {
    /// Tell the rivals apart.
    Decide,
    /// Show a law of this strength.
    Show(Strength),
    /// Halve the interval of the only rival.
    Narrow(Interval),
}

/// The question.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The sensor as far as it is known.
    pub sensor: Sensor,
    /// Laws that it follows in any case.
    pub common: Vec<Known>,
    /// Laws of which it follows one, or none of them.
    pub rivals: Vec<Known>,
    /// Purpose of the experiment.
    pub purpose: Purpose,
}

impl Question {
    /// The sensor where a law is true; where none is, that of the first.
    pub(super) fn sensor_with<'a>(&'a self, own: Option<&'a Known>) -> &'a Sensor {
        own.and_then(|known| known.sensor.as_ref()).unwrap_or(&self.sensor)
    }
}
