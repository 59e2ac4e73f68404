//! The rows that a decay is fitted to: at most forty a cycle, each the value of a parabola through
//! its neighbours, so that neither the fineness of sampling nor decimation matters.

use std::ops::Range;

use crate::driven::intake::data::Data;
use crate::driven::simulated::rows::{LEAST_BLOCK, Rows};
use crate::engine::kind::Layout;
use crate::numerics::moments::dot;

use super::swings::Motion;

/// Rows of a cycle at most.
const PER_CYCLE: f64 = 40.0;
/// Half the width of a parabola, in rows that are left.
const HALF: f64 = 0.75;
/// Cycles of a segment.
pub(super) const CYCLES: f64 = 4.0;
/// Rows of a segment at least.
pub(super) const LEAST_SEGMENT: f64 = 24.0;
/// Rows of a cycle that are kept where there are many cycles.
const FEW_PER_CYCLE: f64 = 16.0;
/// Rows in all at about; of more, segments are left out evenly, the first one never.
const MOST: f64 = 2000.0;
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

/// Rows of a motion; `filled` were not recorded.
pub(super) fn rows(data: &Data, motion: &Motion, filled: &[Range<usize>]) -> Rows {
    let seen = motion.stretches.iter().map(Range::len).sum::<usize>() as f64;
    let step = (motion.cycle / PER_CYCLE).max((seen / MOST).min(motion.cycle / FEW_PER_CYCLE)).max(1.0) as usize;
    let half = if step > 1 { ((HALF * step as f64).round() as usize).max(2) } else { 0 };
    let weights = if half > 0 { weights(half) } else { vec![1.0] };
    let cycle = motion.cycle / step as f64;
    let length = (CYCLES * cycle).max(LEAST_SEGMENT);
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for stretch in &motion.stretches {
        let all: Vec<usize> = (stretch.start + half..stretch.end.saturating_sub(half)).step_by(step).collect();
        let count = ((all.len() as f64 / length).round() as usize).max(1);
        parts.extend((0..count).map(|i| all[all.len() * i / count..all.len() * (i + 1) / count].to_vec()));
    }
    parts.retain(|p| p.len() >= 3 * LEAST_BLOCK);
    let total: usize = parts.iter().map(Vec::len).sum();
    let of = ((total as f64 / MOST).round() as usize).max(1);
    let parts: Vec<Vec<usize>> = parts.into_iter().step_by(of).collect();
    let mut segments = Vec::new();
    let mut at: Vec<usize> = Vec::new();
    for part in parts {
        segments.push(at.len()..at.len() + part.len());
        at.extend(part);
    }
    let recorded = |k: usize| filled.iter().all(|f| f.end <= k - half || f.start > k + half);
    let columns = data.environments;
    let block = (cycle as usize).min(at.len() / FEWEST_BLOCKS).max(LEAST_BLOCK);
    let counts = at.iter().map(|k| recorded(*k)).collect();
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
    let layout = Layout::new(segments, block, counts);
    Rows { data, layout, own_offsets: false, at, step, of, noise_gain }
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
