//! A study in motion that was stopped or killed goes on with `--resume` and ends with the bits of
//! one that was not.

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::bench::{Bench, run};
use super::strapdown::NOISE;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("resume: a flight that was stopped or killed ends with the same bits", same_bits),
        test("resume: a state of another flight is refused", another),
        test("resume: a run that begins anew says that it replaces what an interrupted one had done", anew),
    ]
}

/// Numbers of members, in several batches each: the first that is long enough to be stopped on this
/// machine is taken.
const MEMBERS: [u64; 4] = [20_000, 60_000, 180_000, 540_000];

/// A folder with a study.
struct World(tempfile::TempDir);

impl World {
    fn new(members: u64) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        let text = format!(
            "members = {members}\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\nkind = \"car\"\n\
             [earth]\nlatitude_deg = 47.4\n[report]\ntimes_s = [10.0, 20.0]\n{NOISE}[alignment]\nkind = \"still\"\n\
             still_s = 2.0\n"
        );
        std::fs::write(folder.path().join("study.toml"), text)?;
        Ok(Self(folder))
    }

    fn state(&self) -> PathBuf {
        self.0.path().join("out/interrupted-1.json")
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = program();
        command.args(["--json", "study"]).arg(self.0.path().join("study.toml"));
        command.arg("--out").arg(self.0.path().join("out")).args(["--backend", "cpu"]).args(more);
        command.env("PROOFMASS_STATE_INTERVAL_S", "0.0").stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// What a run says that is sent a signal once it has kept something; `None` of one that ended
    /// before.
    fn stopped(&self, signal: &str) -> Result<Option<Output>, Failed> {
        let mut child = self.command(&[]).spawn()?;
        while !self.state().exists() && child.try_wait()?.is_none() {
            std::thread::sleep(Duration::from_millis(5));
        }
        Command::new("kill").arg(format!("-{signal}")).arg(child.id().to_string()).stderr(Stdio::null()).status()?;
        let output = child.wait_with_output()?;
        // A kill may meet a run that is done and has not ended yet.
        Ok((!output.status.success() && self.state().exists()).then_some(output))
    }

    /// A run that was stopped, of the smallest number of members that allows it.
    fn interrupted(signal: &str) -> Result<(Self, u64, Output), Failed> {
        for members in MEMBERS {
            let world = Self::new(members)?;
            let Some(output) = world.stopped(signal)? else { continue };
            let state: Value = serde_json::from_slice(&std::fs::read(world.state())?)?;
            let done = state["next_member"].as_u64().unwrap_or(0);
            check(done > 0, "nothing is kept")?;
            if done < members {
                return Ok((world, members, output));
            }
        }
        Err("no run was long enough to be stopped".into())
    }
}

fn ended(output: &Output) -> Result<Value, Failed> {
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    let mut document: Value = serde_json::from_slice(&output.stdout)?;
    document.as_object_mut().and_then(|fields| fields.remove("seconds"));
    Ok(document)
}

fn same_bits() -> Result<(), Failed> {
    for signal in ["INT", "KILL"] {
        let (world, members, output) = World::interrupted(signal)?;
        if signal == "INT" {
            check(output.status.code() == Some(130), format!("exit {:?}", output.status.code()))?;
            let message = String::from_utf8_lossy(&output.stderr);
            check(message.contains("--resume"), format!("it does not say how to go on: {message}"))?;
        }
        let resumed = ended(&world.command(&["--resume"]).output()?)?;
        check(!world.state().exists(), "a resumed run leaves its state behind")?;
        let whole = ended(&World::new(members)?.command(&[]).output()?)?;
        check(resumed == whole, "resumed and undisturbed answers differ")?;
        // Control: another seed has other bits.
        let other = ended(&World::new(members)?.command(&["--set", "seed=2"]).output()?)?;
        check(other["position_error_ned_m"] != whole["position_error_ned_m"], "any run gives these bits")?;
    }
    Ok(())
}

fn another() -> Result<(), Failed> {
    let refused = |world: &World, more: &[&str], words: &str| {
        let output = world.command(&[&["--resume"], more].concat()).output()?;
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        check(!output.status.success() && message.contains(words), format!("no {words:?} in: {message}"))
    };
    refused(&World::new(MEMBERS[0])?, &[], "no interrupted run")?;
    let (world, ..) = World::interrupted("KILL")?;
    refused(&world, &["--set", "seed=2"], "another run")?;
    let bytes = std::fs::read(world.state())?;
    let damaged = String::from_utf8_lossy(&bytes).replacen("\"failed\":0", "\"failed\":7", 1);
    std::fs::write(world.state(), damaged)?;
    refused(&world, &[], "damaged")
}

fn anew() -> Result<(), Failed> {
    let bench = Bench::new()?;
    let study = bench.file("study.toml", "members = 100\nduration_s = 1.0\n[report]\ntimes_s = [1.0]\n")?;
    let command = |more: &[&str]| {
        let mut command = program();
        command.arg("study").arg(&study).arg("--out").arg(bench.path("out")).args(["--backend", "cpu"]).args(more);
        command
    };
    let first = run(&mut command(&[]))?;
    check(first.code == Some(0) && !first.stderr.contains("--resume"), format!("control: {}", first.stderr))?;
    bench.file("out/interrupted-1.json", "{}")?;
    // Not of this program's writing: the user says that it may go.
    let again = run(&mut command(&["--force"]))?;
    check(again.code == Some(0) && again.stderr.contains("--resume goes on"), format!("nothing said: {}", again.stderr))
}
