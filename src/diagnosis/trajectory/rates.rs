//! Rates of a reference and of a gyro over the same short windows, whatever the shift of their
//! clocks: of the reference by its attitudes, of the gyro by its integral.

use nalgebra::Vector3;

use super::integral::{Rule, between, cumulative, place};
use super::log::{Log, Motion};

/// Length of a window, s.
pub(super) const WINDOW_S: f64 = 0.1;
/// The shifts of clocks that are tried, s: up to, in steps of.
pub(super) const SHIFTS_S: (f64, f64) = (2.0, 0.02);
/// Most windows where not all are asked for.
const MOST: usize = 3000;

/// One window of the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// First and last pose.
    pub poses: [usize; 2],
    /// Their times, s.
    pub ends_s: [f64; 2],
    /// The reference's mean rate, in its body axes, rad/s.
    pub rate: Vector3<f64>,
}

/// Windows, and what the gyro reads in them.
#[derive(Debug, Clone)]
pub(super) struct Rates<'a> {
    log: &'a Log,
    integral: Vec<Vector3<f64>>,
    /// Readings left out before each sample.
    left_out: Vec<usize>,
    /// In order of time.
    pub windows: Vec<Window>,
}

impl<'a> Rates<'a> {
    /// Enough windows for a regression. Those with a masked reading in them say nothing.
    pub(super) fn some(log: &'a Log, masked: &[bool], motion: &Motion) -> Self {
        Self::of(log, masked, motion, MOST)
    }

    /// Windows that overlap by half, so that each pose lies in one.
    pub(super) fn all(log: &'a Log, masked: &[bool], motion: &Motion) -> Self {
        Self::of(log, masked, motion, usize::MAX)
    }

    fn of(log: &'a Log, masked: &[bool], motion: &Motion, most: usize) -> Self {
        let reach = ((WINDOW_S / motion.interval_s).round() as usize).max(1);
        let last = motion.time_s.len().saturating_sub(reach);
        let every = (last / most).max(reach / 2).max(1);
        let window = |from: usize| {
            let (to, times) = (from + reach, &motion.time_s);
            let ends_s = [times[from], times[to]];
            let turn = motion.attitude[from].inverse() * motion.attitude[to];
            let rate = turn.scaled_axis() / (ends_s[1] - ends_s[0]);
            Window { poses: [from, to], ends_s, rate }
        };
        let is_short = |w: &Window| w.ends_s[1] - w.ends_s[0] < 3.0 * reach as f64 * motion.interval_s;
        let windows = (0..last).step_by(every).map(window).filter(is_short).collect();
        let mut left_out = Vec::with_capacity(masked.len() + 1);
        left_out.push(0);
        for (k, masked) in masked.iter().enumerate() {
            left_out.push(left_out[k] + usize::from(*masked));
        }
        Self { log, integral: cumulative(&log.time_s, &log.rate, Rule::Straight), left_out, windows }
    }

    /// The gyro's mean rate over a window, where it stamps so much later, rad/s; none outside the
    /// log and where a reading is masked.
    pub(super) fn read(&self, window: &Window, shift_s: f64) -> Option<Vector3<f64>> {
        let times = &self.log.time_s;
        let [from, to] = window.ends_s.map(|t| t + shift_s);
        if from < times[0] || to > times[times.len() - 1] {
            return None;
        }
        let [start, end] = [from, to].map(|t| place(times, t));
        if self.left_out[end.0 + 2] > self.left_out[start.0] {
            return None;
        }
        let at = |there: (usize, f64)| between(times, &self.integral, &self.log.rate, there);
        Some((at(end) - at(start)) / (window.ends_s[1] - window.ends_s[0]))
    }
}
