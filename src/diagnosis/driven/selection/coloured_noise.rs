//! Readout noise with a short memory: what a sigma-delta converter, an anti-alias filter or a
//! moving average leaves of white noise. It shows nothing of the physics, and all of it goes when
//! each reading is compared with the few before it.
//!
//! The errors are taken for an autoregressive process of low order (Yule–Walker equations). Errors
//! that physics leaves remember for a good part of a cycle, or until a free oscillation has died
//! away: they follow the resonance, the input or time. So the process counts only where its memory
//! is short next to either. Not for noise inside the model (`force-noise`, `bias-random-walk`):
//! what that does to the errors, the filter knows.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

/// Highest order of the process.
const MOST: usize = 3;
/// An earlier disturbance is remembered while it still does this much.
const REMEMBERED: f64 = 0.1;
/// Longest memory: in samples; as a part of a cycle, or if that is longer, of the time constant of
/// a free oscillation.
const MOST_SAMPLES: usize = 4;
const MOST_OF_A_CYCLE: f64 = 0.25;
const MOST_OF_A_DECAY: f64 = 0.1;

/// The memory of a resonance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Resonance {
    /// Its period, samples.
    pub(crate) cycle: f64,
    /// Its damping ratio ζ.
    pub(crate) zeta: f64,
}

impl Resonance {
    /// Samples of memory that are short next to it.
    fn short(self) -> f64 {
        // The amplitude falls as e^(−ζω₀t).
        let decay = self.cycle / (TAU * self.zeta.max(1e-9));
        (MOST_OF_A_CYCLE * self.cycle).max(MOST_OF_A_DECAY * decay)
    }
}

/// An autoregressive process of short memory: eₖ = a₁eₖ₋₁ + a₂eₖ₋₂ + … + white noise.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coloured {
    /// a₁, a₂, …
    coefficients: Vec<f64>,
    /// Correlation of each error with the one before.
    pub(crate) neighbour: f64,
    /// Standard deviation of the white noise that has the same density at low frequencies, over
    /// that of the errors.
    pub(crate) low_frequency: f64,
}

