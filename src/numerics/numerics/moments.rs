//! Moments and products of numbers in memory.
//!
//! Not for ensembles, whose moments are summed while they run (`statistics`).

/// Mean; zero of nothing.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean and standard deviation (of the whole, not of a sample: divided by n). Zero and zero of
/// nothing.
pub fn mean_sd(values: &[f64]) -> (f64, f64) {
    let mean = mean(values);
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt())
}

/// Root mean square; zero of nothing.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (squares, count) = values.into_iter().fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    (squares / f64::max(count, 1.0)).sqrt()
}

/// Scalar product; of the shorter length where they differ.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Eight partial sums: independent chains, and less rounding than one.
    let mut sums = [0.0; 8];
    let whole = a.len().min(b.len()) / 8 * 8;
    let ((head_a, tail_a), (head_b, tail_b)) = (a.split_at(whole), b.split_at(whole));
    for (x, y) in head_a.chunks_exact(8).zip(head_b.chunks_exact(8)) {
        for l in 0..8 {
            sums[l] += x[l] * y[l];
        }
    }
    let rest: f64 = tail_a.iter().zip(tail_b).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_the_first_whole_numbers() {
        // Of 1 … n: mean (n+1)/2, variance (n²−1)/12, sum of squares n(n+1)(2n+1)/6.
        for n in [1.0, 2.0, 7.0, 8.0, 19.0_f64] {
            let values: Vec<f64> = (1..=n as usize).map(|v| v as f64).collect();
            let (mean, sd) = mean_sd(&values);
            assert!((mean - 0.5 * (n + 1.0)).abs() < 1e-12 && (sd * sd - (n * n - 1.0) / 12.0).abs() < 1e-12);
            let squares = n * (n + 1.0) * (2.0 * n + 1.0) / 6.0;
            assert!((dot(&values, &values) - squares).abs() < 1e-9, "{n}");
            assert!((rms(values.iter().copied()) - (squares / n).sqrt()).abs() < 1e-12);
            assert!((dot(&values, &values[..1]) - 1.0).abs() < 1e-12);
        }
        assert_eq!((mean(&[]), mean_sd(&[]), rms([]), dot(&[], &[])), (0.0, (0.0, 0.0), 0.0, 0.0));
        assert!(mean(&[1.0, f64::NAN]).is_nan());
    }
}
