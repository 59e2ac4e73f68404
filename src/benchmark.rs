//! How fast this machine does the tool's work, beside what it could do at most and what a plain loop does.
//!
//! Rates are member-steps per second of wall time, the fastest of repeated runs, all in one process: on a machine that
//! does other things too, that is the run least disturbed, and only ratios within one process mean anything. Not for correctness: `validation` has that.

use std::time::Instant;

use crate::backend::cpu::{Cpu, Precision};
use crate::backend::{Backend, Batch};
use crate::error::Result;
use crate::kernel::cpu::lanes::Level;
use crate::kernel::job::Job;
use crate::progress;

pub mod duffing;
pub mod peak;
pub mod scalar;
pub mod work;

/// One measurement.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Row {
    /// What was done.
    pub work: String,
    /// "cpu", or the adapter's name.
    pub place: String,
    /// "f32" or "f64".
    pub precision: String,
    /// Members at a time.
    pub members: u64,
    /// Shortest of several runs, s.
    pub seconds: f64,
    /// Units per second.
    pub per_second: f64,
    /// What a unit is.
    pub unit: String,
    /// Share of the machine's multiply-add peak, where instructions were counted.
    pub share_of_peak: Option<f64>,
}

/// Runs until half a second and three runs have passed; the shortest time of one. The first run is not counted.
fn shortest_s(mut run: impl FnMut() -> Result<()>) -> Result<f64> {
    run()?;
    let (begun, mut shortest, mut runs) = (Instant::now(), f64::INFINITY, 0);
    while runs < 3 || begun.elapsed().as_secs_f64() < 0.5 {
        let one = Instant::now();
        run()?;
        shortest = one.elapsed().as_secs_f64().min(shortest);
        runs += 1;
        if progress::interrupted() {
            break;
        }
    }
    Ok(shortest)
}

fn row(
    work: &str,
    precision: &str,
    members: u64,
    units: f64,
    unit: &str,
    run: impl FnMut() -> Result<()>,
) -> Result<Row> {
    let seconds = shortest_s(run)?;
    Ok(Row {
        work: work.to_owned(),
        place: "cpu".to_owned(),
        precision: precision.to_owned(),
        members,
        seconds,
        per_second: units / seconds,
        unit: unit.to_owned(),
        share_of_peak: None,
    })
}

const STEPS: &str = "member-steps";

/// The machine's peak and the work unit that other tools are measured on, in one precision.
///
/// # Errors
/// None; the signature is that of the others.
fn ceiling<T: crate::numerics::elementary::Real>() -> Result<Vec<Row>> {
    let peak = |done: &mut f64, work: fn() -> f64| {
        row("multiply-add peak", T::NAME, 0, 1.0, "multiply-adds", || {
            *done = work();
            Ok(())
        })
    };
    let mut best: Option<Row> = None;
    for work in [peak::multiply_adds::<T, 1>, peak::multiply_adds::<T, 2>, peak::multiply_adds::<T, 3>] {
        let mut done = 0.0;
        let mut measured = peak(&mut done, work)?;
        measured.per_second = done / measured.seconds;
        if best.as_ref().is_none_or(|b| b.per_second < measured.per_second) {
            best = Some(measured);
        }
    }
    let peak = best.as_ref().map_or(f64::NAN, |b| b.per_second);
    let mut rows: Vec<Row> = best.into_iter().collect();
    let problem = duffing::Problem::<T>::new();
    let steps = (duffing::MEMBERS * duffing::STEPS) as f64;
    for (noise, name) in [(false, "Duffing, Runge-Kutta 4"), (true, "Duffing, Runge-Kutta 4, one normal number a step")]
    {
        let mut measured = row(name, T::NAME, duffing::MEMBERS as u64, steps, STEPS, || {
            std::hint::black_box(problem.run(noise, Level::best()));
            Ok(())
        })?;
        measured.share_of_peak = (!noise).then_some(measured.per_second * duffing::INSTRUCTIONS / peak);
        rows.push(measured);
    }
    Ok(rows)
}

