//! The bytes of a recording by their place in the file, and the checksum of all of them.
//!
//! Standard input, `-`, is kept in an unnamed temporary file, as a recording is read more than
//! once. Not for what the bytes mean: see `formats`.

use std::fs::File;
use std::io::{Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use sha2::{Digest, Sha256};

use crate::document::hexadecimal;
use crate::error::{Error, Result};

/// Bytes that are looked at to tell formats apart.
pub(super) const HEAD_BYTES: usize = 1 << 16;
/// Bytes digested at once.
const DIGESTED_BYTES: usize = 1 << 18;
/// Smaller files are digested on the spot.
const SMALL_BYTES: u64 = 1 << 20;

/// Bytes in memory, and whoever keeps them alive.
pub(super) type Bytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// A file that is open for reading at any place.
#[derive(Debug, Clone)]
pub struct Input {
    /// Holds what the user called it.
    pub path: PathBuf,
    store: Arc<Store>,
    length: u64,
    /// The file that it was unpacked from.
    packed: Option<Box<Input>>,
}

/// States where the bytes are.
#[derive(Debug)]
enum Store {
    File(File),
    Memory(Vec<u8>),
    Parts(Parts),
}

/// Pieces of memory that follow one another, each with the place of its first byte.
struct Parts(Vec<(u64, Bytes)>);

impl std::fmt::Debug for Parts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} parts", self.0.len())
    }
}

impl Parts {
    /// Returns what lies from a place to the end of its piece.
    fn from(&self, at: u64) -> &[u8] {
        let Some((start, bytes)) = self.0.iter().rev().find(|(start, _)| *start <= at) else { return &[] };
        usize::try_from(at - start).ok().and_then(|at| (**bytes).as_ref().get(at..)).unwrap_or_default()
    }
}

impl Store {
    fn read_at(&self, into: &mut [u8], at: u64) -> std::io::Result<usize> {
        match self {
            Self::File(file) => read_some_at(file, into, at),
            Self::Memory(bytes) => {
                let rest = usize::try_from(at).ok().and_then(|at| bytes.get(at..)).unwrap_or_default();
                Ok(copied(rest, into))
            }
            Self::Parts(parts) => Ok(copied(parts.from(at), into)),
        }
    }
}

/// Copies as much as there is, and as there is room for.
fn copied(from: &[u8], into: &mut [u8]) -> usize {
    let count = from.len().min(into.len());
    into[..count].copy_from_slice(&from[..count]);
    count
}

#[cfg(unix)]
fn read_some_at(file: &File, into: &mut [u8], at: u64) -> std::io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, into, at)
}

#[cfg(windows)]
fn read_some_at(file: &File, into: &mut [u8], at: u64) -> std::io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, into, at)
}

impl Input {
    /// Opens a file; `-` is standard input.
    ///
    /// # Errors
    /// A folder, a pipe or a device, told before it is opened: to open a pipe is to wait for its
    /// writer.
    pub fn open(path: &Path) -> Result<Self> {
        if path == Path::new("-") {
            let (store, length) = standard_input()?;
            return Ok(Self { path: path.into(), store, length, packed: None });
        }
        let about = std::fs::metadata(path).map_err(|e| Error::io("read", path, &e))?;
        if about.is_dir() {
            return Err(Error::io("read", path, &std::io::ErrorKind::IsADirectory.into()));
        }
        if !about.is_file() {
            // It is read more than once: for its headings, its clock and its rows.
            return Err(Error::new(
                format!("could not read {}", path.display()),
                "it is a pipe or a device, not a file",
                "save the recording as a file first, or pass it on standard input and give - as its name",
            ));
        }
        let file = File::open(path).map_err(|e| Error::io("read", path, &e))?;
        Ok(Self { path: path.into(), store: Arc::new(Store::File(file)), length: about.len(), packed: None })
    }

    /// Bytes in memory, under a name for messages.
    pub fn of_bytes(path: &Path, bytes: Vec<u8>) -> Self {
        let length = bytes.len() as u64;
        Self { path: path.into(), store: Arc::new(Store::Memory(bytes)), length, packed: None }
    }

    /// Pieces of memory one behind the other, under a name for messages.
    pub fn of_parts(path: &Path, parts: Vec<Bytes>) -> Self {
        let mut length = 0;
        let placed = parts.into_iter().map(|bytes| {
            let start = length;
            length += (*bytes).as_ref().len() as u64;
            (start, bytes)
        });
        let store = Arc::new(Store::Parts(Parts(placed.collect())));
        Self { path: path.into(), store, length, packed: None }
    }

