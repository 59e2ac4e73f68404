//! Noise of a reading, measured apart from every model of the resonator: what seven neighbouring
//! steps leave of a pole.
//!
//! Over a few steps any response near a resonance is (a + bδ)/(c + δ) of the distance δ in
//! frequency, exactly so for a linear one; polynomials would take the resonance itself for noise.

use nalgebra::{Complex, Matrix3, Vector3};

use crate::numerics::order;

use super::intake::Sweeps;
use super::pole::{Local, pole};

/// Steps on either side.
const HALF: usize = 3;
/// Median of χ² of eight degrees of freedom over its mean: fourteen numbers less six that are fitted.
const MEDIAN: f64 = 0.918;
/// Standard error of that median of one value over the mean: 1.25 of √(2/8).
const SCATTER: f64 = 0.63;
/// Numbers of a window, and how many of them are free.
const NUMBERS: f64 = 14.0;
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

/// The largest standard deviation that a measured one may stand for, by one standard error: the median of n
/// values of χ²₈ over its mean scatters by 0.63/√n, and windows that share no step are as many as there
/// are sevens of steps.
pub(super) fn allowed(deviation: f64, steps: usize) -> f64 {
    deviation * (1.0 + SCATTER * (FREE / freedom(steps)).sqrt()).sqrt()
}

/// Free numbers of the windows that share no step.
pub(super) fn freedom(steps: usize) -> f64 {
    FREE * (steps as f64 / (2 * HALF + 1) as f64).max(1.0)
}

/// Variance of a component after the best pole is subtracted.
fn left(frequency_hz: &[f64], reading: &[Complex<f64>]) -> Option<f64> {
    let local = Local::about(frequency_hz[HALF], frequency_hz)?;
    let points: Vec<(f64, Complex<f64>)> =
        frequency_hz.iter().map(|f| local.at(*f)).zip(reading.iter().copied()).collect();
    let pole = pole(&points)?;
    // The better one of A + B/(c + δ) and a parabola: where noise alone is seen, no pole is.
    let one = Complex::new(1.0, 0.0);
    let shapes: [&dyn Fn(f64) -> Vector3<Complex<f64>>; 2] =
        [&|delta| Vector3::new(one, one / (pole.from + delta), Complex::new(0.0, 0.0)), &|delta| {
            Vector3::new(one, one * delta, one * (delta * delta))
        }];
    let left: Vec<f64> = shapes.into_iter().filter_map(|shape| least_squares(&points, shape)).collect();
    let variance = weighed(&left)? / FREE;
    variance.is_finite().then_some(variance)
}

/// Mean of sums of squares, each with its likelihood S^(−N/2) as the weight: the least one alone would be too small
/// where both shapes are right.
fn weighed(left: &[f64]) -> Option<f64> {
    let best = left.iter().copied().reduce(f64::min)?;
    let weight = |sum: &f64| if *sum > 0.0 { (best / sum).powf(0.5 * NUMBERS) } else { 1.0 };
    let (sum, weights) = left.iter().fold((0.0, 0.0), |(s, w), one| (s + weight(one) * one, w + weight(one)));
    Some(sum / weights)
}

/// Sum of squares that a combination of three shapes leaves.
fn least_squares(points: &[(f64, Complex<f64>)], shape: &dyn Fn(f64) -> Vector3<Complex<f64>>) -> Option<f64> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (delta, y) in points {
        let row = shape(*delta);
        normal += row.conjugate() * row.transpose();
        right += row.conjugate() * *y;
    }
    // A shape that is nothing takes no part.
    for i in 0..3 {
        if normal[(i, i)].re == 0.0 {
            normal[(i, i)] = Complex::new(1.0, 0.0);
        }
    }
    let solved = normal.lu().solve(&right)?;
    let sum: f64 = points.iter().map(|(delta, y)| (shape(*delta).dot(&solved) - y).norm_sqr()).sum();
    sum.is_finite().then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// A resonance of eight steps to its width on a background with this slope per Hz, with white noise.
    fn resonance(noise: f64, slope: f64) -> Sweeps {
        let mut rng = Philox::new(5, 0, Stream::Host);
        let frequency_hz: Vec<f64> = (0..120).map(|k| 100.0 + 0.01 * f64::from(k)).collect();
        let reading = frequency_hz.iter().map(|f| {
            let resonance = Complex::new(0.04, 0.0) / Complex::new(100.6 - f, 0.04);
            resonance + (f - 100.0) * slope + 0.2 + Complex::new(rng.normal(), rng.normal()) * noise
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

    #[test]
    fn the_shape_that_is_right_counts() {
        // Where one shape is right and the other wrong, the right one counts; where both are, their mean.
        assert!(weighed(&[1.0, 9.0]).is_some_and(|w| (w - 1.0).abs() < 1e-5));
        assert_eq!(weighed(&[2.0, 2.0]), Some(2.0));
        assert!(weighed(&[]).is_none());
    }

    // The standard deviation that was put in, within what 114 windows of 8 free numbers allow. A
    // resonance on a constant background is a pole and leaves nothing; on a slope it is none, and leaves
    // less than the least noise that is measured here.
    #[test]
    fn white_noise_is_measured_on_a_resonance() {
        let measured = |noise: f64, slope: f64| deviation(&resonance(noise, slope)).expect("it has windows");
        for noise in [1e-4, 1e-2] {
            assert!((measured(noise, 0.1) / noise - 1.0).abs() < 0.2, "{noise}: {}", measured(noise, 0.1));
        }
        assert!(measured(0.0, 0.0) < 1e-9, "{}", measured(0.0, 0.0));
        assert!(measured(0.0, 0.1) < 1e-4, "{}", measured(0.0, 0.1));
    }
}
