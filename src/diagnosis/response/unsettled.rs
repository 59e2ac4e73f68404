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
/// Ratio of a jump to the changes of the reading [`APART`] steps before and after it, at least.
const STEEP: f64 = 3.0;
/// Distance of those changes in steps: the steps right next to a jump may not have settled.
const APART: usize = 2;

/// Finds the jumps and takes the steps next to them out of the fit; `deviation` is that of X and of Y.
pub(super) fn mark(all: &mut Sweeps, deviation: f64) {
    all.jumps = if all.is_ordered { jumps(all, deviation) } else { Vec::new() };
    take_out(all, &all.jumps.clone());
}

/// Steps next to a change of the reading that is much larger than those around it.
pub(super) fn steep(all: &Sweeps) -> Vec<bool> {
    let mut near = all.clone();
    take_out(&mut near, &large_changes(all));
    (0..all.len()).map(|k| all.counts[k] && !near.counts[k]).collect()
}

/// The steps without those that a model says had not settled, and without those next to the jumps that it shows:
/// large changes next to such a step. `None` where all had.
pub(super) fn shown(all: &Sweeps, unsettled: &[bool]) -> Option<Sweeps> {
    let change = changes(all);
    let mut found = large_changes(all);
    found.retain(|k| (unsettled[*k] || unsettled[k + 1]) && (all.counts[*k] || all.counts[k + 1]));
    let mut rested = all.clone();
    rested.counts.iter_mut().zip(unsettled).for_each(|(counts, unsettled)| *counts &= !unsettled);
    take_out(&mut rested, &found);
    // Of large changes in a row one is the jump.
    found.sort_by(|a, b| change[*b].total_cmp(&change[*a]));
    for k in &found {
        if rested.jumps.iter().all(|j| j.abs_diff(*k) > UNSETTLED) {
            rested.jumps.push(*k);
        }
    }
    rested.jumps.sort_unstable();
    (rested.counts != all.counts).then_some(rested)
}

/// Steps after which the reading changes by much more than around them.
fn large_changes(all: &Sweeps) -> Vec<usize> {
    let change = changes(all);
    let is_steep = |k: usize, own: &Range<usize>| {
        let around = [k.checked_sub(APART).filter(|j| *j >= own.start), Some(k + APART).filter(|j| j + 1 < own.end)];
        let largest = around.into_iter().flatten().map(|j| change[j]).fold(0.0, f64::max);
        change[k] > LEAST.max(STEEP * largest)
    };
    let of = |own: &Range<usize>| -> Vec<usize> {
        (own.start..own.end.saturating_sub(1)).filter(|k| is_steep(*k, own)).collect()
    };
    all.sweeps.iter().filter(|_| all.is_ordered).flat_map(of).collect()
}

/// Takes the steps next to jumps out of the fit.
fn take_out(all: &mut Sweeps, jumps: &[usize]) {
    for k in jumps {
        let own = all.sweeps.iter().find(|s| s.contains(k)).cloned().unwrap_or(0..0);
        let near = (k + 1).saturating_sub(UNSETTLED).max(own.start)..(k + 1 + UNSETTLED).min(own.end);
        all.counts[near].fill(false);
    }
}

/// Change of the reading over the drive from each step to the next, in the largest reading over its drive.
fn changes(all: &Sweeps) -> Vec<f64> {
    let of_drive = |k: usize| all.reading[k] / all.drive[k];
    let most = (0..all.len()).filter(|k| all.counts[*k]).map(|k| of_drive(k).norm()).fold(0.0, f64::max);
    (1..all.len()).map(|k| (of_drive(k) - of_drive(k - 1)).norm() / most.max(1e-300)).collect()
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
