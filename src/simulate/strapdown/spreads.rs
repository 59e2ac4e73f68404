//! Distributions along axes and radii about the truth, as the public document has them.

use serde::Serialize;

use super::answer::Answer;
use crate::backend::flight::Quantity;
use crate::drift::document::Distribution;

/// A distribution along each axis of north-east-down.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct NorthEastDown {
    north: Distribution,
    east: Distribution,
    down: Distribution,
}

/// Radii of circles about the truth that hold 50 and 95 % of the members.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Circular {
    cep50: Vec<f64>,
    cep95: Vec<f64>,
}

/// Radii of spheres about the truth that hold 50 and 95 % of them.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Spherical {
    sep50: Vec<f64>,
    sep95: Vec<f64>,
}

/// Mean and standard deviation by the linear model.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Spread {
    mean: Vec<f64>,
    sd: Vec<f64>,
}

/// Those along each axis.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Axes {
    north: Spread,
    east: Spread,
    down: Spread,
}

/// Everything of an answer at some of its report times.
pub(super) struct At<'a> {
    /// Result of the study.
    pub answer: &'a Answer,
    /// Places of the times.
    pub places: &'a [usize],
}

impl At<'_> {
    /// Distribution of one quantity.
    pub(super) fn distribution(&self, quantity: Quantity) -> Distribution {
        let at = |place: &usize| self.answer.ensemble.summary(*place, quantity);
        Distribution::of(&self.places.iter().map(at).collect::<Vec<_>>())
    }

    /// One along each axis.
    pub(super) fn north_east_down(&self, quantity: fn(usize) -> Quantity) -> NorthEastDown {
        NorthEastDown {
            north: self.distribution(quantity(0)),
            east: self.distribution(quantity(1)),
            down: self.distribution(quantity(2)),
        }
    }

    fn percentile(&self, quantity: Quantity, rank: usize) -> Vec<f64> {
        self.places.iter().map(|k| self.answer.ensemble.summary(*k, quantity).percentiles[rank]).collect()
    }

    /// Horizontal distance from the truth.
    pub(super) fn circular(&self) -> Circular {
        Circular { cep50: self.percentile(Quantity::Horizontal, 2), cep95: self.percentile(Quantity::Horizontal, 3) }
    }

    /// Distance from the truth.
    pub(super) fn spherical(&self) -> Spherical {
        Spherical { sep50: self.percentile(Quantity::Spherical, 2), sep95: self.percentile(Quantity::Spherical, 3) }
    }

    /// Returns what the linear model says of one of its nine.
    pub(super) fn linear(&self, place: usize) -> Spread {
        let covariance = &self.answer.covariance;
        Spread {
            mean: self.places.iter().map(|k| covariance.mean(*k, place)).collect(),
            sd: self.places.iter().map(|k| covariance.variance(*k, place).sqrt()).collect(),
        }
    }

    /// Returns what it says of three.
    pub(super) fn linear_axes(&self, first: usize) -> Axes {
        Axes { north: self.linear(first), east: self.linear(first + 1), down: self.linear(first + 2) }
    }
}
