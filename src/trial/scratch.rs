//! Folders for the files of single cases. They go with the process; those of a process that was
//! killed are removed by the next one that needs such a folder in the same place.

use std::fs::{File, OpenOptions};
use std::path::Path;

use tempfile::TempDir;

use proofmass_base::error::{Error, Result};

/// States how the names of such folders begin.
const PREFIX: &str = ".proofmass-cases-";
/// A file in each, locked as long as its process lives.
const LOCK: &str = "lock";

/// A folder for the files of cases.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    _lock: File,
}

impl Scratch {
    /// Makes one in `home`, or in the folder for temporary files where there is none.
    ///
    /// # Errors
    /// Nothing can be written there.
    pub fn new(home: Option<&Path>) -> Result<Self> {
        let temporary = std::env::temp_dir();
        let home = home.unwrap_or(&temporary);
        let failed = |e: std::io::Error| Error::io("create a folder in", home, &e);
        sweep(home);
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(home).map_err(failed)?;
        let lock = File::create(folder.path().join(LOCK)).map_err(failed)?;
        // Where a file system has no locks, another process may take the folder for a dead one's:
        // nothing is swept there.
        let _ = lock.try_lock();
        Ok(Self { folder, _lock: lock })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// A folder of its own for one case, which goes when it is dropped.
    ///
    /// # Errors
    /// Nothing can be written there.
    pub fn case(&self) -> Result<TempDir> {
        tempfile::tempdir_in(self.path()).map_err(|e| Error::io("create a folder in", self.path(), &e))
    }
}

/// Removes the folders of processes that are gone: whose lock can be had.
fn sweep(home: &Path) {
    for entry in std::fs::read_dir(home).into_iter().flatten().flatten() {
        let ours = entry.file_name().to_string_lossy().starts_with(PREFIX);
        if ours && entry.file_type().is_ok_and(|kind| kind.is_dir()) && is_abandoned(&entry.path()) {
            // What cannot be removed, another user's, is in nobody's way.
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

/// A folder without a lock file is one that is just being made.
fn is_abandoned(folder: &Path) -> bool {
    let lock = OpenOptions::new().write(true).open(folder.join(LOCK));
    lock.is_ok_and(|lock| lock.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_dead_processes_go_and_those_of_living_ones_stay() {
        let home = tempfile::tempdir().expect("temporary folder");
        let dead = home.path().join(".proofmass-cases-dead");
        std::fs::create_dir_all(dead.join("case")).expect("made");
        std::fs::write(dead.join(LOCK), "").expect("written");
        std::fs::create_dir(home.path().join("other")).expect("made");
        let living = Scratch::new(Some(home.path())).expect("made");
        assert!(!dead.exists() && home.path().join("other").exists());
        let second = Scratch::new(Some(home.path())).expect("made");
        assert!(living.path().exists() && second.path() != living.path());
        let case = living.case().expect("made");
        assert!(case.path().starts_with(living.path()));
        drop((case, living, second));
        assert_eq!(std::fs::read_dir(home.path()).expect("listing").count(), 1);
    }
}
