//! Too little of what a machine must give: each limit ends in words, with the answer printed where
//! there is one, and leaves whole files or none.

use std::path::Path;
use std::process::{Command, Output};

use libtest_mimic::{Failed, Trial};
use serde_json::Value;

use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    if !cfg!(unix) {
        return Vec::new();
    }
    vec![
        test("limits: files that may not be as large as the report (ulimit -f)", small_files),
        test("limits: a little memory is enough for a study (ulimit -v)", little_memory),
        small_disk(),
    ]
}

const STUDY: &str =
    "name = \"small\"\nmembers = 1024\nduration_s = 5.0\n[accelerometer]\nnoise_density_ug_rthz = 100.0\n";

/// A study run by a shell that has set a limit.
fn limited(folder: &Path, limit: &str, out: &Path) -> Result<Output, Failed> {
    let study = folder.join("study.toml");
    std::fs::write(&study, STUDY)?;
    let program = env!("CARGO_BIN_EXE_proofmass");
    let script = format!("{limit} && exec \"$0\" --json study \"$1\" --backend cpu --out \"$2\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, program]).arg(&study).arg(out).env("PROOFMASS_STATE_INTERVAL_S", "0.01");
    // Each thread takes addresses for its stack and its part of the heap.
    command.env("RAYON_NUM_THREADS", "2");
    Ok(command.output()?)
}

/// An error in words about a report that could not be written, after an answer that was printed.
fn without_report(output: &Output, out: &Path) -> Result<(), Failed> {
    let message = String::from_utf8_lossy(&output.stderr);
    check(output.status.code() == Some(2), format!("exit {:?}: {message}", output.status.code()))?;
    check(message.contains("cause:") && message.contains("hint:") && !message.contains("panicked"), message.clone())?;
    check(message.contains("could not write"), message.clone())?;
    let answer: Value = serde_json::from_slice(&output.stdout).map_err(|e| format!("no answer was printed: {e}"))?;
    check(answer["schema"] == "proofmass.study/1", "the answer is another document")?;
    // A folder that was made for nothing may be gone again.
    for entry in std::fs::read_dir(out).into_iter().flatten() {
        let path = entry?.path();
        let name = path.display().to_string();
        let is_whole = match path.extension().and_then(|e| e.to_str()) {
            Some("json") => serde_json::from_slice::<Value>(&std::fs::read(&path)?).is_ok(),
            Some("html") => std::fs::read_to_string(&path)?.trim_end().ends_with("</html>"),
            Some("svg") => std::fs::read_to_string(&path)?.trim_end().ends_with("</svg>"),
            _ => false,
        };
        check(is_whole, format!("{name} is half-written"))?;
    }
    Ok(())
}

fn small_files() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("out");
    // 16 blocks: 8 or 16 KB, as the shell counts.
    without_report(&limited(folder.path(), "ulimit -f 16", &out)?, &out)
}

fn little_memory() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("out");
    // 400 MB of addresses: stacks of threads count in full.
    let output = limited(folder.path(), "ulimit -v 400000", &out)?;
    check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
    check(std::fs::read_to_string(out.join("report.html"))?.trim_end().ends_with("</html>"), "half a report")
}

/// A disk of 24 KB, mounted in a folder; goes with the value.
struct Disk(tempfile::TempDir);

impl Disk {
    fn new() -> Option<Self> {
        let folder = tempfile::tempdir().ok()?;
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=24k", "tmpfs"]).arg(folder.path());
        mount.output().is_ok_and(|output| output.status.success()).then_some(Self(folder))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).output();
    }
}

fn small_disk() -> Trial {
    match Disk::new() {
        Some(disk) => test("limits: a disk of 24 KB", move || {
            let (folder, out) = (tempfile::tempdir()?, disk.0.path().join("out"));
            without_report(&limited(folder.path(), "true", &out)?, &out)
        }),
        None => {
            Trial::test("limits: a disk of 24 KB (needs the right to mount one)", || Ok(())).with_ignored_flag(true)
        }
    }
}
