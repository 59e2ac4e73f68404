//! Dispatch arithmetic: how a run is cut into tiles of samples. Pure, and the same for every
//! backend.

use std::ops::Range;

use crate::kernel::job::Clock;

/// Tiles of one submission: what their tables of forces take of the device's memory is bounded.
pub const MOST_TILES: usize = 256;

/// A tile in time, and the report it ends with, if any.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tile {
    /// Samples of the tile, counted from zero, half-open.
    pub samples: Range<u64>,
    /// Index into `Clock::report_samples`, if the tile ends at a report time.
    pub report: Option<usize>,
}

/// The tile that begins at sample `from`: at most `most` samples (rounded down to a multiple of
/// four, the numbers that one draw gives, unless fewer are allowed), and never beyond the end of
/// the still start, a report time or the end of the run.
pub fn next(clock: &Clock, from: u64, most: u64) -> Option<Tile> {
    if from >= clock.samples {
        return None;
    }
    let due = clock.report_samples.iter().position(|&r| r > from);
    let stop = due.map_or(clock.samples, |i| clock.report_samples[i].min(clock.samples));
    let stop = if from < clock.still_samples { stop.min(clock.still_samples) } else { stop };
    let longest = if most >= 4 { (from + most) & !3 } else { from + most.max(1) };
    if longest < stop {
        return Some(Tile { samples: from..longest, report: None });
    }
    let report = due.filter(|&i| clock.report_samples[i] == stop);
    Some(Tile { samples: from..stop, report })
}

/// The tiles of one submission: from sample `from` on, each of at most `most` samples, `budget`
/// samples in all and at most [`MOST_TILES`]. So what a submission costs does not depend on how
/// many report times it passes.
pub fn submission(clock: &Clock, from: u64, budget: u64, most: u64) -> Vec<Tile> {
    let (mut at, end) = (from, from.saturating_add(budget));
    let mut tiles: Vec<Tile> = Vec::new();
    while at < end && tiles.len() < MOST_TILES {
        let Some(tile) = next(clock, at, most.min((end - at).max(4))) else { break };
        at = tile.samples.end;
        tiles.push(tile);
    }
    tiles
}

/// The number of samples that brings a submission to `target_s`, from how long the last one took:
/// at most four times as many, or half.
pub fn adapt(samples: u64, took_s: f64, target_s: f64) -> u64 {
    let ratio = (target_s / took_s.max(1e-6)).clamp(0.5, 4.0);
    ((samples as f64 * ratio) as u64 & !3).max(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_run_once_and_end_at_every_report() {
        let clock = Clock {
            step_s: 1e-3,
            steps_per_sample: 1,
            samples: 1003,
            report_samples: vec![5, 6, 500, 1003],
            still_samples: 0,
        };
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
    fn submissions_are_as_many_whatever_the_report_times() {
        let submissions = |every: u64| {
            let report_samples: Vec<u64> = (1..=100_000 / every).map(|i| i * every).collect();
            let clock = Clock { step_s: 1e-3, steps_per_sample: 1, samples: 100_000, report_samples, still_samples: 0 };
            let (mut from, mut count, mut reports) = (0, 0, 0);
            while from < clock.samples {
                let tiles = submission(&clock, from, 4000, 3000);
                assert_eq!(tiles.first().map(|t| t.samples.start), Some(from));
                assert!(tiles.windows(2).all(|w| w[0].samples.end == w[1].samples.start));
                assert!(tiles.iter().all(|t| t.samples.end - t.samples.start <= 3000));
                reports += tiles.iter().filter(|t| t.report.is_some()).count() as u64;
                from = tiles.last().map_or(u64::MAX, |t| t.samples.end);
                count += 1;
            }
            assert_eq!((from, reports), (100_000, 100_000 / every));
            count
        };
        assert_eq!([100_000, 1000, 100, 16].map(submissions), [25; 4]);
        // Control: beyond the most tiles of a submission there are more.
        assert!(submissions(10) > 25);
    }

    #[test]
    fn tiles_grow_and_shrink_towards_the_target() {
        assert_eq!(adapt(1000, 0.01, 0.08), 4000);
        assert_eq!(adapt(1000, 10.0, 0.08), 500);
        assert_eq!(adapt(4, 10.0, 0.08), 4);
        assert_eq!(adapt(1000, 0.08, 0.08), 1000);
    }
}
