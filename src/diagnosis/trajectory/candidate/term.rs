//! A candidate as the fit takes it: the parameters that it frees and how they are stated.

use std::ops::Range;

use crate::candidate::Candidate;
use crate::model::Half;
use crate::sensor::Sense;

/// A unit that parameters are stated in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Name of the unit, as in the document.
    pub name: &'static str,
    /// Number of these units in one SI unit.
    pub per_si: f64,
}

/// States how a parameter of the fit is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// The parameter as it is.
    Plain,
    /// By its root: the fit is linear in the square, which no law makes negative. Below the time
    /// from one reading to the next it cannot be told from the straight lines between them.
    Time,
}

/// A candidate and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Its entry in the library of candidates.
    pub candidate: &'static Candidate,
    /// The sensor it acts in; none: both.
    pub sensor: Option<Sense>,
    /// Indices of the parameters that it frees.
    pub parameters: Range<usize>,
    /// Symbols of its parameters, in order.
    pub names: &'static [&'static str],
    /// Unit of its parameters.
    pub unit: Unit,
    /// States how its parameters are stated.
    pub measure: Measure,
    /// Sizes below which it costs nothing, SI.
    pub smallest: f64,
    /// Holds what looks the same in the readings as an attitude of the reference that errs by one
    /// radian, SI; zero where nothing.
    pub per_tilt: f64,
    /// The half of a pose without which a reference does not show it, if there is one.
    pub needs: Option<Half>,
}

impl Term {
    /// Its id in the library of candidates.
    pub fn id(&self) -> &'static str {
        self.candidate.id
    }

    /// The largest size that such a sensor or mounting has, as the library states it, SI.
    pub fn largest(&self) -> f64 {
        self.candidate.parameters.iter().map(|p| p.range.1).fold(0.0, f64::max) / self.unit.per_si
    }

    /// Returns whether the motion determines a parameter at all: to better than the largest size
    /// that there is.
    pub(in crate::trajectory) fn knows(&self, half_width: f64) -> bool {
        match self.measure {
            Measure::Plain => half_width <= self.largest(),
            Measure::Time => true,
        }
    }

    /// Returns whether a parameter of the fit with the half width of its interval may be such a
    /// sensor's.
    pub(in crate::trajectory) fn allows(&self, value: f64, half_width: f64) -> bool {
        match self.measure {
            Measure::Plain => value.abs() - half_width <= self.largest(),
            Measure::Time => value > half_width && value - half_width <= self.largest().powi(2),
        }
    }

    /// Returns whether a parameter of the fit is large enough to cost anything, where attitudes err
    /// by `tilt_rad` and readings are `interval_s` apart.
    pub(in crate::trajectory) fn matters(&self, value: f64, tilt_rad: f64, interval_s: f64) -> bool {
        match self.measure {
            Measure::Plain => value.abs() >= self.smallest.max(self.per_tilt * tilt_rad),
            Measure::Time => value >= self.smallest.max(interval_s).powi(2),
        }
    }

    /// A size of a parameter of the fit as it is stated, SI.
    pub(in crate::trajectory) fn size(&self, value: f64) -> f64 {
        match self.measure {
            Measure::Plain => value,
            Measure::Time => value.max(0.0).sqrt(),
        }
    }

    /// "misalignment of the gyro".
    pub fn phrase(&self) -> String {
        match self.sensor {
            Some(sensor) => format!("{} of the {}", self.id(), sensor.name()),
            None => self.id().to_owned(),
        }
    }
}
