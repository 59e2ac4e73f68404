//! The weighted median of a few estimates, and how much wider it spreads than their mean.

use crate::numerics::order;

/// The median of values with weights: half of the weight lies on either side, by straight lines
/// between the middles of the values' weights. NaN for none.
pub(super) fn weighted(values: &[f64], weights: &[f64]) -> f64 {
    let ranked = order::ranked(values);
    let total: f64 = weights.iter().sum();
    let mut before: Option<(f64, f64)> = None;
    let mut sum = 0.0;
    for k in ranked {
        let middle = (sum + 0.5 * weights[k]) / total;
        sum += weights[k];
        if middle >= 0.5 {
            return match before {
                Some((at, value)) if middle > at => value + (values[k] - value) * (0.5 - at) / (middle - at),
                _ => values[k],
            };
        }
        before = Some((middle, values[k]));
    }
    before.map_or(f64::NAN, |(_, value)| value)
}

/// Variance of the median of `count` normal values over that of their mean: π/2 for many; for few
/// the formula that is 1 for one and for two and meets the exact values (David & Nagaraja, *Order
/// statistics*, 3rd ed., §4.6) within 3 %.
pub(super) fn excess(count: usize) -> f64 {
    let (n, half_pi) = (count.max(1) as f64, std::f64::consts::FRAC_PI_2);
    let few = if count.is_multiple_of(2) { 2.0 * half_pi - 2.0 } else { half_pi - 1.0 };
    half_pi * n / (n + few)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    #[test]
    fn equal_weights_give_the_median_and_a_heavy_value_wins() {
        assert_eq!(weighted(&[3.0, 1.0, 2.0], &[1.0; 3]), 2.0);
        assert_eq!(weighted(&[1.0, 3.0], &[1.0; 2]), 2.0);
        assert_eq!(weighted(&[5.0], &[0.3]), 5.0);
        assert!((weighted(&[0.0, 0.0, 10.0], &[1.0, 1.0, 100.0]) - 10.0).abs() < 0.6);
        assert!(weighted(&[], &[]).is_nan());
    }

    #[test]
    fn the_median_spreads_as_it_should() {
        for count in [1usize, 2, 3, 4, 5, 8, 9, 25] {
            let trials = 40_000u64;
            let mut squares = 0.0;
            for trial in 0..trials {
                let mut draw = Philox::new(7, trial, Stream::Start);
                let values: Vec<f64> = (0..count).map(|_| draw.normal()).collect();
                squares += weighted(&values, &vec![1.0; count]).powi(2);
            }
            let measured = squares / trials as f64 * count as f64;
            // Five standard errors of a variance, 5√(2/40 000) = 3.5 %, and the formula's 3 %.
            assert!((measured / excess(count) - 1.0).abs() < 0.065, "{count}: {measured}, {}", excess(count));
        }
        // One formula for odd and even counts would not do.
        assert!(excess(3) / excess(2) > 1.2);
    }
}
