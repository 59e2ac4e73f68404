//! The same bits for any tile, batch, thread count and lane width, and for a run that was
//! interrupted and resumed.

use std::path::Path;
use std::sync::Arc;

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::{Cpu, Precision};
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::backend::{Backend, Batch, Ran};
use proofmass::control::Control;
use proofmass::ensemble::{Choice, Keeper, Options, run_kept, run_on, run_or_fall_back};
use proofmass::error::{Error, Result};
use proofmass::kernel::cpu::lanes::Level;
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::{Job, Member};
use proofmass::sensor::Sensor;
use proofmass::sensor::mechanics::CUBIC_STIFFNESS;
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
        test("invariance: a CPU that goes on for a device gives the bits of a CPU", falling_back),
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
    run_on(&study(), backend, &Options { batch_members: batch, ..Options::default() })
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

/// A backend that stops within a batch, every time it is asked to go on, and fails after so many
/// tiles.
struct Faulty {
    cpu: Cpu,
    tiles: u32,
    failed: bool,
}

impl Faulty {
    /// With another instruction set than the CPU's own, so that it has bits of its own where the
    /// two differ.
    fn after(tiles: u32) -> Self {
        Self { cpu: Cpu { tile_samples: 40, level: Level::Baseline, ..Cpu::default() }, tiles, failed: false }
    }
}

impl Backend for Faulty {
    fn machine(&self, job: &Job) -> Machine {
        Machine { kind: "gpu".to_owned(), name: "a device that fails".to_owned(), ..self.cpu.machine(job) }
    }
    fn batch_members(&self, job: &Job) -> Result<u64> {
        self.cpu.batch_members(job)
    }
    fn run(&mut self, batch: &Batch<'_>) -> Result<Ran> {
        self.tiles = self.tiles.saturating_sub(1);
        if self.tiles == 0 {
            self.failed = true;
            return Err(Error::new("could not compute", "the device was lost", "use another"));
        }
        let Batch { job, members, bins, resume, progress, .. } = batch;
        let after_one_tile = || true;
        let (job, members, bins) = (*job, members.clone(), *bins);
        self.cpu.run(&Batch { job, members, bins, resume: *resume, stop: &after_one_tile, progress: *progress })
    }
    fn has_failed(&self) -> bool {
        self.failed
    }
}

const IN_BATCHES: Options =
    Options { backend: Choice::Auto, precision: Precision::F32, batch_members: Some(512), control: Control::silent() };

/// A number in the state that a run has left.
fn state(folder: &Path) -> std::result::Result<serde_json::Value, Failed> {
    Ok(serde_json::from_slice(&std::fs::read(folder.join("interrupted-1.json"))?)?)
}

fn resumed() -> std::result::Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let begin = |resume: bool| match resume {
        true => Keeper::resume(folder.path(), "a study"),
        false => Ok(Keeper::new(folder.path(), "a study")),
    };
    // Members summed, then samples of the batch under way: how far a state has come.
    let reached = || -> std::result::Result<(u64, u64), Failed> {
        let state = state(folder.path())?;
        Ok((state["next_member"].as_u64().unwrap_or(0), state["under_way"][1]["samples"].as_u64().unwrap_or(0)))
    };
    let (mut stops, mut before) = (0, (0, 0));
    let whole = loop {
        let mut keeper = begin(stops > 0)?;
        match run_kept(&study(), &mut Faulty::after(4), &IN_BATCHES, &mut keeper) {
            Ok(statistics) => break statistics,
            Err(error) => check(error.hint.contains("--resume"), "an interrupted run does not say how to go on")?,
        }
        let now = reached()?;
        check(now > before, format!("from {before:?} to {now:?}: a run that was resumed did not come further"))?;
        (stops, before) = (stops + 1, now);
    };
    check(stops > 6, format!("only {stops} stops"))?;
    let plain = run(&mut Cpu { level: Level::Baseline, ..Cpu::default() }, None)?;
    same("interruption", &plain, &whole)?;
    let others: [(Job, &str); 3] =
        [(Job { seed: 2, ..study() }, "a study"), (Job { members: 1501, ..study() }, "a study"), (study(), "another")];
    for (job, identity) in others {
        let mut keeper = Keeper::resume(folder.path(), identity)?;
        let refused = run_kept(&job, &mut Cpu::default(), &IN_BATCHES, &mut keeper);
        check(refused.is_err_and(|e| e.cause.contains("another run")), "the state of another run was accepted")?;
    }
    // A digit of a sum that is not the one that was written.
    let path = folder.path().join("interrupted-1.json");
    let text = std::fs::read_to_string(&path)?;
    let place = text.find("\"mean\":").ok_or("no mean in the state")? + 12;
    let digit = if text.as_bytes()[place] == b'7' { "8" } else { "7" };
    std::fs::write(&path, format!("{}{digit}{}", &text[..place], &text[place + 1..]))?;
    let damaged = run_kept(&study(), &mut Cpu::default(), &IN_BATCHES, &mut begin(true)?);
    check(damaged.is_err_and(|e| e.cause.contains("checksum")), "a state that was changed was accepted")?;
    Keeper::new(folder.path(), "a study").forget()?;
    check(std::fs::read_dir(folder.path())?.count() == 0, "a finished run leaves its state behind")?;
    // Twice is no error: another may have removed it.
    Ok(Keeper::new(folder.path(), "a study").forget()?)
}

