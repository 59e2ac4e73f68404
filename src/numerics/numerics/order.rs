//! Numbers in memory by rank: sorted, their median and quantiles; other things sorted by a number
//! of theirs. One sort is compiled for all of them.
//!
//! Not for ensembles, whose quantiles come from histograms (`statistics`), and not for
//! distributions (`special`).

/// Sorts from −∞ to ∞, NaN at the ends.
pub fn sort(values: &mut [f64]) {
    values.sort_unstable_by(f64::total_cmp);
}

/// Sorts by a number, smallest first, equal ones in the order they came in. Largest first is by the
/// number with its sign changed.
pub fn sort_by_key<T>(items: &mut [T], key: impl Fn(&T) -> f64) {
    let keys: Vec<f64> = items.iter().map(key).collect();
    let mut order = ranked(&keys);
    // Every item goes to its place along the cycles of the permutation, a swap each.
    for start in 0..order.len() {
        let mut place = start;
        while order[place] != start {
            let from = std::mem::replace(&mut order[place], place);
            items.swap(place, from);
            place = from;
        }
        order[place] = place;
    }
}

/// Indices of `keys`, smallest key first, equal ones in order.
pub fn ranked(keys: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_unstable_by(|a, b| keys[*a].total_cmp(&keys[*b]).then(a.cmp(b)));
    order
}

/// The middle value, the upper one of an even number; `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The value below which a share of `sorted` lies, interpolated between ranks; NaN of nothing.
pub fn quantile(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let rank = fraction * last as f64;
    let below = (rank as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (rank - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorting_by_a_number_keeps_equal_ones_in_order() {
        // Every sequence of six keys, most with equal ones, against the stable sort of the standard
        // library.
        for code in 0..6_usize.pow(6) {
            let keys: Vec<usize> = (0..6).map(|i| code / 6_usize.pow(i) % 6).collect();
            let mut expected: Vec<(usize, usize)> = keys.iter().copied().zip(0..).collect();
            let mut found = expected.clone();
            expected.sort_by_key(|e| e.0);
            sort_by_key(&mut found, |e| e.0 as f64);
            assert_eq!(found, expected);
            expected.sort_by_key(|e| std::cmp::Reverse(e.0));
            sort_by_key(&mut found, |e| -(e.0 as f64));
            assert_eq!(found, expected);
        }
        let mut values = [f64::NAN, 1.0, f64::NEG_INFINITY, -0.0, 0.0];
        sort(&mut values);
        assert_eq!(values.map(f64::to_bits)[..4], [f64::NEG_INFINITY, -0.0, 0.0, 1.0].map(f64::to_bits));
    }

    #[test]
    fn quantiles_of_a_ramp_and_the_median_of_a_few() {
        let ramp: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!([0.0, 0.05, 0.505, 1.0].map(|p| quantile(&ramp, p)), [0.0, 5.0, 50.5, 100.0]);
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!((median(vec![3.0, 1.0, 2.0]), median(vec![4.0, 1.0]), median(vec![])), (Some(2.0), Some(4.0), None));
    }
}
