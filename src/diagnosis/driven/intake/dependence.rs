//! Whether a reading depends on its input at all, by whatever law.
//!
//! An oscillator far from its linear range follows its input by no linear law: each answer depends
//! on where the mass is. But wherever it is, the input enters its equation of motion. Multiplied by
//! a smooth weight that vanishes at both ends and integrated by parts, that equation holds for the
//! readings themselves, without derivatives of noise (the weak form: Messenger & Bortz, J. Comput.
//! Phys. 443, 2021). What the input adds there to a force of displacement and velocity is compared
//! with what the same input adds when it is played faster or slower and from another moment on,
//! which shows how much it would add by chance. Not for which law it is, and not for any number in
//! the verdict.

use std::ops::Range;

use crate::numerics::least_squares::Linear;
use crate::numerics::moments::mean_sd;
use crate::numerics::order;
use crate::parallel;

use super::alignment::{Alignment, align, looked_at};

/// Half widths of the weights, in samples; each is twice the one before.
const SHORTEST: usize = 4;
/// Fewest rows of the weighted equation per coefficient.
const ROWS_EACH: usize = 12;
/// Paces at which the input is played otherwise, and moments from which on.
const PACES: [f64; 8] = [0.8, 0.84, 0.88, 0.93, 1.07, 1.12, 1.17, 1.23];
const MOMENTS: usize = 5;
/// How many times more log-likelihood the input must add as it stands than any other way.
const BEYOND_CHANCE: f64 = 2.0;
/// How many times further out than the middle one a force counts.
const FURTHEST: f64 = 3.0;
/// Columns of the equation that hold the state, and those that hold the input.
const STATE: usize = 5;
const INPUT: usize = 5;

/// Whether the reading depends on the input.
pub(crate) fn depends(input: &[f64], reading: &[f64], among: &Range<usize>) -> bool {
    let [u, y] = looked_at(input, reading, among).map(|values| unit(&values));
    let squared: Vec<f64> = input.iter().map(|u| u * u).collect();
    let by_square = || align(&squared, reading, among).is_some_and(|a: Alignment| !a.is_chance());
    let mut sides = vec![SHORTEST];
    while let Some(next) = sides.last().map(|s| 2 * s).filter(|s| y.len() / s >= ROWS_EACH * (STATE + INPUT)) {
        sides.push(next);
    }
    parallel::map(&sides, |side| enters(&u, &y, *side)).into_iter().any(|found| found) || by_square()
}

/// Without mean and of unit size.
fn unit(values: &[f64]) -> Vec<f64> {
    let (mean, size) = mean_sd(values);
    values.iter().map(|v| (v - mean) / size.max(1e-300)).collect()
}

/// Whether the input enters the equation of motion, by weights of this half width.
fn enters(u: &[f64], y: &[f64], side: usize) -> bool {
    let weak = Weak::new(side);
    let force = weak.sums(y, |k, w| w[2] * y[k]);
    if force.len() < ROWS_EACH * (STATE + INPUT) {
        return false;
    }
    let state: [Vec<f64>; STATE] = [
        weak.sums(y, |k, w| w[1] * y[k]),
        weak.sums(y, |_, w| w[0]),
        weak.sums(y, |k, w| w[0] * y[k]),
        weak.sums(y, |k, w| w[0] * y[k].powi(2)),
        weak.sums(y, |k, w| w[0] * y[k].powi(3)),
    ];
    let around = within(rest(&force, &state));
    let of_state: f64 = rest(&around, &state).iter().map(|r| r * r).sum();
    // Where a reading does not tell on which side of the middle the mass is, the input pushes it up
    // as often as down, and shows in the size of what is left alone.
    let sizes: Vec<f64> = around.iter().map(|r| r.abs()).collect();
    let constant = vec![1.0; sizes.len()];
    let of_size: f64 = rest(&sizes, std::slice::from_ref(&constant)).iter().map(|r| r * r).sum();
    // Log-likelihood per row that this input adds, to the force and to its size.
    let added = |u: &dyn Fn(usize) -> f64| {
        let push = weak.sums(y, |k, w| w[0] * u(k));
        let pushes = [push.iter().map(|p| p.abs()).collect(), push.iter().map(|p| p * p).collect()];
        let columns: [Vec<f64>; INPUT] = [
            push,
            weak.sums(y, |k, w| w[1] * u(k)),
            weak.sums(y, |k, w| w[0] * u(k).powi(2)),
            weak.sums(y, |k, w| w[0] * u(k).abs()),
            weak.sums(y, |k, w| w[0] * u(k) * y[k]),
        ];
        let gain = |to: &[f64], alone: f64, columns: Vec<Vec<f64>>| {
            let with = Linear { residual: to.to_vec(), columns }.normal().predicted();
            (alone / with.max(1e-300)).ln()
        };
        [
            gain(&around, of_state, state.iter().cloned().chain(columns).collect()),
            gain(&sizes, of_size, std::iter::once(constant.clone()).chain(pushes).collect()),
        ]
    };
    let ways = PACES.iter().flat_map(|pace| (0..MOMENTS).map(move |moment| (*pace, moment)));
    let otherwise = |(pace, moment): (f64, usize)| {
        let from = u.len() as f64 * (moment as f64 + 0.5) / MOMENTS as f64;
        added(&|k| u[(from + pace * k as f64) as usize % u.len()])
    };
    let chance = ways.map(otherwise).fold([0.0; 2], |a: [f64; 2], b| [a[0].max(b[0]), a[1].max(b[1])]);
    added(&|k| u[k]).iter().zip(chance).any(|(found, chance)| *found > BEYOND_CHANCE * chance)
}