/// The first 512 members with one instruction set, the others with another.
struct Split;

impl Backend for Split {
    fn machine(&self, job: &Job) -> Machine {
        Cpu::default().machine(job)
    }
    fn batch_members(&self, job: &Job) -> Result<u64> {
        Cpu::default().batch_members(job)
    }
    fn run(&mut self, batch: &Batch<'_>) -> Result<Ran> {
        let level = if batch.members.start < 512 { Level::Baseline } else { Level::best() };
        Cpu { level, ..Cpu::default() }.run(batch)
    }
}

fn falling_back() -> std::result::Result<(), Failed> {
    // Eight tiles a batch: it fails in the second, whose members then all come from the CPU.
    let mut device = Faulty::after(12);
    let got = run_or_fall_back(&study(), &mut device, &IN_BATCHES, &mut Keeper::none())?;
    let expected = run_on(&study(), &mut Split, &IN_BATCHES)?;
    same("a device that fails", &expected, &got)?;
    let [first, second] = &got.origins[..] else { return Err("not two origins".into()) };
    check(first.members == (0..512) && first.machine.kind == "gpu" && first.reason.is_none(), format!("{first:?}"))?;
    check(second.members == (512..1500) && second.machine.kind == "cpu", format!("{second:?}"))?;
    check(second.reason.as_ref().is_some_and(|r| r.contains("the device was lost")), format!("{second:?}"))?;
    // Control: members of the one are not those of the other, where their instructions round
    // differently.
    let all = run(&mut Cpu::default(), None)?;
    check(all.at != got.at || Level::best().fused() == Level::Baseline.fused(), "the comparison is blind")
}
/// Every other member has a spring that softens until it gives way under the load.
fn failing() -> std::result::Result<(), Failed> {
    let mut job = study();
    let plain = run_on(&job, &mut Cpu::default(), &Options::default())?;
    job.draw = Arc::new(|i| {
        let mass = duffing(30.0, 0.7);
        let cubic = if i % 2 == 1 { -60.0 * mass.cubic_per_m2_s2() } else { mass.cubic_per_m2_s2() };
        let mut sensor = Sensor { proof_mass: Some(mass.with(&CUBIC_STIFFNESS, cubic)), ..everything() };
        sensor.accelerometer.range_m_s2 = f64::INFINITY;
        Member { sensor, sine: None }
    });
    job.waveform = Arc::new(Sine { amplitude_m_s2: 9.0, frequency_hz: 3.0, offset_m_s2: 0.0 });
    let s = run_on(&job, &mut Cpu::default(), &Options::default())?;
    check(plain.failed == 0, "members fail that should not")?;
    check(s.failed == 750, format!("{} of 1500 members failed, 750 were made to", s.failed))?;
    let last = &s.at[s.at.len() - 1][POSITION];
    check(last.count == 750 && last.mean.is_finite() && last.sd < 1.0, "failed members are in the sums")
}

fn gpu() -> std::result::Result<(), Failed> {
    let device = Arc::new(Gpu::open()?);
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
        let options = Options { batch_members: Some(members), ..Options::default() };
        run_on(&mixed, &mut on(4096), &options)
    };
    same("the batch where a noise is absent", &in_batches(1536)?, &in_batches(256)?)
}
