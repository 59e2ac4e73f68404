//! Decides whether a white level other than the promised one holds throughout: at every frequency
//! where white noise dominates, and from the first sample to the last. Otherwise a disturbance,
//! spikes or noise that grows raised it, and the datasheet is not to blame.

use super::cause::Cause;
use super::channel::{Channel, Fitted};
use super::residual::Residual;
use crate::remainder::REAL;

/// Fraction of a bin's variance that has to be white for the bin to count.
const DOMINATES: f64 = 0.8;
/// Fraction of the blocks of bins that have to be nearer to the fitted level than to the promised
/// one.
const AGREEING: f64 = 0.75;
/// Fewer blocks are not compared.
const FEWEST_BLOCKS: usize = 4;
/// Fewest coefficients per block.
const SMALLEST_BLOCK: f64 = 32.0;

/// White variance per sample: as fitted and as promised.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levels {
    pub(super) fitted: f64,
    pub(super) promised: f64,
}

impl Levels {
    /// Returns whether a level is nearer, by its logarithm, to the fitted one than to the promised
    /// one.
    fn supports(self, level: f64) -> bool {
        let middle = (self.fitted * self.promised).sqrt();
        if self.fitted > self.promised { level > middle } else { level < middle }
    }

    /// Coefficients whose mean square scatters by a third of the way between both levels: twice its
    /// inverse square.
    fn block(self) -> f64 {
        (18.0 / (self.fitted / self.promised).ln().powi(2)).max(SMALLEST_BLOCK)
    }
}

/// Returns whether a level holds throughout in a channel.
pub(super) fn holds(levels: Levels, channel: &Channel, fitted: &Fitted, residual: &Residual) -> bool {
    // Behind a filter the level is that of the lowest frequencies, continued: as much a shape as a
    // level.
    let is_read = !fitted.has(Cause::BandLimit) || residual.p_value >= REAL;
    let is_clean = channel.disturbances.spikes == 0;
    is_clean && is_read && holds_in_time(levels, residual) && holds_in_frequency(levels, fitted)
}

/// Returns whether the stretch of time that is nearest to the promise still departs from it.
pub(super) fn holds_in_time(levels: Levels, residual: &Residual) -> bool {
    let [least, most] = residual.power;
    let nearest = if levels.fitted > levels.promised { least } else { most };
    !residual.uneven || levels.supports(nearest * levels.fitted)
}

fn holds_in_frequency(levels: Levels, fitted: &Fitted) -> bool {
    let (mut supporting, mut blocks) = (0, 0);
    let (mut power, mut modelled, mut count) = (0.0, 0.0, 0.0);
    let white = fitted.white().0;
    for (bin, variance) in fitted.bins.iter().zip(&fitted.variances) {
        if white < DOMINATES * variance {
            continue;
        }
        let coefficients = bin.count[0] + bin.count[1];
        power += bin.sum[0] + bin.sum[1];
        modelled += variance * coefficients;
        count += coefficients;
        if count >= levels.block() {
            supporting += usize::from(levels.supports(power / modelled * levels.fitted));
            blocks += 1;
            (power, modelled, count) = (0.0, 0.0, 0.0);
        }
    }
    blocks < FEWEST_BLOCKS || supporting as f64 >= AGREEING * blocks as f64
}
