//! States how fast this machine does the tool's work, next to what it could do at most and what a
//! plain loop does.
//!
//! Rates are per second of wall time, the fastest of repeated runs, all in one process: on a
//! machine that does other things too, that is the run least disturbed, and only ratios within one
//! process mean anything. Not for correctness: `validation` has that.

#![warn(unreachable_pub)]

use proofmass_base::control::{Control, Progress};
use proofmass_base::error::Result;
use proofmass_kernel::cpu::lanes::Level;
use proofmass_kernel::job::Job;
use proofmass_numerics::numerics::elementary::Real;
use proofmass_simulate::backend::cpu::{Cpu, Precision};
use proofmass_simulate::backend::gpu::Gpu;
use proofmass_simulate::backend::gpu::peak::multiply_adds;
use proofmass_simulate::backend::orbits::{Device, explore_on};
use proofmass_simulate::backend::{Backend, Batch};

pub mod diffusion;
pub mod duffing;
pub mod lorenz;
pub mod normal;
pub mod operations;
pub mod others;
pub mod page;
pub mod peak;
pub mod peers;
pub mod prediction;
pub mod published;
mod row;
pub mod scalar;
pub mod work;

pub use row::Row;
use row::row;
pub use work::FULL;

/// Name of the rows that all shares refer to.
pub(crate) const PEAK: &str = "multiply-add peak";
/// Name of a row that has a published counterpart.
const LORENZ: &str = "Lorenz, 1000 Runge-Kutta steps";
/// Name of a row that has a published counterpart.
const DIFFUSION: &str = "three states, 256 Euler-Maruyama steps";
/// Name of the rows of the same without its numbers.
pub(crate) const NOISELESS: &str = "full without force noise";
/// Name of the rows of its numbers alone.
pub(crate) const NORMAL: &str = "normal numbers, one a member-step";
const MAP: &str = "Lyapunov map: orbit and tangent by Runge-Kutta";
const STEPS: &str = "member-steps";

/// A row of work that cannot fail.
fn timed<O>(
    control: &Control,
    work: &str,
    precision: &str,
    members: usize,
    units: f64,
    run: impl Fn() -> O,
) -> Result<Row> {
    row(control, work, precision, members as u64, units, STEPS, || {
        std::hint::black_box(run());
        Ok(())
    })
}

/// Fills in the shares of the peak measured at the same place in the same precision.
fn fill_shares_of_peak(rows: &mut [Row]) {
    let peaks: Vec<Row> = rows.iter().filter(|r| r.work == PEAK).cloned().collect();
    for r in rows {
        let peak = peaks.iter().find(|p| p.place == r.place && p.precision == r.precision);
        r.share_of_peak = r.instructions.zip(peak).map(|(n, peak)| r.per_second * n / peak.per_second);
    }
}

/// The machine's peak, and kernels alone: no members drawn, nothing summed up.
fn kernels<T: Real>(control: &Control) -> Result<Vec<Row>> {
    let mut best: Option<Row> = None;
    for work in [peak::multiply_adds::<T, 1>, peak::multiply_adds::<T, 2>, peak::multiply_adds::<T, 3>] {
        let mut done = 0.0;
        let mut measured = row(control, PEAK, T::NAME, 0, 1.0, "multiply-adds", || {
            done = work();
            Ok(())
        })?;
        measured.per_second = done / measured.seconds;
        if best.as_ref().is_none_or(|b| b.per_second < measured.per_second) {
            best = Some(measured);
        }
    }
    let mut rows: Vec<Row> = best.into_iter().collect();
    let (problem, level) = (duffing::Problem::<T>::new(), Level::best());
    let (members, steps) = (duffing::MEMBERS, (duffing::MEMBERS * duffing::STEPS) as f64);
    let quiet = timed(control, "Duffing, Runge-Kutta 4", T::NAME, members, steps, || problem.run(false, level))?;
    rows.push(quiet.counted(operations::DUFFING));
    let name = "Duffing, Runge-Kutta 4, one normal number a step";
    let noisy = timed(control, name, T::NAME, members, steps, || problem.run(true, level))?;
    // Next to the step and its number: the force noise added three times, and its deviation.
    rows.push(noisy.counted(operations::DUFFING + 4.0 + operations::normal::<T>()));
    let numbers = timed(control, NORMAL, T::NAME, members, steps, || normal::run::<T>(level))?;
    rows.push(numbers.counted(operations::normal::<T>()));
    let (members, steps) = (lorenz::MEMBERS, (lorenz::MEMBERS * lorenz::STEPS) as f64);
    rows.push(timed(control, LORENZ, T::NAME, members, steps, || lorenz::run::<T>(level))?.counted(operations::LORENZ));
    let (members, steps) = (diffusion::MEMBERS, (diffusion::MEMBERS * diffusion::STEPS) as f64);
    let paths = timed(control, DIFFUSION, T::NAME, members, steps, || diffusion::run::<T>(level))?;
    rows.push(paths.counted(operations::diffusion::<T>()));
    Ok(rows)
}

