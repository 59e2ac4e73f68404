//! Finds what disturbs a log at rest: knocks, jumps of the level, and gaps that were filled.
//!
//! Noise of any colour sets its own scale here: each test compares one value with the robust spread
//! of all its like in the log, so that a log of Gaussian noise, flicker and random walk has none
//! (two in a billion values pass six deviations). Readings coarser than their noise are not
//! Gaussian; their jumps are also held against the plain spread. Not a diagnosis: it says which
//! stretches of a log are not noise, so that results can be shown with and without them.

use std::ops::Range;

use crate::numerics::moments::{mean, rms};
use crate::numerics::order;

/// A reading this many robust deviations off the mean of its second is a knock.
const KNOCK: f64 = 8.0;
/// Steps that are needed as well where readings are coarse.
const STEPS: f64 = 10.0;
/// Neighbouring means this many robust deviations of such differences apart are a jump.
const JUMP: f64 = 6.0;
/// Lengths of the means, s.
const BLOCKS_S: [f64; 2] = [1.0, 4.0];
/// From median absolute deviation to standard deviation of a normal.
const TO_DEVIATION: f64 = 1.4826;
/// Fewer means than this do not tell what is usual.
const LEAST: usize = 20;

/// Kind of disturbance in a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Readings far off their neighbours.
    Knock,
    /// A level that changes at once.
    Jump,
    /// Samples that were not recorded but filled in.
    Gap,
}

impl Kind {
    /// Its name as a word in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Knock => "knock",
            Self::Jump => "jump",
            Self::Gap => "filled gap",
        }
    }
}

/// A stretch of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disturbance {
    /// Kind of disturbance.
    pub kind: Kind,
    /// Disturbed samples of the log, half-open.
    pub samples: Range<usize>,
}

/// The disturbed stretches of a channel sampled at `rate_hz`; `filled` are those that were not
/// recorded.
pub fn find(values: &[f64], rate_hz: f64, filled: &[Range<usize>]) -> Vec<Disturbance> {
    let mut found: Vec<Disturbance> =
        filled.iter().map(|samples| Disturbance { kind: Kind::Gap, samples: samples.clone() }).collect();
    found.extend(knocks(values, rate_hz));
    for block_s in BLOCKS_S {
        found.extend(jumps(values, (block_s * rate_hz).round() as usize));
    }
    found
}

/// Robust standard deviation about zero.
fn spread(values: &[f64]) -> f64 {
    TO_DEVIATION * order::median(values.iter().map(|v| v.abs()).collect()).unwrap_or(0.0)
}

fn knocks(values: &[f64], rate_hz: f64) -> Vec<Disturbance> {
    let block = (rate_hz.round() as usize).clamp(16, values.len().max(16));
    let away: Vec<f64> = values
        .chunks(block)
        .flat_map(|chunk| {
            // The median: a knock must not pull its own reference along.
            let level = order::median(chunk.to_vec()).unwrap_or(0.0);
            chunk.iter().map(move |v| v - level)
        })
        .collect();
    let changes = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|c| *c > 0.0);
    let step = changes.fold(f64::INFINITY, f64::min);
    // Readings that seldom leave their median have no robust spread; what little they do have is
    // theirs.
    let usual = if spread(&away) > 0.0 { spread(&away) } else { rms(away.iter().copied()) };
    let limit = (KNOCK * usual).max(if step.is_finite() { STEPS * step } else { 0.0 });
    let mut found: Vec<Disturbance> = Vec::new();
    for (n, _) in away.iter().enumerate().filter(|(_, v)| v.abs() > limit) {
        match found.last_mut() {
            Some(last) if n < last.samples.end + block => last.samples.end = n + 1,
            _ => found.push(Disturbance { kind: Kind::Knock, samples: n..n + 1 }),
        }
    }
    found
}

fn jumps(values: &[f64], block: usize) -> Vec<Disturbance> {
    if block == 0 || values.len() / block < LEAST {
        return Vec::new();
    }
    let means: Vec<f64> = values.chunks_exact(block).map(mean).collect();
    let differences: Vec<f64> = means.windows(2).map(|w| w[1] - w[0]).collect();
    let limit = JUMP * spread(&differences).max(rms(differences.iter().copied()));
    let mut found: Vec<Disturbance> = Vec::new();
    for (k, _) in differences.iter().enumerate().filter(|(_, d)| limit > 0.0 && d.abs() > limit) {
        // Between the middles of the two blocks: a jump inside a block shows in the differences on
        // both of its sides.
        let samples = k * block + block / 2..(k + 1) * block + block / 2;
        match found.last_mut() {
            Some(last) if samples.start <= last.samples.end => last.samples.end = samples.end,
            _ => found.push(Disturbance { kind: Kind::Jump, samples }),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// Ten minutes at 100 Hz: white noise of deviation 1 on a random walk, rounded to `step`.
    fn noise(step: f64) -> Vec<f64> {
        let mut rng = Philox::new(4, 0, Stream::Host);
        let mut walk = 0.0;
        (0..60_000)
            .map(|_| {
                walk += 0.003 * rng.normal();
                let value: f64 = walk + rng.normal();
                if step > 0.0 { (value / step).round() * step } else { value }
            })
            .collect()
    }

    #[test]
    fn noise_has_no_disturbance_whatever_its_steps() {
        for step in [0.0, 0.5, 2.0, 4.0] {
            assert_eq!(find(&noise(step), 100.0, &[]), [], "rounded to {step}");
        }
    }

    #[test]
    fn a_knock_a_jump_and_a_gap_are_found_where_they_are() {
        let mut values = noise(0.5);
        values[12_345] += 40.0;
        values[40_010..].iter_mut().for_each(|v| *v += 2.0);
        let found = find(&values, 100.0, &[500..510, 700..703]);
        let of = |kind: Kind| -> Vec<&Disturbance> { found.iter().filter(|d| d.kind == kind).collect() };
        assert_eq!(of(Kind::Gap).len(), 2);
        assert_eq!(of(Kind::Knock), [&Disturbance { kind: Kind::Knock, samples: 12_345..12_346 }]);
        let jumps = of(Kind::Jump);
        assert!(
            !jumps.is_empty() && jumps.iter().all(|d| d.samples.start < 40_100 && d.samples.end > 39_900),
            "{jumps:?}"
        );
    }
}