impl Coloured {
    /// The processes of order one, two … that describe these errors and forget soon enough, the
    /// simplest first.
    pub(crate) fn of(errors: &[f64], resonance: Resonance) -> Vec<Self> {
        let n = errors.len();
        if n < 100 * MOST {
            return Vec::new();
        }
        let mean = errors.iter().sum::<f64>() / n as f64;
        let at = |lag: usize| errors.iter().zip(&errors[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
        let correlations: Vec<f64> = (0..=MOST).map(|lag| at(lag) / at(0).max(1e-300)).collect();
        let process = |order: usize| {
            let matrix = DMatrix::from_fn(order, order, |i, j| correlations[i.abs_diff(j)]);
            let right = DVector::from_fn(order, |i, _| correlations[i + 1]);
            let coefficients: Vec<f64> = matrix.cholesky()?.solve(&right).iter().copied().collect();
            // The white noise behind it has the fraction 1 − Σ aᵢρᵢ of the variance, and a density at
            // zero frequency that is 1/(1 − Σ aᵢ)² as large as its own (Box & Jenkins, §3.2).
            let behind = 1.0 - coefficients.iter().zip(&correlations[1..]).map(|(a, r)| a * r).sum::<f64>();
            let low_frequency = behind.max(0.0).sqrt() / (1.0 - coefficients.iter().sum::<f64>());
            Some(Self { coefficients, neighbour: correlations[1], low_frequency })
        };
        let soon = |c: &Self| c.memory().is_some_and(|m| m as f64 <= resonance.short());
        (1..=MOST).filter_map(process).filter(soon).collect()
    }

    /// Samples for which a disturbance is remembered; `None` where they are more than counted.
    fn memory(&self) -> Option<usize> {
        let mut response = vec![1.0];
        for k in 1..=4 * MOST_SAMPLES {
            let earlier = self.coefficients.iter().zip(response[..k].iter().rev());
            response.push(earlier.map(|(a, r)| a * r).sum::<f64>());
        }
        let last = response.iter().rposition(|r| r.abs() >= REMEMBERED)?;
        (last <= MOST_SAMPLES).then_some(last)
    }

    /// Returns the part of a sequence that a forecast from its own past misses; as long as the
    /// sequence less the order.
    pub(crate) fn whitened(&self, values: &[f64]) -> Vec<f64> {
        let order = self.coefficients.len();
        let past = |k: usize| self.coefficients.iter().enumerate().map(|(i, a)| a * values[k - 1 - i]).sum::<f64>();
        (order..values.len()).map(|k| values[k] - past(k)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    const ROWS: usize = 20_000;

    /// Normal noise through y_k = a₁y_{k−1} + a₂y_{k−2} + n_k.
    fn process(a: [f64; 2], seed: u64) -> Vec<f64> {
        let mut rng = Philox::new(seed, 0, Stream::Host);
        let mut y = vec![0.0, 0.0];
        for k in 2..ROWS {
            y.push(a[0] * y[k - 1] + a[1] * y[k - 2] + rng.normal());
        }
        y
    }

    fn neighbour(values: &[f64]) -> f64 {
        let at = |lag: usize| values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum::<f64>();
        at(1) / at(0)
    }

    fn at(cycle: f64) -> Resonance {
        Resonance { cycle, zeta: 0.05 }
    }

    // Standard errors of a coefficient are √((1 − a²)/n) = 0.007 (Box & Jenkins, Time Series
    // Analysis, §7.2).
    #[test]
    fn a_short_memory_is_found_and_taken_out() {
        for (seed, a) in [(1, 0.3), (2, -0.3), (3, 0.1)] {
            let errors = process([a, 0.0], seed);
            let found = Coloured::of(&errors, at(40.0));
            assert_eq!(found.len(), MOST, "{a}");
            assert!((found[0].coefficients[0] - a).abs() < 0.03, "{found:?}");
            assert!((found[0].neighbour - a).abs() < 0.03, "{found:?}");
            // First order: √((1 + a)/(1 − a)).
            assert!((found[0].low_frequency / ((1.0 + a) / (1.0 - a)).sqrt() - 1.0).abs() < 0.05, "{found:?}");
            let white = found[0].whitened(&errors);
            assert_eq!(white.len(), ROWS - 1);
            assert!(neighbour(&white).abs() < 0.03 && neighbour(&errors).abs() > 0.07);
        }
        // Second order: ρ₁ = a₁/(1 − a₂), and the first order alone does not whiten it.
        let errors = process([0.4, -0.4], 4);
        let found = Coloured::of(&errors, at(40.0));
        assert!((found[0].neighbour - 0.4 / 1.4).abs() < 0.03, "{found:?}");
        let [first, second] = [&found[0], &found[1]].map(|c| c.whitened(&errors));
        let power = |v: &[f64]| v.iter().map(|e| e * e).sum::<f64>() / v.len() as f64;
        assert!((power(&second) - 1.0).abs() < 0.05 && power(&first) > 1.1);
    }

    #[test]
    fn what_remembers_for_a_good_part_of_a_cycle_is_not_taken_for_readout_noise() {
        // A resonance of 40 samples a cycle, ζ = 0.05: 2e^{−ζω} cos ω, −e^{−2ζω} with ω = 2π/40.
        let (omega, zeta) = (TAU / 40.0, 0.05);
        let a = [2.0 * (-zeta * omega).exp() * omega.cos(), -(-2.0 * zeta * omega).exp()];
        assert!(Coloured::of(&process(a, 5), at(40.0)).is_empty());
        assert!(Coloured::of(&process([0.9, 0.0], 6), at(40.0)).is_empty());
        // The same memory of one sample is short next to a cycle of 40 samples and long next to one
        // of 3.
        let errors = process([0.3, 0.0], 7);
        assert!(!Coloured::of(&errors, at(40.0)).is_empty() && Coloured::of(&errors, at(3.0)).is_empty());
        // Unless the mass rings on for hundreds of samples: 3/(2π·0.001) = 477.
        assert!(!Coloured::of(&errors, Resonance { zeta: 1e-3, ..at(3.0) }).is_empty());
    }
}
