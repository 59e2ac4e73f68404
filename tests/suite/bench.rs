//! `diagnose` as a user runs it: a log and a model written into a folder of their own, and what the
//! program answers.

use std::fs;
use std::path::{Path, PathBuf};

use libtest_mimic::Failed;
use serde_json::Value;

use super::world::{check, program};

/// What the program said.
pub struct Answer {
    /// Exit status.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Answer {
    /// The document on standard output of a run that ended well.
    pub fn json(&self) -> Result<Value, Failed> {
        check(self.code == Some(0), format!("exit {:?}: {}", self.code, self.stderr))?;
        Ok(serde_json::from_str(&self.stdout)?)
    }

    /// Exit 2 with an attempt, a cause that holds these words (none are nobody's cause) and a hint.
    pub fn refuses(&self, what: &str, words: &str) -> Result<(), Failed> {
        check(!words.is_empty(), format!("{what}: the test says nothing of the cause"))?;
        check(self.code == Some(2), format!("{what}: exit {:?} {}{}", self.code, self.stdout, self.stderr))?;
        for part in ["error: ", "cause: ", "hint:  ", words] {
            check(self.stderr.contains(part), format!("{what}: no \"{part}\" in: {}", self.stderr))?;
        }
        Ok(())
    }
}

/// Runs the program.
pub fn run(command: &mut std::process::Command) -> Result<Answer, Failed> {
    let output = command.output()?;
    Ok(Answer {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}

/// `proofmass diagnose` on files that exist.
pub fn diagnose(csv: &Path, model: &Path, more: &[&str]) -> Result<Answer, Failed> {
    run(program().arg("diagnose").arg(csv).arg("--model").arg(model).args(more))
}

/// A folder to write logs and models into.
pub struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    /// An empty one.
    pub fn new() -> Result<Self, Failed> {
        Ok(Self { folder: tempfile::tempdir()? })
    }

    /// Where a file of this name stands.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn file(&self, name: &str, text: &str) -> Result<PathBuf, Failed> {
        let path = self.path(name);
        fs::write(&path, text)?;
        Ok(path)
    }

    /// Diagnoses a log by a model.
    pub fn diagnose(&self, csv: &str, model: &str, more: &[&str]) -> Result<Answer, Failed> {
        diagnose(&self.file("log.csv", csv)?, &self.file("model.toml", model)?, more)
    }

    /// The verdict on a log that can be judged.
    pub fn verdict(&self, csv: &str, model: &str) -> Result<Value, Failed> {
        self.diagnose(csv, model, &["--json"])?.json()
    }

    /// Fails unless the log is refused for this cause.
    pub fn refused(&self, what: &str, csv: &str, model: &str, words: &str) -> Result<(), Failed> {
        self.diagnose(csv, model, &[])?.refuses(what, words)
    }

    /// The verdict on a log that is judged in spite of its damage, which is mentioned in these
    /// words.
    pub fn survived(&self, what: &str, csv: &str, model: &str, words: &str) -> Result<Value, Failed> {
        let answer = self.diagnose(csv, model, &["--json"])?;
        check(answer.code == Some(0), format!("{what}: exit {:?} {}", answer.code, answer.stderr))?;
        let verdict: Value = serde_json::from_str(&answer.stdout)?;
        let found = verdict["findings"].to_string();
        check(found.contains(words), format!("{what}: no \"{words}\" in {found}"))?;
        Ok(verdict)
    }
}

/// Runs a repaired model as a study of so many members; its document.
pub fn study(model: &Path, out: &Path, members: u32) -> Result<Value, Failed> {
    let members = members.to_string();
    let answer = run(program().arg("study").arg(model).args(["--members", &members, "--json", "--out"]).arg(out))?;
    check(answer.code == Some(0), format!("the repaired model does not run as a study: {}", answer.stderr))?;
    let drift = answer.json()?;
    check(drift["schema"] == "proofmass.study/1" && drift["failed"] == 0, "the repaired model fails as a study")?;
    Ok(drift)
}
