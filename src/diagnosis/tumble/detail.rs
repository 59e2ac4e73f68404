//! Plain numbers behind the figures and the words of a diagnosis of poses.

use super::account::Account;
use super::calibration::Calibration;
use crate::verdict::Triads;

/// Plain numbers behind the figures.
#[derive(Debug, Clone)]
pub struct Detail {
    /// The poses, in order of time.
    pub poses: Vec<PoseDetail>,
    /// States whether the tool found the poses itself.
    pub poses_found: bool,
    /// Root-mean-square residuals on poses that were not fitted, in the units of `Group`: base
    /// model, repaired model.
    pub held_out: [[f64; 2]; 3],
    /// Calibration with the named physics.
    pub calibration: Calibration,
    /// Biases and matrices with their intervals, to be used.
    pub published: Option<Triads>,
    /// K's entries with their 95 % intervals, °/s/g, by rows; empty unless named.
    pub g_sensitivity: Vec<(String, f64, [f64; 2])>,
    /// Length of specific force over time, m/s², thinned for plotting, as (time in s, |f|).
    pub length_m_s2: Vec<(f64, f64)>,
    /// Gravity as the model states it.
    pub gravity_m_s2: f64,
    /// Facts that the sentences of the verdict are made from.
    pub account: Account,
}

/// One pose as the figures show it.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseDetail {
    /// Beginning and end of the pose, s.
    pub time_s: [f64; 2],
    /// Specific force over g, as the repaired model sees it.
    pub share: [f64; 3],
    /// Residuals before, in the units of `Group`: |f| − g; rate x, y, z; direction error after the
    /// following move.
    pub before: [f64; 5],
    /// The same residuals with the named physics.
    pub after: [f64; 5],
    /// Standard deviation that noise alone gives each residual.
    pub noise: [f64; 5],
}
