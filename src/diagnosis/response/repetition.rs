//! States whether what a model leaves repeats from one sweep to the next at the same drive: physics does, or turns
//! around with the direction, and noise of whatever memory does neither.

use std::ops::Range;

use nalgebra::Complex;

use crate::numerics::special;

use super::intake::{ANOTHER_DRIVE, Sweeps};

/// Part of a step of frequency within which two steps are at the same one.
const SAME: f64 = 0.25;
/// Pairs of steps below which nothing is said.
const FEWEST: usize = 20;

/// Probability that noise repeats as much, or as much with the other sign; `None` where no drive was swept twice.
pub(super) fn repeats_by_chance(sweeps: &Sweeps, left: &[Complex<f64>]) -> Option<f64> {
    let (mut sum, mut square, mut pairs) = (0.0, 0.0, 0);
    for (i, one) in sweeps.sweeps.iter().enumerate().filter(|_| sweeps.is_ordered) {
        let drive = sweeps.drive[one.start];
        let is_same = |other: &&Range<usize>| (sweeps.drive[other.start] - drive).abs() <= ANOTHER_DRIVE * drive;
        // With the next one alone: each step has a part in two products at most.
        let Some(other) = sweeps.sweeps[i + 1..].iter().find(is_same) else { continue };
        for k in one.clone().filter(|k| sweeps.counts[*k]) {
            if let Some(j) = at(sweeps, other, sweeps.frequency_hz[k]).filter(|j| sweeps.counts[*j]) {
                sum += (left[k] * left[j].conj()).re;
                square += 0.5 * left[k].norm_sqr() * left[j].norm_sqr();
                pairs += 1;
            }
        }
    }
    (pairs >= FEWEST && square > 0.0).then(|| special::chi_squared_survival(sum * sum / square, 1.0))
}

/// The step of a sweep at a frequency.
fn at(sweeps: &Sweeps, own: &Range<usize>, frequency_hz: f64) -> Option<usize> {
    let apart = |k: &usize| (sweeps.frequency_hz[*k] - frequency_hz).abs();
    let nearest = own.clone().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    let step = (sweeps.frequency_hz[own.end - 1] - sweeps.frequency_hz[own.start]).abs() / own.len().max(2) as f64;
    (apart(&nearest) <= SAME * step).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    // Noise with a memory of ρ = ½ from step to step does not repeat. It widens the sum by √(1 + 2 Σ ρ²ᵏ) = 1.29, so that
    // 4.6 % of recordings are below 1 %: of 200 that is 9.2 ± 3.0, and 17 are 2.6 standard errors. A part as large as
    // the noise repeats, and so does one that turns its sign around with the direction.
    #[test]
    fn noise_does_not_repeat_and_physics_does() {
        let count = 60;
        let frequency_hz: Vec<f64> = (0..count).chain((0..count).rev()).map(|k| 100.0 + k as f64).collect();
        let sweeps = Sweeps {
            drive: vec![1.0; 2 * count],
            counts: vec![true; 2 * count],
            sweeps: vec![0..count, count..2 * count],
            is_ordered: true,
            frequency_hz,
            ..Sweeps::default()
        };
        let made = |seed: u64, part: f64, sign: f64| -> f64 {
            let mut rng = Philox::new(seed, 0, Stream::Host);
            let mut before = Complex::from(0.0);
            let of = |k: usize| {
                before = before * 0.5 + Complex::new(rng.normal(), rng.normal()) * 0.75f64.sqrt();
                let way = if k < count { 1.0 } else { sign };
                before + way * part * (0.1 * sweeps.frequency_hz[k]).sin()
            };
            let left: Vec<Complex<f64>> = (0..2 * count).map(of).collect();
            repeats_by_chance(&sweeps, &left).expect("both ways are swept")
        };
        let below = (0..200).filter(|seed| made(*seed, 0.0, 1.0) < 0.01).count();
        assert!(below <= 17, "{below}");
        for sign in [1.0, -1.0] {
            assert!(made(7, 2.0, sign) < 1e-4, "{sign}: {}", made(7, 2.0, sign));
        }
    }
}
