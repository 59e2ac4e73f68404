//! Decides whether a reading depends on its input at all, by whatever law.
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

use crate::control::{Control, Stopped};
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
/// Factor by which the log-likelihood that the input adds as it stands must exceed that of any
/// other way.
const BEYOND_CHANCE: f64 = 2.0;
/// Factor over the middle force at which a force is clipped.
const FURTHEST: f64 = 3.0;
/// Columns of the equation that hold the state, and those that hold the input: linearly, and bent.
const STATE: usize = 5;
const LINEAR: usize = 2;
const BENT: usize = 3;
const COLUMNS: usize = STATE + LINEAR + BENT;

/// Contribution that is asked of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Asked {
    /// Anything.
    Anything,
    /// More than a linear law makes of it.
    ABend,
}

/// Returns whether the reading depends on the input.
///
/// # Errors
/// Stopped.
pub(crate) fn depends(
    input: &[f64],
    reading: &[f64],
    among: &Range<usize>,
    control: &Control,
) -> Result<bool, Stopped> {
    let squared: Vec<f64> = input.iter().map(|u| u * u).collect();
    let by_square = || align(&squared, reading, among).is_some_and(|a: Alignment| !a.is_chance());
    Ok(enters_anywhere(input, reading, among, Asked::Anything, control)? || by_square())
}

/// Returns whether the reading depends on the input by a law that bends, whatever a linear one
/// makes of it besides: noise that is loud and has a memory hides a linear answer, and does not
/// bend it.
///
/// # Errors
/// Stopped.
pub(crate) fn bends(input: &[f64], reading: &[f64], among: &Range<usize>, control: &Control) -> Result<bool, Stopped> {
    enters_anywhere(input, reading, among, Asked::ABend, control)
}

/// Returns whether the input enters the equation of motion by weights of any width.
///
/// # Errors
/// Stopped.
fn enters_anywhere(
    input: &[f64],
    reading: &[f64],
    among: &Range<usize>,
    asked: Asked,
    control: &Control,
) -> Result<bool, Stopped> {
    let [u, y] = looked_at(input, reading, among).map(|values| unit(&values));
    let mut sides = vec![SHORTEST];
    while let Some(next) = sides.last().map(|s| 2 * s).filter(|s| y.len() / s >= ROWS_EACH * COLUMNS) {
        sides.push(next);
    }
    let found = parallel::map(&sides, |side| enters(&u, &y, *side, asked, control));
    let entered = found.into_iter().collect::<Result<Vec<bool>, Stopped>>()?;
    control.go_on()?;
    Ok(entered.contains(&true))
}

/// Returns the values without their mean and of unit size.
fn unit(values: &[f64]) -> Vec<f64> {
    let (mean, size) = mean_sd(values);
    values.iter().map(|v| (v - mean) / size.max(1e-300)).collect()
}

/// Returns whether the input enters the equation of motion, by weights of this half width.
///
/// # Errors
/// Stopped.
fn enters(u: &[f64], y: &[f64], side: usize, asked: Asked, control: &Control) -> Result<bool, Stopped> {
    let weak = Weak::new(side);
    let force = weak.sums(y, |k, w| w[2] * y[k]);
    if force.len() < ROWS_EACH * COLUMNS {
        return Ok(false);
    }
    let state: [Vec<f64>; STATE] = [
        weak.sums(y, |k, w| w[1] * y[k]),
        weak.sums(y, |_, w| w[0]),
        weak.sums(y, |k, w| w[0] * y[k]),
        weak.sums(y, |k, w| w[0] * y[k].powi(2)),
        weak.sums(y, |k, w| w[0] * y[k].powi(3)),
    ];
    let linear = |u: &dyn Fn(usize) -> f64| -> [Vec<f64>; LINEAR] {
        [weak.sums(y, |k, w| w[0] * u(k)), weak.sums(y, |k, w| w[1] * u(k))]
    };
    let mut granted = state.to_vec();
    if asked == Asked::ABend {
        granted.extend(linear(&|k| u[k]));
    }
    let around = within(rest(&force, &granted));
    let of_state: f64 = rest(&around, &granted).iter().map(|r| r * r).sum();
    // Where a reading does not show on which side of the middle the mass is, the input pushes it up
    // as often as down, and shows in the size of the residual alone.
    let sizes: Vec<f64> = around.iter().map(|r| r.abs()).collect();
    let constant = vec![1.0; sizes.len()];
    let of_size: f64 = rest(&sizes, std::slice::from_ref(&constant)).iter().map(|r| r * r).sum();
    // Log-likelihood per row that this input adds, to the force and to its size.
    let added = |u: &dyn Fn(usize) -> f64| {
        let linear = linear(u);
        let pushes = [linear[0].iter().map(|p| p.abs()).collect(), linear[0].iter().map(|p| p * p).collect()];
        let bent: [Vec<f64>; BENT] = [
            weak.sums(y, |k, w| w[0] * u(k).powi(2)),
            weak.sums(y, |k, w| w[0] * u(k).abs()),
            weak.sums(y, |k, w| w[0] * u(k) * y[k]),
        ];
        let linear = linear.into_iter().filter(|_| asked == Asked::Anything);
        let columns = linear.chain(bent);
        let gain = |to: &[f64], alone: f64, columns: Vec<Vec<f64>>| {
            let with = Linear { residual: to.to_vec(), columns }.normal().predicted();
            (alone / with.max(1e-300)).ln()
        };
        [
            gain(&around, of_state, granted.iter().cloned().chain(columns).collect()),
            gain(&sizes, of_size, std::iter::once(constant.clone()).chain(pushes).collect()),
        ]
    };
    let ways = PACES.iter().flat_map(|pace| (0..MOMENTS).map(move |moment| (*pace, moment)));
    let otherwise = |(pace, moment): (f64, usize)| {
        let from = u.len() as f64 * (moment as f64 + 0.5) / MOMENTS as f64;
        added(&|k| u[(from + pace * k as f64) as usize % u.len()])
    };
    let mut chance = [0.0f64; 2];
    for way in ways {
        control.go_on()?;
        let by_chance = otherwise(way);
        chance = [0, 1].map(|of| chance[of].max(by_chance[of]));
    }
    Ok(added(&|k| u[k]).iter().zip(chance).any(|(found, chance)| *found > BEYOND_CHANCE * chance))
}

