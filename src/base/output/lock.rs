//! One run at a time in a folder: a lock that the system releases when its process ends, however it
//! ends.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// The file that is locked. It is empty and goes with the lock; one that a killed run has left
/// behind means nothing.
const NAME: &str = ".proofmass.lock";
/// Rounds after which a file that is replaced again and again is given up.
const MOST_ROUNDS: usize = 100;

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
    /// Another run holds it, something else than a plain file has its name, or the folder cannot be
    /// written.
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
        for _ in 0..MOST_ROUNDS {
            // A link would be followed out of the folder, and a pipe waited for.
            if std::fs::symlink_metadata(&path).is_ok_and(|about| !about.is_file()) {
                return Err(Error::new(
                    format!("could not write in {}", folder.display()),
                    format!("{name} is a link, a folder, a pipe or a device, where a plain file was expected"),
                    format!("remove {}, or give another folder with --out DIR", path.display()),
                ));
            }
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
        Err(busy())
    }

    /// Returns whether the file that is locked is the one that stands in the folder.
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

    #[cfg(unix)]
    #[test]
    fn a_lock_that_is_no_plain_file_is_refused_and_nothing_is_made_elsewhere() {
        use std::os::unix::fs::symlink;
        let (folder, home) = (tempfile::tempdir().expect("folder"), tempfile::tempdir().expect("folder"));
        let (lock, target) = (folder.path().join(NAME), home.path().join("target"));
        let refused = || Lock::take(folder.path()).is_err_and(|e| e.cause.contains("a plain file was expected"));
        symlink(&target, &lock).expect("a link to nothing");
        assert!(refused() && !target.exists());
        std::fs::write(&target, "precious").expect("written");
        assert!(refused() && std::fs::read_to_string(&target).is_ok_and(|text| text == "precious"));
        std::fs::remove_file(&lock).expect("removed");
        std::fs::create_dir(&lock).expect("a folder");
        assert!(refused());
    }
}
