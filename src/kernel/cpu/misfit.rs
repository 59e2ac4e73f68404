//! CPU twin of `misfit.wgsl`: models of a driven recording simulated freely, 64 at a time, their errors squared and summed.
//!
//! The oscillator's linear part is carried exactly (Lawson's Runge–Kutta of order 4), as in the diagnosis' own filter. Terms
//! stand in loops of their own, so that one that no point of the job has costs nothing.

#![allow(clippy::needless_range_loop, reason = "one index over many arrays is the form that vectorises")]

use std::ops::Range;

mod step;

use step::{advance, input};

use super::lanes::{Kernel, LANES, Lane};
use crate::kernel::misfit::{COLUMNS, Job, LOST, MOST_DIRECTIONS, Parts, Point, STATE, column};
use crate::numerics::elementary::{Real, fma};

/// Samples whose squares are summed in the working precision before they go to f64.
const PARTIAL: usize = 64;

/// What all points of a job share.
#[derive(Debug, Clone)]
pub struct Shared<T> {
    /// Which parts are on.
    pub parts: Parts,
    steps: usize,
    run: Range<usize>,
    grid_end: usize,
    /// Readings of the run.
    reading: Vec<T>,
    /// Input of the whole recording.
    grid: Vec<T>,
    /// Directions, sample by sample of the run.
    directions: Vec<T>,
    count: usize,
}

impl<T: Real> Shared<T> {
    /// Of a job, in its units.
    pub fn of(job: &Job<'_>, parts: Parts) -> Self {
        let count = job.directions.len().min(MOST_DIRECTIONS);
        let row = |k: usize| job.directions[..count].iter().map(move |d| T::of(d[k]));
        Self {
            parts,
            steps: job.steps,
            run: job.run.clone(),
            grid_end: job.grid_end,
            reading: job.reading[job.run.clone()].iter().map(|y| T::of(y / job.units.output)).collect(),
            grid: job.grid.iter().map(|u| T::of(u / job.units.input)).collect(),
            directions: (0..job.run.len()).flat_map(row).collect(),
            count,
        }
    }
}

/// Up to 64 points and where they stand.
#[derive(Debug, Clone)]
pub struct Group<T> {
    columns: [Lane<T>; COLUMNS],
    state: [Lane<T>; STATE],
    /// Sum of squares of each block, then of products with each direction.
    pub sums: Vec<Lane<f64>>,
}

impl<T: Real> Group<T> {
    /// Loads points; spare lanes repeat the last one.
    pub fn load(job: &Job<'_>, points: &[Point]) -> Self {
        let zero = Lane::splat(T::of(0.0));
        let mut group = Self {
            columns: [zero; COLUMNS],
            state: [zero; STATE],
            sums: vec![Lane::splat(0.0); job.blocks.len() + job.directions.len().min(MOST_DIRECTIONS)],
        };
        for l in 0..LANES {
            let (columns, state) = points[l.min(points.len().saturating_sub(1))].columns(job);
            columns.iter().enumerate().for_each(|(c, v)| group.columns[c][l] = T::of(*v));
            state.iter().enumerate().for_each(|(s, v)| group.state[s][l] = T::of(*v));
        }
        group
    }

    /// Whether the simulation of a lane has left every bound.
    pub fn lost(&self, lane: usize) -> bool {
        self.state[7][lane].f64() != 0.0
    }
}

/// One group through one stretch of samples.
pub struct Misfit<'a, T> {
    /// The recording.
    pub shared: &'a Shared<T>,
    /// The points.
    pub group: &'a mut Group<T>,
    /// Samples.
    pub samples: Range<usize>,
    /// The block they belong to, if any.
    pub block: Option<usize>,
    /// Blocks of the job.
    pub blocks: usize,
}

impl<T: Real> Kernel for Misfit<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { shared, group, samples, block, blocks } = self;
        let mut from = samples.start;
        while from < samples.end {
            let to = samples.end.min(from + PARTIAL);
            let mut sums = [Lane::splat(T::of(0.0)); 1 + MOST_DIRECTIONS];
            for k in from..to {
                let error = error::<T, FMA>(shared, group, k);
                if block.is_some() {
                    for l in 0..LANES {
                        sums[0][l] = fma::<T, FMA>(error[l], error[l], sums[0][l]);
                    }
                    let row = (k - shared.run.start) * shared.count;
                    for d in 0..shared.count {
                        let along = shared.directions[row + d];
                        for l in 0..LANES {
                            sums[1 + d][l] = fma::<T, FMA>(along, error[l], sums[1 + d][l]);
                        }
                    }
                }
                for step in 0..shared.steps {
                    advance::<T, FMA>(shared, group, k, step);
                }
            }
            if let Some(block) = block {
                for l in 0..LANES {
                    group.sums[block][l] += sums[0][l].f64();
                    for d in 0..shared.count {
                        group.sums[blocks + d][l] += sums[1 + d][l].f64();
                    }
                }
            }
            lose(group);
            from = to;
        }
    }
}

/// Reading less simulation at sample k.
#[inline(always)]
fn error<T: Real, const FMA: bool>(shared: &Shared<T>, group: &mut Group<T>, k: usize) -> Lane<T> {
    let (c, s, parts) = (&group.columns, &mut group.state, &shared.parts);
    let mut y = Lane::splat(T::of(0.0));
    for l in 0..LANES {
        y[l] = s[0][l] + c[column::OFFSET][l];
    }
    if parts.mode {
        for l in 0..LANES {
            y[l] = y[l] + s[3][l];
        }
    }
    if parts.lag {
        for l in 0..LANES {
            y[l] = y[l] + (s[5][l] - s[0][l]);
        }
    }
    if parts.feedthrough {
        let u = input(shared, c, 2 * shared.steps * k);
        for l in 0..LANES {
            y[l] = fma::<T, FMA>(c[column::FEEDTHROUGH][l], u[l], y[l]);
        }
    }
    if parts.bend {
        for l in 0..LANES {
            let bend = fma::<T, FMA>(c[column::BEND_3][l], s[0][l], c[column::BEND_2][l]);
            y[l] = fma::<T, FMA>(s[0][l] * s[0][l], bend, y[l]);
        }
    }
    if parts.bias {
        let time = T::of(k as f64);
        for l in 0..LANES {
            y[l] = fma::<T, FMA>(c[column::RAMP][l], time, y[l] + s[6][l]);
            s[6][l] = fma::<T, FMA>(s[6][l], c[column::FADE][l], s[6][l]);
        }
    }
    if parts.rails {
        for l in 0..LANES {
            y[l] = y[l].max(c[column::LOW][l]).min(c[column::HIGH][l]);
        }
    }
    let reading = shared.reading[k - shared.run.start];
    for l in 0..LANES {
        y[l] = reading - y[l];
    }
    y
}

/// Marks lanes that left every bound and brings them to rest, so that they cost nothing and poison nothing.
#[inline(always)]
fn lose<T: Real>(group: &mut Group<T>) {
    for l in 0..LANES {
        let out = (0..5).any(|s| group.state[s][l].beyond(LOST));
        if out {
            for s in 0..6 {
                group.state[s][l] = T::of(0.0);
            }
            group.state[7][l] = T::of(1.0);
        }
    }
}
