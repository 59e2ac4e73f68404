//! Runs the map kernels: on the CPU in blocks of 64 lanes over all threads with the widest vector
//! unit the host has, or on a GPU.

use super::gpu::{self, Gpu};
use crate::control::{Control, Stopped};
use crate::error::Result;
use crate::kernel::cpu::lanes::{Kernel, LANES, Level};
use crate::kernel::cpu::lyapunov::exponents;
use crate::kernel::cpu::poincare::{Block, strobes};
use crate::kernel::orbit::{ALIGN_PERIODS, Orbit, Plan, Point};
use crate::numerics::elementary::Real;
use crate::parallel;

/// The device that orbits are integrated on.
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
pub fn explore_on(device: Device<'_>, points: &[Point], plan: &Plan, control: &Control) -> Result<Vec<Orbit>> {
    let (attempt, hint) = ("could not finish the map", "run it again; a smaller map takes less time");
    match device {
        Device::Cpu => explore::<f32>(points, plan, control).map_err(|s| s.during(attempt, hint)),
        Device::Gpu(gpu) => gpu::orbits::explore(gpu, points, plan, control).map_err(|e| e.within(attempt, hint)),
    }
}

/// Integrates every point; the result does not depend on the number of threads. `T` is f32, or f64
/// for references.
///
/// # Errors
/// Stopped.
pub fn explore<T: Real>(points: &[Point], plan: &Plan, control: &Control) -> Result<Vec<Orbit>, Stopped> {
    let halves = 2 * plan.steps_per_period;
    let angle = |j: u32| 2.0 * std::f64::consts::PI * f64::from(j % halves) / f64::from(halves);
    let table: Vec<T> = (0..=halves).map(|j| T::of(angle(j).cos())).collect();
    let blocks: Vec<Vec<Orbit>> = parallel::map_chunks(points, LANES, |number, chunk| {
        if control.cancelled() {
            return Vec::new();
        }
        let mut block = Block::<T>::load(chunk, plan, (number * LANES) as u64);
        let mut recorded = Vec::with_capacity(plan.strobes as usize);
        let exponents = Level::best().run(Both { block: &mut block, plan, table: &table, out: &mut recorded });
        let orbit = |l: usize| Orbit { exponent_per_s: exponents[l], strobes: recorded.iter().map(|s| s[l]).collect() };
        (0..chunk.len()).map(orbit).collect()
    });
    control.go_on()?;
    Ok(blocks.into_iter().flatten().collect())
}

/// Both kernels one after the other.
struct Both<'a, T> {
    block: &'a mut Block<T>,
    plan: &'a Plan,
    table: &'a [T],
    out: &'a mut Vec<[[f32; 2]; LANES]>,
}

impl<T: Real> Kernel for Both<'_, T> {
    type Output = [f64; LANES];
    /// Neither fuses multiply and add, whether or not it could: maps do not depend on the host.
    #[inline(always)]
    fn run<const FMA: bool>(self) -> [f64; LANES] {
        let Self { block, plan, table, out } = self;
        let exponents = exponents(block, plan, table);
        strobes(block, plan, table, plan.transient_periods + ALIGN_PERIODS + plan.periods, out);
        exponents
    }
}
