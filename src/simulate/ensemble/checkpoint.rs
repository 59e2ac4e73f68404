//! Keeps what a run of several parts has summed up, so that it goes on after a stop, a kill or a
//! fault.
//!
//! One file per part, written when [`INTERVAL_S`] seconds of work are not kept yet and when the run
//! is stopped, and removed by [`Keeper::forget`], after the caller has written everything that the
//! run was for. A shard keeps all its pieces in one file, which is its result and stays.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::kept::Kept;
use super::state::{Run, State};
use super::state_file;
use crate::backend::cpu::Precision;
use crate::control::{Control, Stopped};
use crate::error::{Error, Result};
use crate::kernel::job::Job;

/// Seconds of work after which it is kept. `PROOFMASS_STATE_INTERVAL_S` sets another number.
const INTERVAL_S: f64 = 30.0;
/// Most parts of a run: an ensemble and its error budget have some twenty, a map over two keys has
/// 64 × 64 points.
const MOST_PARTS: usize = 4096;

/// The states of a run.
#[derive(Debug)]
pub struct Keeper {
    /// Folder of the files; none are written without.
    folder: Option<PathBuf>,
    /// The one file of a shard.
    shard: Option<Kept>,
    /// Identity of the run, so that sums of another are not mixed in.
    identity: String,
    interval: Duration,
    last: Instant,
    /// Says whether parts are read from their files.
    resume: bool,
    /// Parts that are done: their sums, megabytes each, where they are not written yet.
    done: Vec<Option<State>>,
    /// The part begun last, and whether it has changed since it was written; empty before one is.
    part: State,
    begun: bool,
    changed: bool,
    /// Says whether the user was told that nothing can be written.
    warned: bool,
}

impl Keeper {
    /// A keeper that saves no state.
    pub fn none() -> Self {
        Self::of(None, "", false)
    }

    /// Keeps the run of this `identity` in a folder. States of an earlier run there give way to the
    /// first one written.
    pub fn new(folder: &Path, identity: &str) -> Self {
        Self::of(Some(folder), identity, false)
    }

    /// Goes on with the run of this `identity` that was stopped in a folder.
    ///
    /// # Errors
    /// No run was.
    pub fn resume(folder: &Path, identity: &str) -> Result<Self> {
        match (1..=MOST_PARTS).any(|part| file(folder, part).exists()) {
            true => Ok(Self::of(Some(folder), identity, true)),
            false => Err(Error::new(
                "could not resume",
                format!("no interrupted run in {}", folder.display()),
                "leave --resume out to start over, or give the --out of the interrupted run",
            )),
        }
    }

    /// Keeps a shard in its file, going on from what that holds.
    pub fn shard(kept: Kept) -> Self {
        let identity = kept.identity().to_owned();
        Self { shard: Some(kept), ..Self::of(None, &identity, false) }
    }

    fn of(folder: Option<&Path>, identity: &str, resume: bool) -> Self {
        let given = std::env::var("PROOFMASS_STATE_INTERVAL_S").ok().and_then(|text| text.parse().ok());
        Self {
            folder: folder.map(Path::to_owned),
            shard: None,
            identity: identity.to_owned(),
            interval: Duration::try_from_secs_f64(given.unwrap_or(INTERVAL_S)).unwrap_or(Duration::MAX),
            last: Instant::now(),
            resume,
            done: Vec::new(),
            part: State::default(),
            begun: false,
            changed: false,
            warned: false,
        }
    }

    /// Begins the next part, or goes on with it where its file is there.
    pub(super) fn begin(&mut self, job: &Job, precision: Precision) -> Result<()> {
        if let Some(shard) = &mut self.shard {
            self.part = shard.begin(self.begun.then_some(&self.part), job, precision)?;
            self.begun = true;
            return Ok(());
        }
        if self.begun {
            let done = std::mem::take(&mut self.part);
            self.done.push(Some(done).filter(|_| self.changed && self.folder.is_some()));
        }
        self.begun = true;
        let part = self.done.len() + 1;
        let run = Run { identity: &self.identity, part, job, precision };
        let path = self.folder.as_ref().map(|folder| file(folder, part)).filter(|path| self.resume && path.exists());
        // A part that was not reached yet begins at its beginning.
        self.part = path.map_or_else(|| Ok(State::new(&run, 0..job.members)), |path| state_file::read(&path, &run))?;
        self.changed = false;
        Ok(())
    }

