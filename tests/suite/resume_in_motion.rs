//! A study in motion that was stopped or killed goes on with `--resume` and ends with the bits of one that was not.

use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::strapdown::NOISE;
use super::world::{check, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("resume: a flight that was stopped or killed ends with the same bits", same_bits),
        test("resume: a state of another flight is refused", another),
    ]
}

/// Several batches of a few tenths of a second each.
struct World(tempfile::TempDir);

impl World {
    fn new() -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        let text = format!(
            "members = 20000\nduration_s = 20.0\n[sensor]\nsample_rate_hz = 50.0\n[trajectory]\nkind = \"car\"\n\
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

    /// A run that has kept something.
    fn begun(&self, more: &[&str]) -> Result<Child, Failed> {
        let mut child = self.command(more).spawn()?;
        for _ in 0..12_000 {
            if self.state().exists() {
                return Ok(child);
            }
            check(child.try_wait()?.is_none(), "it ended before anything was kept")?;
            std::thread::sleep(Duration::from_millis(5));
        }
        Err("nothing was kept for a minute".into())
    }
}

fn ended(output: &Output) -> Result<Value, Failed> {
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    let mut document: Value = serde_json::from_slice(&output.stdout)?;
    document.as_object_mut().and_then(|fields| fields.remove("seconds"));
    Ok(document)
}

fn same_bits() -> Result<(), Failed> {
    let world = World::new()?;
    let whole = ended(&world.command(&[]).output()?)?;
    check(!world.state().exists(), "a finished run leaves its state behind")?;
    for signal in ["INT", "KILL"] {
        let world = World::new()?;
        let child = world.begun(&[])?;
        let sent = Command::new("kill").arg(format!("-{signal}")).arg(child.id().to_string()).status()?;
        check(sent.success(), "kill failed")?;
        let output = child.wait_with_output()?;
        check(!output.status.success(), "it ended before it was stopped")?;
        if signal == "INT" {
            check(output.status.code() == Some(130), format!("exit {:?}", output.status.code()))?;
            let message = String::from_utf8_lossy(&output.stderr);
            check(message.contains("--resume"), format!("it does not say how to go on: {message}"))?;
        }
        let state: Value = serde_json::from_slice(&std::fs::read(world.state())?)?;
        let done = state["next_member"].as_u64().unwrap_or(0);
        check(done > 0 && done < 20_000, format!("{done} members are kept"))?;
        check(ended(&world.command(&["--resume"]).output()?)? == whole, "resumed and undisturbed answers differ")?;
        check(!world.state().exists(), "a resumed run leaves its state behind")?;
    }
    // Control: another seed has other bits.
    let other = ended(&World::new()?.command(&["--set", "seed=2"]).output()?)?;
    check(other["position_error_ned_m"] != whole["position_error_ned_m"], "any run gives these bits")
}

fn another() -> Result<(), Failed> {
    let world = World::new()?;
    let refused = |output: &Output, words: &str| {
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        check(!output.status.success() && message.contains(words), format!("no {words:?} in: {message}"))
    };
    refused(&world.command(&["--resume"]).output()?, "no interrupted run")?;
    let mut child = world.begun(&[])?;
    child.kill()?;
    child.wait()?;
    refused(&world.command(&["--resume", "--set", "seed=2"]).output()?, "another run")?;
    let bytes = std::fs::read(world.state())?;
    let damaged = String::from_utf8_lossy(&bytes).replacen("\"failed\":0", "\"failed\":7", 1);
    std::fs::write(world.state(), damaged)?;
    refused(&world.command(&["--resume"]).output()?, "damaged")
}