/// A job on a backend, drawing of members and sums included.
fn ensemble(name: &str, place: &str, backend: &mut dyn Backend, job: &Job) -> Result<Row> {
    let members = job.members.min(backend.batch_members(job)?);
    let steps = members * job.clock.samples * u64::from(job.clock.steps_per_sample * job.integrator.substeps());
    let precision = backend.machine(job).precision;
    let mut measured = row(name, &precision, members, steps as f64, STEPS, || {
        let batch = Batch { job, members: 0..members, bins: &[], progress: &|_| () };
        backend.run(&batch).map(drop)
    })?;
    measured.place = place.to_owned();
    Ok(measured)
}

/// All measurements on the CPU.
///
/// # Errors
/// Ctrl-C.
pub fn cpu(mut told: impl FnMut(&str)) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    told("multiply-add peak and Duffing");
    rows.extend(ceiling::<f32>()?);
    rows.extend(ceiling::<f64>()?);
    told("a plain loop");
    rows.push(row(
        "the noisy Duffing unit as a plain loop, one member at a time",
        "f64",
        512,
        512.0 * 4096.0,
        STEPS,
        || {
            std::hint::black_box(scalar::duffing(512));
            Ok(())
        },
    )?);
    for precision in [Precision::F32, Precision::F64] {
        let mut cpu = Cpu { precision, ..Cpu::default() };
        for (name, job) in work::ensembles(8192) {
            told(name);
            rows.push(ensemble(name, "cpu", &mut cpu, &job)?);
        }
    }
    for members in work::SIZES {
        told("sizes");
        let job = work::full(members);
        let mut cpu = Cpu { batch_members: members, ..Cpu::default() };
        rows.push(ensemble(work::SIZED, "cpu", &mut cpu, &job)?);
    }
    Ok(rows)
}

/// The ensembles on a device.
///
/// # Errors
/// As the device; Ctrl-C.
pub fn gpu(name: &str, hardware: bool, backend: &mut dyn Backend, mut told: impl FnMut(&str)) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    // A card is full at a million members; a software adapter at a few thousand.
    let many = if hardware { 1 << 20 } else { 8192 };
    for (what, job) in work::ensembles(many) {
        told(what);
        rows.push(ensemble(what, name, backend, &job)?);
    }
    for members in work::SIZES {
        told("sizes");
        rows.push(ensemble(work::SIZED, name, backend, &work::full(members))?);
    }
    Ok(rows)
}

/// Rows `peer,config,dtype,work,seconds_per_run,others_cpu_fraction,x_check` of the work unit that other tools print too.
pub fn peers() -> Vec<String> {
    fn rows<T: crate::numerics::elementary::Real>(dtype: &str) -> Vec<String> {
        let problem = duffing::Problem::<T>::new();
        let one = |(noise, work): (bool, &str)| {
            let (begun, mut runs) = (Instant::now(), 0);
            let mut x = problem.run(noise, Level::best());
            let warm = Instant::now();
            while runs == 0 || begun.elapsed().as_secs_f64() < 0.5 {
                x = problem.run(noise, Level::best());
                runs += 1;
            }
            let seconds = warm.elapsed().as_secs_f64() / f64::from(runs);
            format!("proofmass,64 lanes {},{dtype},{work},{seconds:.5},0.000,{x:.9e}", Level::best().name())
        };
        [(false, "rk4"), (true, "rk4+noise")].map(one).into()
    }
    let full = |(precision, dtype): (Precision, &str)| {
        let mut cpu = Cpu { precision, ..Cpu::default() };
        let job = work::full(8192);
        let measured = ensemble("full", "cpu", &mut cpu, &job).map_or(f64::NAN, |r| r.seconds);
        format!("proofmass,ensemble kernel {},{dtype},full,{measured:.5},0.000,nan", Level::best().name())
    };
    let mut all = rows::<f32>("float32");
    all.extend(rows::<f64>("float64"));
    all.extend([(Precision::F32, "float32"), (Precision::F64, "float64")].map(full));
    all
}