/// Values none of which lies much further out than the middle one: blows at a stop are no measure of
/// what goes on between them.
fn within(mut values: Vec<f64>) -> Vec<f64> {
    let Some(middle) = order::median(values.iter().map(|v| v.abs()).collect()) else { return values };
    let most = FURTHEST * middle;
    values.iter_mut().for_each(|v| *v = v.clamp(-most, most));
    values
}

/// Returns the residual that columns leave of values.
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

    /// Returns the sum of what `of` makes of each sample and its weights, around every `side`-th
    /// sample.
    fn sums(&self, y: &[f64], of: impl Fn(usize, &[f64; 3]) -> f64) -> Vec<f64> {
        let firsts = (0..(y.len() + 1).saturating_sub(self.weights.len())).step_by(self.side);
        let sum = |first: usize| self.weights.iter().enumerate().map(|(j, w)| of(first + j, w)).sum();
        firsts.map(sum).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{Stage, Watcher};
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

    fn depends(input: &[f64], reading: &[f64], among: &Range<usize>) -> bool {
        super::depends(input, reading, among, &Control::silent()).expect("nobody stops it")
    }

    /// Stops whatever asks.
    struct Stops;

    impl Stage for Stops {
        fn set(&self, _: u64) {}
        fn add(&self, _: u64) {}
        fn rename(&self, _: &str) {}
    }

    impl Watcher for Stops {
        fn stopped_by(&self) -> Option<&'static str> {
            Some("a test")
        }
        fn begin(&self, _: &str, _: u64) -> Box<dyn Stage> {
            Box::new(Self)
        }
        fn remark(&self, _: &str) {}
    }

    #[test]
    fn it_ends_when_it_is_stopped() {
        let (u, y) = moved(|x| 4.0 * x);
        assert!(super::depends(&u, &y, &(0..y.len()), &Control::new(Stops)).is_err());
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

    // A reading that is the size of the displacement: on which side the mass is cannot be known.
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
        assert!(bends(&u, &y, &whole, &Control::silent()).is_ok_and(|bent| bent));
        let mut backwards = u.clone();
        backwards.reverse();
        assert!(!depends(&backwards, &y, &whole), "the same input in another order");
    }

    // The first part of the reading's power is the mass's, the rest noise of nine times its size and a
    // memory of ten samples: the negative control of what bends.
    #[test]
    fn a_linear_answer_in_loud_noise_with_a_memory_is_not_bent() {
        for seed in 20..24 {
            let mut rng = Philox::new(seed, 0, Stream::Host);
            let u: Vec<f64> = (0..8000).map(|_| rng.normal()).collect();
            let (mut motion, mut noise) = ([0.0f64; 2], 0.0);
            let y: Vec<f64> = u
                .iter()
                .map(|u| {
                    let now = motion[0];
                    motion = [1.5 * motion[0] - 0.859 * motion[1] + u, now];
                    noise += -0.1 * noise + 0.436 * rng.normal();
                    now + 9.0 * 3.3 * noise
                })
                .collect();
            assert!(bends(&u, &y, &(0..u.len()), &Control::silent()).is_ok_and(|bent| !bent), "seed {seed}");
        }
    }
}
