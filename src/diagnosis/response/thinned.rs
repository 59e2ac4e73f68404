//! Thins the steps of a recording, in short runs of neighbours at other frequencies in each sweep: enough
//! to say where a law may begin. A fit to all steps follows.

use std::ops::Range;

use super::intake::Sweeps;

/// Steps that are kept, about; with fewer than twice as many, all are.
const ENOUGH: usize = 512;
/// Neighbours in a run: what a step leaves in the next one is seen within it.
const RUN: usize = 4;

/// A part of the steps, and which they are; `None` where there are too few to leave any out.
pub(super) fn thinned(all: &Sweeps) -> Option<(Sweeps, Vec<usize>)> {
    // Between them the sweeps keep every part of the band.
    let every = (all.len() / ENOUGH).min(all.sweeps.len());
    if every < 2 {
        return None;
    }
    let runs = |(place, sweep): (usize, &Range<usize>)| -> Vec<Range<usize>> {
        let first = sweep.start + RUN * (place % every);
        let end = sweep.end;
        (first..end).step_by(RUN * every).map(|from| from..(from + RUN).min(end)).collect()
    };
    let runs: Vec<Range<usize>> = all.sweeps.iter().enumerate().flat_map(runs).collect();
    let kept: Vec<usize> = runs.iter().cloned().flatten().collect();
    let mut sweeps = Vec::with_capacity(runs.len());
    for run in &runs {
        let from = sweeps.last().map_or(0, |last: &Range<usize>| last.end);
        sweeps.push(from..from + run.len());
    }
    let some = Sweeps {
        frequency_hz: kept.iter().map(|k| all.frequency_hz[*k]).collect(),
        drive: kept.iter().map(|k| all.drive[*k]).collect(),
        reading: kept.iter().map(|k| all.reading[*k]).collect(),
        time_s: all.time_s.as_ref().map(|time| kept.iter().map(|k| time[*k]).collect()),
        counts: kept.iter().map(|k| all.counts[*k]).collect(),
        sweeps,
        jumps: Vec::new(),
        is_ordered: all.is_ordered,
        derivatives: all.derivatives,
    };
    Some((some, kept))
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    #[test]
    fn sweeps_one_after_the_other_keep_other_steps_and_together_the_whole_band() {
        let (sweeps, steps) = (4, 400);
        let one = |s: usize| (0..steps).map(move |k| if s.is_multiple_of(2) { k } else { steps - 1 - k });
        let frequency_hz: Vec<f64> = (0..sweeps).flat_map(one).map(|k| 1.0 + k as f64).collect();
        let n = sweeps * steps;
        let all = Sweeps {
            reading: frequency_hz.iter().map(|f| Complex::from(*f)).collect(),
            frequency_hz,
            drive: vec![1.0; n],
            time_s: None,
            counts: (0..n).map(|k| k != 1).collect(),
            sweeps: (0..sweeps).map(|s| s * steps..(s + 1) * steps).collect(),
            is_ordered: true,
            ..Sweeps::default()
        };
        let (some, kept) = thinned(&all).expect("1600 steps are more than twice as many as needed");
        assert!((ENOUGH..2 * ENOUGH).contains(&some.len()), "{}", some.len());
        assert!(
            some.sweeps.iter().all(|run| run.len() <= RUN) && some.sweeps.last().map(|r| r.end) == Some(kept.len())
        );
        assert!(
            kept.iter().enumerate().all(|(i, k)| some.reading[i] == all.reading[*k] && some.counts[i] == (*k != 1))
        );
        let mut known: Vec<u64> = some.frequency_hz.iter().map(|f| *f as u64).collect();
        known.sort_unstable();
        known.dedup();
        let widest = known.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0);
        assert!(widest as usize <= 2 * RUN, "{widest} steps without one that is kept");
        assert!(thinned(&some).is_none(), "control: the rest is few enough");
    }
}
