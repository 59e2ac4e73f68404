//! Keeps what a study in motion has summed so far, in a file: a run that was stopped goes on after
//! the last whole batch, and ends with the bits of one that was not.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::share::{Results, Share};
use super::totals::Totals;
use crate::control::{Control, Stopped};
use crate::document::{hexadecimal, write_whole};
use crate::error::{Error, Result};
use crate::kernel::flight::Flight;
use crate::shard::file::damaged;
use crate::statistics::Machine;

/// Name of the file in the folder of results.
const FILE: &str = "interrupted-1.json";
const SCHEMA: &str = "proofmass.flight-state/1";
/// Seconds of work after which it is kept. `PROOFMASS_STATE_INTERVAL_S` sets another number.
const INTERVAL_S: f64 = 30.0;

/// Content of that file.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct State {
    schema: String,
    /// SHA-256 of this document with this field empty.
    sha256: String,
    /// Digest of the run: sums of another one must not be mixed in.
    fingerprint: String,
    /// First member that is not summed yet.
    next_member: u64,
    /// Wall time that it took so far, s.
    seconds: f64,
    totals: Totals,
}

/// Place where a run keeps its sums, if anywhere.
#[derive(Debug)]
pub struct Kept {
    folder: Option<PathBuf>,
    /// A shard, whose file it is instead.
    share: Option<Share>,
    identity: String,
    resume: bool,
    interval: Duration,
    last: Instant,
    warned: bool,
}

/// Progress of a run.
#[derive(Debug, Clone, Default)]
pub(super) struct Progress {
    /// First member that is not summed yet.
    pub next_member: u64,
    /// Wall time of the runs before, s.
    pub seconds: f64,
    /// Sums over the members that are done.
    pub totals: Totals,
}

impl Kept {
    /// A keeper that keeps nothing.
    pub fn none() -> Self {
        Self::of(None, "", false)
    }

    /// Keeps the run of this identity in a folder.
    pub fn new(folder: &Path, identity: &str) -> Self {
        Self::of(Some(folder), identity, false)
    }

    /// Goes on with the run of this identity that was stopped in a folder.
    ///
    /// # Errors
    /// No run was.
    pub fn resume(folder: &Path, identity: &str) -> Result<Self> {
        match folder.join(FILE).exists() {
            true => Ok(Self::of(Some(folder), identity, true)),
            false => Err(Error::new(
                "could not resume",
                format!("no interrupted run in {}", folder.display()),
                "leave --resume out to start over, or give the --out of the interrupted run",
            )),
        }
    }

    fn of(folder: Option<&Path>, identity: &str, resume: bool) -> Self {
        let given = std::env::var("PROOFMASS_STATE_INTERVAL_S").ok().and_then(|text| text.parse().ok());
        Self {
            folder: folder.map(Path::to_owned),
            share: None,
            identity: identity.to_owned(),
            resume,
            interval: Duration::try_from_secs_f64(given.unwrap_or(INTERVAL_S)).unwrap_or(Duration::MAX),
            last: Instant::now(),
            warned: false,
        }
    }

    /// Keeps a shard in its file.
    pub fn share(share: Share) -> Self {
        Self { share: Some(share), ..Self::of(None, "", false) }
    }

    /// Members that the run integrates.
    pub(super) fn members(&self, flight: &Flight) -> Range<u64> {
        self.share.as_ref().map_or(0..flight.members(), Share::members)
    }

    /// A run that begins or, where a stopped one is to be gone on with, what that has summed.
    pub(super) fn begin(&mut self, flight: &Flight, machine: &Machine) -> Result<Progress> {
        if let Some(share) = &mut self.share {
            let (next_member, before) = share.begun(machine)?;
            return match before {
                None => Ok(Progress { next_member, ..Progress::default() }),
                Some(Results { seconds, totals, .. }) if totals.fit(flight) => {
                    Ok(Progress { next_member, seconds, totals })
                }
                Some(_) => Err(damaged(share.path(), "its sums are not at the times of this study")),
            };
        }
        let Some(path) = self.folder.as_ref().map(|folder| folder.join(FILE)).filter(|_| self.resume) else {
            return Ok(Progress::default());
        };
        let refuse = |cause: String| {
            Error::new(
                format!("could not resume from {}", path.display()),
                cause,
                "leave --resume out to start over, or give the study, seed, members and backend of that run",
            )
        };
        let bytes = std::fs::read(&path).map_err(|e| Error::io("resume from", &path, &e))?;
        let state: State = serde_json::from_slice(&bytes)
            .map_err(|e| refuse(format!("it is not the state of a run in motion: {e}")))?;
        if state.schema != SCHEMA || checksum(&state).ok().as_ref() != Some(&state.sha256) {
            return Err(refuse("it is damaged, or of another version".into()));
        }
        if state.fingerprint != self.fingerprint(flight, machine) || !state.totals.fit(flight) {
            return Err(refuse(
                "it belongs to another run: the study, what it reads, the seed, the number of members, the backend or the \
                 version of the program is not the same"
                    .into(),
            ));
        }
        Ok(Progress { next_member: state.next_member, seconds: state.seconds, totals: state.totals })
    }

