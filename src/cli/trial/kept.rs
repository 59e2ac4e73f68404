//! A sealed trial in a folder: what a stopped one goes on from, and what a finished one leaves and says.

use std::path::{Path, PathBuf};

use crate::output::{say, sayln};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_trial::scratch::Scratch;

const STATES: [&str; 2] = ["truth.json", "verdicts.jsonl"];
const FILES: [&str; 3] = ["report.html", "summary.md", "trial.json"];

/// Folder of a trial's results, and whether they may be there.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// Folder of the results; without one, nothing is kept.
    pub out: Option<PathBuf>,
    /// Replace what is not ours.
    pub force: bool,
    /// Says whether to continue an interrupted trial.
    pub resume: bool,
}

/// A trial in its folder.
pub(super) struct Kept {
    place: Place,
    folder: Option<Folder>,
    scratch: Scratch,
}

/// Texts of a finished trial.
pub(super) struct Found {
    /// SHA-256 of the sealed truth.
    pub sealed: String,
    /// The JSON document.
    pub document: String,
    /// The report page.
    pub page: String,
    /// The summary that is committed.
    pub summary: String,
    /// Words for a terminal.
    pub words: String,
}

impl Kept {
    /// Opens the folder; to resume a trial, there must be one.
    ///
    /// # Errors
    /// There is none to resume, or nothing can be written.
    pub(super) fn open(command: &'static str, place: &Place) -> Result<Self> {
        let Place { out, force, resume } = place.clone();
        let open = |path: &Path| -> Result<Folder> {
            if resume && !path.join(STATES[0]).is_file() {
                return Err(Error::new(
                    "could not resume",
                    format!("no trial in {}", path.display()),
                    "leave --resume out to start over, or give the --out of the interrupted trial",
                ));
            }
            let writes = FILES.map(str::to_owned).to_vec();
            let mut folder =
                Folder::open(path, output::Request { command, writes, force, ..output::Request::default() })?;
            STATES.iter().try_for_each(|name| folder.state(name, resume))?;
            Ok(folder)
        };
        let folder = out.as_deref().map(open).transpose()?;
        Ok(Self { place: place.clone(), folder, scratch: Scratch::new(out.as_deref())? })
    }

    fn path(&self, state: &str) -> PathBuf {
        self.place.out.as_deref().unwrap_or(self.scratch.path()).join(state)
    }

    /// Path of the sealed truth.
    pub(super) fn truth(&self) -> PathBuf {
        self.path(STATES[0])
    }

    /// Path of the verdicts, a line each; those of an earlier trial go, where this one begins anew.
    ///
    /// # Errors
    /// They cannot be removed.
    pub(super) fn verdicts(&self) -> Result<PathBuf> {
        let path = self.path(STATES[1]);
        if !self.place.resume && path.exists() {
            std::fs::remove_file(&path).map_err(|e| Error::io("replace", &path, &e))?;
        }
        Ok(path)
    }

    /// Writes the results and prints them.
    ///
    /// # Errors
    /// They cannot be written or printed.
    pub(super) fn finish(self, found: &Found, json: bool) -> Result<()> {
        let Found { sealed, document, page, summary, words } = found;
        let written = self.folder.map_or(Ok(()), |mut folder| {
            let texts = [page, summary, document];
            FILES.iter().zip(texts).try_for_each(|(name, text)| folder.write(name, text.as_bytes()))?;
            STATES.iter().for_each(|name| folder.record(name));
            folder.finish()
        });
        if json {
            sayln!("{document}")?;
        } else {
            sayln!("sealed truth, SHA-256 {sealed} (opened after the last verdict)\n")?;
            say(format_args!("{words}"))?;
            if let (Some(folder), Ok(())) = (&self.place.out, &written) {
                sayln!("\nreport: {}", folder.join(FILES[0]).display())?;
            }
        }
        written
    }
}
