//! The orthonormal cosine transform (DCT-II): where slow noises without a stationary law become
//! independent.
//!
//! A random walk seen from its own mean has uncorrelated coefficients here, exactly: the transform
//! diagonalises the second difference with free ends. White noise does in any orthonormal basis. So
//! a likelihood over these coefficients needs no window and no correction for leakage, which a
//! Fourier periodogram of a walk does.

use std::f64::consts::PI;
use std::sync::Arc;

use realfft::num_complex::Complex64;
use realfft::{ComplexToReal, RealToComplex};

use super::fourier;
use super::recent::Recent;

/// Samples over all plans that are kept: 16 bytes each of factors.
const KEPT: usize = 1 << 22;

/// Plan and factors that transforms of one length share.
struct Plan {
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// e^(−iπk/(2N)).
    turns: Vec<Complex64>,
}

fn plan(count: usize) -> Arc<Plan> {
    static PLANS: Recent<Arc<Plan>> = Recent::new(KEPT);
    let turn = |k: usize| Complex64::from_polar(1.0, -PI * k as f64 / (2.0 * count as f64));
    PLANS.of(count, || {
        let turns = (0..count).map(turn).collect();
        Arc::new(Plan { forward: fourier::forward(count), inverse: fourier::inverse(count), turns })
    })
}

/// Coefficients c₀ … c_{N−1}; c_k belongs to the frequency k·rate/(2N), Σ c_k² = Σ x². Empty in,
/// empty out.
pub fn transform(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    if count == 0 {
        return Vec::new();
    }
    let plan = plan(count);
    // Makhoul 1980: one real FFT of the even samples followed by the odd ones backwards.
    let mut input: Vec<f64> = values.iter().step_by(2).copied().collect();
    input.extend(values.iter().skip(1).step_by(2).rev());
    let mut bins = plan.forward.make_output_vec();
    // Fails only for buffers of another length than planned.
    if plan.forward.process(&mut input, &mut bins).is_err() {
        return vec![0.0; count];
    }
    let scale = (2.0 / count as f64).sqrt();
    let coefficient = |k: usize| {
        let bin = if k < bins.len() { bins[k] } else { bins[count - k].conj() };
        (bin * plan.turns[k]).re * if k == 0 { scale / 2f64.sqrt() } else { scale }
    };
    (0..count).map(coefficient).collect()
}

/// The sequence with these coefficients: the inverse of [`transform`].
pub fn invert(coefficients: &[f64]) -> Vec<f64> {
    let count = coefficients.len();
    if count == 0 {
        return Vec::new();
    }
    let plan = plan(count);
    let mut bins = plan.inverse.make_input_vec();
    let scale = (count as f64 / 2.0).sqrt();
    for (k, bin) in bins.iter_mut().enumerate() {
        let mirrored = if k == 0 { 0.0 } else { coefficients[count - k] };
        let own = coefficients[k] * if k == 0 { 2f64.sqrt() } else { 1.0 };
        *bin = Complex64::new(own, -mirrored) * plan.turns[k].conj() * scale;
    }
    bins[0].im = 0.0;
    if count.is_multiple_of(2)
        && let Some(last) = bins.last_mut()
    {
        last.im = 0.0;
    }
    let mut output = plan.inverse.make_output_vec();
    // Fails only for buffers of another length than planned.
    if plan.inverse.process(&mut bins, &mut output).is_err() {
        return vec![0.0; count];
    }
    let mut out = vec![0.0; count];
    let half = count.div_ceil(2);
    for (n, value) in output.iter().enumerate() {
        let place = if n < half { 2 * n } else { 2 * (count - n) - 1 };
        out[place] = value / count as f64;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_do_not_mix_whatever_was_transformed_before() {
        // c_k = √(2/N) Σ x_n cos(πk(2n+1)/(2N)), with one over √2 for k = 0 (Rao & Yip 1990).
        let by_definition = |x: &[f64], k: usize| {
            let n = x.len() as f64;
            let wave = |i: usize| (PI * k as f64 * (2 * i + 1) as f64 / (2.0 * n)).cos();
            let sum: f64 = x.iter().enumerate().map(|(i, v)| v * wave(i)).sum();
            sum * (2.0 / n).sqrt() * if k == 0 { 0.5f64.sqrt() } else { 1.0 }
        };
        for count in [7, 12, 30, 7, 9, 16, 5, 12, 7] {
            let values: Vec<f64> = (0..count).map(|i| ((i * 37 + 11) % 17) as f64 - 8.0).collect();
            let found = transform(&values);
            assert!((0..count).all(|k| (found[k] - by_definition(&values, k)).abs() < 1e-12 * 17.0), "{count}");
            // Control: another length's coefficients are others.
            assert!((found[1] - by_definition(&values[1..], 1)).abs() > 1e-3, "{count}");
        }
    }

    #[test]
    fn it_is_orthonormal_and_inverts() {
        for count in [1, 2, 5, 8, 63] {
            let values: Vec<f64> = (0..count).map(|i| ((i * 37 + 11) % 17) as f64 - 8.0).collect();
            let coefficients = transform(&values);
            let back = invert(&coefficients);
            assert!(values.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-10), "{count}");
            let energy = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
            assert!((energy(&values) - energy(&coefficients)).abs() < 1e-9 * energy(&values).max(1.0));
        }
    }
}
