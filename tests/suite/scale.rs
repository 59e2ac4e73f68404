//! Ensembles too large for any patience: planned and begun within a bounded memory, and stopped at
//! once.

use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};
use proofmass::backend::cpu::Cpu;
use proofmass::backend::gpu::Gpu;
use proofmass::backend::gpu::simulate::Ensembles;
use proofmass::backend::{Backend, Batch, Ran};
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::Job;
use proofmass::statistics::Machine;
use proofmass::validation::jobs::{Sine, duffing, job};
use proofmass::validation::parity::everything;

use super::world::{check, gpu_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![
        test("scale: batches of the CPU do not grow with the ensemble", || bounded(&Cpu::default())),
        test("scale: batches that grow with the ensemble are noticed", grown),
    ];
    all.push(gpu_test("scale: batches of a GPU do not grow with the ensemble", || {
        bounded(&Ensembles::on(Arc::new(Gpu::open()?)))
    }));
    #[cfg(target_os = "linux")]
    all.push(test("scale: ten million members over a million steps begin in bounded memory and stop at once", begun));
    all
}

/// Members of a batch are as many for a million sensors as for ten, and fit a memory.
fn bounded(backend: &dyn Backend) -> Result<(), Failed> {
    let force = Sine { amplitude_m_s2: 1.0, frequency_hz: 1.0, offset_m_s2: 0.0 };
    let sensor = proofmass::sensor::Sensor { proof_mass: Some(duffing(30.0, 0.7)), ..everything() };
    let of = |members: u64| -> Job { job(sensor, members, &[1.0], force, Integrator::RungeKutta4 { substeps: 1 }) };
    let (small, large) = (backend.batch_members(&of(1_000_000))?, backend.batch_members(&of(10_000_000))?);
    // Half a gigabyte of members: columns, state and flicker terms are some hundred numbers of four
    // bytes.
    check(small == large && large <= 1 << 20, format!("{small} and {large} members per batch"))
}

/// A backend that takes every ensemble whole.
struct Whole;

impl Backend for Whole {
    fn machine(&self, job: &Job) -> Machine {
        Cpu::default().machine(job)
    }

    fn batch_members(&self, job: &Job) -> proofmass::error::Result<u64> {
        Ok(job.members)
    }

    fn run(&mut self, batch: &Batch<'_>) -> proofmass::error::Result<Ran> {
        Cpu::default().run(batch)
    }
}

fn grown() -> Result<(), Failed> {
    check(bounded(&Whole).is_err(), "a backend without batches passes")
}

/// Most memory that a process has held, bytes.
#[cfg(target_os = "linux")]
fn most_memory(process: u32) -> Result<u64, Failed> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status"))?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).ok_or("no VmHWM")?;
    let kilobytes: u64 = line.trim().trim_end_matches(" kB").parse()?;
    Ok(kilobytes * 1024)
}

#[cfg(target_os = "linux")]
fn begun() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("fleet.toml");
    let text = "name = \"fleet\"\nmembers = 10000000\nduration_s = 10000.0\nstep_s = 0.01\n[sensor]\n\
                sample_rate_hz = 100.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\nbias_instability_ug = 40.0\n";
    std::fs::write(&path, text)?;
    let mut command = program();
    command.arg("study").arg(&path).arg("--out").arg(folder.path().join("out")).args(["--backend", "cpu"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
    while !folder.path().join("out/.proofmass.json").exists() && child.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(2500));
    let ended = child.try_wait()?;
    let held = most_memory(child.id());
    Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
    let asked = Instant::now();
    let output = child.wait_with_output()?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    check(ended.is_none(), format!("it ended by itself: {message}"))?;
    check(output.status.code() == Some(130) && message.contains("Ctrl-C"), message)?;
    check(asked.elapsed() < Duration::from_secs(20), format!("it took {:?} to stop", asked.elapsed()))?;
    let held = held?;
    check(held < 512 << 20, format!("it held {} MB", held >> 20))
}
