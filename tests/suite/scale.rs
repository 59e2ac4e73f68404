//! Ensembles too large for any patience: planned and begun within a bounded memory, and stopped at once.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use libtest_mimic::{Failed, Trial};
use proofmass::backend::Backend;
use proofmass::backend::cpu::Cpu;
use proofmass::kernel::integrator::Integrator;
use proofmass::kernel::job::Job;
use proofmass::validation::jobs::{Sine, duffing, job};
use proofmass::validation::parity::everything;

use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    let mut all = vec![test("scale: batches do not grow with the ensemble", batches)];
    #[cfg(target_os = "linux")]
    all.push(test("scale: ten million members over a million steps begin in bounded memory and stop at once", begun));
    all
}

fn batches() -> Result<(), Failed> {
    let force = Sine { amplitude_m_s2: 1.0, frequency_hz: 1.0, offset_m_s2: 0.0 };
    let sensor = proofmass::sensor::Sensor { proof_mass: Some(duffing(30.0, 0.7)), ..everything() };
    let of = |members: u64| -> Job { job(sensor, members, &[1.0], force, Integrator::RungeKutta4 { substeps: 1 }) };
    let [small, large] = [1_000_000, 10_000_000].map(|m| Cpu::default().batch_members(&of(m)));
    let (small, large) = (small?, large?);
    check(small == large && large <= 100_000, format!("{small} and {large} members per batch"))
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
    std::thread::sleep(Duration::from_millis(2500));
    let ended = child.try_wait()?;
    let held = most_memory(child.id());
    Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
    let asked = Instant::now();
    let output = child.wait_with_output()?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    check(ended.is_none(), format!("it ended by itself: {message}"))?;
    check(output.status.code() == Some(130) && message.contains("Ctrl-C"), message)?;
    check(asked.elapsed() < Duration::from_secs(5), format!("it took {:?} to stop", asked.elapsed()))?;
    let held = held?;
    check(held < 512 << 20, format!("it held {} MB", held >> 20))
}
