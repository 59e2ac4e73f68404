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
/// Free numbers of a window.
const FREE: f64 = 8.0;

/// Standard deviation of X and of Y; `None` where no seven steps follow one another.
pub(super) fn deviation(sweeps: &Sweeps) -> Option<f64> {
    let mut all = Vec::new();
    for sweep in sweeps.sweeps.iter().filter(|_| sweeps.is_ordered) {
        let middles = sweep.start + HALF..sweep.end.saturating_sub(HALF);
        let windows = middles.map(|k| k - HALF..k + HALF + 1);
        let left: Vec<Option<[f64; 2]>> = windows
            .map(|window| {
                let counts = window.clone().all(|j| sweeps.counts[j]);
                counts.then(|| left(&sweeps.frequency_hz[window.clone()], &sweeps.reading[window]))?
            })
            .collect();
        let of = |k: usize| Some(left[k]?[right_shape(&left, k)?] / FREE);
        all.extend((0..left.len()).filter_map(of).filter(|variance| variance.is_finite()));
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

/// Sums of squares that either shape leaves of a window: A + B/(c + δ) with the best pole, and a parabola, as where noise
/// alone is seen no pole is.
fn left(frequency_hz: &[f64], reading: &[Complex<f64>]) -> Option<[f64; 2]> {
    let local = Local::about(frequency_hz[HALF], frequency_hz)?;
    let points: Vec<(f64, Complex<f64>)> =
        frequency_hz.iter().map(|f| local.at(*f)).zip(reading.iter().copied()).collect();
    let pole = pole(&points)?;
    let one = Complex::new(1.0, 0.0);
    let nothing = Complex::new(0.0, 0.0);
    let of_pole = least_squares(&points, &|delta| Vector3::new(one, one / (pole.from + delta), nothing));
    let of_parabola = least_squares(&points, &|delta| Vector3::new(one, one * delta, one * (delta * delta)));
    Some([of_pole.unwrap_or(f64::INFINITY), of_parabola.unwrap_or(f64::INFINITY)])
}

/// The shape that leaves less of the windows next to this one, which share no step with it: chosen by its own steps, the
/// less of two would be too small. `None` where neither shape fits.
fn right_shape(left: &[Option<[f64; 2]>], window: usize) -> Option<usize> {
    let next = 2 * HALF + 1;
    let beside = [window.checked_sub(next), window.checked_add(next)].into_iter().flatten();
    let sums: Vec<[f64; 2]> = beside.filter_map(|k| *left.get(k)?).collect();
    let of = |shape: usize| match sums.is_empty() {
        true => left[window].map_or(f64::INFINITY, |own| own[shape]),
        false => sums.iter().map(|sums| sums[shape]).sum(),
    };
    let best = usize::from(of(1) < of(0));
    of(best).is_finite().then_some(best)
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
        drawn(0, noise, slope)
    }

    fn drawn(seed: u64, noise: f64, slope: f64) -> Sweeps {
        let mut rng = Philox::new(5, seed, Stream::Host);
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

    // Of one sweep the deviation scatters by half of 0.63/√(114/7), 8 %, and of 40 their mean by 1.2 %: within three.
    #[test]
    fn over_many_sweeps_the_noise_is_not_too_small() {
        let ratio = |seed: u64| deviation(&drawn(seed, 1e-2, 0.1)).expect("it has windows") / 1e-2;
        let mean = (0..40).map(ratio).sum::<f64>() / 40.0;
        assert!((mean - 1.0).abs() < 0.037, "{mean}");
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
