//! Bias instability: a sum of first-order Gauss–Markov processes whose Allan deviation is flat.
//!
//! Term j is held over 4ʲ samples and then relaxes by e⁻¹ (its exact discretisation: time
//! constant = time held), so all terms are one process at different speeds and the sum costs little
//! more than one new number per sample: the slow ones take turns (Voss and McCartney), and the two
//! fast ones, whose sum over a time is that of many numbers, take small steps that are not normal
//! (`cpu::cheap_noise`). It starts from its stationary law, each group of 64 members at a place of
//! its own in the schedule of renewals: at the same place for all, a slow term would change at the
//! same time in every member, and a drift over few seconds would be that of one moment of the
//! process and not of any (15 % short of 1/f noise over 10 s after 10 s of still start; with the
//! places spread, within 0.3 %). With the weights below, the Allan deviation stays within 2 % of
//! 0.664 B from one sample to the length of the run, whatever that is; the test computes it.

use crate::numerics::allan::law::FLICKER_FLOOR;

/// e⁻¹: what is left of a term at its next update.
pub(super) const RETAINED: f64 = 0.367_879_441_171_442_3;
/// √(1 − e⁻²): the share of the new number.
pub(super) const RENEWED: f64 = 0.929_873_495_032_193_7;
/// Most terms a kernel carries: 4¹⁵ samples, 124 days at 100 Hz.
pub(crate) const MOST_TERMS: usize = 16;

/// Variance of term j for a unit Allan variance. The fast end has no faster neighbours and differs
/// from the rest; found by non-negative fitting of the Allan variance in the test below.
const VARIANCE: [f64; 6] = [1.262, 1.060, 0.957, 1.028, 0.984, 0.996];

/// Terms needed for a run: until one is held for longer than it.
pub fn terms(samples: u64) -> usize {
    (1..MOST_TERMS).find(|&j| 4_u64.pow(j as u32 - 1) >= samples).map_or(MOST_TERMS, |j| j + 1)
}

/// Standard deviation that a decade of 1/f noise adds, for bias instability 1: its one-sided
/// spectrum is B²/(π f), so that ln 10 of frequency hold B² ln 10/π.
pub const PER_DECADE: f64 = 0.856_116_580_191_873_1;

/// Frequency down to which a run of this many samples has 1/f noise, Hz: that of the slowest term,
/// 1/(2π τ), with the time τ for which it is held.
pub fn lowest_frequency_hz(samples: u64, sample_s: f64) -> f64 {
    let held = 4f64.powi(terms(samples) as i32 - 1);
    1.0 / (std::f64::consts::TAU * held * sample_s)
}

/// Standard deviation of term j for bias instability 1.
pub fn amplitude(term: usize) -> f64 {
    FLICKER_FLOOR * VARIANCE[term.min(VARIANCE.len() - 1)].sqrt()
}

/// Places in the schedule at which runs begin are multiples of this many samples, a stretch of the
/// CPU's kernel.
const PLACES: u64 = 16;
/// Places spread over by a Weyl sequence: the golden ratio of 2³², odd, so that any power of two of
/// groups has all places.
pub(crate) const SPREAD: u32 = 0x9E37_79B9;
/// Places up to the longest time a term is held, 4¹⁵ samples.
pub(super) const PLACE_MASK: u32 = (1 << 26) - 1;

/// Samples for which members of a chain hold a slow term, whatever its time constant. An ordinary
/// member renews one slow term at a time instead, so its drift depends on whether one of the
/// slowest happens to be renewed during the run. Seen over many members that is a mixture of normal
/// laws: right at two standard deviations, exceeded several times too often at five.
pub(super) const HELD: u64 = 16;

/// Returns where in the schedule the 64 members from `first_member` on begin, samples.
pub(crate) fn place(first_member: u64) -> u64 {
    PLACES * u64::from(((first_member / 64) as u32).wrapping_mul(SPREAD) & PLACE_MASK)
}

/// For how long term j is held, and when it may first be renewed, in samples: one first renewal for
/// each of the places at which a run may begin, all equally likely; an even selection of at most
/// `most`.
pub fn hold_and_firsts(term: usize, most: u64) -> (u64, Vec<u64>) {
    let hold = 4_u64.pow(term as u32);
    let places = (hold / PLACES).max(1);
    let shown = places.min(most.max(1));
    let first = |k: u64| {
        // The middle of its part of the places.
        let place = PLACES * ((2 * k + 1) * places / (2 * shown));
        match (hold / 2).wrapping_sub(place) & (hold - 1) {
            0 => hold,
            first => first,
        }
    };
    (hold, (0..shown).map(first).collect())
}

