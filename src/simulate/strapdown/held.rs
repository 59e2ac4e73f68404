//! A held process over a still start: how far its mean goes, and how much of it is left at the end.

/// For a process of unit variance that is held for `every` steps, with `first` steps left to its
/// next renewal at the end of the still start (none: a whole time), over the `steps` before it: the
/// variance of its mean, and the mean's covariance with the value at the end.
pub(super) fn mean_and_end(every: u64, first: u64, steps: f64) -> [f64; 2] {
    let left = if first.is_multiple_of(every) { every } else { first % every };
    // Pieces of constant value, the last one first, each e⁻¹ of correlation from the one after.
    let mut pieces = Vec::new();
    let (mut remaining, mut length) = (steps, (every - left) as f64);
    if length == 0.0 {
        // The value at the end is renewed there: it has no time before it.
        length = every as f64;
        pieces.push(0.0);
    }
    while remaining > 0.0 {
        let piece = length.min(remaining);
        pieces.push(piece / steps);
        remaining -= piece;
        length = every as f64;
    }
    let kept = |a: usize, b: usize| (-(a.abs_diff(b) as f64)).exp();
    // Beyond forty pieces apart nothing is left of the correlation.
    let near = |i: usize| i.saturating_sub(40)..pieces.len().min(i + 41);
    let variance = (0..pieces.len()).map(|i| near(i).map(|j| pieces[i] * pieces[j] * kept(i, j)).sum::<f64>()).sum();
    let with_end = pieces.iter().enumerate().take(41).map(|(i, p)| p * kept(i, 0)).sum();
    [variance, with_end]
}

#[cfg(test)]
mod tests {
    use super::mean_and_end;

    #[test]
    fn a_long_hold_is_a_constant_and_a_short_one_averages_out() {
        // Held throughout: the mean is the value itself.
        let [variance, with_end] = mean_and_end(1000, 10, 20.0);
        assert!((variance - 1.0).abs() < 1e-12 && (with_end - 1.0).abs() < 1e-12);
        // Many holds: an AR(1) of e⁻¹ per hold, whose mean over n has variance (1 + e⁻¹)/(1 −
        // e⁻¹)/n.
        let [variance, _] = mean_and_end(1, 0, 10_000.0);
        let kept = (-1.0f64).exp();
        assert!((variance * 10_000.0 / ((1.0 + kept) / (1.0 - kept)) - 1.0).abs() < 1e-3, "{variance}");
    }
}
