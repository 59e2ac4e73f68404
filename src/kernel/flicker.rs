//! Bias instability: a sum of first-order Gauss–Markov processes whose Allan deviation is flat.
//!
//! Term j is held over 4ʲ samples and then relaxes by e⁻¹ (its exact discretisation: time constant = time held), so all
//! terms are one process at different speeds and the sum costs one new number per sample and a third: the slow ones
//! take turns (Voss and McCartney). It starts from its stationary law. With the weights below, the Allan deviation
//! stays within 2 % of 0.664 B from one sample to the length of the run, whatever that is; the test computes it.

/// e⁻¹: what is left of a term at its next update.
pub const RETAINED: f64 = 0.367_879_441_171_442_3;
/// √(1 − e⁻²): the share of the new number.
pub const RENEWED: f64 = 0.929_873_495_032_193_7;
/// Minimum Allan deviation of bias instability B: √(2 ln 2 / π).
pub const ALLAN_PER_INSTABILITY: f64 = 0.664_281_4;
/// Most terms a kernel carries: 4¹⁵ samples, 124 days at 100 Hz.
pub const MOST_TERMS: usize = 16;

/// Variance of term j for a unit Allan variance. The fast end has no faster neighbours and differs from the rest; found
/// by non-negative fitting of the Allan variance in the test below.
const VARIANCE: [f64; 6] = [1.262, 1.060, 0.957, 1.028, 0.984, 0.996];

/// Terms needed for a run: until one is held for longer than it.
pub fn terms(samples: u64) -> usize {
    (1..MOST_TERMS).find(|&j| 4_u64.pow(j as u32 - 1) >= samples).map_or(MOST_TERMS, |j| j + 1)
}

/// Standard deviation of term j for bias instability 1.
pub fn amplitude(term: usize) -> f64 {
    ALLAN_PER_INSTABILITY * VARIANCE[term.min(VARIANCE.len() - 1)].sqrt()
}

/// Which update of term j takes place at sample n, if one does. Slow terms take turns: at most one per sample.
#[inline(always)]
pub fn update(term: usize, sample: u64) -> Option<u32> {
    let hold = 1_u64 << (2 * term as u32);
    let phase = sample + hold / 2;
    (sample == 0 || phase & (hold - 1) == 0).then_some((phase >> (2 * term as u32)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Allan variance at m samples of a unit term held over 4ʲ, averaged over where the averaging begins.
    fn allan_variance(term: usize, m: i64) -> f64 {
        let hold = 4_f64.powi(term as i32);
        let covariance = |lag: i64| {
            let lag = lag.abs() as f64 / hold;
            let (whole, part) = (lag.floor(), lag.fract());
            (1.0 - part) * (-whole).exp() + part * (-whole - 1.0).exp()
        };
        let sum: f64 = (1 - m..m).map(|k| (m - k.abs()) as f64 * (covariance(k) - covariance(m + k))).sum();
        sum / (m * m) as f64
    }

    #[test]
    fn the_sum_is_flat_from_one_sample_to_the_run() {
        for samples in [1 << 6, 1 << 10, 1 << 13] {
            for octave in 0.. {
                let m = 1_i64 << octave;
                if m > samples as i64 {
                    break;
                }
                let sum: f64 = (0..terms(samples)).map(|j| amplitude(j).powi(2) * allan_variance(j, m)).sum();
                let ratio = sum.sqrt() / ALLAN_PER_INSTABILITY;
                assert!((ratio - 1.0).abs() < 0.02, "{samples} samples, over {m}: {ratio}");
            }
        }
    }

    #[test]
    fn at_most_one_slow_term_is_renewed_per_sample_and_updates_are_numbered_without_gap() {
        for n in 1..5000 {
            assert!((1..8).filter(|&j| update(j, n).is_some()).count() <= 1);
        }
        for j in 0..5 {
            let numbers: Vec<u32> = (0..5000).filter_map(|n| update(j, n)).collect();
            assert!(numbers.iter().enumerate().all(|(i, &u)| i == u as usize), "{j}");
        }
        assert!((RETAINED * RETAINED + RENEWED * RENEWED - 1.0).abs() < 1e-15);
    }
}
