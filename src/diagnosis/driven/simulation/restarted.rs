//! A model run in windows, each from the state that fits its readings best: for chaotic responses,
//! whose free simulation parts from any recording however true the model is.
//!
//! The state of each window is found by Gauss and Newton's method, so that errors and their
//! derivatives are those of the model alone (variable projection: Golub & Pereyra, SIAM J. Numer.
//! Anal. 10, 1973; multiple shooting without the continuity: Voss, Timmer & Kurths, Int. J.
//! Bifurcation Chaos 14, 2004). As innovations stand the recursive residuals (Brown, Durbin &
//! Evans, J. R. Stat. Soc. B 37, 1975): each sample against what the samples before it in the
//! window and the model predict, over the standard deviation of that forecast. They have the same
//! sum of squares and are white where the noise is.

use crate::driven::intake::data::Data;
use crate::driven::intake::windows::Windows;
use crate::physics::state::{LANES, Lanes};

use super::filter::{Beginning, Keep, Nothing};
use super::once::{Run, lane, once};
use super::structure::ModelStructure;

/// Steps by Gauss and Newton towards the state of a window.
const STEPS: usize = 2;
/// Determinant of the information on a state, relative to its diagonal, below which nothing is
/// predicted yet.
const UNKNOWN: f64 = 1e-9;

/// Errors of one point, and their derivatives by displacement and velocity at the beginning of
/// their window, per nudge.
struct Errors {
    error: Vec<f64>,
    slopes: [Vec<f64>; 2],
}

/// Does the same as [`super::run::innovations`], in windows.
pub fn innovations<K: Keep>(
    data: &Data,
    structure: &ModelStructure,
    points: &[Vec<f64>],
    run: &Run,
    windows: &Windows,
    keep: &mut K,
) -> Vec<Lanes> {
    let parts = windows.parts(&run.range);
    let at: Vec<usize> = parts.iter().map(|p| p.start).collect();
    let first = |point: &Vec<f64>| -> Vec<[f64; 2]> {
        let state = |k: &usize| {
            let [level, slope] = windows.state(*k);
            [level - point[structure.offset(recording(data, structure, *k))], slope]
        };
        at.iter().map(state).collect()
    };
    let mut states: Vec<Vec<[f64; 2]>> = points.iter().map(first).collect();
    let mut errors = Vec::new();
    for step in 0..=STEPS {
        errors = looked(data, structure, points, &states, run, windows, &at);
        if step == STEPS {
            break;
        }
        for (state, found) in states.iter_mut().zip(&errors) {
            for (state, part) in state.iter_mut().zip(&parts) {
                let rows = part.start - run.range.start..part.end - run.range.start;
                let mut sums = Information::default();
                rows.for_each(|k| sums.add([found.slopes[0][k], found.slopes[1][k]], found.error[k]));
                let step = sums.estimate().unwrap_or([0.0; 2]);
                // No further than the linear step is worth: a state is known to a few per cent of
                // its size.
                for (i, s) in state.iter_mut().enumerate() {
                    *s += step[i].clamp(-3e3, 3e3) * windows.nudge[i];
                }
            }
        }
    }
    // What is kept is seen along the states found.
    if let Some(point) = points.first() {
        let point = std::slice::from_ref(point);
        once(data, structure, point, run, begun(data, structure, point, &at, &states), keep);
    }
    let mut out = vec![[0.0; LANES]; run.range.len()];
    for l in 0..LANES {
        let found = &errors[l.min(errors.len() - 1)];
        if !run.corrected {
            out.iter_mut().zip(&found.error).for_each(|(o, e)| o[l] = *e);
            continue;
        }
        for part in &parts {
            let rows = part.start - run.range.start..part.end - run.range.start;
            let mut sums = Information::default();
            for k in rows {
                let slope = [found.slopes[0][k], found.slopes[1][k]];
                out[k][l] = sums.surprise(slope, found.error[k]);
                sums.add(slope, found.error[k]);
            }
        }
    }
    out
}

/// Errors at each point from these states, with their derivatives: three lanes for each.
fn looked(
    data: &Data,
    structure: &ModelStructure,
    points: &[Vec<f64>],
    states: &[Vec<[f64; 2]>],
    run: &Run,
    windows: &Windows,
    at: &[usize],
) -> Vec<Errors> {
    let jobs: Vec<(usize, Option<usize>)> =
        (0..points.len()).flat_map(|p| [None, Some(0), Some(1)].map(|side| (p, side))).collect();
    let mut columns: Vec<Vec<f64>> = Vec::with_capacity(jobs.len());
    for group in jobs.chunks(LANES) {
        let here: Vec<Vec<f64>> = group.iter().map(|(p, _)| points[*p].clone()).collect();
        let moved: Vec<Vec<[f64; 2]>> = group
            .iter()
            .map(|(p, side)| {
                let mut state = states[*p].clone();
                if let Some(side) = side {
                    state.iter_mut().for_each(|s| s[*side] += windows.nudge[*side]);
                }
                state
            })
            .collect();
        let lanes = once(data, structure, &here, run, begun(data, structure, &here, at, &moved), &mut Nothing);
        columns.extend((0..group.len()).map(|l| lanes.iter().map(|e| e[l]).collect::<Vec<f64>>()));
    }
    let mut columns = columns.into_iter();
    let mut next = || columns.next().unwrap_or_default();
    points
        .iter()
        .map(|_| {
            let (error, mut slopes) = (next(), [next(), next()]);
            for slope in &mut slopes {
                slope.iter_mut().zip(&error).for_each(|(s, e)| *s -= e);
            }
            Errors { error, slopes }
        })
        .collect()
}