    /// The part begun last.
    pub(super) fn part(&self) -> &State {
        &self.part
    }

    /// The same, to be changed.
    pub(super) fn part_mut(&mut self) -> &mut State {
        self.changed = true;
        &mut self.part
    }

    /// Returns whether a batch that has `begun` then should stop to be kept. One that has hardly
    /// begun is let finish.
    pub(super) fn is_due_within(&self, begun: Instant) -> bool {
        self.keeps() && self.last.elapsed() >= self.interval && begun.elapsed() >= self.interval / 6
    }

    /// Returns whether anything is written.
    fn keeps(&self) -> bool {
        self.folder.is_some() || self.shard.is_some()
    }

    /// Writes what was done, if it is time. A run goes on where that fails, and says so once.
    pub(super) fn keep_if_due(&mut self, control: &Control) {
        if !self.keeps() || self.last.elapsed() < self.interval {
            return;
        }
        if let Err(error) = self.write()
            && !std::mem::replace(&mut self.warned, true)
        {
            let words = format!(
                "note: {}: {}. The run continues, but cannot be resumed if it is stopped.",
                error.attempt, error.cause
            );
            control.remark(&words);
        }
        self.last = Instant::now();
    }

    /// Writes every part that has changed since it was written.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&mut self) -> Result<()> {
        if let Some(shard) = &mut self.shard {
            self.last = Instant::now();
            return shard.write(self.begun.then_some(&self.part));
        }
        let Some(folder) = self.folder.clone() else { return Ok(()) };
        if !std::mem::replace(&mut self.resume, true) {
            remove(&folder)?;
        }
        for (n, done) in self.done.iter_mut().enumerate() {
            if let Some(state) = done {
                state_file::write(state, &file(&folder, n + 1))?;
            }
            *done = None;
        }
        let path = file(&folder, self.done.len() + 1);
        if self.begun && (self.changed || !path.exists()) {
            state_file::write(&mut self.part, &path)?;
            self.changed = false;
        }
        self.last = Instant::now();
        Ok(())
    }

    /// Removes the files, when all that the run was for is written.
    ///
    /// # Errors
    /// A file is there and cannot be removed.
    pub fn forget(&self) -> Result<()> {
        self.folder.as_deref().map_or(Ok(()), remove)
    }

    /// Writes what was done, and says in the hint of an error that ended the run how to go on.
    pub fn kept(&mut self, error: Error) -> Error {
        let Some(folder) = self.folder.clone().or(self.shard.as_ref().map(|s| s.path().to_owned())) else {
            return error;
        };
        let hint = match self.write() {
            Ok(()) => {
                format!("progress is kept in {}: the same command with --resume continues", folder.display())
            }
            Err(unkept) => format!("progress could not be saved ({}: {})", unkept.attempt, unkept.cause),
        };
        let hint = if error.hint.is_empty() { hint } else { format!("{}; {hint}", error.hint) };
        Error { hint, ..error }
    }

    /// The error of a run that the user has stopped.
    pub(super) fn stopped(&mut self, stopped: Stopped) -> Error {
        let hint = if self.keeps() { "" } else { "run it again" };
        self.kept(stopped.during("could not finish the simulation", hint))
    }
}

fn file(folder: &Path, part: usize) -> PathBuf {
    folder.join(format!("interrupted-{part}.json"))
}

/// Removes all states in a folder.
fn remove(folder: &Path) -> Result<()> {
    for path in (1..=MOST_PARTS).map(|part| file(folder, part)) {
        match std::fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound && e.kind() != std::io::ErrorKind::NotADirectory => {
                return Err(Error::io("remove", &path, &e));
            }
            _ => {}
        }
    }
    Ok(())
}
