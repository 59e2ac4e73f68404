//! Plans of real Fourier transforms by their length: to make one costs as much as several transforms.

use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use super::recent::Recent;

/// Samples over all plans of one direction that are kept. A plan holds about 12 bytes of factors a sample,
/// eight of its complex transform of half the length and four that part real from imaginary: 50 MB.
const KEPT: usize = 1 << 22;

/// Plans the transform of `count` real samples; kept for the next of that length.
pub fn forward(count: usize) -> Arc<dyn RealToComplex<f64>> {
    static PLANS: Recent<Arc<dyn RealToComplex<f64>>> = Recent::new(KEPT);
    PLANS.of(count, || RealFftPlanner::new().plan_fft_forward(count))
}

/// Plans the inverse transform to `count` real samples. It does not divide by `count`.
pub fn inverse(count: usize) -> Arc<dyn ComplexToReal<f64>> {
    static PLANS: Recent<Arc<dyn ComplexToReal<f64>>> = Recent::new(KEPT);
    PLANS.of(count, || RealFftPlanner::new().plan_fft_inverse(count))
}