/// A Lyapunov map, loading and reading of the points included.
fn map(control: &Control, place: &str, device: Device<'_>, points: usize) -> Result<Row> {
    let (points, plan) = work::orbits(points);
    let steps = work::orbit_steps(points.len(), &plan);
    let measured = row(control, MAP, f32::NAME, points.len() as u64, steps, STEPS, || {
        explore_on(device, &points, &plan, control).map(drop)
    })?;
    Ok(Row { place: place.to_owned(), ..measured.counted(operations::LYAPUNOV) })
}

/// A job on a backend from end to end: members drawn, integrated in batches, summed up.
fn ensemble(control: &Control, name: &str, place: &str, backend: &mut dyn Backend, job: &Job) -> Result<Row> {
    let size = backend.batch_members(job)?;
    let precision = backend.machine(job).precision;
    let mut measured = row(control, name, &precision, job.members, job.member_steps() as f64, STEPS, || {
        let mut from = 0;
        while from < job.members && !control.cancelled() {
            let members = from..job.members.min(from + size);
            from = members.end;
            backend.run(&Batch { stop: &|| control.cancelled(), ..Batch::whole(job, members) })?;
        }
        Ok(())
    })?;
    measured.place = place.to_owned();
    Ok(measured)
}

/// All measurements on the CPU; `progress` is told which is next.
///
/// # Errors
/// Stopped.
pub fn cpu(control: &Control, progress: &Progress) -> Result<Vec<Row>> {
    progress.rename("kernels");
    let mut rows = kernels::<f32>(control)?;
    rows.extend(kernels::<f64>(control)?);
    progress.rename("a plain loop");
    let plain = "the noisy Duffing unit as a plain loop, one member at a time";
    rows.push(timed(control, plain, f64::NAME, 512, (512 * duffing::STEPS) as f64, || scalar::duffing(512))?);
    progress.rename(MAP);
    rows.push(map(control, "cpu", Device::Cpu, 8192)?);
    for precision in [Precision::F32, Precision::F64] {
        let mut cpu = Cpu { precision, ..Cpu::default() };
        let (instructions, bytes) = match precision {
            Precision::F32 => (operations::full::<f32>(), operations::full_bytes::<f32>(cpu.tile_samples)),
            Precision::F64 => (operations::full::<f64>(), operations::full_bytes::<f64>(cpu.tile_samples)),
        };
        for (name, job) in work::ensembles(8192) {
            progress.rename(name);
            let mut measured = ensemble(control, name, "cpu", &mut cpu, &job)?;
            if name == FULL {
                (measured.instructions, measured.bytes) = (Some(instructions), Some(bytes));
            }
            rows.push(measured);
        }
        progress.rename(NOISELESS);
        rows.push(ensemble(control, NOISELESS, "cpu", &mut cpu, &work::noiseless(8192))?);
    }
    let mut cpu = Cpu::default();
    for members in work::SIZES {
        progress.rename(&format!("{members} members"));
        rows.push(ensemble(control, work::SIZED, "cpu", &mut cpu, &work::full(members))?);
    }
    for samples in work::LENGTHS {
        progress.rename(&format!("{samples} steps"));
        let name = format!("{}: {samples} steps", work::SCALED);
        rows.push(ensemble(control, &name, "cpu", &mut cpu, &work::long(8192, samples))?);
    }
    fill_shares_of_peak(&mut rows);
    Ok(rows)
}

/// The device's peak, a map and the ensembles; `progress` is told which is next.
///
/// # Errors
/// As the device; stopped.
pub fn gpu(device: &Gpu, backend: &mut dyn Backend, control: &Control, progress: &Progress) -> Result<Vec<Row>> {
    let (name, hardware) = (&device.adapter.name, device.adapter.hardware);
    progress.rename(PEAK);
    let mut done = 0.0;
    let mut peak = row(control, PEAK, f32::NAME, 0, 1.0, "multiply-adds", || {
        done = multiply_adds(device)?;
        Ok(())
    })?;
    (peak.per_second, peak.place) = (done / peak.seconds, name.clone());
    // A card is full at a million members; a software adapter at a few thousand.
    let many = if hardware { 1 << 20 } else { 8192 };
    progress.rename(MAP);
    let mut rows = vec![peak, map(control, name, Device::Gpu(device), many)?];
    for (what, job) in work::ensembles(many as u64) {
        progress.rename(what);
        let mut measured = ensemble(control, what, name, backend, &job)?;
        measured.instructions = (what == FULL).then_some(operations::FULL_GPU);
        rows.push(measured);
    }
    // Drawing and sending members costs the same for any length, so a long run measures the kernel alone.
    if hardware {
        progress.rename(work::LONG);
        let job = work::long(many as u64, work::LONG_SAMPLES);
        rows.push(ensemble(control, work::LONG, name, backend, &job)?.counted(operations::FULL_GPU));
    }
    // Ten million on a software adapter would only take long.
    for members in work::SIZES.into_iter().filter(|m| hardware || *m <= 1 << 20) {
        progress.rename(&format!("{members} members"));
        rows.push(ensemble(control, work::SIZED, name, backend, &work::full(members))?);
    }
    fill_shares_of_peak(&mut rows);
    Ok(rows)
}
