//! `.proofmass.json`: which runs have written into a folder, and the SHA-256 of each file as it was
//! written.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{ErrorKind, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::names;
use crate::document::{open, to_json, write_whole};
use crate::error::{Error, Result};

/// Name of the manifest in a folder of results.
pub const NAME: &str = ".proofmass.json";
const SCHEMA: &str = "proofmass.outputs/1";

/// Identifies a run: the same command on the same files is the same run, whatever stands in them.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Identity {
    /// Subcommand that wrote, e.g. "study".
    pub command: String,
    /// Paths of the files that it was asked about, as seen from the folder, so that a project can
    /// be moved or shared as a whole; none for a command that reads none.
    pub inputs: Vec<String>,
}

/// A run that has written here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Run {
    /// Identity of the run.
    #[serde(flatten)]
    pub identity: Identity,
    /// SHA-256 of each file, hexadecimal, by its name in the folder.
    pub files: BTreeMap<String, String>,
    /// The same of the files that are being replaced: a run that is killed in between leaves
    /// either.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub replaced: BTreeMap<String, String>,
    /// Files that change while the run goes on, states that it can be resumed from; `*` is any
    /// text.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub states: BTreeSet<String>,
}

impl Run {
    /// A run that has written nothing yet.
    pub fn new(identity: Identity) -> Self {
        Self { identity, files: BTreeMap::new(), replaced: BTreeMap::new(), states: BTreeSet::new() }
    }

    /// Returns whether the run has written a file of this name.
    pub fn names(&self, name: &str) -> bool {
        self.files.contains_key(name) || self.replaced.contains_key(name) || self.has_state(name)
    }

    /// Returns true where the run has written a file of this name with this content.
    pub fn wrote(&self, name: &str, sha256: &str) -> bool {
        let holds = |files: &BTreeMap<String, String>| files.get(name).is_some_and(|known| known == sha256);
        holds(&self.files) || holds(&self.replaced)
    }

    /// Returns true where a name is that of a state, whose content no hash can tell: it changes
    /// while the run goes on.
    pub fn has_state(&self, name: &str) -> bool {
        self.states.iter().any(|pattern| names::matches(pattern, name))
    }

    /// Another run's file is theirs from now on.
    fn forget(&mut self, names: impl Fn(&str) -> bool) {
        self.files.retain(|name, _| !names(name));
        self.replaced.retain(|name, _| !names(name));
        self.states.retain(|name| !names(name));
    }

    fn is_empty(&self) -> bool {
        self.files.is_empty() && self.replaced.is_empty() && self.states.is_empty()
    }
}

/// Every run that has written into a folder and whose files still stand there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    schema: String,
    /// Runs in the order of their first write.
    pub runs: Vec<Run>,
}

impl Default for Manifest {
    fn default() -> Self {
        Self { schema: SCHEMA.into(), runs: Vec::new() }
    }
}