/// Values none of which lies much further out than the middle one: blows at a stop are no measure of
/// what goes on between them.
fn within(mut values: Vec<f64>) -> Vec<f64> {
    let Some(middle) = order::median(values.iter().map(|v| v.abs()).collect()) else { return values };
    let most = FURTHEST * middle;
    values.iter_mut().for_each(|v| *v = v.clamp(-most, most));
    values
}

/// What columns leave of values.
fn rest(values: &[f64], columns: &[Vec<f64>]) -> Vec<f64> {
    let step = Linear { residual: values.to_vec(), columns: columns.to_vec() }.normal().step(1e-9);
    let left = |(k, value): (usize, &f64)| value + columns.iter().zip(step.iter()).map(|(c, s)| c[k] * s).sum::<f64>();
    values.iter().enumerate().map(left).collect()
}

/// A weight and its first two derivatives by time, in samples, side by side.
struct Weak {
    side: usize,
    weights: Vec<[f64; 3]>,
}

impl Weak {
    /// (1 − s²)⁶.
    fn new(side: usize) -> Self {
        let half = side as f64;
        let weight = |j: usize| {
            let s = j as f64 / half - 1.0;
            let q = 1.0 - s * s;
            let second = -12.0 * q.powi(5) + 120.0 * s * s * q.powi(4);
            [q.powi(6), -12.0 * s * q.powi(5) / half, second / (half * half)]
        };
        Self { side, weights: (0..=2 * side).map(weight).collect() }
    }

    /// What `of` a sample and its weights comes to, around every `side`-th sample.
    fn sums(&self, y: &[f64], of: impl Fn(usize, &[f64; 3]) -> f64) -> Vec<f64> {
        let firsts = (0..(y.len() + 1).saturating_sub(self.weights.len())).step_by(self.side);
        let sum = |first: usize| self.weights.iter().enumerate().map(|(j, w)| of(first + j, w)).sum();
        firsts.map(sum).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// x″ + 0.2x′ + pull(x) = u at 20 samples per unit of time under a dozen sines, by RK4; 1 % of
    /// noise.
    fn moved(pull: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let force = |t: f64| (0..12).map(|i| 0.4 * ((0.3 + 0.17 * f64::from(i)) * t + f64::from(i * i)).cos()).sum();
        let (h, mut s) = (0.01, [1.0, 0.0]);
        let slope = |t: f64, [x, v]: [f64; 2]| {
            let u: f64 = force(t);
            [v, u - 0.2 * v - pull(x)]
        };
        let mut rng = Philox::new(8, 0, Stream::Host);
        let (mut u, mut y) = (Vec::new(), Vec::new());
        for k in 0..15_000 {
            let t = f64::from(k) * h;
            if k % 5 == 0 {
                u.push(force(t));
                y.push(s[0] + 0.01 * rng.normal());
            }
            let ahead = |r: [f64; 2], h: f64| [s[0] + h * r[0], s[1] + h * r[1]];
            let k1 = slope(t, s);
            let k2 = slope(t + 0.5 * h, ahead(k1, 0.5 * h));
            let k3 = slope(t + 0.5 * h, ahead(k2, 0.5 * h));
            let k4 = slope(t + h, ahead(k3, h));
            s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        (u, y)
    }

    #[test]
    fn a_mass_that_jumps_between_wells_depends_on_its_force_and_not_on_another() {
        let (u, y) = moved(|x| x.powi(3) - x);
        let (_, other) = moved(|x| 4.0 * x + x.powi(3));
        let whole = 0..y.len();
        assert!(depends(&u, &y, &whole) && depends(&u, &other, &whole));
        // The negative controls: sines at other frequencies, as smooth and as loud; noise.
        let sines = |i: usize| (0..12).map(|j| ((0.385 + 0.17 * j as f64) * 0.05 * i as f64).sin()).sum();
        let foreign: Vec<f64> = (0..y.len()).map(sines).collect();
        let mut rng = Philox::new(9, 0, Stream::Host);
        let noise: Vec<f64> = (0..y.len()).map(|_| rng.normal()).collect();
        for stranger in [&foreign, &noise] {
            assert!(!depends(stranger, &y, &whole));
        }
        assert!(!depends(&u, &noise, &whole));
    }

    // A reading that is the size of the displacement: on which side the mass is cannot be told.
    #[test]
    fn a_reading_without_a_sign_depends_on_its_input() {
        let (u, y) = moved(|x| 4.0 * x);
        let y: Vec<f64> = y.iter().map(|y| y.abs()).collect();
        let whole = 0..y.len();
        assert!(depends(&u, &y, &whole));
        let mut rng = Philox::new(11, 0, Stream::Host);
        let noise: Vec<f64> = (0..y.len()).map(|_| rng.normal()).collect();
        assert!(!depends(&noise, &y, &whole), "noise moved nothing");
    }

    // A force that goes with the square of the input: its oscillator answers at sums and
    // differences of the lines only.
    #[test]
    fn what_follows_the_square_of_its_input_depends_on_it() {
        let mut rng = Philox::new(10, 0, Stream::Host);
        let u: Vec<f64> = (0..3000).map(|_| rng.normal()).collect();
        let mut y = vec![0.0; u.len()];
        for k in 2..u.len() {
            y[k] = 1.95 * y[k - 1] - 0.98 * y[k - 2] + 0.03 * u[k - 1] * u[k - 1];
        }
        let whole = 0..u.len();
        assert!(depends(&u, &y, &whole));
        let mut backwards = u.clone();
        backwards.reverse();
        assert!(!depends(&backwards, &y, &whole), "the same input in another order");
    }
}
