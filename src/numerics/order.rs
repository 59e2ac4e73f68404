//! The value at a share of a sorted sequence: median and quantiles of numbers in memory.
//!
//! Not for ensembles, whose quantiles come from histograms (`statistics`), and not for distributions (`special`).

/// The middle value, the upper one of an even number; `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The value below which a share of `sorted` lies, interpolated between ranks; NaN of nothing.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let rank = share * last as f64;
    let below = (rank as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (rank - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_ramp_and_the_median_of_a_few() {
        let ramp: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!([0.0, 0.05, 0.505, 1.0].map(|p| quantile(&ramp, p)), [0.0, 5.0, 50.5, 100.0]);
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!((median(vec![3.0, 1.0, 2.0]), median(vec![4.0, 1.0]), median(vec![])), (Some(2.0), Some(4.0), None));
    }
}
