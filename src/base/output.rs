//! A folder of results: what a run may replace there, and the files of one run put into their
//! places together.
//!
//! The same command on the same input path replaces its own files. Any other file, and one that was
//! changed since it was written, is the user's: it is refused by name before the work begins and
//! again before anything is replaced, unless the run is forced. The files that a run reads are
//! never replaced. `.proofmass.json` in the folder knows what was written ([`manifest`]); a lock
//! keeps a second run out ([`lock`]).

pub mod lock;
pub mod manifest;
pub mod names;
mod refusal;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::document::{Staged, UNFINISHED, hexadecimal};
use crate::error::{Error, Result};
use crate::signal::Keeping;
use lock::Lock;
use manifest::{Identity, Manifest, Run};

/// A command that is about to write, and what it will write.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Request {
    /// Subcommand that writes, e.g. "study".
    pub command: &'static str,
    /// The files that it was asked about: the same command on the same ones replaces its own
    /// results.
    pub inputs: Vec<PathBuf>,
    /// Further files that it reads.
    pub reads: Vec<PathBuf>,
    /// Files that it will write, as far as is known beforehand; `*` is any text in a name.
    pub writes: Vec<String>,
    /// Replace the user's files too.
    pub force: bool,
    /// Keeps what an earlier run of the same command has written here under other names: each run
    /// writes one file of the user's naming.
    pub keeps: bool,
}

/// A folder that one run writes into. Dropped without [`Folder::finish`], it has replaced nothing.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Holds what runs have written, this one's states included.
    manifest: Manifest,
    identity: Identity,
    /// Full paths of the files that are read.
    read: Vec<PathBuf>,
    force: bool,
    keeps: bool,
    announced: Vec<String>,
    staged: BTreeMap<String, (Staged, String)>,
    /// Files of the run's own making.
    recorded: Vec<String>,
    /// Present where the run keeps states that it writes in intervals.
    keeping: Option<Keeping>,
    // Fields are dropped in their order: a folder that was made for nothing goes last.
    _lock: Lock,
    _made: Made,
}

/// Takes a folder away again that was made for nothing.
#[derive(Debug)]
struct Made(Option<PathBuf>);

impl Drop for Made {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // Refused where something stands in it.
            let _ = std::fs::remove_dir(path);
        }
    }
}

fn full(path: &Path) -> PathBuf {
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}

/// A full path as seen from a full folder; itself where they share no root.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let shared = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return path.to_path_buf();
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(path.components().skip(shared)).collect()
}

/// The full path of what is seen so from a full folder, whether it still stands there or not.
fn absolute(seen: &Path, folder: &Path) -> PathBuf {
    seen.components().fold(folder.to_path_buf(), |path, part| match part {
        Component::ParentDir => path.parent().map_or_else(PathBuf::new, Path::to_path_buf),
        part => path.join(part),
    })
}

