//! Counts how often recorded errors lie inside the predicted bands, and whether they are as large
//! as predicted.

use super::predict::Expected;
use super::window::Nine;
use crate::numerics::special::{chi_squared_quantile, exact_interval, normal_quantile};

/// Central bands, as fractions of the predicted errors that they hold.
pub const BANDS: [f64; 3] = [0.5, 0.9, 0.99];
/// Level of every interval.
const LEVEL: f64 = 0.95;

/// One of the nine errors over all windows of a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Number of windows judged.
    pub windows: usize,
    /// Number that lie inside each of the [`BANDS`].
    pub inside: [usize; 3],
    /// Exact 95 % interval of the share that each of them holds.
    pub interval: [[f64; 2]; 3],
    /// Root mean square of the recorded errors.
    pub rms_recorded: f64,
    /// Standard deviation of the recorded errors (n − 1).
    pub sd_recorded: f64,
    /// Root mean square over the windows of the predicted standard deviation.
    pub sd_predicted: f64,
    /// Mean of the normalised errors squared.
    pub nees: Nees,
}

/// Normalised errors squared, per degree of freedom: one where errors are as large as predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nees {
    /// Degrees of freedom, all windows together.
    pub freedom: usize,
    /// Their mean; not a number where nothing is predicted.
    pub mean: f64,
    /// Interval that it stays within in 95 of 100 cases if the prediction is right: χ² over its
    /// degrees of freedom.
    pub interval: [f64; 2],
}

impl Nees {
    fn new(sum: f64, freedom: usize) -> Self {
        let n = freedom as f64;
        let at = |p: f64| chi_squared_quantile(p, n) / n;
        Self { freedom, mean: sum / n, interval: [at(0.5 - 0.5 * LEVEL), at(0.5 + 0.5 * LEVEL)] }
    }

    /// Returns whether it is what chance allows.
    pub fn is_consistent(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.mean)
    }
}

/// Scores one of the nine.
pub fn axis(errors: &[Nine], expected: &[Expected], place: usize) -> Axis {
    let n = errors.len();
    let sd = |e: &Expected| e.covariance[(place, place)].max(0.0).sqrt();
    let pairs = || errors.iter().zip(expected);
    let normalised: Vec<f64> = pairs().map(|(error, e)| (error[place] - e.mean[place]) / sd(e)).collect();
    let inside = BANDS.map(|share| {
        let most = normal_quantile(0.5 + 0.5 * share);
        normalised.iter().filter(|z| z.abs() <= most).count()
    });
    let mean = errors.iter().map(|e| e[place]).sum::<f64>() / n as f64;
    let squares: f64 = errors.iter().map(|e| (e[place] - mean).powi(2)).sum();
    let rms = |sum: f64| (sum / n as f64).sqrt();
    Axis {
        windows: n,
        inside,
        interval: inside.map(|hits| exact_interval(hits as u64, n as u64, LEVEL)),
        rms_recorded: rms(errors.iter().map(|e| e[place].powi(2)).sum()),
        sd_recorded: (squares / n.saturating_sub(1) as f64).sqrt(),
        sd_predicted: rms(expected.iter().map(|e| e.covariance[(place, place)].max(0.0)).sum()),
        nees: Nees::new(normalised.iter().map(|z| z * z).sum(), n),
    }
}

/// Scores several of the nine together, with what is common to them.
pub fn together(errors: &[Nine], expected: &[Expected], places: std::ops::Range<usize>) -> Nees {
    let (first, count) = (places.start, places.len());
    let one = |(error, e): (&Nine, &Expected)| -> f64 {
        let off = (error - e.mean).rows(first, count).into_owned();
        let covariance = e.covariance.view((first, first), (count, count)).into_owned();
        // Positions, velocities and angles are of very different size: each by its own spread
        // first.
        let scale = covariance.diagonal().map(|v| if v > 0.0 { 1.0 / v.sqrt() } else { f64::NAN });
        let scaled = |m: nalgebra::DMatrix<f64>| {
            nalgebra::DMatrix::from_fn(count, count, |i, j| m[(i, j)] * scale[i] * scale[j])
        };
        let off = off.component_mul(&scale);
        scaled(covariance).cholesky().map_or(f64::NAN, |root| off.dot(&root.solve(&off)))
    };
    Nees::new(errors.iter().zip(expected).map(one).sum(), errors.len() * count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};
    use crate::strapdown::linear::Square;

    /// Errors of a correlated law, and that law with its spread divided by `short`.
    fn drawn(windows: u64, short: f64) -> (Vec<Nine>, Vec<Expected>) {
        let root =
            Square::from_fn(|i, j| if j > i { 0.0 } else { 10f64.powi(2 - i as i32 / 3) / (1.0 + (i - j) as f64) });
        let error = |k: u64| {
            let mut draw = Philox::new(11, k, Stream::Start);
            root * Nine::from_fn(|_, _| draw.normal())
        };
        let covariance = root * root.transpose() / (short * short);
        let expected = Expected { mean: Nine::zeros(), covariance };
        ((0..windows).map(error).collect(), vec![expected; windows as usize])
    }

    #[test]
    fn what_is_predicted_is_found_and_a_third_of_it_is_not() {
        let (errors, expected) = drawn(400, 1.0);
        for place in 0..9 {
            let axis = axis(&errors, &expected, place);
            for (hits, share) in axis.inside.into_iter().zip(BANDS) {
                let [low, high] = exact_interval(hits as u64, 400, 0.9999);
                assert!(low <= share && share <= high, "{place}: {hits} of 400 inside {share}");
            }
            // Five standard errors, √(2/400) each.
            assert!((axis.nees.mean - 1.0).abs() < 5.0 * (2.0f64 / 400.0).sqrt(), "{:?}", axis.nees);
        }
        let all = together(&errors, &expected, 0..9);
        assert!((all.mean - 1.0).abs() < 5.0 * (2.0f64 / 3600.0).sqrt() && all.freedom == 3600, "{all:?}");
        let (errors, expected) = drawn(400, 3.0);
        let axis = axis(&errors, &expected, 0);
        assert!(!axis.nees.is_consistent() && axis.interval[1][1] < 0.9, "{axis:?}");
        assert!(!together(&errors, &expected, 0..9).is_consistent());
    }
}
