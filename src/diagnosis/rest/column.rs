//! An environment column, averaged and scaled by its own standard deviation, as the search for
//! shapes uses it.

use super::block_means;
use super::cause::Cause;
use super::channel::{Addition, Curve, Term};
use super::decimated;
use super::followed::{Delay, Followed};
use crate::numerics::moments::mean_sd;

/// Lags that are tried, as parts of the recording; shorter than the first is none.
const LAGS: [f64; 2] = [0.002, 0.3];
/// Half widths of play that are tried, as parts of the column's range.
const PLAYS: [f64; 2] = [0.01, 0.4];
/// The column itself and no power of it.
pub(super) const STRAIGHT: &[i32] = &[1];
/// Powers of the column that are tried together: a square or a cube only where it is needed.
pub(super) const POWERS: [&[i32]; 4] = [STRAIGHT, &[1, 2], &[1, 3], &[1, 2, 3]];

/// A column that is not constant.
#[derive(Debug, Clone)]
pub(super) struct Column<'a> {
    name: &'a str,
    /// At every sample.
    full: &'a Curve,
    pub(super) means: Vec<f64>,
    /// Samples in a mean.
    together: usize,
    /// Standard deviation of the means.
    unit: f64,
}

impl<'a> Column<'a> {
    /// `None` for one that is constant.
    pub(super) fn of(name: &'a str, full: &'a Curve) -> Option<Self> {
        let together = decimated::together(full.values.len());
        let means = block_means::means(&full.values, together);
        let (_, unit) = mean_sd(&means);
        (unit > 0.0).then_some(Self { name, full, means, together, unit })
    }

    pub(super) fn name(&self) -> &str {
        self.name
    }

    /// Shortest and longest lag that is tried, in means.
    pub(super) fn lags(&self) -> [f64; 2] {
        LAGS.map(|part| part * self.means.len() as f64)
    }

    /// Least and most play that is tried, in the column's unit.
    pub(super) fn plays(&self) -> [f64; 2] {
        let [low, high] =
            self.means.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
        PLAYS.map(|part| part * (high - low))
    }

    /// Powers, in its own deviation, of what a delay makes of it, or of another column of as many
    /// means.
    pub(super) fn powers(&self, delayed: &[f64], of: &[i32]) -> Vec<Curve> {
        let (mean, _) = mean_sd(delayed);
        let power = |p: &i32| Curve::new(delayed.iter().map(|v| ((v - mean) / self.unit).powi(*p)).collect());
        of.iter().map(power).collect()
    }

    /// The term that follows it so, on all samples; a lag is given in means.
    pub(super) fn term(&self, delay: Delay, powers: &'static [i32]) -> Term {
        let delay = delay.in_samples(self.together);
        Term {
            cause: Cause::TemperatureSensitivity,
            addition: Addition::Curves(self.powers(&delay.of(&self.full.values), powers)),
            searched: 0.0,
            column: Some(Followed { column: self.name.into(), delay, unit: self.unit, powers }),
        }
    }
}