fn checksum(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// SHA-256 of a file that stands in a folder, hexadecimal; `None` for what is no plain file or
/// cannot be read.
fn checksum_of(path: &Path) -> Option<String> {
    // A pipe is never opened: it would be waited for. A link is a file of some other place.
    std::fs::symlink_metadata(path).ok().filter(std::fs::Metadata::is_file)?;
    std::fs::read(path).ok().map(|bytes| checksum(&bytes))
}

impl Folder {
    /// Makes the folder, locks it, sweeps what killed runs left half-written, and finds out whether
    /// the results may be written.
    ///
    /// # Errors
    /// The folder cannot be made or written, another run is writing there, or files of the user's
    /// are in the way.
    pub fn open(path: &Path, request: Request) -> Result<Self> {
        let made = Made((!path.exists()).then(|| path.to_path_buf()));
        std::fs::create_dir_all(path).map_err(|e| Error::io("create the folder", path, &e))?;
        let lock = Lock::take(path)?;
        sweep(path);
        let manifest = match Manifest::read(path) {
            Err(_) if request.force => Manifest::default(),
            read => read?,
        };
        let home = full(path);
        let inputs = request.inputs.iter().map(|p| relative(&full(p), &home).display().to_string()).collect();
        let folder = Self {
            path: path.to_path_buf(),
            manifest,
            identity: Identity { command: request.command.into(), inputs },
            read: request.inputs.iter().chain(&request.reads).map(|p| full(p)).collect(),
            force: request.force,
            keeps: request.keeps,
            announced: request.writes.clone(),
            staged: BTreeMap::new(),
            recorded: Vec::new(),
            keeping: None,
            _lock: lock,
            _made: made,
        };
        let earlier = if request.keeps { Run::new(folder.identity.clone()) } else { folder.earlier() };
        let there: Vec<String> = request.writes.iter().flat_map(|pattern| folder.matching(pattern)).collect();
        folder.check(request.writes.iter().chain(&there).chain(earlier.files.keys()).map(String::as_str))?;
        Ok(folder)
    }

    /// Files that change while the run goes on, which the run writes itself, and from which it can
    /// be resumed: one of the names of states, which may hold one `*` for any text. `resume` says
    /// that those which lie there are meant to be gone on from, whoever put them there.
    ///
    /// # Errors
    /// A file of the user's has such a name, or the folder cannot be written.
    pub fn state(&mut self, pattern: &str, resume: bool) -> Result<()> {
        let there = self.matching(pattern);
        let special = |name: &&String| self.reason(name).is_some_and(|reason| reason == refusal::Reason::Special);
        self.check(there.iter().filter(|name| !resume || special(name)).map(String::as_str))?;
        // Verdicts are written one by one, and are on the disk before the next is thought of.
        if pattern == names::INTERRUPTED {
            self.keeping.get_or_insert_with(Keeping::begin);
        }
        let mut run = self.earlier();
        if !run.states.insert(pattern.into()) {
            return Ok(());
        }
        self.manifest.set(run);
        self.manifest.write(&self.path)
    }

    /// Returns whether an earlier run has left states there.
    pub fn holds(&self, pattern: &str) -> bool {
        !self.matching(pattern).is_empty()
    }

    /// Files whose names match a pattern, in the folder or in the one below it that the pattern
    /// names.
    fn matching(&self, pattern: &str) -> Vec<String> {
        let (below, place) = match pattern.rsplit_once('/') {
            Some((below, _)) => (format!("{below}/"), self.path.join(below)),
            None => (String::new(), self.path.clone()),
        };
        let names = std::fs::read_dir(place).into_iter().flatten().flatten();
        let names = names.map(|e| format!("{below}{}", e.file_name().to_string_lossy()));
        names.filter(|n| names::matches(pattern, n)).collect()
    }

    /// Lists a file that the run has written itself among its results: changed after
    /// [`finish`](Self::finish), it is the user's.
    pub fn record(&mut self, name: &str) {
        self.recorded.push(name.into());
    }

    /// Returns whether the run said beforehand that it will write files of this name or pattern.
    pub fn announces(&self, pattern: &str) -> bool {
        self.announced.iter().any(|name| name == pattern)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns what the same run has written here before.
    fn earlier(&self) -> Run {
        self.manifest.run(&self.identity).cloned().unwrap_or_else(|| Run::new(self.identity.clone()))
    }

    /// Refuses to replace what is not this run's own.
    fn check<'a>(&self, names: impl Iterator<Item = &'a str>) -> Result<()> {
        let mut found: Vec<(String, refusal::Reason)> = Vec::new();
        for name in names {
            let reason = self.reason(name);
            if let Some(reason) = reason.filter(|r| !self.force || r.stands_against_force())
                && found.iter().all(|(known, _)| known != name)
            {
                found.push((name.into(), reason));
            }
        }
        if found.is_empty() { Ok(()) } else { Err(refusal::refuse(&self.path, &found)) }
    }

    /// Why a file must not be replaced, if it must not.
    fn reason(&self, name: &str) -> Option<refusal::Reason> {
        let path = self.path.join(name);
        if names::crosses_link(&self.path, name) {
            return Some(refusal::Reason::Link);
        }
        let below = path.parent().filter(|below| *below != self.path);
        if below.is_some_and(|below| below.exists() && !below.is_dir()) {
            return Some(refusal::Reason::File);
        }
        let about = std::fs::symlink_metadata(&path).ok()?;
        if self.read.contains(&full(&path)) {
            return Some(refusal::Reason::Input);
        }
        if about.is_dir() {
            return Some(refusal::Reason::Folder);
        }
        let is_state = names::STATES.iter().any(|pattern| names::matches(pattern, name));
        // A state is written where it stands: through a link it would be written elsewhere.
        if is_state && !about.is_file() {
            return Some(refusal::Reason::Special);
        }
        let own = |run: &Run| run.has_state(name) || checksum_of(&path).is_some_and(|sha256| run.wrote(name, &sha256));
        if self.manifest.run(&self.identity).is_some_and(own) {
            return None;
        }
        Some(match self.manifest.runs.iter().find(|run| run.names(name)) {
            Some(run) if run.identity == self.identity => refusal::Reason::Changed,
            Some(run) => {
                let home = full(&self.path);
                let inputs = run.identity.inputs.iter().map(|i| absolute(i.as_ref(), &home).display().to_string());
                refusal::Reason::Other(Identity { inputs: inputs.collect(), ..run.identity.clone() })
            }
            None => refusal::Reason::Unknown,
        })
    }

    /// Writes a file next to its place; [`finish`](Self::finish) puts it there.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<()> {
        let staged = Staged::within(&self.path, &self.path.join(name), bytes)?;
        self.staged.insert(name.into(), (staged, checksum(bytes)));
        Ok(())
    }

    /// Puts everything that was written into its place, and takes away what this run had written
    /// here before and has not written again: a repaired model of a sensor that is found to be in
    /// order now would be wrong.
    ///
    /// # Errors
    /// Files of the user's came into the way meanwhile (then nothing is replaced), or the folder
    /// cannot be written.
    pub fn finish(&mut self) -> Result<()> {
        self.check(self.staged.keys().map(String::as_str))?;
        let earlier = self.earlier();
        let mut run = Run::new(self.identity.clone());
        run.states = earlier.states.clone();
        run.states.retain(|pattern| !self.recorded.contains(pattern));
        let recorded = self.recorded.iter().filter_map(|n| Some((n.clone(), checksum_of(&self.path.join(n))?)));
        let kept = earlier.files.iter().filter(|_| self.keeps).map(|(n, sha256)| (n.clone(), sha256.clone()));
        run.files = kept
            .chain(self.staged.iter().map(|(n, (_, sha256))| (n.clone(), sha256.clone())))
            .chain(recorded)
            .collect();
        let known = earlier.files.keys().chain(earlier.replaced.keys()).chain(run.files.keys());
        run.replaced = known.filter_map(|n| Some((n.clone(), checksum_of(&self.path.join(n))?))).collect();
        // A manifest can be of anybody's making: what is removed has a name that the program gives,
        // lies in the folder itself, and has the very bytes that were written.
        let stale = |(name, sha256): &(&String, &String)| {
            !run.files.contains_key(*name)
                && names::is_result(name)
                && !names::crosses_link(&self.path, name)
                && earlier.wrote(name, sha256)
        };
        let stale: Vec<PathBuf> = run.replaced.iter().filter(stale).map(|(name, _)| self.path.join(name)).collect();
        self.manifest.set(run.clone());
        self.manifest.write(&self.path)?;
        for (staged, _) in std::mem::take(&mut self.staged).into_values() {
            staged.publish()?;
        }
        for path in stale.iter().filter(|path| !self.read.contains(&full(path))) {
            std::fs::remove_file(path).map_err(|e| Error::io("remove", path, &e))?;
            // A folder below goes with its last file; it stays while something stands in it.
            if let Some(below) = path.parent().filter(|below| *below != self.path) {
                let _ = std::fs::remove_dir(below);
            }
        }
        run.replaced.clear();
        self.manifest.set(run);
        self.manifest.write(&self.path)
    }
}

