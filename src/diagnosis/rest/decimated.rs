//! A channel on means of neighbours, next to a walk and flicker whose strengths are free: what a
//! curve in its mean is held against before any noise is named.
//!
//! A curve that only looks like the drift gains nothing there. Not for fast noise: it is averaged.

use super::block_means;
use super::cause::Cause;
use super::channel::{Addition, Channel, Curve, Fitted, Term};
use super::spectrum::Law;

/// Means, at most.
const MOST: usize = 4096;
/// Twice the log-likelihood that a number of a curve must gain: Schwarz's for [`MOST`] values.
pub(super) const PENALTY: f64 = 8.3;

/// Samples averaged into one mean, so that a record of this length gives at most [`MOST`] means.
pub(super) fn together(values: usize) -> usize {
    values.div_ceil(MOST)
}

/// A channel on means, and what its noise alone tells.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    pub(super) channel: Channel,
    /// Log-likelihood of noise alone.
    alone: f64,
}

impl Coarse {
    pub(super) fn of(channel: &Channel) -> Self {
        Self::on(block_means::channel(channel, &channel.values, together(channel.values.len())))
    }

    fn on(channel: Channel) -> Self {
        let alone = fitted(&channel, Vec::new()).log_likelihood();
        Self { channel, alone }
    }

    /// Number of means.
    pub(super) fn count(&self) -> usize {
        self.channel.values.len()
    }

    /// Log-likelihood next to curves.
    pub(super) fn with(&self, curves: Vec<Curve>) -> f64 {
        fitted(&self.channel, curves).log_likelihood()
    }

    /// Twice what a log-likelihood next to curves is above that of noise alone; none below it.
    pub(super) fn gain(&self, log_likelihood: f64) -> f64 {
        (2.0 * (log_likelihood - self.alone)).max(0.0)
    }

    /// Returns what curves leave of the channel.
    pub(super) fn without(&self, curves: Vec<Curve>) -> Self {
        let taken = fitted(&self.channel, curves).mean_curve(self.count());
        let left: Vec<f64> = self.channel.values.iter().zip(&taken).map(|(v, t)| v - t).collect();
        Self::on(block_means::channel(&self.channel, &left, 1))
    }
}

/// A channel with curves in its mean, next to the noise.
fn fitted(channel: &Channel, curves: Vec<Curve>) -> Fitted {
    let term = |cause, addition| Term { cause, addition, searched: 0.0, column: None };
    let mut terms =
        vec![term(Cause::RandomWalk, Addition::Law(Law::Walk)), term(Cause::FlickerNoise, Addition::Law(Law::Flicker))];
    if !curves.is_empty() {
        terms.push(term(Cause::TemperatureSensitivity, Addition::Curves(curves)));
    }
    channel.fit(terms)
}
