//! The rows that a decay is fitted to. Laws are searched on at most forty a cycle, each the value of a parabola
//! through its neighbours, so that the search does not depend on the fineness of sampling; what is found is
//! judged and measured on every sample, up to as many as a fit takes.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use crate::driven::intake::data::Data;
use crate::driven::simulated::rows::{LEAST_BLOCK, Rows};
use crate::engine::kind::Layout;
use crate::numerics::moments::dot;
use crate::physics::library::Term;
use crate::physics::ringing_mode::RingingMode;

use super::swings::Motion;

/// Rows of a cycle at most.
const PER_CYCLE: f64 = 40.0;
/// Half the width of a parabola, in rows that are left.
const HALF: f64 = 0.75;
/// Cycles of a segment in which laws are searched first.
pub(super) const CYCLES: f64 = 4.0;
/// Factor by which segments are lengthened where shorter ones show only noise.
pub(super) const LONGER: f64 = 4.0;
/// Rows of a segment at least.
pub(super) const LEAST_SEGMENT: f64 = 24.0;
/// Rows of a cycle that are kept where there are many cycles.
const FEW_PER_CYCLE: f64 = 16.0;
/// Rows in all at about; of more, segments are left out evenly, the first one never.
const MOST: f64 = 2000.0;
/// Rows in all at most where segments are lengthened.
const MOST_LONG: f64 = 8192.0;
/// Rows in all at most that numbers are fitted to.
const MOST_SAMPLES: usize = 20_000;
/// Blocks in all at least, where each keeps some rows.
const FEWEST_BLOCKS: usize = 32;

/// Weights of a parabola's value in the middle of 2m + 1 rows (Savitzky & Golay, Anal. Chem. 36,
/// 1964).
fn weights(m: usize) -> Vec<f64> {
    let m = m as f64;
    let norm = (2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0);
    let of = |j: f64| 3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * j * j) / norm;
    (0..=2 * m as usize).map(|i| of(i as f64 - m)).collect()
}

/// Rows to either side that a parabola passes through, where one sample in `step` is a row.
fn half(step: usize) -> usize {
    if step > 1 { ((HALF * step as f64).round() as usize).max(2) } else { 0 }
}

/// Factor from a law's parameter in the rows to the same in the samples: the parabolas take part of a sine
/// whose samples are few a cycle.
pub(super) fn in_samples(rows: &Rows, term: &Term, parameters: &[f64], which: usize) -> f64 {
    let frequency_hz = match (term, parameters) {
        (Term::PeriodicDisturbance(_), [_, _, frequency_hz, ..]) if which < 2 => *frequency_hz,
        (Term::RingingMode(_), [omega_rad_s, ..]) if RingingMode::SIZES.contains(&which) => omega_rad_s / TAU,
        _ => return 1.0,
    };
    let half = half(rows.step);
    let turn = TAU * frequency_hz / (rows.data.rate_hz * rows.step as f64);
    let weights = weights(half);
    let kept = weights.iter().enumerate().map(|(i, w)| w * (turn * (i as f64 - half as f64)).cos());
    1.0 / kept.sum::<f64>()
}

/// Rows of a motion in which laws are searched, in segments of about `cycles` cycles each; rows in `filled` were
/// not recorded.
pub(super) fn rows(data: &Data, motion: &Motion, filled: &[Range<usize>], cycles: f64) -> Rows {
    let seen = motion.stretches.iter().map(Range::len).sum::<usize>() as f64;
    let most = (MOST * cycles / CYCLES).min(MOST_LONG);
    let step = (motion.cycle / PER_CYCLE).max((seen / most).min(motion.cycle / FEW_PER_CYCLE)).max(1.0) as usize;
    let half = half(step);
    let length = (cycles * motion.cycle / step as f64).max(LEAST_SEGMENT);
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for stretch in &motion.stretches {
        let all: Vec<usize> = (stretch.start + half..stretch.end.saturating_sub(half)).step_by(step).collect();
        let count = ((all.len() as f64 / length).round() as usize).max(1);
        parts.extend((0..count).map(|i| all[all.len() * i / count..all.len() * (i + 1) / count].to_vec()));
    }
    parts.retain(|p| p.len() >= 3 * LEAST_BLOCK);
    let total: usize = parts.iter().map(Vec::len).sum();
    let of = ((total as f64 / most).round() as usize).max(1);
    let rows = taken(data, parts.into_iter().step_by(of), step, filled);
    let samples = (step > 1).then(|| Arc::new(taken(data, runs(&rows, 1), 1, filled)));
    Rows { layout: blocks(rows.layout, motion.cycle, step), of, samples, ..rows }
}

