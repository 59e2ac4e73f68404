//! Jumps from one stable motion to another: where they were read, and where the model, following
//! the history of the sweep, has them.

use super::intake::Sweeps;
use super::predicted::Predicted;

/// Change of the predicted amplitude over that of the steps around it from which on it is a jump.
const JUMP: f64 = 3.0;
/// Part of the largest amplitude that a predicted jump changes at least.
const LEAST: f64 = 0.1;

/// A jump in a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Number of the sweep, from zero.
    pub sweep: usize,
    /// States whether the sweep goes up.
    pub rises: bool,
    /// Drive of the sweep.
    pub drive: f64,
    /// Middle of the step at which it was read, Hz; `None` where the reading does not jump.
    pub read_hz: Option<f64>,
    /// Middle of the step at which the model has it, Hz; `None` where the model does not jump.
    pub predicted_hz: Option<f64>,
    /// Steps between the two; 0 where they agree.
    pub steps: Option<usize>,
}

/// Jumps of every sweep, as they were read and as a model that was followed through the sweep has
/// them.
pub(super) fn jumps(sweeps: &Sweeps, followed: &Predicted) -> Vec<Jump> {
    let most = followed.amplitude.iter().copied().fold(0.0, f64::max);
    let middle = |k: usize| 0.5 * (sweeps.frequency_hz[k] + sweeps.frequency_hz[k + 1]);
    let mut all = Vec::new();
    for (n, sweep) in sweeps.sweeps.iter().enumerate() {
        let change = |k: usize| (followed.amplitude[k + 1] - followed.amplitude[k]).abs();
        let is_jump = |k: &usize| {
            let around = [k.checked_sub(1), Some(k + 1)];
            let other = around
                .into_iter()
                .flatten()
                .filter(|j| *j >= sweep.start && j + 1 < sweep.end)
                .map(change)
                .fold(0.0, f64::max);
            change(*k) > LEAST * most && change(*k) > JUMP * other && (followed.several[*k] || followed.several[k + 1])
        };
        let last = sweep.end.saturating_sub(1);
        let mut predicted: Vec<usize> = (sweep.start..last).filter(is_jump).collect();
        let jump = |read: Option<usize>, at: Option<usize>| Jump {
            sweep: n,
            rises: sweeps.rises(sweep),
            drive: sweeps.drive[sweep.start],
            read_hz: read.map(middle),
            predicted_hz: at.map(middle),
            steps: read.zip(at).map(|(a, b)| a.abs_diff(b)),
        };
        for read in sweeps.jumps.iter().copied().filter(|k| sweep.contains(k)) {
            let nearest = (0..predicted.len()).min_by_key(|i| predicted[*i].abs_diff(read));
            let at = nearest.map(|i| predicted.remove(i));
            all.push(jump(Some(read), at));
        }
        all.extend(predicted.into_iter().map(|at| jump(None, Some(at))));
    }
    all
}
