//! One verdict from files and nothing else: what is diagnosed, and what it says, in how much
//! processor time.

use std::path::PathBuf;

use super::processor;
use super::said::Said;
use super::workers::alone;
use proofmass_base::error::{Error, Kind, Result};
use proofmass_diagnosis::verdict::Verdict;

/// The files of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Files {
    /// Path of recording.csv.
    pub recording: PathBuf,
    /// Path of model.toml.
    pub model: PathBuf,
    /// Recordings of the same sensor that only judge.
    pub judging: Vec<PathBuf>,
}

/// Anything that turns a recording and a base model into a verdict.
pub type Subject<'a> = dyn Fn(&Files) -> Result<Verdict> + Sync + 'a;

/// Returns what a subject says of files, and the verdict itself where there is one. All of it is
/// done by one thread, whose processor time is the verdict's.
///
/// # Errors
/// No thread can be started, or the subject was asked to stop. A diagnosis that fails is a verdict
/// too: "error".
pub fn ask(files: &Files, subject: &Subject<'_>) -> Result<(Said, Option<Verdict>)> {
    let (verdict, seconds) = alone(|| {
        let begun = processor::thread_s();
        (subject(files), processor::thread_s() - begun)
    })?;
    match verdict {
        Ok(verdict) => Ok((Said::from_verdict(&verdict, seconds), Some(verdict))),
        Err(error) if error.kind == Kind::Interrupted => {
            Err(Error { hint: "run it again with --resume; finished verdicts are kept".into(), ..error })
        }
        Err(error) => Ok((Said::from_error(&error, seconds), None)),
    }
}