/// The same segments at every sample, or at as many as a fit takes; `None` where no more are.
pub(super) fn finer(data: &Data, rows: &Rows, motion: &Motion, filled: &[Range<usize>]) -> Option<Rows> {
    let all: usize = runs(rows, 1).map(|run| run.len()).sum();
    let step = all.div_ceil(MOST_SAMPLES);
    let finer = (step < rows.step).then(|| taken(data, runs(rows, step), step, filled))?;
    Some(Rows { layout: blocks(finer.layout, motion.cycle, step), of: rows.of, samples: rows.samples.clone(), ..finer })
}

/// Samples of each segment, one in `step`, which go on evenly where the next segment does.
fn runs(rows: &Rows, step: usize) -> impl Iterator<Item = Vec<usize>> {
    let segments = &rows.layout.segments;
    let mut anchor = 0;
    segments.iter().enumerate().map(move |(i, s)| {
        let (first, last) = (rows.at[s.start], rows.at[s.end - 1]);
        if i == 0 || !rows.follows(&segments[i - 1], s) {
            anchor = first;
        }
        let goes_on = segments.get(i + 1).is_some_and(|next| rows.follows(s, next));
        let end = if goes_on { last + rows.step } else { last + 1 };
        (anchor + (first - anchor).next_multiple_of(step)..end).step_by(step).collect()
    })
}

/// Rows at these samples, segment by segment, each the value of a parabola through its neighbours.
fn taken(data: &Data, parts: impl Iterator<Item = Vec<usize>>, step: usize, filled: &[Range<usize>]) -> Rows {
    let mut segments = Vec::new();
    let mut at: Vec<usize> = Vec::new();
    for part in parts {
        segments.push(at.len()..at.len() + part.len());
        at.extend(part);
    }
    let (half, columns) = (half(step), data.environments);
    let weights = weights(half);
    let recorded = |k: &usize| filled.iter().all(|f| f.end <= k - half || f.start > k + half);
    let counts = at.iter().map(recorded).collect();
    let first = at.first().copied().unwrap_or(0);
    let data = Data {
        reading: at.iter().map(|k| dot(&weights, &data.reading[k - half..=k + half])).collect(),
        input: None,
        environment: at.iter().flat_map(|k| data.environment[k * columns..(k + 1) * columns].iter().copied()).collect(),
        rate_hz: data.rate_hz / step as f64,
        hull: 0..at.len(),
        breaks: segments.iter().skip(1).map(|s| s.start).collect(),
        train: segments.clone(),
        validation: Vec::new(),
        test: Vec::new(),
        windows: None,
        clock_s: at.iter().map(|k| (k - first) as f64 / data.rate_hz).collect(),
        ..data.clone()
    };
    let noise_gain = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
    let layout = Layout::new(segments, LEAST_BLOCK, counts);
    Rows { data, layout, own_offsets: false, at, step, of: 1, noise_gain, samples: None }
}

/// The same segments in blocks of a cycle, or shorter ones where those were few. `cycle` in samples.
fn blocks(layout: Layout, cycle: f64, step: usize) -> Layout {
    let rows = layout.counts.len();
    let block = ((cycle / step as f64) as usize).min(rows / FEWEST_BLOCKS).max(LEAST_BLOCK);
    Layout::new(layout.segments, block, layout.counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Σw = 1, Σw j = Σw j² = 0: a parabola is its own value.
    #[test]
    fn a_parabola_keeps_its_value_in_the_middle() {
        for m in [2, 5, 8] {
            let weights = weights(m);
            let moment =
                |p: i32| -> f64 { weights.iter().enumerate().map(|(i, w)| w * (i as f64 - m as f64).powi(p)).sum() };
            assert!((moment(0) - 1.0).abs() < 1e-12 && moment(1).abs() < 1e-12 && moment(2).abs() < 1e-10);
            assert!(moment(4).abs() > 0.1, "a fourth power is no parabola");
        }
    }
}
