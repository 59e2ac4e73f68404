//! The misfit kernel on a device: points stay there from tile to tile, only sums are read back.
//!
//! A submission is a stretch of samples within one block, as long as a driver is patient for.

use std::ops::Range;
use std::time::Instant;

use bytemuck::{bytes_of, cast_slice};

use super::{Dispatch, Gpu};
use crate::backend::misfits::{finish, stopped};
use crate::error::Result;
use crate::kernel::layout::{MISFIT_WORKGROUP, MisfitTile};
use crate::kernel::misfit::{COLUMNS, Job, MOST_DIRECTIONS, Misfit, Parts, Point, STATE, stretches};
use crate::kernel::source;
use crate::progress;

/// Seconds a submission should take.
const TARGET_S: f64 = 0.08;
/// Samples of the first submission, which also compiles.
const FIRST: usize = 64;

/// Evaluates every point on the device, as `backend::misfits::evaluate::<f32>` does on the CPU.
///
/// # Errors
/// Not enough memory, a device that was lost, or Ctrl-C.
pub fn evaluate(gpu: &Gpu, job: &Job<'_>, points: &[Point]) -> Result<Vec<Misfit>> {
    let parts = Parts::of(points);
    let most = (gpu.adapter.largest_binding.min(1 << 30) / (4 * COLUMNS as u64)) as usize;
    let mut all = Vec::with_capacity(points.len());
    for part in points.chunks(most.clamp(MISFIT_WORKGROUP as usize, 1 << 20)) {
        all.extend(evaluate_part(gpu, job, &parts, part)?);
    }
    Ok(all)
}

fn evaluate_part(gpu: &Gpu, job: &Job<'_>, parts: &Parts, points: &[Point]) -> Result<Vec<Misfit>> {
    let n = points.len();
    let directions = job.directions.len().min(MOST_DIRECTIONS);
    let mut constants = parts.constants();
    constants.extend([("STEPS", job.steps as f64), ("DIRECTIONS", directions as f64)]);
    let kernel = gpu.kernel(&source::misfit(), &constants)?;
    let drawn: Vec<_> = points.iter().map(|p| p.columns(job)).collect();
    let columns: Vec<f32> = (0..COLUMNS).flat_map(|c| drawn.iter().map(move |d| d.0[c] as f32)).collect();
    let begin: Vec<f32> = (0..STATE).flat_map(|s| drawn.iter().map(move |d| d.1[s] as f32)).collect();
    let row = |k: usize| {
        let reading = (job.reading[job.run.start + k] / job.units.output) as f32;
        std::iter::once(reading).chain(job.directions[..directions].iter().map(move |d| d[k] as f32))
    };
    let rows: Vec<f32> = (0..job.run.len()).flat_map(row).collect();
    let mut grid: Vec<f32> = job.grid.iter().map(|u| (u / job.units.input) as f32).collect();
    // A recording without input is one whose input is zero.
    grid.resize(grid.len().max(1), 0.0);
    let width = job.blocks.len() + directions;
    let (columns, rows) = (gpu.upload(cast_slice(&columns))?, gpu.upload(cast_slice(&rows))?);
    let (state, sums) = (gpu.upload(cast_slice(&begin))?, gpu.zeros((4 * n * width.max(1)) as u64)?);
    let last = grid.len() - 1;
    let grid = gpu.upload(cast_slice(&grid))?;
    let tile = |samples: Range<usize>, block: Option<usize>| MisfitTile {
        points: n as u32,
        run: job.run.start as u32,
        first: samples.start as u32,
        samples: samples.len() as u32,
        block: block.unwrap_or(job.blocks.len()) as u32,
        blocks: job.blocks.len() as u32,
        last: last as u32,
        grid_end: job.grid_end as u32,
    };
    let mut length = FIRST;
    for (samples, block) in stretches(job) {
        let mut from = samples.start;
        while from < samples.end {
            if progress::interrupted() {
                return Err(stopped());
            }
            let to = samples.end.min(from + length);
            let begun = Instant::now();
            let uniform = gpu.uniform(bytes_of(&tile(from..to, block)))?;
            let buffers = [&uniform, &columns, &rows, &grid, &state, &sums];
            let workgroups = (n as u32).div_ceil(MISFIT_WORKGROUP);
            gpu.wait(&gpu.submit(&[Dispatch { kernel: &kernel, buffers: &buffers, workgroups }])?)?;
            let took_s = begun.elapsed().as_secs_f64().max(1e-6);
            let wanted = (to - from) as f64 * TARGET_S / took_s;
            length = (wanted as usize).clamp(16, length.saturating_mul(4));
            from = to;
        }
    }
    let ends: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read(&state, (4 * STATE * n) as u64)?);
    let sums: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read(&sums, (4 * n * width.max(1)) as u64)?);
    let one = |i: usize| {
        let own: Vec<f64> = (0..width).map(|w| f64::from(sums[w * n + i])).collect();
        finish(job, &own, ends[7 * n + i] != 0.0)
    };
    Ok((0..n).map(one).collect())
}
