//! Dispatch arithmetic: how a run is cut into tiles of samples. Pure, and the same for every backend.

use std::ops::Range;

use crate::kernel::job::Clock;

/// A tile in time, and the report it ends with, if any.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tile {
    /// Samples, 0-based.
    pub samples: Range<u64>,
    /// Place in `Clock::report_samples`.
    pub report: Option<usize>,
}

/// The tile that begins at sample `from`: at most `most` samples (rounded down to a multiple of four, the numbers that
/// one draw gives, unless fewer are allowed), and never beyond a report time or the end of the run.
pub fn next(clock: &Clock, from: u64, most: u64) -> Option<Tile> {
    if from >= clock.samples {
        return None;
    }
    let due = clock.report_samples.iter().position(|&r| r > from);
    let stop = due.map_or(clock.samples, |i| clock.report_samples[i].min(clock.samples));
    let longest = if most >= 4 { (from + most) & !3 } else { from + most.max(1) };
    if longest < stop {
        return Some(Tile { samples: from..longest, report: None });
    }
    let report = due.filter(|&i| clock.report_samples[i] == stop);
    Some(Tile { samples: from..stop, report })
}

/// The number of samples that brings a tile to `target_s`, from how long the last one took: at most doubled or halved.
pub fn adapt(samples: u64, took_s: f64, target_s: f64) -> u64 {
    let ratio = (target_s / took_s.max(1e-6)).clamp(0.5, 2.0);
    ((samples as f64 * ratio) as u64 & !3).max(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_run_once_and_end_at_every_report() {
        let clock = Clock { step_s: 1e-3, steps_per_sample: 1, samples: 1003, report_samples: vec![5, 6, 500, 1003] };
        for most in [1, 3, 4, 7, 64, 5000] {
            let (mut from, mut reports) = (0, vec![]);
            while let Some(tile) = next(&clock, from, most) {
                assert_eq!(tile.samples.start, from);
                assert!(tile.samples.end > from && tile.samples.end - from <= most);
                reports.extend(tile.report.map(|_| tile.samples.end));
                from = tile.samples.end;
            }
            assert_eq!((from, reports), (1003, vec![5, 6, 500, 1003]), "{most}");
        }
    }

    #[test]
    fn tiles_grow_and_shrink_towards_the_target() {
        assert_eq!(adapt(1000, 0.01, 0.08), 2000);
        assert_eq!(adapt(1000, 10.0, 0.08), 500);
        assert_eq!(adapt(4, 10.0, 0.08), 4);
        assert_eq!(adapt(1000, 0.08, 0.08), 1000);
    }
}
