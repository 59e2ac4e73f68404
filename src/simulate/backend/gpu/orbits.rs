//! The map kernels on a device: orbits stay there from the transient through the exponent to the
//! strobes.
//!
//! A submission is a few periods of the force, as many as fit the time that a driver is patient
//! for.

use std::time::Instant;

use bytemuck::{bytes_of, cast_slice};

use super::{Buffer, Dispatch, Gpu, Kernel};
use crate::control::Control;
use crate::error::Result;
use crate::kernel::layout::{ORBIT_WORKGROUP, OrbitTile};
use crate::kernel::orbit::{ALIGN_PERIODS, Orbit, Plan, Point};
use crate::kernel::source;
use crate::parallel;

/// Seconds a submission should take.
const TARGET_S: f64 = 0.08;
/// Numbers of state per point: x, v, tangent x and v, sum of logarithms, lost.
const STATE: usize = 6;
/// Numbers that a point is given.
const PARAMETERS: usize = 6;
/// Points that are prepared in one go.
const AT_ONCE: usize = 4096;

/// Integrates every point on the device, as `backend::orbits::explore::<f32>` does on the CPU.
/// Orbits agree with those of the CPU while they are regular; chaotic ones agree in distribution,
/// because the device may fuse multiply and add.
///
/// # Errors
/// Not enough memory, a device that was lost, or Ctrl-C.
pub fn explore(gpu: &Gpu, points: &[Point], plan: &Plan, control: &Control) -> Result<Vec<Orbit>> {
    // Strobes are the largest buffer: as many points at a time as it holds.
    let room = gpu.adapter.largest_binding.min(1 << 30) / (8 * u64::from(plan.strobes.max(1)));
    let most = (room as usize).clamp(ORBIT_WORKGROUP as usize, 1 << 20);
    let mut orbits = Vec::with_capacity(points.len());
    for (number, part) in points.chunks(most).enumerate() {
        let first = plan.first_member + (number * most) as u64;
        orbits.extend(Run::new(gpu, part, &Plan { first_member: first, ..*plan })?.finish(control)?);
    }
    Ok(orbits)
}

/// One set of points on the device.
struct Run<'a> {
    gpu: &'a Gpu,
    points: &'a [Point],
    plan: Plan,
    lyapunov: Kernel,
    poincare: Kernel,
    tile: Buffer,
    parameters: Buffer,
    cosines: Buffer,
    state: Buffer,
    strobes: Buffer,
    /// Period that comes next, and how many a submission takes.
    next: u32,
    stride: u32,
}

/// Purpose of a stretch of periods.
#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Transient,
    Align,
    Count,
    Strobe,
}

impl<'a> Run<'a> {
    fn new(gpu: &'a Gpu, points: &'a [Point], plan: &Plan) -> Result<Self> {
        let step_s = |p: &Point| 2.0 * std::f64::consts::PI / (p.omega_rad_s * f64::from(plan.steps_per_period));
        // Parameters, then the state: columns of some points at a time.
        let numbers = |p: &Point| {
            let noise = p.noise_m_s2_rts / step_s(p).sqrt();
            let given = [p.damping_per_s, p.stiffness_per_s2, p.cubic_per_m2_s2, p.amplitude_m_s2, step_s(p), noise];
            let state = [p.x_m, p.v_m_s, 1.0, 0.0, 0.0, 0.0];
            let all: [f64; PARAMETERS + STATE] = std::array::from_fn(|k| *given.get(k).unwrap_or(&state[k % STATE]));
            all.map(|number| number as f32)
        };
        let chunks = parallel::map_chunks(points, AT_ONCE, |_, points| {
            let all: Vec<_> = points.iter().map(numbers).collect();
            std::array::from_fn::<Vec<f32>, { PARAMETERS + STATE }, _>(|k| all.iter().map(|n| n[k]).collect())
        });
        let column =
            |k: usize, take: &mut dyn FnMut(&[u8])| chunks.iter().for_each(|chunk| take(cast_slice(&chunk[k])));
        let column_bytes = 4 * points.len() as u64;
        let halves = 2 * plan.steps_per_period;
        let angle = |j: u32| 2.0 * std::f64::consts::PI * f64::from(j % halves) / f64::from(halves);
        let cosines: Vec<f32> = (0..=halves).map(|j| angle(j).cos() as f32).collect();
        let int64 = gpu.adapter.int64;
        Ok(Self {
            gpu,
            points,
            plan: *plan,
            lyapunov: gpu.kernel(&source::lyapunov(int64), &[])?,
            poincare: gpu.kernel(&source::poincare(int64), &[])?,
            tile: gpu.uniform(&[0; size_of::<OrbitTile>()])?,
            parameters: gpu.upload_columns(column_bytes, PARAMETERS, &column)?,
            cosines: gpu.upload(cast_slice(&cosines))?,
            state: gpu.upload_columns(column_bytes, STATE, &|k, take| column(PARAMETERS + k, take))?,
            strobes: gpu.zeros((points.len() * plan.strobes.max(1) as usize * 8) as u64)?,
            next: 0,
            stride: 1,
        })
    }