    /// A run that begins anew on another machine, after the first has failed.
    pub(super) fn restart(&mut self) {
        self.resume = false;
        self.share.iter_mut().for_each(Share::restart);
    }

    fn fingerprint(&self, flight: &Flight, machine: &Machine) -> String {
        let version = env!("CARGO_PKG_VERSION");
        // What a file of poses holds.
        let felt: f64 =
            flight.course.truth.samples.iter().map(|s| s.specific_force_m_s2.sum() + s.rate_rad_s.sum()).sum();
        let text = format!(
            "{version} {} {} {} {:?} {:?} {} {} {} {felt:?}",
            self.identity,
            flight.seed(),
            flight.members(),
            flight.clock(),
            flight.axes[0].integrator,
            machine.kind,
            if machine.kind == "cpu" { "" } else { &machine.name },
            machine.precision,
        );
        hexadecimal(&Sha256::digest(text))
    }

    /// Writes the sums, if it is time. A run goes on where that fails, and says so once.
    pub(super) fn keep_if_due(&mut self, flight: &Flight, machine: &Machine, so_far: &Progress, control: &Control) {
        if self.place().is_none() || self.last.elapsed() < self.interval {
            return;
        }
        self.last = Instant::now();
        if let Err(error) = self.write(flight, machine, so_far)
            && !std::mem::replace(&mut self.warned, true)
        {
            let Error { attempt, cause, .. } = error;
            control.remark(&format!(
                "note: {attempt}: {cause}. The run continues, but cannot be resumed if it is stopped."
            ));
        }
    }

    /// Returns the place of the sums, for messages.
    fn place(&self) -> Option<&Path> {
        self.share.as_ref().map(Share::path).or(self.folder.as_deref())
    }

    /// Writes the file of a shard, which is its result and stays.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub(super) fn finish(&self, flight: &Flight, machine: &Machine, so_far: &Progress) -> Result<()> {
        if self.share.is_some() { self.write(flight, machine, so_far) } else { Ok(()) }
    }

    fn write(&self, flight: &Flight, machine: &Machine, so_far: &Progress) -> Result<()> {
        if let Some(share) = &self.share {
            let Progress { next_member, seconds, ref totals } = *so_far;
            return share.write(next_member, &Results { machine: machine.clone(), seconds, totals: totals.clone() });
        }
        let Some(path) = self.folder.as_ref().map(|folder| folder.join(FILE)) else { return Ok(()) };
        let unwritten = |e: serde_json::Error| {
            Error::new(format!("could not write {}", path.display()), e.to_string(), "run again")
        };
        let mut state = State {
            schema: SCHEMA.to_owned(),
            sha256: String::new(),
            fingerprint: self.fingerprint(flight, machine),
            next_member: so_far.next_member,
            seconds: so_far.seconds,
            totals: so_far.totals.clone(),
        };
        state.sha256 = checksum(&state).map_err(unwritten)?;
        write_whole(&path, &serde_json::to_vec(&state).map_err(unwritten)?)
    }

    /// The error of a run that was stopped: what it has summed is kept, and the hint says how to go
    /// on.
    pub(super) fn stopped(&self, flight: &Flight, machine: &Machine, so_far: &Progress, by: Stopped) -> Error {
        let hint = match (self.place(), so_far.totals.is_empty()) {
            (Some(folder), false) => match self.write(flight, machine, so_far) {
                Ok(()) => {
                    format!("progress is kept in {}: the same command with --resume continues", folder.display())
                }
                Err(unkept) => format!("progress could not be saved ({}: {})", unkept.attempt, unkept.cause),
            },
            (Some(_), true) => "nothing was summed yet: run it again".to_owned(),
            (None, _) => "run it again".to_owned(),
        };
        by.during("could not finish the simulation", hint)
    }

    /// Removes the file, when all that the run was for is written.
    ///
    /// # Errors
    /// It is there and cannot be removed.
    pub fn forget(&self) -> Result<()> {
        let Some(path) = self.folder.as_ref().map(|folder| folder.join(FILE)) else { return Ok(()) };
        match std::fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(Error::io("remove", &path, &e)),
            _ => Ok(()),
        }
    }
}

fn checksum(state: &State) -> serde_json::Result<String> {
    let bare = State { sha256: String::new(), ..state.clone() };
    Ok(hexadecimal(&Sha256::digest(serde_json::to_vec(&bare)?)))
}