impl Drop for Folder {
    /// States that were never written, or are as they were found, are announced no longer.
    fn drop(&mut self) {
        let mut run = self.earlier();
        let same = |name: &String| {
            let sha256 = checksum_of(&self.path.join(name));
            sha256.is_some() && sha256.as_ref() == run.files.get(name)
        };
        let changed = |pattern: &String| self.matching(pattern).iter().any(|name| !same(name));
        let kept: BTreeSet<String> = run.states.iter().filter(|pattern| changed(pattern)).cloned().collect();
        if kept == run.states || !self.path.is_dir() {
            return;
        }
        run.states = kept;
        self.manifest.set(run);
        // Nobody can be told here; a name too many does no harm.
        let _ = match self.manifest.runs.is_empty() {
            true => std::fs::remove_file(self.path.join(manifest::NAME)).is_ok(),
            false => self.manifest.write(&self.path).is_ok(),
        };
    }
}

/// Removes what runs that were killed have left half-written. Only under the lock: nobody else is
/// writing.
fn sweep(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let unfinished = entry.file_name().to_string_lossy().starts_with(UNFINISHED);
        if unfinished && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_seen_from_the_folder_and_found_again() {
        let home = Path::new("/logs/reports/a");
        for (path, seen) in [
            ("/logs/reports/a/study.toml", "study.toml"),
            ("/logs/study.toml", "../../study.toml"),
            ("/x", "../../../x"),
        ] {
            assert_eq!(relative(Path::new(path), home), Path::new(seen));
            assert_eq!(absolute(Path::new(seen), home), Path::new(path));
        }
    }
}
