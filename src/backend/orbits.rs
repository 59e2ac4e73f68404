//! Runs the map kernels: on the CPU in blocks of 64 lanes over all threads with the widest vector unit the
//! host has, or on a GPU.

use rayon::prelude::*;

use super::gpu::{self, Gpu};
use crate::error::{Error, Result};
use crate::kernel::cpu::lyapunov::exponents;
use crate::kernel::cpu::poincare::{Block, LANES, Real, strobes};
use crate::kernel::orbit::{ALIGN_PERIODS, Orbit, Plan, Point};
use crate::progress;

/// Where orbits are integrated.
#[derive(Clone, Copy)]
pub enum Device<'a> {
    /// CPU lanes in f32.
    Cpu,
    /// A GPU, in f32.
    Gpu(&'a Gpu),
}

/// Integrates every point on a device in f32.
///
/// # Errors
/// When stopped by Ctrl-C, or when the device fails.
pub fn explore_on(device: Device<'_>, points: &[Point], plan: &Plan) -> Result<Vec<Orbit>> {
    match device {
        Device::Cpu => explore::<f32>(points, plan),
        Device::Gpu(gpu) => gpu::orbits::explore(gpu, points, plan),
    }
}

/// Integrates every point; the result does not depend on the number of threads. `T` is f32, or f64 for references.
///
/// # Errors
/// When stopped by Ctrl-C.
pub fn explore<T: Real>(points: &[Point], plan: &Plan) -> Result<Vec<Orbit>> {
    let halves = 2 * plan.steps_per_period;
    let angle = |j: u32| 2.0 * std::f64::consts::PI * f64::from(j % halves) / f64::from(halves);
    let table: Vec<T> = (0..=halves).map(|j| T::of(angle(j).cos())).collect();
    let blocks: Vec<Vec<Orbit>> = points
        .par_chunks(LANES)
        .enumerate()
        .map(|(number, chunk)| {
            if progress::interrupted() {
                return Vec::new();
            }
            let mut block = Block::<T>::load(chunk, plan, (number * LANES) as u64);
            let mut recorded = Vec::with_capacity(plan.strobes as usize);
            let exponents = run(&mut block, plan, &table, &mut recorded);
            let orbit =
                |l: usize| Orbit { exponent_per_s: exponents[l], strobes: recorded.iter().map(|s| s[l]).collect() };
            (0..chunk.len()).map(orbit).collect()
        })
        .collect();
    if progress::interrupted() {
        return Err(Error::interrupted("could not finish the map", "run it again; a smaller map takes less time"));
    }
    Ok(blocks.into_iter().flatten().collect())
}

/// Both kernels one after the other, in whatever instruction set the caller was compiled for.
#[inline(always)]
fn both<T: Real>(block: &mut Block<T>, plan: &Plan, table: &[T], out: &mut Vec<[[f32; 2]; LANES]>) -> [f64; LANES] {
    let exponents = exponents(block, plan, table);
    strobes(block, plan, table, plan.transient_periods + ALIGN_PERIODS + plan.periods, out);
    exponents
}

#[cfg(target_arch = "x86_64")]
fn run<T: Real>(block: &mut Block<T>, plan: &Plan, table: &[T], out: &mut Vec<[[f32; 2]; LANES]>) -> [f64; LANES] {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
    fn avx512<T: Real>(b: &mut Block<T>, p: &Plan, t: &[T], o: &mut Vec<[[f32; 2]; LANES]>) -> [f64; LANES] {
        both(b, p, t, o)
    }
    #[target_feature(enable = "avx2")]
    fn avx2<T: Real>(b: &mut Block<T>, p: &Plan, t: &[T], o: &mut Vec<[[f32; 2]; LANES]>) -> [f64; LANES] {
        both(b, p, t, o)
    }
    let has_avx512 = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    if has_avx512 {
        // SAFETY: the three features were found on this host in the line above.
        unsafe { avx512(block, plan, table, out) }
    } else if is_x86_feature_detected!("avx2") {
        // SAFETY: the feature was found on this host in the line above.
        unsafe { avx2(block, plan, table, out) }
    } else {
        both(block, plan, table, out)
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn run<T: Real>(block: &mut Block<T>, plan: &Plan, table: &[T], out: &mut Vec<[[f32; 2]; LANES]>) -> [f64; LANES] {
    both(block, plan, table, out)
}
