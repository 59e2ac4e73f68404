//! The input as it acts on the mass: late where the reading is late, early where it was recorded
//! late.
//!
//! A smooth input is shifted by interpolation on its own grid. A held one jumps within a step then:
//! it stands there for the parabola with its first three moments, so that the mass receives the
//! impulse of the jump when and as large as it comes.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::numerics::lagrange;
use crate::physics::state::{LANES, Lanes};

/// Samples on half steps, `2·steps` per sample, and how late they act.
pub(super) struct Acting<'a> {
    /// Empty without an input.
    grid: &'a [f64],
    steps: usize,
    /// Grid points before the end of a step at which its last value is read.
    end: usize,
    delay: Option<Delay>,
}

enum Delay {
    Smooth(Box<Shift>),
    /// Step by step of a sample.
    Held(Vec<Jump>),
}

/// A delay in grid points: a whole part, and cubic Lagrange weights for the rest.
struct Shift {
    whole: isize,
    /// Weights of the four nodes around the rest.
    weights: [Lanes; 4],
}

impl Shift {
    fn new(delay_s: &Lanes, spacing_s: f64) -> Self {
        let whole = (delay_s[0] / spacing_s).ceil();
        let mut weights = [[0.0; LANES]; 4];
        for l in 0..LANES {
            // Position right of the node `index − whole`, normally in [0, 1).
            let t = whole - delay_s[l] / spacing_s;
            let nodes = lagrange::cubic(t);
            (0..4).for_each(|node| weights[node][l] = nodes[node]);
        }
        Self { whole: whole as isize, weights }
    }
}

/// The step within which a held input may jump.
struct Jump {
    /// Sample that acts at its beginning, from the one at hand.
    before: [isize; LANES],
    /// Part of the way to the next sample at the beginning, in the middle and at the end of the
    /// parabola.
    rise: [Lanes; 3],
}

impl Jump {
    /// Builds it for one of the steps that make a sample.
    fn new(delay_samples: &Lanes, step: usize, steps: usize) -> Self {
        let (mut before, mut rise) = ([0; LANES], [[0.0; LANES]; 3]);
        for l in 0..LANES {
            let place = step as f64 / steps as f64 - delay_samples[l];
            before[l] = place.floor() as isize;
            // Part of the step that has gone by at the jump; at its end there is none in it.
            let s = ((1.0 - (place - place.floor())) * steps as f64).min(1.0);
            // Legendre's coefficients of a jump there, on 0 to 1.
            let moments = [1.0 - s, 3.0 * s * (1.0 - s), -5.0 * s * (1.0 - s) * (1.0 - 2.0 * s)];
            rise[0][l] = moments[0] - moments[1] + moments[2];
            rise[1][l] = moments[0] - 0.5 * moments[2];
            rise[2][l] = moments[0] + moments[1] + moments[2];
        }
        Self { before, rise }
    }
}

impl<'a> Acting<'a> {
    /// Takes samples on a grid, `end` being how far before the end of a step its last value is
    /// read, 1 for a held input; `late_s` may be less than nothing.
    pub(super) fn new(grid: &'a [f64], end: usize, steps: usize, interval_s: f64, late_s: Option<&Lanes>) -> Self {
        let delay = |late_s: &Lanes| match end {
            0 => Delay::Smooth(Box::new(Shift::new(late_s, interval_s / (2 * steps) as f64))),
            _ => {
                let samples = late_s.map(|s| s / interval_s);
                Delay::Held((0..steps).map(|step| Jump::new(&samples, step, steps)).collect())
            }
        };
        Self { grid, steps, end, delay: late_s.map(delay) }
    }

    /// The sample as it was recorded.
    #[inline(always)]
    pub(super) fn recorded(&self, k: usize) -> Lanes {
        [self.point((2 * k * self.steps) as isize); LANES]
    }

    /// Returns what acts at a sample.
    #[inline(always)]
    pub(super) fn at(&self, k: usize) -> Lanes {
        match &self.delay {
            None => self.recorded(k),
            Some(Delay::Smooth(shift)) => self.shifted(2 * k * self.steps, shift),
            Some(Delay::Held(jumps)) => std::array::from_fn(|l| self.sample(k as isize + jumps[0].before[l])),
        }
    }

