//! Integrals of sampled vectors over time, at the samples and between them.

use nalgebra::Vector3;

/// Holds what is taken to happen between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Rule {
    /// A straight line: what vibrates about as fast as it is sampled is made smaller.
    #[default]
    Straight,
    /// The cubic through four samples: what moves smoothly is integrated to the fourth order.
    Cubic,
}

/// The integral from the first sample to each; the straight line also where too few samples stand
/// or the stamps are uneven.
pub(super) fn cumulative(time_s: &[f64], values: &[Vector3<f64>], rule: Rule) -> Vec<Vector3<f64>> {
    let mut sum = Vector3::zeros();
    let mut all = Vec::with_capacity(values.len());
    all.push(sum);
    for k in 0..values.len().saturating_sub(1) {
        let step = time_s[k + 1] - time_s[k];
        let even = |i: usize| ((time_s[i + 1] - time_s[i]) / step - 1.0).abs() < 0.1;
        sum += if rule == Rule::Cubic && k > 0 && k + 2 < values.len() && even(k - 1) && even(k + 1) {
            ((values[k] + values[k + 1]) * 13.0 - values[k - 1] - values[k + 2]) * (step / 24.0)
        } else {
            (values[k] + values[k + 1]) * (0.5 * step)
        };
        all.push(sum);
    }
    all
}

/// Returns where an instant lies among samples: the one before it and the fraction of the interval;
/// at the ends, those of the ends.
pub(super) fn place(time_s: &[f64], at_s: f64) -> (usize, f64) {
    let after = time_s.partition_point(|t| *t <= at_s).clamp(1, time_s.len() - 1);
    let fraction = (at_s - time_s[after - 1]) / (time_s[after] - time_s[after - 1]);
    (after - 1, fraction)
}

/// An integral between samples, from itself and its integrand: Hermite's cubic.
pub(super) fn between(
    time_s: &[f64],
    integral: &[Vector3<f64>],
    integrand: &[Vector3<f64>],
    (k, u): (usize, f64),
) -> Vector3<f64> {
    let step = time_s[k + 1] - time_s[k];
    let rise = u * u * (3.0 - 2.0 * u);
    let (start, end) = (u * (1.0 - u) * (1.0 - u), -u * u * (1.0 - u));
    integral[k] + (integral[k + 1] - integral[k]) * rise + (integrand[k] * start + integrand[k + 1] * end) * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_integrated_exactly_at_samples_and_between() {
        let time_s: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k)).collect();
        let values: Vec<_> = time_s.iter().map(|t| Vector3::new(t.powi(3), 1.0, t * t)).collect();
        let all = cumulative(&time_s, &values, Rule::Cubic);
        // From one even stretch to another: the ends are straight lines.
        let got = all[15] - all[5];
        assert!((got.x - (1.5f64.powi(4) - 0.5f64.powi(4)) / 4.0).abs() < 1e-12);
        let at = place(&time_s, 0.73);
        assert_eq!(at.0, 7);
        let between = between(&time_s, &all, &values, at) - all[7];
        assert!((between.z - (0.73f64.powi(3) - 0.7f64.powi(3)) / 3.0).abs() < 1e-12);
        // The straight line alone is far off.
        let straight = 0.5 * 0.1 * values.windows(2).skip(5).take(10).map(|v| v[0].x + v[1].x).sum::<f64>();
        assert!((straight - got.x).abs() > 1e-3);
    }
}
