//! The orthonormal cosine transform (DCT-II): where slow noises without a stationary law become independent.
//!
//! A random walk seen from its own mean has uncorrelated coefficients here, exactly: the transform diagonalises the second
//! difference with free ends. White noise does in any orthonormal basis. So a likelihood over these coefficients needs no
//! window and no correction for leakage, which a Fourier periodogram of a walk does.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

/// Coefficients c₀ … c_{N−1}; c_k belongs to the frequency k·rate/(2N), Σ c_k² = Σ x². Empty in, empty out.
pub fn transform(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    if count == 0 {
        return Vec::new();
    }
    // Makhoul 1980: one real FFT of the even samples followed by the odd ones backwards.
    let mut input: Vec<f64> = values.iter().step_by(2).copied().collect();
    input.extend(values.iter().skip(1).step_by(2).rev());
    let fft = RealFftPlanner::new().plan_fft_forward(count);
    let mut bins = fft.make_output_vec();
    // Fails only for buffers of another length than planned.
    if fft.process(&mut input, &mut bins).is_err() {
        return vec![0.0; count];
    }
    let scale = (2.0 / count as f64).sqrt();
    let coefficient = |k: usize| {
        let bin = if k < bins.len() { bins[k] } else { bins[count - k].conj() };
        let turn = Complex64::from_polar(1.0, -std::f64::consts::PI * k as f64 / (2.0 * count as f64));
        (bin * turn).re * if k == 0 { scale / 2f64.sqrt() } else { scale }
    };
    (0..count).map(coefficient).collect()
}

/// The sequence with these coefficients. Quadratic in the number of non-zero ones: for smooth parts only.
pub fn synthesise(coefficients: &[f64], count: usize) -> Vec<f64> {
    let scale = (2.0 / count as f64).sqrt();
    let mut out = vec![0.0; count];
    for (k, c) in coefficients.iter().enumerate().filter(|(_, c)| **c != 0.0) {
        let scale = if k == 0 { scale / 2f64.sqrt() } else { scale };
        for (n, value) in out.iter_mut().enumerate() {
            *value += c * scale * (std::f64::consts::PI * k as f64 * (n as f64 + 0.5) / count as f64).cos();
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_orthonormal_and_inverts() {
        for count in [1, 2, 5, 8, 63] {
            let values: Vec<f64> = (0..count).map(|i| ((i * 37 + 11) % 17) as f64 - 8.0).collect();
            let coefficients = transform(&values);
            let back = synthesise(&coefficients, count);
            assert!(values.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-10), "{count}");
            let energy = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
            assert!((energy(&values) - energy(&coefficients)).abs() < 1e-9 * energy(&values).max(1.0));
        }
    }
}