    /// Runs all phases and reads back what they measured.
    fn finish(mut self, control: &Control) -> Result<Vec<Orbit>> {
        self.go(Phase::Transient, self.plan.transient_periods, control)?;
        self.go(Phase::Align, ALIGN_PERIODS, control)?;
        self.go(Phase::Count, self.plan.periods, control)?;
        let n = self.points.len();
        let bytes = self.gpu.read(&self.state, (4 * STATE * n) as u64)?;
        let state: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        self.go(Phase::Strobe, self.plan.strobes, control)?;
        let bytes = self.gpu.read(&self.strobes, (8 * n * self.plan.strobes.max(1) as usize) as u64)?;
        let strobes: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&bytes);
        let orbit = |(i, p): (usize, &Point)| {
            let span_s = f64::from(self.plan.periods) * 2.0 * std::f64::consts::PI / p.omega_rad_s;
            let lost = state[5 * n + i] != 0.0;
            Orbit {
                exponent_per_s: if lost { f64::NAN } else { f64::from(state[4 * n + i]) / span_s },
                strobes: (0..self.plan.strobes as usize).map(|s| strobes[s * n + i]).collect(),
            }
        };
        Ok(parallel::map_indices(n, |i| orbit((i, &self.points[i]))))
    }

    fn go(&mut self, phase: Phase, periods: u32, control: &Control) -> Result<()> {
        let mut done = 0;
        while done < periods {
            control.go_on().map_err(|s| s.during("could not finish the orbits", "run it again"))?;
            let now = self.stride.min(periods - done);
            let tile = OrbitTile {
                seed: [self.plan.seed as u32, (self.plan.seed >> 32) as u32],
                first: [self.plan.first_member as u32, (self.plan.first_member >> 32) as u32],
                points: self.points.len() as u32,
                steps: self.plan.steps_per_period,
                begin: self.next,
                periods: now,
                counted: u32::from(phase == Phase::Count || phase == Phase::Strobe),
                strobe: done,
                padding: [0; 2],
            };
            self.gpu.write(&self.tile, bytes_of(&tile))?;
            let begun = Instant::now();
            let strobed = matches!(phase, Phase::Transient | Phase::Strobe);
            let mut buffers = vec![&self.tile, &self.parameters, &self.cosines, &self.state];
            buffers.extend(strobed.then_some(&self.strobes));
            let kernel = if strobed { &self.poincare } else { &self.lyapunov };
            let workgroups = (self.points.len() as u32).div_ceil(ORBIT_WORKGROUP);
            let submission = self.gpu.submit(&[Dispatch { kernel, buffers, workgroups }])?;
            self.gpu.wait(&submission)?;
            let took_s = begun.elapsed().as_secs_f64().max(1e-6);
            (done, self.next) = (done + now, self.next + now);
            // Towards the target, at most fourfold at once: the first submission also compiles.
            let wanted = f64::from(now) * TARGET_S / took_s;
            self.stride = (wanted as u32).clamp(1, self.stride.saturating_mul(4));
        }
        Ok(())
    }
}
