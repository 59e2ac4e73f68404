//! Which powers of time an error envelope is made of: σ²(t) = a₁₅²t³ + a₂²t⁴ + a₂₅²t⁵ + a₃²t⁶ with
//! a ≥ 0.
//!
//! The powers belong to velocity random walk (1.5), acceleration bias (2), angle or acceleration
//! random walk (2.5) and gyro bias (3). Neighbouring powers imitate each other over a short span:
//! the fit describes the envelope, it does not prove a source; the error budget does that.

use nalgebra::{DMatrix, DVector};

/// Exponents of t that are fitted.
pub const EXPONENTS: [f64; 4] = [1.5, 2.0, 2.5, 3.0];

/// Coefficients a of the four powers, unit/s^p, by non-negative least squares on relative variance.
///
/// `envelope` holds (t in s, standard deviation); points that are not positive are left out. All
/// zero when fewer than two points remain. Every subset of the four powers is solved; the best with
/// no negative share wins (15 solves).
pub fn fit(envelope: &[(f64, f64)]) -> [f64; 4] {
    let points: Vec<(f64, f64)> = envelope.iter().copied().filter(|(t, sd)| *t > 0.0 && *sd > 0.0).collect();
    let mut best = ([0.0; 4], f64::INFINITY);
    for subset in 1u32..16 {
        let members: Vec<usize> = (0..4).filter(|k| subset >> k & 1 == 1).collect();
        if members.len() > points.len() {
            continue;
        }
        // Rows divided by σ²: a relative error counts the same at every time.
        let design = DMatrix::from_fn(points.len(), members.len(), |row, column| {
            let (t, sd) = points[row];
            t.powf(2.0 * EXPONENTS[members[column]]) / (sd * sd)
        });
        let ones = DVector::from_element(points.len(), 1.0);
        // Columns differ by many decades; scale them to unit length before solving.
        let lengths: Vec<f64> = design.column_iter().map(|c| c.norm()).collect();
        // Deviations so large or small that their squares leave the range of numbers: the
        // decomposition would panic.
        if lengths.iter().any(|length| !length.is_normal()) {
            continue;
        }
        let scaled = DMatrix::from_fn(design.nrows(), design.ncols(), |r, c| design[(r, c)] / lengths[c]);
        let Ok(solution) = scaled.clone().svd(true, true).solve(&ones, 1e-12) else { continue };
        if solution.iter().any(|coefficient| *coefficient < 0.0 || !coefficient.is_finite()) {
            continue;
        }
        let misfit = (&scaled * &solution - &ones).norm_squared();
        // A power more must earn its place: one per cent of the misfit, and more than rounding.
        if misfit + 1e-12 * (points.len() as f64) < best.1 * 0.99 {
            let mut coefficients = [0.0; 4];
            for (column, k) in members.iter().enumerate() {
                coefficients[*k] = (solution[column] / lengths[column]).sqrt();
            }
            best = (coefficients, misfit);
        }
    }
    best.0
}

/// The exponent of t by which the envelope grows around each of its points: d ln σ / d ln t,
/// central differences.
pub fn local_exponents(envelope: &[(f64, f64)]) -> Vec<f64> {
    let last = envelope.len().saturating_sub(1);
    let slope = |a: (f64, f64), b: (f64, f64)| (b.1 / a.1).ln() / (b.0 / a.0).ln();
    (0..envelope.len()).map(|k| slope(envelope[k.saturating_sub(1)], envelope[(k + 1).min(last)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn envelope(law: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..40).map(|k| 10f64.powf(-2.0 + 4.0 * k as f64 / 39.0)).map(|t| (t, law(t))).collect()
    }

    #[test]
    fn planted_coefficients_come_back() {
        let planted = [3e-4, 2e-3, 0.0, 5e-5];
        let law = |t: f64| (0..4).map(|k| (planted[k] * t.powf(EXPONENTS[k])).powi(2)).sum::<f64>().sqrt();
        let found = fit(&envelope(law));
        for k in 0..4 {
            assert!((found[k] - planted[k]).abs() <= 1e-6 * planted[k] + 1e-9, "{found:?}");
        }
    }

    #[test]
    fn a_single_power_is_not_shared_out() {
        assert_eq!(fit(&envelope(|t| 0.1 * t.powf(2.5))).map(|c| c > 0.0), [false, false, true, false]);
        let slopes = local_exponents(&envelope(|t| 0.1 * t.powf(2.5)));
        assert!(slopes.iter().all(|s| (s - 2.5).abs() < 1e-9));
        assert_eq!(fit(&[]), [0.0; 4]);
        // Deviations whose squares are no numbers: nothing to fit, and no panic in the
        // decomposition.
        assert_eq!(fit(&envelope(|t| 1e300 * t)), [0.0; 4]);
        assert_eq!(fit(&envelope(|_| f64::INFINITY)), [0.0; 4]);
    }
}
