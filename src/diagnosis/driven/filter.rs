//! One pass over a recording, for [`LANES`] parameter sets at once: simulate, compare with the reading, correct.
//!
//! The oscillator's linear part is propagated exactly (Lawson's fourth-order Runge–Kutta in the rotating frame), so that
//! step length limits only the terms and the input. Without noise terms nothing is corrected and the innovations are the
//! errors of free simulation; with them they are one-step prediction errors, whose likelihood is Gaussian and white.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use std::ops::Range;

use super::friction::{self, Sliding};
use super::propagator::{Shift, Transition};
use super::term::{BaseLanes, Constants, Instant, LANES, Lanes, Stride, Term};

/// Most own states of all terms of a model together.
pub const MOST_STATES: usize = 8;
/// Most of them that belong to terms which move the mass and so go through the stages with it; they come first.
const MOST_STAGED: usize = 2;
/// Place in the chain of the readout of what moves beside the mass; its states 0 and 1 are displacement and velocity.
const MODES: u8 = 0;
/// Place of the offset in the chain of the readout: what comes before it sees the displacement alone.
const OFFSET: u8 = 3;

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
        let h = self.interval_s / self.steps as f64;
        let half = Transition::new(&self.oscillator, 0.5 * h);
        let full = Transition::new(&self.oscillator, h);
        let linear = !self.terms.iter().any(Term::moves);
        let placed = |kept: fn(&Term) -> bool| -> Vec<Mover<'_>> {
            let mut all = movers(self.terms, self.first);
            all.retain(|m| kept(m.term));
            all
        };
        let moving = placed(|t| t.moves() && !t.rubs());
        let staged = moving.iter().any(|m| m.term.states() > 0);
        let mut followers = placed(Term::follows);
        // A low-pass sees the others where they have come to.
        followers.sort_by_key(|m| m.term.lags());
        let constants: Vec<Constants> =
            followers.iter().map(|m| m.term.constants(&self.parameters[m.first..], h)).collect();
        let mut readers = placed(|t| t.reads().is_some());
        readers.sort_by_key(|m| m.term.reads());
        let (sensing, adding): (Vec<_>, Vec<_>) = readers.into_iter().partition(|m| m.term.reads() < Some(OFFSET));
        let modes: Vec<usize> = sensing.iter().filter(|m| m.term.reads() == Some(MODES)).map(|m| m.state).collect();
        let delay = self
            .terms
            .iter()
            .zip(self.first)
            .find(|(t, _)| t.delays())
            .map(|(_, f)| Shift::new(&self.parameters[*f], self.interval_s / (2 * self.steps) as f64));
        let friction = self.terms.iter().zip(self.first).find(|(t, _)| t.rubs()).map(|(_, f)| &self.parameters[*f]);
        let [mut x, mut v] = self.initial;
        let mut bias = [0.0; LANES];
        let mut own = [[0.0; LANES]; MOST_STATES];
        let (later, earlier): (Vec<_>, Vec<_>) =
            movers(self.terms, self.first).into_iter().partition(|m| m.term.lags());
        for m in &earlier {
            m.term.begin(&x, &v, &self.parameters[m.first..], &mut own[m.state..]);
        }
        for m in &later {
            let (x, v) = together(&modes, &own, [&x, &v]);
            m.term.begin(&x, &v, &self.parameters[m.first..], &mut own[m.state..]);
        }
        let mut out = Vec::with_capacity(self.run.len());
        let per_sample = 2 * self.steps;
        for k in self.run.clone() {
            let environment = &self.environment[k * self.environments..(k + 1) * self.environments];
            let mut at = Instant {
                time_s: k as f64 * self.interval_s,
                step_s: h,
                input: self.input(k * per_sample, None),
                x,
                v,
                base: &self.base,
                environment,
            };
            let mut y = x;
            for r in &sensing {
                r.term.reading(&at, &self.parameters[r.first..], &own[r.state..], &mut y);
            }
            for l in 0..LANES {
                y[l] += self.offset[l] + bias[l];
            }
            for r in &adding {
                r.term.reading(&at, &self.parameters[r.first..], &own[r.state..], &mut y);
            }
            keep.keep(k, &x, &v);
            let reading = self.reading[k];
            let mut e = [0.0; LANES];
            for l in 0..LANES {
                e[l] = reading - y[l];
            }
            out.push(e);
            if let Some(gains) = &self.gains {
                for l in 0..LANES {
                    x[l] += gains[0][l] * e[l];
                    v[l] += gains[1][l] * e[l];
                    bias[l] += gains[2][l] * e[l];
                }
                if let Some(Mover { state, .. }) = later.first() {
                    for l in 0..LANES {
                        own[*state][l] += gains[3][l] * e[l];
                    }
                }
            }
            let begin = at.time_s;
            for step in 0..self.steps {
                let index = k * per_sample + 2 * step;
                let u = [
                    self.input(index, delay.as_ref()),
                    self.input(index + 1, delay.as_ref()),
                    self.input(index + 2 - self.grid_end, delay.as_ref()),
                ];
                if linear {
                    let mut a = [[0.0; LANES]; 3];
                    for s in 0..3 {
                        for l in 0..LANES {
                            a[s][l] = self.base.gain[l] * u[s][l];
                        }
                    }
                    let (mut nx, mut nv) = full.apply(&x, &v);
                    for l in 0..LANES {
                        nx[l] += h / 6.0 * (full.xv[l] * a[0][l] + 4.0 * half.xv[l] * a[1][l]);
                        nv[l] += h / 6.0 * (full.vv[l] * a[0][l] + 4.0 * half.vv[l] * a[1][l] + a[2][l]);
                    }
                    let stride = Stride { step_s: h, x0: x, v0: v, x1: nx, v1: nv, input: u };
                    (x, v) = (nx, nv);
                    self.follow(stride, &followers, &constants, &modes, &mut own);
                    continue;
                }
                let from = begin + step as f64 * h;
                let (hx, hv) = half.apply(&x, &v);
                let (fx, fv) = full.apply(&x, &v);
                let mut a = [[0.0; LANES]; 4];
                let mut rate = [[0.0; LANES]; MOST_STAGED];
                let mut sums = [[0.0; LANES]; MOST_STAGED];
                let mut here = [own[0], own[1]];
                let mut side = [0.0; LANES];
                for stage in 0..4 {
                    let lead = if stage == 3 { h } else { 0.5 * h };
                    if staged && stage > 0 {
                        for s in 0..MOST_STAGED {
                            for l in 0..LANES {
                                here[s][l] = own[s][l] + lead * rate[s][l];
                            }
                        }
                    }
                    match stage {
                        0 => (at.x, at.v, at.time_s, at.input) = (x, v, from, u[0]),
                        1 => {
                            for l in 0..LANES {
                                at.x[l] = hx[l] + 0.5 * h * half.xv[l] * a[0][l];
                                at.v[l] = hv[l] + 0.5 * h * half.vv[l] * a[0][l];
                            }
                            (at.time_s, at.input) = (from + 0.5 * h, u[1]);
                        }
                        2 => {
                            at.x = hx;
                            for l in 0..LANES {
                                at.v[l] = hv[l] + 0.5 * h * a[1][l];
                            }
                        }
                        _ => {
                            for l in 0..LANES {
                                at.x[l] = fx[l] + h * half.xv[l] * a[2][l];
                                at.v[l] = fv[l] + h * half.vv[l] * a[2][l];
                            }
                            (at.time_s, at.input) = (from + h, u[2]);
                        }
                    }
                    let mut acceleration = [0.0; LANES];
                    for l in 0..LANES {
                        acceleration[l] = self.base.gain[l] * at.input[l];
                    }
                    for m in &moving {
                        let p = &self.parameters[m.first..];
                        m.term.force(&at, p, &here[m.state..], &mut rate[m.state..], &mut acceleration);
                    }
                    if let Some(friction) = friction {
                        if stage == 0 {
                            side = friction::sides(&self.base, friction, [&x, &v, &acceleration]);
                        }
                        for l in 0..LANES {
                            acceleration[l] -= side[l] * friction[l];
                        }
                    }
                    let weight = if stage == 0 || stage == 3 { h / 6.0 } else { h / 3.0 };
                    if staged {
                        for s in 0..MOST_STAGED {
                            for l in 0..LANES {
                                sums[s][l] += weight * rate[s][l];
                            }
                        }
                    }
                    a[stage] = acceleration;
                }
                let (x0, v0) = (x, v);
                for l in 0..LANES {
                    x[l] = fx[l] + h / 6.0 * (full.xv[l] * a[0][l] + 2.0 * half.xv[l] * (a[1][l] + a[2][l]));
                    v[l] = fv[l] + h / 6.0 * (full.vv[l] * a[0][l] + 2.0 * half.vv[l] * (a[1][l] + a[2][l]) + a[3][l]);
                }
                if let Some(friction) = friction {
                    let sliding = Sliding { step_s: h, base: &self.base, friction, side: &side, ends: [&a[0], &a[3]] };
                    sliding.switch([&x0, &v0], [&mut x, &mut v]);
                }
                if staged {
                    for s in 0..MOST_STAGED {
                        for l in 0..LANES {
                            own[s][l] += sums[s][l];
                        }
                    }
                }
                let stride = Stride { step_s: h, x0, v0, x1: x, v1: v, input: u };
                self.follow(stride, &followers, &constants, &modes, &mut own);
            }
        }
        out
    }

    /// Carries the terms that follow the mass over one step of it.
    #[inline(always)]
    fn follow(
        &self,
        stride: Stride,
        followers: &[Mover<'_>],
        constants: &[Constants],
        modes: &[usize],
        own: &mut [Lanes; MOST_STATES],
    ) {
        let (x0, v0) =
            if modes.is_empty() { (stride.x0, stride.v0) } else { together(modes, own, [&stride.x0, &stride.v0]) };
        for (m, constants) in followers.iter().zip(constants) {
            let mut seen = stride;
            if m.term.lags() && !modes.is_empty() {
                let (x1, v1) = together(modes, own, [&stride.x1, &stride.v1]);
                seen = Stride { x0, v0, x1, v1, ..stride };
            }
            m.term.follow(&seen, constants, &self.parameters[m.first..], &mut own[m.state..]);
        }
    }

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

/// A term, where its parameters begin and where its states begin.
struct Mover<'a> {
    term: &'a Term,
    first: usize,
    state: usize,
}

fn movers<'a>(terms: &'a [Term], first: &[usize]) -> Vec<Mover<'a>> {
    let mut next = [0, MOST_STAGED];
    let mut all = Vec::new();
    for (term, first) in terms.iter().zip(first) {
        let (next, end) = if term.moves() { (&mut next[0], MOST_STAGED) } else { (&mut next[1], MOST_STATES) };
        if *next + term.states() <= end {
            all.push(Mover { term, first: *first, state: *next });
            *next += term.states();
        }
    }
    all
}

/// Displacement and velocity of mass and modes together; those of modes are states at these places.
#[inline(always)]
fn together(modes: &[usize], own: &[Lanes; MOST_STATES], [x, v]: [&Lanes; 2]) -> (Lanes, Lanes) {
    let (mut x, mut v) = (*x, *v);
    for m in modes {
        for l in 0..LANES {
            x[l] += own[*m][l];
            v[l] += own[m + 1][l];
        }
    }
    (x, v)
}