    /// Returns what acts at the beginning, in the middle and at the end of a step after a sample.
    #[inline(always)]
    pub(super) fn over(&self, k: usize, step: usize) -> [Lanes; 3] {
        let index = 2 * (k * self.steps + step);
        match &self.delay {
            None => [index, index + 1, index + 2 - self.end].map(|i| [self.point(i as isize); LANES]),
            Some(Delay::Smooth(shift)) => [index, index + 1, index + 2].map(|i| self.shifted(i, shift)),
            Some(Delay::Held(jumps)) => {
                let Jump { before, rise } = &jumps[step];
                let mut u = [[0.0; LANES]; 3];
                for l in 0..LANES {
                    let place = k as isize + before[l];
                    let (from, to) = (self.sample(place), self.sample(place + 1));
                    for s in 0..3 {
                        u[s][l] = from + (to - from) * rise[s][l];
                    }
                }
                u
            }
        }
    }

    #[inline(always)]
    fn point(&self, index: isize) -> f64 {
        if self.grid.is_empty() {
            return 0.0;
        }
        self.grid[index.clamp(0, self.grid.len() as isize - 1) as usize]
    }

    #[inline(always)]
    fn sample(&self, k: isize) -> f64 {
        let last = (self.grid.len() / (2 * self.steps)) as isize - 1;
        self.point(k.min(last) * 2 * self.steps as isize)
    }

    #[inline(always)]
    fn shifted(&self, index: usize, shift: &Shift) -> Lanes {
        let mut u = [0.0; LANES];
        for (j, weight) in shift.weights.iter().enumerate() {
            let value = self.point(index as isize - shift.whole + j as isize - 1);
            for l in 0..LANES {
                u[l] += weight[l] * value;
            }
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocity and displacement of a free mass at the end of `samples`, pushed by a held input.
    fn pushed(held: &[f64], late: f64, steps: usize, samples: usize) -> [f64; 2] {
        let grid: Vec<f64> = held.iter().flat_map(|u| std::iter::repeat_n(*u, 2 * steps)).collect();
        let acting = Acting::new(&grid, 1, steps, 1.0, Some(&[late; LANES]));
        let h = 1.0 / steps as f64;
        let (mut v, mut x) = (0.0, 0.0);
        for k in 2..samples {
            for step in 0..steps {
                let [u0, u1, u2] = acting.over(k, step).map(|u| u[0]);
                // Fourth-order Runge–Kutta where nothing else acts.
                x += h * v + h * h / 6.0 * (u0 + 2.0 * u1);
                v += h / 6.0 * (u0 + 4.0 * u1 + u2);
            }
        }
        [v, x]
    }

    // The jump from 0 to 1 at the beginning of sample 4 acts at 4 + late: a free mass has gone ½t²
    // from there.
    #[test]
    fn a_held_input_acts_late_to_the_letter_whatever_the_steps() {
        let held: Vec<f64> = (0..12).map(|k| if k < 4 { 0.0 } else { 1.0 }).collect();
        for steps in [1, 2, 3, 8] {
            for late in [-1.7, -0.3, 0.0, 0.01, 0.5, 0.99, 1.0, 2.3] {
                let [v, x] = pushed(&held, late, steps, 10);
                let t: f64 = 10.0 - 4.0 - late;
                assert!((v - t).abs() < 1e-12 && (x - 0.5 * t * t).abs() < 1e-12, "{steps} {late}: {v} {x}, not {t}");
            }
        }
        // Control: shifted as if it were smooth, the impulse comes at another time.
        let grid: Vec<f64> = held.iter().flat_map(|u| [*u; 4]).collect();
        let smooth = Acting::new(&grid, 0, 2, 1.0, Some(&[0.3; LANES]));
        let v: f64 = (2..10).flat_map(|k| [smooth.over(k, 0), smooth.over(k, 1)]).fold(0.0, |v, u| {
            let [u0, u1, u2] = u.map(|u| u[0]);
            v + (u0 + 4.0 * u1 + u2) / 12.0
        });
        assert!((v - 5.7).abs() > 0.02, "{v}");
    }
}