/// Windows that begin from these states, a point in each lane.
fn begun(
    data: &Data,
    structure: &ModelStructure,
    points: &[Vec<f64>],
    at: &[usize],
    states: &[Vec<[f64; 2]>],
) -> Vec<Beginning> {
    let initial = |window: usize, side: usize| {
        let state = |l: usize| states.get(l).or(states.last()).and_then(|s| s.get(window)).map_or(0.0, |s| s[side]);
        std::array::from_fn(state)
    };
    let one = |(window, sample): (usize, &usize)| {
        let recording = recording(data, structure, *sample);
        let offset = lane(points, structure.offset(recording));
        Beginning { sample: *sample, recording, offset, initial: [initial(window, 0), initial(window, 1)] }
    };
    at.iter().enumerate().map(one).collect()
}

/// Returns in which of the recordings that the parameters know a sample lies.
fn recording(data: &Data, structure: &ModelStructure, sample: usize) -> usize {
    data.breaks.iter().take(structure.further).filter(|b| **b <= sample).count()
}

/// Information that the samples seen so far hold on the state of their window, in nudges.
#[derive(Debug, Clone, Copy, Default)]
struct Information {
    matrix: [f64; 3],
    vector: [f64; 2],
}

impl Information {
    fn add(&mut self, [a, b]: [f64; 2], error: f64) {
        self.matrix[0] += a * a;
        self.matrix[1] += a * b;
        self.matrix[2] += b * b;
        self.vector[0] += a * error;
        self.vector[1] += b * error;
    }

    /// The inverse of the information; `None` while it holds nothing on one of the two.
    fn inverse(&self) -> Option<[f64; 3]> {
        let [aa, ab, bb] = self.matrix;
        let determinant = aa * bb - ab * ab;
        (determinant.is_finite() && determinant > UNKNOWN * aa * bb).then(|| [bb, -ab, aa].map(|v| v / determinant))
    }

    /// The step of the state that leaves least.
    fn estimate(&self) -> Option<[f64; 2]> {
        let [aa, ab, bb] = self.inverse()?;
        let [a, b] = self.vector;
        Some([-(aa * a + ab * b), -(ab * a + bb * b)])
    }

    /// An error against its forecast, over the standard deviation of that; zero while there is
    /// none.
    fn surprise(&self, [a, b]: [f64; 2], error: f64) -> f64 {
        let Some(([aa, ab, bb], [da, db])) = self.inverse().zip(self.estimate()) else { return 0.0 };
        (error + a * da + b * db) / (1.0 + aa * a * a + 2.0 * ab * a * b + bb * b * b).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    // Errors e = noise − a·s₁ − b·s₂ of a state that is off by s: the recursive residuals do not
    // see s, have the sum of squares of the noise after its projection, and are white.
    #[test]
    fn recursive_residuals_forget_the_state_and_keep_the_sum_of_squares() {
        let mut rng = Philox::new(3, 0, Stream::Host);
        let noise: Vec<f64> = (0..200).map(|_| rng.normal()).collect();
        let slope = |k: usize| [(0.1 * k as f64).cos() * (0.01 * k as f64).exp(), (0.1 * k as f64).sin()];
        let off = |s: [f64; 2]| -> Vec<f64> {
            noise.iter().enumerate().map(|(k, e)| e - slope(k)[0] * s[0] - slope(k)[1] * s[1]).collect()
        };
        let recursive = |errors: &[f64]| -> Vec<f64> {
            let mut sums = Information::default();
            let one = |(k, e): (usize, &f64)| {
                let w = sums.surprise(slope(k), *e);
                sums.add(slope(k), *e);
                w
            };
            errors.iter().enumerate().map(one).collect()
        };
        let (plain, moved) = (recursive(&noise), recursive(&off([50.0, -20.0])));
        let worst = plain.iter().zip(&moved).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-6, "{worst}");
        let mut sums = Information::default();
        noise.iter().enumerate().for_each(|(k, e)| sums.add(slope(k), *e));
        let [da, db] = sums.estimate().expect("200 samples say where two numbers are");
        let residual: f64 =
            noise.iter().enumerate().map(|(k, e)| (e + slope(k)[0] * da + slope(k)[1] * db).powi(2)).sum();
        let sum: f64 = plain.iter().map(|w| w * w).sum();
        assert!((sum / residual - 1.0).abs() < 1e-9, "{sum} {residual}");
    }
}
