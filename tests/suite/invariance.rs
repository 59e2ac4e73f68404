//! The same bits for any tile, batch, thread count and lane width, and for a run that was interrupted and resumed.

use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::{Cpu, Precision};
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::backend::{Backend, Batch, Partial};
use proofmass::ensemble::{Options, run_on};
use proofmass::error::Result;
use proofmass::kernel::cpu::lanes::Level;
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::{Job, Member};
use proofmass::sensor::{ProofMass, Sensor};
use proofmass::statistics::quantity::POSITION;
use proofmass::statistics::{Machine, Statistics};
use proofmass::validation::jobs::{Sine, duffing, job};
use proofmass::validation::parity::everything;

use super::world::{check, gpu_test, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("invariance: tiles, batches, threads and lanes do not change a bit", cpu),
        test("invariance: an interrupted and resumed run gives the same bits", resumed),
        test("invariance: members that fail are counted and left out", failing),
        gpu_test("invariance: tiles and batches do not change a bit on the GPU", gpu),
    ]
}

fn study() -> Job {
    let sensor = Sensor { proof_mass: Some(duffing(30.0, 0.7)), ..everything() };
    let force = Sine { amplitude_m_s2: 5.0, frequency_hz: 3.0, offset_m_s2: 0.0 };
    job(sensor, 1500, &[0.07, 1.0, 2.5], force, Integrator::RungeKutta4 { substeps: 1 })
}

fn run(backend: &mut dyn Backend, batch: Option<u64>) -> Result<Statistics> {
    run_on(&study(), backend, &Options { quiet: true, batch_members: batch, ..Options::default() })
}

fn same(what: &str, a: &Statistics, b: &Statistics) -> std::result::Result<(), Failed> {
    check(a.at == b.at && a.failed == b.failed, format!("{what} changes the result"))
}

fn cpu() -> std::result::Result<(), Failed> {
    let plain = run(&mut Cpu::default(), None)?;
    for tile_samples in [4, 60, 1000] {
        same("the tile", &plain, &run(&mut Cpu { tile_samples, ..Cpu::default() }, None)?)?;
    }
    for batch in [256, 1024] {
        same("the batch", &plain, &run(&mut Cpu::default(), Some(batch))?)?;
    }
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    same("the number of threads", &plain, &one.install(|| run(&mut Cpu::default(), None))?)?;
    for level in Level::available().into_iter().filter(|l| l.fused() == Level::best().fused()) {
        same("the lane width", &plain, &run(&mut Cpu { level, ..Cpu::default() }, None)?)?;
    }
    // Control: another precision is another result.
    let other = run(&mut Cpu { precision: Precision::F64, ..Cpu::default() }, None)?;
    check(other.at != plain.at, "f32 and f64 gave the same bits: the comparison is blind")
}

/// A backend whose user presses Ctrl-C after a few batches.
struct Impatient {
    cpu: Cpu,
    patience: u32,
}

impl Backend for Impatient {
    fn machine(&self, job: &Job) -> Machine {
        self.cpu.machine(job)
    }
    fn batch_members(&self, job: &Job) -> Result<u64> {
        self.cpu.batch_members(job)
    }
    fn run(&mut self, batch: &Batch<'_>) -> Result<Option<Vec<Partial>>> {
        self.patience = self.patience.saturating_sub(1);
        if self.patience == 0 { Ok(None) } else { self.cpu.run(batch) }
    }
}

fn resumed() -> std::result::Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let state = folder.path().join("state.json");
    let mut options =
        Options { quiet: true, batch_members: Some(512), state: Some(state.clone()), ..Options::default() };
    let stopped = run_on(&study(), &mut Impatient { cpu: Cpu::default(), patience: 3 }, &options);
    check(stopped.is_err_and(|e| e.hint.contains("--resume")), "an interrupted run does not say how to go on")?;
    check(state.exists(), "an interrupted run leaves no state")?;
    options.resume = true;
    let other = Job { seed: 2, ..study() };
    check(run_on(&other, &mut Cpu::default(), &options).is_err(), "the state of another study was accepted")?;
    let whole = run_on(&study(), &mut Cpu::default(), &options)?;
    check(!state.exists(), "a finished run leaves its state behind")?;
    same("interruption", &run(&mut Cpu::default(), None)?, &whole)
}

/// Every other member has a spring that softens until it gives way under the load.
fn failing() -> std::result::Result<(), Failed> {
    let mut job = study();
    let plain = run_on(&job, &mut Cpu::default(), &Options { quiet: true, ..Options::default() })?;
    job.draw = Arc::new(|i| {
        let mass = duffing(30.0, 0.7);
        let cubic_per_m2_s2 = if i % 2 == 1 { -60.0 * mass.cubic_per_m2_s2 } else { mass.cubic_per_m2_s2 };
        let mut sensor = Sensor { proof_mass: Some(ProofMass { cubic_per_m2_s2, ..mass }), ..everything() };
        sensor.accelerometer.range_m_s2 = f64::INFINITY;
        Member { sensor, sine: None }
    });
    job.waveform = Arc::new(Sine { amplitude_m_s2: 9.0, frequency_hz: 3.0, offset_m_s2: 0.0 });
    let s = run_on(&job, &mut Cpu::default(), &Options { quiet: true, ..Options::default() })?;
    check(plain.failed == 0, "members fail that should not")?;
    check(s.failed == 750, format!("{} of 1500 members failed, 750 were made to", s.failed))?;
    let last = &s.at[s.at.len() - 1][POSITION];
    check(last.count == 750 && last.mean.is_finite() && last.sd < 1.0, "failed members are in the sums")
}

fn gpu() -> std::result::Result<(), Failed> {
    let device = Arc::new(Gpu::open(false)?);
    let on = |tile_samples| {
        let mut ensembles = Ensembles::on(device.clone());
        ensembles.tile_samples = tile_samples;
        ensembles
    };
    let plain = run(&mut on(4096), None)?;
    same("the tile", &plain, &run(&mut on(20), None)?)?;
    same("a tile that begins inside a draw of four", &plain, &run(&mut on(3), None)?)?;
    same("the batch", &plain, &run(&mut on(4096), Some(512))?)?;
    // A noise that a whole batch does not have: it must run the same kernel as the others.
    let mixed = Job {
        draw: Arc::new(|i| {
            let mut member = (study().draw)(i);
            member.sensor.gyro.rate_random_walk_rad_s_rts *= if i < 600 { 0.0 } else { 1.0 };
            member
        }),
        ..study()
    };
    let in_batches = |members| {
        let options = Options { quiet: true, batch_members: Some(members), ..Options::default() };
        run_on(&mixed, &mut on(4096), &options)
    };
    same("the batch where a noise is absent", &in_batches(1536)?, &in_batches(256)?)
}