/// Which slow term (1, 2, …) is renewed at place n of the schedule: those with n = 4ʲ/2 + a
/// multiple of 4ʲ. At most one per sample, and at most two in four: term 1 at 4m + 2, term 2 at
/// 16m + 8, another perhaps at 16m. Term 0 is renewed at every sample.
#[inline(always)]
pub(super) fn slow_term(sample: u64) -> Option<usize> {
    let zeros = sample.trailing_zeros() as usize;
    (sample != 0 && zeros % 2 == 1).then_some(zeros.div_ceil(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Allan variance at m samples of a unit term of time constant 4ʲ that is held over that, or
    /// over `most` samples, averaged over where the averaging begins.
    fn allan_variance(term: usize, m: i64, most: f64) -> f64 {
        let time = 4_f64.powi(term as i32);
        let hold = time.min(most);
        let covariance = |lag: i64| {
            let lag = lag.abs() as f64 / hold;
            let (whole, part) = (lag.floor() * hold / time, lag.fract());
            (1.0 - part) * (-whole).exp() + part * (-whole - hold / time).exp()
        };
        let sum: f64 = (1 - m..m).map(|k| (m - k.abs()) as f64 * (covariance(k) - covariance(m + k))).sum();
        sum / (m * m) as f64
    }

    // A term is a factor of four in frequency: ln 4 of B²/π. The flat part below the slowest term
    // holds what 1/f noise has in the next decades, so a frequency ten times lower adds what is
    // stated.
    #[test]
    fn a_slower_term_adds_what_its_part_of_the_spectrum_holds() {
        let decade = (10f64.ln() / std::f64::consts::PI).sqrt();
        assert!((PER_DECADE / decade - 1.0).abs() < 1e-12, "{decade}");
        let added = amplitude(9).powi(2) * 10f64.ln() / 4f64.ln();
        assert!((added.sqrt() / PER_DECADE - 1.0).abs() < 0.01, "{added}");
        // One minute at 100 Hz: the slowest of nine terms is held for 4⁸ samples.
        let lowest = lowest_frequency_hz(6000, 0.01);
        assert!((lowest * std::f64::consts::TAU * 655.36 - 1.0).abs() < 1e-12, "{lowest}");
    }

    #[test]
    fn the_sum_is_flat_from_one_sample_to_the_run() {
        for (most, within) in [(f64::INFINITY, 0.02), (HELD as f64, 0.03)] {
            for samples in [1 << 6, 1 << 10, 1 << 13] {
                for m in (0..).map(|octave| 1_i64 << octave).take_while(|m| *m <= samples as i64) {
                    let sum: f64 = (0..terms(samples)).map(|j| amplitude(j).powi(2) * allan_variance(j, m, most)).sum();
                    let ratio = sum.sqrt() / FLICKER_FLOOR;
                    assert!((ratio - 1.0).abs() < within, "{samples} samples, over {m}: {ratio}");
                }
            }
        }
    }

    #[test]
    fn a_slow_term_is_renewed_once_in_the_time_it_is_held() {
        let all = |term| hold_and_firsts(term, u64::MAX);
        assert_eq!((all(0), all(1), all(2)), ((1, vec![1]), (4, vec![2]), (16, vec![8])));
        for j in 1..6 {
            let (hold, firsts) = all(j);
            let mut met = Vec::new();
            for group in 0..64 {
                let place = place(64 * group);
                let renewed: Vec<u64> = (1..5000).filter(|&n| slow_term(n + place) == Some(j)).collect();
                let first = renewed[0];
                assert!(renewed.iter().enumerate().all(|(i, &n)| n == first + i as u64 * hold), "{j}");
                met.push(first);
            }
            // As many of the 64 groups begin at each place.
            for first in &firsts {
                assert_eq!(met.iter().filter(|m| *m == first).count(), 64 / firsts.len(), "term {j}, {first}");
            }
            // A selection of them is an even one.
            let (_, some) = hold_and_firsts(j, 4);
            let mean = |v: &[u64]| v.iter().sum::<u64>() as f64 / v.len() as f64;
            assert!(
                (mean(&some) - mean(&firsts)).abs() <= 0.13 * hold as f64 && some.iter().all(|f| firsts.contains(f))
            );
        }
        assert!((RETAINED * RETAINED + RENEWED * RENEWED - 1.0).abs() < 1e-15);
    }
}
