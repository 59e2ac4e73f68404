//! One run at a time in a folder: a lock that the system releases when its process ends, however it
//! ends.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// The file that is locked. It is empty and goes with the lock; one that a killed run has left
/// behind means nothing.
const NAME: &str = ".proofmass.lock";

/// A folder's lock, held until this is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    file: File,
    path: PathBuf,
}

impl Lock {
    /// Takes the lock of a folder that exists.
    ///
    /// # Errors
    /// Another run holds it, or the folder cannot be written.
    pub(crate) fn take(folder: &Path) -> Result<Self> {
        Self::locked(folder, NAME, || busy(folder))
    }

    /// Takes the lock of one file in a folder that exists, of which others may be written
    /// meanwhile.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub(crate) fn take_for(folder: &Path, file: &str) -> Result<Self> {
        Self::locked(folder, &format!(".{file}.lock"), || busy(&folder.join(file)))
    }

    fn locked(folder: &Path, name: &str, busy: impl Fn() -> Error) -> Result<Self> {
        let path = folder.join(name);
        loop {
            let file = OpenOptions::new()
                .create(true)
                .truncate(false)
                .write(true)
                .open(&path)
                .map_err(|e| Error::io("write in", folder, &e))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(busy()),
                // Some network file systems have no locks: a run there is as safe as it was without
                // them.
                Err(TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => {}
                Err(TryLockError::Error(e)) => return Err(Error::io("lock", &path, &e)),
            }
            let lock = Self { file, path: path.clone() };
            // Between opening and locking, the holder before may have ended and removed the file:
            // then it locks nothing.
            if lock.stands() {
                return Ok(lock);
            }
        }
    }

    /// Whether the file that is locked is the one that stands in the folder.
    #[cfg(unix)]
    fn stands(&self) -> bool {
        use std::os::unix::fs::MetadataExt;
        let (ours, theirs) = (self.file.metadata(), std::fs::symlink_metadata(&self.path));
        ours.ok().zip(theirs.ok()).is_some_and(|(a, b)| (a.dev(), a.ino()) == (b.dev(), b.ino()))
    }

    /// A file that is open cannot be replaced here.
    #[cfg(not(unix))]
    fn stands(&self) -> bool {
        self.file.metadata().is_ok()
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if cfg!(unix) && self.stands() {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn busy(place: &Path) -> Error {
    Error::new(
        format!("could not write in {}", place.display()),
        "another run of proofmass is writing there",
        "wait until it has finished, or give another folder with --out DIR",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_excludes_another_one_until_it_is_dropped_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let first = Lock::take(folder.path()).expect("free");
        assert!(Lock::take(folder.path()).is_err_and(|e| e.cause.contains("another run")));
        drop(first);
        drop(Lock::take(folder.path()).expect("free again"));
        assert_eq!(std::fs::read_dir(folder.path()).expect("listing").count(), usize::from(!cfg!(unix)));
    }

    #[test]
    fn a_file_that_a_killed_run_left_locks_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        std::fs::write(folder.path().join(NAME), "").expect("written");
        assert!(Lock::take(folder.path()).is_ok());
    }
}
