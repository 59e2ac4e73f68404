//! Noise of a reading, measured apart from every model of the resonator: what seven neighbouring
//! steps leave of a pole.
//!
//! Over a few steps any response near a resonance is (a + bδ)/(c + δ) of the distance δ in
//! frequency, exactly so for a linear one; polynomials would take the resonance itself for noise.

use nalgebra::{Complex, Matrix3, Vector3};

use crate::numerics::order;

use super::intake::Sweeps;

/// Steps on either side.
const HALF: usize = 3;
/// Rounds of weighing by the distance from the pole.
const ROUNDS: usize = 3;
/// Median of χ² of eight degrees of freedom over its mean: fourteen numbers less six that are fitted.
const MEDIAN: f64 = 0.918;
/// Free numbers of a window.
const FREE: f64 = 8.0;

/// Standard deviation of X and of Y; `None` where no seven steps follow one another.
pub(super) fn deviation(sweeps: &Sweeps) -> Option<f64> {
    let mut all = Vec::new();
    for sweep in sweeps.sweeps.iter().filter(|_| sweeps.is_ordered) {
        for k in sweep.start + HALF..sweep.end.saturating_sub(HALF) {
            let window = k - HALF..k + HALF + 1;
            if window.clone().all(|j| sweeps.counts[j]) {
                all.extend(left(&sweeps.frequency_hz[window.clone()], &sweeps.reading[window]));
            }
        }
    }
    order::median(all).map(|variance| (variance / MEDIAN).sqrt())
}

/// Variance of a component after the best pole is subtracted.
fn left(frequency_hz: &[f64], reading: &[Complex<f64>]) -> Option<f64> {
    let centre = frequency_hz[HALF];
    let width = frequency_hz.iter().fold(0.0f64, |m, f| m.max((f - centre).abs()));
    let size = reading.iter().fold(0.0f64, |m, y| m.max(y.norm()));
    if width == 0.0 || size == 0.0 {
        return None;
    }
    let points: Vec<(f64, Complex<f64>)> =
        frequency_hz.iter().zip(reading).map(|(f, y)| ((f - centre) / width, y / size)).collect();
    let mut weights = vec![1.0; points.len()];
    let mut pole = [Complex::new(0.0, 0.0); 3];
    for _ in 0..ROUNDS {
        // a + bδ − c·y = δ·y.
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for ((delta, y), w) in points.iter().zip(&weights) {
            let row = Vector3::new(Complex::new(1.0, 0.0), Complex::new(*delta, 0.0), -y);
            normal += row.conjugate() * row.transpose() * Complex::new(*w, 0.0);
            right += row.conjugate() * (y * *delta) * Complex::new(*w, 0.0);
        }
        let solved = normal.lu().solve(&right)?;
        pole = [solved[0], solved[1], solved[2]];
        for ((delta, _), w) in points.iter().zip(&mut weights) {
            *w = 1.0 / (pole[2] + delta).norm_sqr().max(1e-12);
        }
    }
    let errors = points.iter().zip(&weights).map(|((delta, y), w)| {
        let error = y * (pole[2] + delta) - pole[0] - pole[1] * *delta;
        error.norm_sqr() * w
    });
    let variance = errors.sum::<f64>() * size * size / FREE;
    variance.is_finite().then_some(variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// A resonance of eight steps to its width on a sloping background, with white noise.
    fn resonance(noise: f64) -> Sweeps {
        let mut rng = Philox::new(5, 0, Stream::Host);
        let frequency_hz: Vec<f64> = (0..120).map(|k| 100.0 + 0.01 * f64::from(k)).collect();
        let reading = frequency_hz.iter().map(|f| {
            let resonance = Complex::new(0.04, 0.0) / Complex::new(100.6 - f, 0.04);
            resonance + (f - 100.0) * 0.1 + Complex::new(rng.normal(), rng.normal()) * noise
        });
        let reading: Vec<_> = reading.collect();
        let whole = 0..120;
        Sweeps {
            drive: vec![1.0; 120],
            counts: vec![true; 120],
            sweeps: vec![whole],
            is_ordered: true,
            frequency_hz,
            reading,
            ..Sweeps::default()
        }
    }

    // The standard deviation that was put in, within what 114 windows of 8 free numbers allow; the
    // resonance itself leaves nothing.
    #[test]
    fn white_noise_is_measured_on_a_resonance() {
        for noise in [1e-4, 1e-2] {
            let measured = deviation(&resonance(noise)).expect("it has windows");
            assert!((measured / noise - 1.0).abs() < 0.2, "{noise}: {measured}");
        }
        assert!(deviation(&resonance(0.0)).expect("it has windows") < 1e-6);
    }
}
