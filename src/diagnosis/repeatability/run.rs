//! Answers of one recording: what it can know, what it found, and the same of its halves.

use super::besides::Besides;
use super::information::Information;
use super::parameter::Estimate;
use crate::numerics::allan::law::Term;
use crate::sensor::Sense;

/// One recording, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Knowledge of each parameter, before any estimate.
    pub information: Information,
    /// The fit to all of it.
    pub estimate: Estimate,
    /// Its two halves; `None` where it is too short to be divided.
    pub halves: Option<Halves>,
    /// The motion of the sensor, where its kind tells.
    pub motion: Option<Motion>,
    /// Means to determine what it does not.
    pub remedies: Vec<Remedy>,
    /// Findings on the recording itself.
    pub findings: Vec<String>,
    /// Channels that hold something besides noise, where that was asked for.
    pub besides: Vec<Besides>,
}

/// A recording in two halves.
#[derive(Debug, Clone, PartialEq)]
pub struct Halves {
    /// The division.
    pub split: Split,
    /// The fits to the halves.
    pub each: [Estimate; 2],
}

impl Halves {
    /// The division that determines most, by what is known and not by what the halves say: the choice cannot
    /// make them agree.
    pub(crate) fn least_lost(whole: &Estimate, divisions: impl Iterator<Item = Self>) -> Option<Self> {
        let rated = divisions.map(|halves| (lost(whole, &halves.each), halves));
        rated.min_by(|a, b| a.0.total_cmp(&b.0)).map(|h| h.1)
    }
}

/// Cost of a division: parameters that the whole determines and a half does not, then by how much
/// the standard errors of the halves grow, on average of their logarithms.
fn lost(whole: &Estimate, halves: &[Estimate; 2]) -> f64 {
    let of = |p: usize| match halves.iter().all(|h| h.determines(p)) {
        false => 100.0,
        true => (halves[0].deviation(p).hypot(halves[1].deviation(p)) / whole.deviation(p)).ln(),
    };
    let known: Vec<usize> = (0..whole.parameters.len()).filter(|p| whole.determines(*p)).collect();
    let lost = known.iter().map(|p| of(*p)).filter(|l| l.is_finite());
    lost.sum::<f64>() / known.len().max(1) as f64
}

/// Division of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// The first half against the second.
    FirstAndSecond,
    /// The stretches with an even number against those with an odd one.
    Alternating {
        /// Number of stretches.
        parts: usize,
    },
    /// Alternating blocks of poses.
    Blocks {
        /// Poses in a block.
        poses: usize,
    },
}

/// Motion that a sensor was put through.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Still poses that count, where there are any.
    pub poses: Option<usize>,
    /// Numbers, from one, of poses that disagree with all others and were left out.
    pub left_out: Vec<usize>,
    /// Angle turned through about each axis, there and back both counted, rad; `None` without a gyro.
    pub turned_rad: Option<[f64; 3]>,
    /// Lowest and highest specific force along each axis, as a share of gravity.
    pub reached: [[f64; 2]; 3],
}

impl Motion {
    /// Axes about which it was turned: a tenth of what the most turned axis was, or more.
    pub fn turned_about(&self) -> Option<Vec<usize>> {
        let turned = self.turned_rad?;
        let most = turned.iter().copied().fold(0.0, f64::max);
        Some((0..3).filter(|axis| turned[*axis] >= 0.1 * most && most > 0.0).collect())
    }
}

/// Motion, or time, that would determine a parameter, to the precision that is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Remedy {
    /// Quarter turns about an axis that lies level, between still poses.
    Turns {
        /// The axis.
        axis: usize,
        /// Number of turns.
        count: usize,
        /// Standard error that they give, as a share of the input.
        to: f64,
    },
    /// Poses with an axis up and as many with it down.
    UpAndDown {
        /// The sensor that needs them.
        sensor: Sense,
        /// The axis.
        axis: usize,
        /// Number of each.
        count: usize,
        /// Standard error that they give, as a share of gravity; `None` where it is not known.
        to: Option<f64>,
    },
    /// Poses with gravity midway between two axes, on all four sides.
    Between {
        /// The axes.
        axes: [usize; 2],
    },
    /// Turns about an axis as there were about another.
    AsAbout {
        /// The axis that needs them.
        axis: usize,
        /// The axis that had most.
        other: usize,
        /// Angle turned about that one, there and back both counted, rad.
        turned_rad: f64,
        /// Standard error that they gave there, as a share of the input.
        to: f64,
    },
    /// A longer log at rest.
    Longer {
        /// The noise whose coefficient it tells.
        term: Term,
        /// States whether the log shows it; else it is taken to be as large as the log leaves open.
        shows: bool,
        /// Length of the log, s.
        duration_s: f64,
        /// Half of its 95 % interval then, as a share of the coefficient.
        to: f64,
    },
}
