//! Steps at which a reading jumps from one stable motion to another. Next to them a motion near its fold
//! has not settled, so that no steady state predicts them.

use std::ops::Range;

use nalgebra::Complex;

use super::intake::Sweeps;
use super::pole::continued;

/// Part of the largest reading over its drive that a jump changes at least.
pub(super) const LEAST: f64 = 0.15;
/// Standard deviations of the noise by which both sides miss one another at least: a pole through five
/// steps, continued by one, has some five times their noise.
const ABOVE_NOISE: f64 = 20.0;
/// Steps on either side of a jump that are continued to it.
const SIDE: usize = 5;
/// Steps on either side of a jump that have not settled.
const UNSETTLED: usize = 2;

/// Finds the jumps and takes the steps next to them out of the fit; `deviation` is that of X and of Y.
pub(super) fn mark(all: &mut Sweeps, deviation: f64) {
    all.jumps = if all.is_ordered { jumps(all, deviation) } else { Vec::new() };
    for k in all.jumps.clone() {
        let own = all.sweeps.iter().find(|s| s.contains(&k)).cloned().unwrap_or(0..0);
        let near = (k + 1).saturating_sub(UNSETTLED).max(own.start)..(k + 1 + UNSETTLED).min(own.end);
        all.counts[near].fill(false);
    }
}

/// Steps over which neither side, continued as a pole, leads to the other.
fn jumps(all: &Sweeps, deviation: f64) -> Vec<usize> {
    let of_drive = |k: usize| all.reading[k] / all.drive[k];
    let most = (0..all.len()).filter(|k| all.counts[*k]).map(|k| of_drive(k).norm()).fold(0.0, f64::max);
    let change = |k: usize| (of_drive(k + 1) - of_drive(k)).norm();
    // How far a step lies from the pole through others.
    let misses = |others: Range<usize>, k: usize| {
        let reading: Vec<Complex<f64>> = others.clone().map(of_drive).collect();
        continued(&all.frequency_hz[others], &reading, all.frequency_hz[k]).map_or(0.0, |y| (y - of_drive(k)).norm())
    };
    let mut found = Vec::new();
    for sweep in &all.sweeps {
        for k in sweep.start + SIDE..sweep.end.saturating_sub(SIDE) {
            let least = (LEAST * most).max(ABOVE_NOISE * deviation / all.drive[k]);
            let steepest = change(k) > LEAST * most && change(k) > change(k - 1).max(change(k + 1));
            let both = || misses(k + 1 - SIDE..k + 1, k + 1).min(misses(k + 1..k + 1 + SIDE, k));
            if steepest && both() > least {
                found.push(k);
            }
        }
    }
    found
}
