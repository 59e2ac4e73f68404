//! Parameters of a sensor as data: what each is, how large it is before anything is recorded, and what
//! one run makes of it.

use nalgebra::DMatrix;

use super::information::Known;
use crate::numerics::allan::law::Term;
use crate::numerics::special::t_quantile;
use crate::recording::unit::Unit;
use crate::sensor::Sense;

/// Role of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Reading at zero input, on one axis.
    Bias,
    /// Reading per unit of input, on one axis.
    Scale,
    /// Reading of an axis of the input across it.
    Misalignment,
    /// Reading of a gyro's axis of the specific force along an axis.
    GSensitivity,
}

/// One element of a sensor's linear model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// The sensor.
    pub sensor: Sense,
    /// Its role.
    pub role: Role,
    /// The axis that reads, 0 to 2.
    pub axis: usize,
    /// The axis that is read next to it, of parameters between two.
    pub of: Option<usize>,
    /// Holds where it is stated in SI units; else biases and scales are in those of the reading.
    pub is_si: bool,
}

/// The mean or a noise coefficient of a channel at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct AtRest {
    /// Heading of the channel.
    pub channel: String,
    /// Unit of its readings.
    pub unit: Unit,
    /// The noise coefficient; `None` for the mean of the readings.
    pub term: Option<Term>,
}

/// A number that its kind names and states.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name for people, its axis last.
    pub name: String,
    /// Unit that it is stated in.
    pub unit: String,
    /// Number of these units in one of those that it is held in.
    pub factor: f64,
}

/// One parameter that a recording may tell.
#[derive(Debug, Clone, PartialEq)]
pub enum Parameter {
    /// An element of the linear model.
    Element(Element),
    /// The mean or a noise coefficient of a channel, in units of the file.
    AtRest(AtRest),
    /// Any other number of a model.
    Named(Named),
}

impl Parameter {
    /// Returns whether values and errors are held as natural logarithms: sizes that cannot be negative,
    /// known to a share of themselves.
    pub fn is_logarithmic(&self) -> bool {
        matches!(self, Self::AtRest(AtRest { term: Some(_), .. }))
    }

    /// The element, of a linear model's parameters.
    pub fn element(&self) -> Option<&Element> {
        match self {
            Self::Element(element) => Some(element),
            Self::AtRest(_) | Self::Named(_) => None,
        }
    }
}

/// A sensor as one run tells of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The parameters, in one order for all runs of a kind.
    pub parameters: Vec<Parameter>,
    /// Size of each that is plausible before anything is recorded.
    pub tolerance: Vec<f64>,
    /// Values that the fit found (logarithms of those that are logarithmic); without meaning where the run does not determine it.
    pub value: Vec<f64>,
    /// Covariance of the fit's errors, scaled by what the fit leaves.
    pub covariance: DMatrix<f64>,
    /// Degrees of freedom behind the scale of each variance.
    pub freedom: Vec<f64>,
    /// Knowledge of each.
    pub known: Vec<Known>,
}

impl Estimate {
    /// Standard error of a parameter.
    pub fn deviation(&self, parameter: usize) -> f64 {
        self.covariance[(parameter, parameter)].max(0.0).sqrt()
    }

    /// Half the width of its 95 % interval.
    pub fn half_width(&self, parameter: usize) -> f64 {
        t_quantile(0.975, self.freedom[parameter]) * self.deviation(parameter)
    }

    /// Returns whether the run determines a parameter at all.
    pub fn determines(&self, parameter: usize) -> bool {
        self.known[parameter] != Known::Not
    }
}
