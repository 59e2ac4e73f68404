//! States where a simulation is begun anew, and from what: for responses that forget where they
//! began before a recording is over.

use std::ops::Range;

use crate::numerics::least_squares::Linear;
use crate::numerics::moments::mean_sd;

/// Samples on either side through which a polynomial is laid, at most.
const MOST_SIDE: usize = 12;

/// Windows, each simulated from a state of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Windows {
    /// First samples, ascending.
    starts: Vec<usize>,
    /// Reading, smoothed, at each sample of the recording.
    level: Vec<f64>,
    /// Its slope, per second.
    slope: Vec<f64>,
    /// Small steps of displacement and velocity, for derivatives.
    pub nudge: [f64; 2],
    /// A force that describes the motion without any simulation.
    pub force: Force,
}

/// A base model and a force of third degree about its place of rest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Force {
    /// Parameters of the base model.
    pub base: Vec<f64>,
    /// Coefficient of x² in the restoring force per unit mass.
    pub quadratic: f64,
    /// Coefficient of x³ in the restoring force per unit mass.
    pub cubic: f64,
}

/// The readings that windows are laid over.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Readings, one per sample.
    pub reading: &'a [f64],
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Length of the longest window, samples.
    pub length: usize,
    /// Samples of a cycle of the response.
    pub cycle: f64,
}

impl Windows {
    /// Windows of at most `length` samples that end wherever one of these stretches begins or ends.
    pub fn over(c: &Course<'_>, stretches: &[&[Range<usize>]], force: Force) -> Self {
        let n = c.reading.len();
        let mut edges: Vec<usize> = stretches.iter().flat_map(|s| s.iter()).flat_map(|r| [r.start, r.end]).collect();
        edges.extend([0, n]);
        edges.sort_unstable();
        edges.dedup();
        let mut starts = Vec::new();
        for pair in edges.windows(2) {
            let (from, length) = (pair[0], pair[1] - pair[0]);
            let count = length.div_ceil(c.length.max(1)).max(1);
            starts.extend((0..count).map(|i| from + length * i / count));
        }
        let side = ((0.08 * c.cycle) as usize).clamp(2, MOST_SIDE);
        let (level, slope) = smoothed(c.reading, side, c.rate_hz);
        let nudge = [mean_sd(c.reading).1, mean_sd(&slope).1].map(|size| 1e-4 * size.max(1e-300));
        Self { starts, level, slope, nudge, force }
    }

    /// Parts of a range, one for each window that it touches.
    pub fn parts(&self, range: &Range<usize>) -> Vec<Range<usize>> {
        let inside = self.starts.iter().copied().filter(|s| *s > range.start && *s < range.end);
        let starts: Vec<usize> = std::iter::once(range.start).chain(inside).collect();
        let ends = starts[1..].iter().copied().chain([range.end]);
        starts.iter().copied().zip(ends).map(|(a, b)| a..b).collect()
    }

    /// Reading and its slope at a sample, smoothed.
    pub fn state(&self, sample: usize) -> [f64; 2] {
        [self.level[sample], self.slope[sample]]
    }
}

/// Local parabolas: value and slope at each sample. At the ends the nearest whole one is used.
fn smoothed(y: &[f64], side: usize, rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
    let n = y.len();
    let width = 2 * side + 1;
    if n < width {
        return (y.to_vec(), vec![0.0; n]);
    }
    let at: Vec<f64> = (0..width).map(|j| j as f64 - side as f64).collect();
    let columns =
        vec![vec![1.0; width], at.clone(), at.iter().map(|t| t * t).collect(), at.iter().map(|t| t.powi(3)).collect()];
    // Weights of value, slope and bend of the cubic through a unit reading at each place.
    let inverse = Linear { residual: vec![0.0; width], columns: columns.clone() }.normal().inverse(0.0);
    let Some(inverse) = inverse else { return (y.to_vec(), vec![0.0; n]) };
    let weights = |row: usize| -> Vec<f64> {
        (0..width).map(|j| (0..columns.len()).map(|c| inverse[(row, c)] * columns[c][j]).sum()).collect()
    };
    let rows: Vec<Vec<f64>> = (0..columns.len()).map(weights).collect();
    let (mut level, mut slope) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for k in 0..n {
        let centre = k.clamp(side, n - 1 - side);
        let part = &y[centre - side..=centre + side];
        let p: Vec<f64> = rows.iter().map(|w| w.iter().zip(part).map(|(w, y)| w * y).sum()).collect();
        let t = k as f64 - centre as f64;
        level.push(p[0] + t * (p[1] + t * (p[2] + t * p[3])));
        slope.push((p[1] + t * (2.0 * p[2] + 3.0 * t * p[3])) * rate_hz);
    }
    (level, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    // A cubic is its own local cubic: value and slope are exact, at the ends too.
    #[test]
    fn windows_begin_at_edges_and_states_are_those_of_a_cubic() {
        let y: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k * k) - 1e-4 * f64::from(k * k * k)).collect();
        let c = Course { reading: &y, rate_hz: 2.0, length: 30, cycle: 60.0 };
        let windows = Windows::over(&c, &[std::slice::from_ref(&(20..60))], Force::default());
        assert_eq!(windows.starts, [0, 20, 40, 60, 80]);
        assert_eq!(windows.parts(&(10..70)), [10..20, 20..40, 40..60, 60..70]);
        for k in [0, 3, 50, 99] {
            let t = k as f64;
            let exact = [0.01 * t * t - 1e-4 * t.powi(3), 2.0 * (0.02 * t - 3e-4 * t * t)];
            let got = windows.state(k);
            assert!((got[0] - exact[0]).abs() < 1e-8 && (got[1] - exact[1]).abs() < 1e-7, "{k}: {got:?} {exact:?}");
        }
    }
}
