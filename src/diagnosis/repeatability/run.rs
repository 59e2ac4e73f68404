//! Answers of one recording: what it can know, what it found, and the same of its halves.

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
}

/// A recording in two halves.
#[derive(Debug, Clone, PartialEq)]
pub struct Halves {
    /// The division.
    pub split: Split,
    /// The fits to the halves.
    pub each: [Estimate; 2],
}

/// Division of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// The first half against the second.
    FirstAndSecond,
    /// Alternating blocks of poses.
    Blocks {
        /// Poses in a block.
        poses: usize,
    },
}

/// Motion that a sensor was put through.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Still poses that count.
    pub poses: usize,
    /// Numbers, from one, of poses that disagree with all others and were left out.
    pub left_out: Vec<usize>,
    /// Angle turned through about each axis, there and back both counted, rad; `None` without a gyro.
    pub turned_rad: Option<[f64; 3]>,
    /// Lowest and highest share of gravity along each axis.
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
    /// A longer log at rest.
    Longer {
        /// The noise whose coefficient it tells.
        term: Term,
        /// Length of the log, s.
        duration_s: f64,
        /// Half of its 95 % interval then, as a share of the coefficient.
        to: f64,
    },
}
