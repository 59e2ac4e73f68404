//! One pass over a recording, for [`LANES`] parameter sets at once: simulate, compare with the reading, correct.
//!
//! The oscillator's linear part is propagated exactly (Lawson's fourth-order Runge–Kutta in the rotating frame), so that
//! step length limits only the terms and the input. Without noise terms nothing is corrected and the innovations are the
//! errors of free simulation; with them they are one-step prediction errors, whose likelihood is Gaussian and white.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use std::ops::Range;

use super::propagator::Shift;
pub use super::step::MOST_STATES;
use super::step::{Motion, Plan, movers, together};
use super::term::{BaseLanes, Instant, LANES, Lanes, Term};

/// What one pass simulates.
#[derive(Debug)]
pub struct Pass<'a> {
    /// Samples to run over.
    pub run: Range<usize>,
    /// Readings of the whole recording.
    pub reading: &'a [f64],
    /// Input on half steps, `2·steps` per sample; empty without one.
    pub grid: &'a [f64],
    /// As `Input::end`.
    pub grid_end: usize,
    /// Integration steps per sample.
    pub steps: usize,
    /// Sampling interval.
    pub interval_s: f64,
    /// Environment, row by row.
    pub environment: &'a [f64],
    /// Columns in it.
    pub environments: usize,
    /// Terms of the model.
    pub terms: &'a [Term],
    /// Their parameters, term by term.
    pub parameters: &'a [Lanes],
    /// First parameter of each term.
    pub first: &'a [usize],
    /// Base model.
    pub base: BaseLanes,
    /// ω₀ and ζ, for the exact propagation.
    pub oscillator: [Lanes; 2],
    /// Offset of the reading.
    pub offset: Lanes,
    /// Displacement and velocity at the beginning.
    pub initial: [Lanes; 2],
    /// Corrections per unit innovation; `None` for free simulation.
    pub gains: Option<[Lanes; 4]>,
}

/// What a pass wants to keep of the state besides the innovations.
pub trait Keep {
    /// Called at every sample with displacement and velocity as expected before the reading is seen.
    fn keep(&mut self, sample: usize, x: &Lanes, v: &Lanes);
}

/// Keeps nothing.
pub struct Nothing;

impl Keep for Nothing {
    #[inline(always)]
    fn keep(&mut self, _: usize, _: &Lanes, _: &Lanes) {}
}

/// Keeps displacement and velocity of lane 0.
#[derive(Debug, Default)]
pub struct States {
    /// Displacement.
    pub x: Vec<f64>,
    /// Velocity.
    pub v: Vec<f64>,
}

impl Keep for States {
    #[inline(always)]
    fn keep(&mut self, _: usize, x: &Lanes, v: &Lanes) {
        self.x.push(x[0]);
        self.v.push(v[0]);
    }
}

impl Pass<'_> {
    /// Innovations (reading less expectation), one row of lanes per sample of the run.
    pub fn innovations<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f") {
                // SAFETY: the processor has been asked for AVX-512F.
                return unsafe { self.wide(keep) };
            }
            if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                // SAFETY: the processor has been asked for AVX2 and FMA.
                return unsafe { self.middle(keep) };
            }
        }
        self.plain(keep)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f")]
    unsafe fn wide<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        self.plain(keep)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn middle<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        self.plain(keep)
    }

    #[inline(always)]
    fn plain<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        let plan = Plan::of(self);
        let mut motion = self.beginning(&plan);
        let mut out = Vec::with_capacity(self.run.len());
        for k in self.run.clone() {
            let environment = &self.environment[k * self.environments..(k + 1) * self.environments];
            let mut at = Instant {
                time_s: k as f64 * self.interval_s,
                step_s: plan.step_s,
                input: self.input(2 * k * self.steps, None),
                x: motion.x,
                v: motion.v,
                base: &self.base,
                environment,
            };
            let y = self.expected(&plan, &at, &motion);
            keep.keep(k, &motion.x, &motion.v);
            let reading = self.reading[k];
            let mut e = [0.0; LANES];
            for l in 0..LANES {
                e[l] = reading - y[l];
            }
            out.push(e);
            self.correct(&plan, &e, &mut motion);
            let begin = at.time_s;
            for step in 0..self.steps {
                let index = 2 * (k * self.steps + step);
                let u = [
                    self.input(index, plan.delay.as_ref()),
                    self.input(index + 1, plan.delay.as_ref()),
                    self.input(index + 2 - self.grid_end, plan.delay.as_ref()),
                ];
                let stride = if plan.linear {
                    self.swing(&plan, u, &mut motion)
                } else {
                    at.time_s = begin + step as f64 * plan.step_s;
                    self.pushed(&plan, &mut at, u, &mut motion)
                };
                self.follow(stride, &plan, &mut motion.own);
            }
        }
        out
    }

    /// Where everything begins.
    fn beginning(&self, plan: &Plan<'_>) -> Motion {
        let [x, v] = self.initial;
        let mut own = [[0.0; LANES]; MOST_STATES];
        let (later, earlier): (Vec<_>, Vec<_>) =
            movers(self.terms, self.first).into_iter().partition(|m| m.term.lags());
        for m in &earlier {
            m.term.begin(&x, &v, &self.parameters[m.first..], &mut own[m.state..]);
        }
        for m in &later {
            let (x, v) = together(&plan.modes, &own, [&x, &v]);
            m.term.begin(&x, &v, &self.parameters[m.first..], &mut own[m.state..]);
        }
        Motion { x, v, bias: [0.0; LANES], own }
    }

    /// The reading expected before it is seen.
    #[inline(always)]
    fn expected(&self, plan: &Plan<'_>, at: &Instant<'_>, motion: &Motion) -> Lanes {
        let mut y = at.x;
        for r in &plan.sensing {
            r.term.reading(at, &self.parameters[r.first..], &motion.own[r.state..], &mut y);
        }
        for l in 0..LANES {
            y[l] += self.offset[l] + motion.bias[l];
        }
        for r in &plan.adding {
            r.term.reading(at, &self.parameters[r.first..], &motion.own[r.state..], &mut y);
        }
        y
    }

    /// What a reading teaches.
    #[inline(always)]
    fn correct(&self, plan: &Plan<'_>, e: &Lanes, motion: &mut Motion) {
        let Some(gains) = &self.gains else { return };
        for l in 0..LANES {
            motion.x[l] += gains[0][l] * e[l];
            motion.v[l] += gains[1][l] * e[l];
            motion.bias[l] += gains[2][l] * e[l];
        }
        if let Some(state) = plan.lagging {
            for l in 0..LANES {
                motion.own[state][l] += gains[3][l] * e[l];
            }
        }
    }

    /// The input at a point of the grid, late where the reading is late.
    #[inline(always)]
    fn input(&self, index: usize, delay: Option<&Shift>) -> Lanes {
        if self.grid.is_empty() {
            return [0.0; LANES];
        }
        let last = self.grid.len() as isize - 1;
        match delay {
            None => [self.grid[index.min(last as usize)]; LANES],
            Some(shift) => {
                let mut u = [0.0; LANES];
                for (j, weight) in shift.weights.iter().enumerate() {
                    let i = (index as isize - shift.whole + j as isize - 1).clamp(0, last);
                    for l in 0..LANES {
                        u[l] += weight[l] * self.grid[i as usize];
                    }
                }
                u
            }
        }
    }
}