    /// Returns whether both are of the same bytes at the same place.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.store, &other.store)
    }

    /// The same file unpacked into an unnamed temporary one, to be read at any place.
    ///
    /// # Errors
    /// When it cannot be unpacked, or the disk is full.
    pub fn unpacked_by(&self, unpacked: &mut dyn Read) -> std::io::Result<Self> {
        let (store, length) = spool(unpacked)?;
        Ok(Self { path: self.path.clone(), store, length, packed: Some(Box::new(self.clone())) })
    }

    /// Size, bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Size of the file itself, where it was unpacked from one, bytes.
    pub fn stored_length(&self) -> u64 {
        self.packed.as_ref().map_or(self.length, |p| p.stored_length())
    }

    /// The first bytes, at most `HEAD_BYTES`.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn head(&self) -> Result<Vec<u8>> {
        let mut head = Vec::new();
        self.at(0).take(HEAD_BYTES as u64).read_to_end(&mut head).map_err(|e| Error::io("read", &self.path, &e))?;
        Ok(head)
    }

    /// Fills `into` from a place in the file.
    ///
    /// # Errors
    /// The file ends before: what was expected there is `what`.
    pub fn read_at(&self, at: u64, into: &mut [u8], what: &str) -> Result<()> {
        let end = at.checked_add(into.len() as u64);
        if end.is_none_or(|end| end > self.length) {
            return Err(self.truncated(what, at, into.len() as u64));
        }
        self.at(at).read_exact(into).map_err(|e| Error::io("read", &self.path, &e))
    }

    /// The same as a vector; `count` is believed only as far as the file reaches.
    ///
    /// # Errors
    /// As [`Input::read_at`].
    pub fn bytes_at(&self, at: u64, count: u64, what: &str) -> Result<Vec<u8>> {
        if at.checked_add(count).is_none_or(|end| end > self.length) {
            return Err(self.truncated(what, at, count));
        }
        let mut bytes = vec![0; usize::try_from(count).map_err(|_| self.truncated(what, at, count))?];
        self.read_at(at, &mut bytes, what)?;
        Ok(bytes)
    }

    /// A reader from a place in the file on.
    pub fn at(&self, at: u64) -> Cursor {
        Cursor { store: Arc::clone(&self.store), at }
    }

    /// An error that names this file.
    pub fn fail(&self, cause: impl Into<String>, hint: impl Into<String>) -> Error {
        Error::new(format!("could not read {}", self.path.display()), cause, hint)
    }

    /// The file ends where something was expected.
    pub fn truncated(&self, what: &str, at: u64, count: u64) -> Error {
        self.fail(
            format!("expected {what}, {count} bytes at byte {at}, but the file has {} bytes", self.length),
            "it is cut short or damaged: copy it again, or repair it with the tools of whatever wrote it",
        )
    }

    /// Begins to digest all its bytes, next to other work.
    pub fn checksum(&self) -> Checksum {
        if let Some(packed) = &self.packed {
            return packed.checksum();
        }
        if self.length < SMALL_BYTES {
            return Checksum::Later(self.at(0));
        }
        let mut cursor = self.at(0);
        match std::thread::Builder::new().spawn(move || digest(&mut cursor)) {
            Ok(handle) => Checksum::Running(handle),
            Err(_) => Checksum::Later(self.at(0)),
        }
    }
}

/// A reader at a place in the file.
#[derive(Debug, Clone)]
pub struct Cursor {
    store: Arc<Store>,
    at: u64,
}

impl Cursor {
    /// Position of the reader, bytes from the beginning.
    pub fn place(&self) -> u64 {
        self.at
    }
}

impl Read for Cursor {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.store.read_at(buffer, self.at)?;
        self.at += count as u64;
        Ok(count)
    }
}

/// SHA-256 that is being made.
#[derive(Debug)]
pub enum Checksum {
    /// A thread computes the digest.
    Running(JoinHandle<std::io::Result<(String, u64)>>),
    /// When it is asked for.
    Later(Cursor),
}

impl Checksum {
    /// SHA-256 as hexadecimal digits, and how many bytes it is of.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn finish(self, path: &Path) -> Result<(String, u64)> {
        let done = match self {
            Self::Later(mut cursor) => digest(&mut cursor),
            Self::Running(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
        };
        done.map_err(|e| Error::io("read", path, &e))
    }
}

fn digest(cursor: &mut Cursor) -> std::io::Result<(String, u64)> {
    let mut digest = Sha256::new();
    let mut buffer = vec![0; DIGESTED_BYTES];
    loop {
        match cursor.read(&mut buffer)? {
            0 => return Ok((hexadecimal(&digest.finalize()), cursor.place())),
            count => digest.update(&buffer[..count]),
        }
    }
}

fn spool(from: &mut dyn Read) -> std::io::Result<(Arc<Store>, u64)> {
    let mut file = tempfile::tempfile()?;
    let length = std::io::copy(from, &mut file)?;
    file.flush()?;
    Ok((Arc::new(Store::File(file)), length))
}

/// Standard input, read once.
fn standard_input() -> Result<(Arc<Store>, u64)> {
    static KEPT: OnceLock<Result<(Arc<Store>, u64)>> = OnceLock::new();
    let kept = || spool(&mut std::io::stdin().lock()).map_err(|e| Error::io("keep", Path::new("-"), &e));
    KEPT.get_or_init(kept).clone()
}