impl Manifest {
    /// Reads the manifest of a folder; where there is none, no run has written.
    ///
    /// # Errors
    /// It cannot be read, or is not what proofmass writes.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(NAME);
        if std::fs::symlink_metadata(&path).is_err_and(|e| e.kind() == ErrorKind::NotFound) {
            return Ok(Self::default());
        }
        let mut text = Vec::new();
        open(&path, "manifest")?.read_to_end(&mut text).map_err(|e| Error::io("read", &path, &e))?;
        let refuse = |cause: String| {
            let hint =
                "without it, no file there is known to be replaceable: give another folder with --out DIR, or --force";
            Err(Error::new(format!("could not read {}", path.display()), cause, hint))
        };
        let manifest: Self = match serde_json::from_slice(&text) {
            Ok(manifest) => manifest,
            Err(e) => return refuse(e.to_string()),
        };
        if manifest.schema != SCHEMA {
            return refuse(format!("need the schema {SCHEMA}, got {}", manifest.schema));
        }
        // What is listed may be replaced or removed: nothing outside the folder ever is.
        for run in &manifest.runs {
            for name in run.files.keys().chain(run.replaced.keys()).chain(&run.states) {
                if !names::is_inside(name) {
                    return refuse(format!("it lists a file outside the folder, `{name}`"));
                }
                if names::crosses_link(folder, name) {
                    return refuse(format!("it lists `{name}`, whose folder is a link to another place"));
                }
            }
            if let Some(state) = run.states.iter().find(|state| !names::STATES.contains(&state.as_str())) {
                let known = names::STATES.join(", ");
                return refuse(format!("it lists the state `{state}`, where one of {known} was expected"));
            }
        }
        Ok(manifest)
    }

    /// Writes it.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        write_whole(&folder.join(NAME), to_json(self)?.as_bytes())
    }

    /// The files that a run has written here.
    pub fn run(&self, identity: &Identity) -> Option<&Run> {
        self.runs.iter().find(|run| run.identity == *identity)
    }

    /// Takes the place of the same run's entry; what it has written is no other run's any more.
    pub fn set(&mut self, run: Run) {
        self.runs.iter_mut().filter(|r| r.identity != run.identity).for_each(|r| r.forget(|name| run.names(name)));
        match self.runs.iter_mut().find(|r| r.identity == run.identity) {
            Some(place) => *place = run,
            None => self.runs.push(run),
        }
        self.runs.retain(|run| !run.is_empty());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(input: &str, file: &str) -> Run {
        let mut run = Run::new(Identity { command: "study".into(), inputs: vec![input.into()] });
        run.files.insert(file.into(), "00".into());
        run
    }

    #[test]
    fn what_was_written_is_read_back_and_a_file_has_one_writer() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let mut manifest = Manifest::default();
        manifest.set(run("/a.toml", "report.html"));
        manifest.write(folder.path()).expect("written");
        assert_eq!(Manifest::read(folder.path()).expect("read"), manifest);
        manifest.set(run("/b.toml", "report.html"));
        assert_eq!(manifest.runs, [run("/b.toml", "report.html")]);
    }

    #[test]
    fn a_manifest_of_files_elsewhere_or_of_another_schema_is_refused() {
        let folder = tempfile::tempdir().expect("temporary folder");
        for name in ["../precious", "/etc/passwd", ""] {
            let mut manifest = Manifest::default();
            manifest.set(run("/a.toml", name));
            manifest.write(folder.path()).expect("written");
            assert!(Manifest::read(folder.path()).is_err(), "{name:?}");
        }
        for text in ["{}", "no JSON", "{\"schema\": \"proofmass.outputs/9\", \"runs\": []}"] {
            std::fs::write(folder.path().join(NAME), text).expect("written");
            assert!(Manifest::read(folder.path()).is_err(), "{text}");
        }
    }

    #[test]
    fn a_state_that_the_program_never_writes_is_refused() {
        let folder = tempfile::tempdir().expect("temporary folder");
        for (state, is_ours) in [("interrupted-*.json", true), ("verdicts.jsonl", true), ("*", false), ("a.tex", false)]
        {
            let mut of_states = Run::new(Identity { command: "study".into(), inputs: Vec::new() });
            of_states.states.insert(state.into());
            let mut manifest = Manifest::default();
            manifest.set(of_states);
            manifest.write(folder.path()).expect("written");
            assert_eq!(Manifest::read(folder.path()).is_ok(), is_ours, "{state}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_name_beyond_a_link_is_refused_and_one_in_a_folder_is_not() {
        let (folder, home) = (tempfile::tempdir().expect("folder"), tempfile::tempdir().expect("folder"));
        std::os::unix::fs::symlink(home.path(), folder.path().join("link")).expect("a link");
        std::fs::create_dir(folder.path().join("plain")).expect("a folder");
        for (name, is_ours) in [("plain/a.svg", true), ("link/a.svg", false)] {
            let mut manifest = Manifest::default();
            manifest.set(run("/a.toml", name));
            manifest.write(folder.path()).expect("written");
            assert_eq!(Manifest::read(folder.path()).is_ok(), is_ours, "{name}");
        }
    }
}
