//! Files written whole or not at all: next to their place, to the disk, then renamed.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::error::{Error, Result};

/// Beginning of the names of half-written files; a killed run may leave some.
pub const UNFINISHED: &str = ".proofmass-";

/// A file that is written but does not stand in its place yet; dropped, it is gone.
#[derive(Debug)]
pub struct Staged {
    // Closed: a run may stage more files than a process may have open.
    file: TempPath,
    path: PathBuf,
}

/// The folder that holds a file.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

impl Staged {
    /// Writes the bytes next to `path`, down to the disk.
    ///
    /// # Errors
    /// The folder cannot be made or written.
    pub fn new(path: &Path, bytes: &[u8]) -> Result<Self> {
        Self::within(folder_of(path), path, bytes)
    }

    /// Writes the bytes in a folder above `path` on the same disk, down to the disk; what lies
    /// between is made when the file is put in its place.
    ///
    /// # Errors
    /// The folder cannot be made or written.
    pub fn within(folder: &Path, path: &Path, bytes: &[u8]) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|e| Error::io("create the folder", folder, &e))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(UNFINISHED);
        // Of what any program may do with a new file, the user's umask takes away what it should
        // not.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(folder).map_err(|e| Error::io("write in", folder, &e))?;
        // Renamed before its bytes are on the disk, a file could be empty after a power failure.
        file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(|e| Error::io("write", path, &e))?;
        Ok(Self { file: file.into_temp_path(), path: path.into() })
    }

    /// Puts the file in its place; what stood there is replaced.
    ///
    /// # Errors
    /// A folder stands there, or the file system refuses.
    pub fn publish(self) -> Result<()> {
        let Self { file, path } = self;
        let folder = folder_of(&path);
        std::fs::create_dir_all(folder).map_err(|e| Error::io("create the folder", folder, &e))?;
        file.persist(&path).map_err(|e| Error::io("write", &path, &e.error))
    }
}

/// Makes renamings in a folder survive a power failure, where the file system can.
fn sync_folder(folder: &Path) {
    // Not every system opens folders; the files themselves are on the disk already.
    let _ = File::open(folder).and_then(|f| f.sync_all());
}

/// Writes a file next to its place and renames it, so that a reader never sees half of it.
///
/// # Errors
/// When the folder cannot be made or written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    Staged::new(path, bytes)?.publish()?;
    sync_folder(folder_of(path));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let blocked = folder.path().join("taken");
        std::fs::create_dir(&blocked).expect("a folder where the file should be written");
        assert!(write_whole(&blocked, b"x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).expect("listing").count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn files_have_the_rights_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("temporary folder");
        let [ours, plain] = ["ours", "plain"].map(|name| folder.path().join(name));
        write_whole(&ours, b"x").expect("written");
        std::fs::write(&plain, b"x").expect("written");
        let mode = |path: &Path| std::fs::metadata(path).expect("there").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
