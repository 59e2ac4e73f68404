//! The state file of a shard: what it belongs to, how far it has come, and what it has found so
//! far.
//!
//! First line: the schema and the SHA-256 of all that follows. Second line: the [`Header`] as JSON.
//! Then, for each piece, the bytes that the command packs its results in.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Piece, Shard};
use crate::document::{hexadecimal, write_whole};
use crate::error::{Error, Result};
use crate::output::lock::Lock;

/// Value of `schema` in the head of the file.
pub const SCHEMA: &str = "proofmass.shard/1";

/// Identity of a run: files of the same one belong together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Subcommand that is divided, e.g. "study".
    pub command: String,
    /// Version of the program.
    pub version: String,
    /// Digest of everything that the numbers depend on.
    pub identity: String,
    /// Name of a unit in the plural, e.g. "members".
    pub unit: String,
    /// Units of each part.
    pub parts: Vec<u64>,
}

/// The head of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The run that it is a shard of.
    pub run: Run,
    /// The file that the run was asked about, as far as there is one: the same command on it
    /// replaces this file.
    pub input: Option<PathBuf>,
    /// Holds what the command needs to know to put the shards together.
    pub document: serde_json::Value,
    /// Number of the shard and of all shards.
    pub shard: Shard,
    /// Work that it is to do, and how far it has come.
    pub pieces: Vec<Progress>,
}

/// Progress of a piece.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// Piece of the run.
    #[serde(flatten)]
    pub piece: Piece,
    /// The first unit that is not done.
    pub next: u64,
    /// Length of its results in the file.
    pub bytes: u64,
}

impl Progress {
    /// Returns whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        self.next >= self.piece.units.end
    }
}

impl Header {
    /// Returns whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        self.pieces.iter().all(Progress::is_done)
    }
}

/// The place of a shard's file in a folder, locked: two runs of one shard exclude each other, two
/// shards do not.
#[derive(Debug)]
pub struct Place {
    path: PathBuf,
    _lock: Lock,
}

impl Place {
    /// Locks it, and makes sure that what stands there may be replaced: nothing, or the same shard
    /// of a run on the same input.
    ///
    /// # Errors
    /// The folder cannot be made or written, another process is working on this shard, or the file
    /// is something else and the run is not forced.
    pub fn take(folder: &Path, header: &Header, force: bool) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|e| Error::io("create the folder", folder, &e))?;
        let name = header.shard.file_name();
        let lock = Lock::take_for(folder, &name)?;
        let path = folder.join(&name);
        if path.symlink_metadata().is_ok() && !force {
            let refuse = |cause: String| {
                let hint = "give another folder with --out DIR, or --force to replace it";
                Err(Error::new(format!("could not replace {}", path.display()), cause, hint))
            };
            match read_head(&path) {
                Ok(there) if there.run.command == header.run.command && there.input == header.input => {}
                Ok(there) => return refuse(format!("it is the state of {}", of(&there))),
                Err(error) => return refuse(error.cause),
            }
        }
        Ok(Self { path, _lock: lock })
    }

    /// Path of the shard's file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file, whole or not at all; `results` of each piece of the header.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write(&self, header: &Header, results: &[Vec<u8>]) -> Result<()> {
        let mut header = header.clone();
        header.pieces.iter_mut().zip(results).for_each(|(piece, bytes)| piece.bytes = bytes.len() as u64);
        let head = serde_json::to_vec(&header)
            .map_err(|e| Error::new("could not write a shard's state", e.to_string(), "report this as a defect"))?;
        let mut digest = Sha256::new();
        let rest: Vec<&[u8]> = [&head[..], b"\n"].into_iter().chain(results.iter().map(Vec::as_slice)).collect();
        rest.iter().for_each(|part| digest.update(part));
        let first = format!("{SCHEMA} {}\n", hexadecimal(&digest.finalize()));
        let mut bytes = first.into_bytes();
        rest.iter().for_each(|part| bytes.extend_from_slice(part));
        write_whole(&self.path, &bytes)
    }
}

/// Says what a file is a shard of.
pub fn of(header: &Header) -> String {
    let input = header.input.as_ref().map_or(String::new(), |input| format!(" of {}", input.display()));
    format!("a `{}`{input}", header.run.command)
}

fn refuse(path: &Path, cause: impl Into<String>) -> Error {
    let hint = "remove the file and run that shard again";
    Error::new(format!("could not use {}", path.display()), cause, hint)
}

/// Longest header, bytes: it holds a study, which is at most 16 MiB long.
const LONGEST_HEADER: u64 = 64 << 20;

/// Reads the head of a file; what follows is not looked at.
///
/// # Errors
/// It cannot be read, or is no state of a shard, or one of another version.
pub fn read_head(path: &Path) -> Result<Header> {
    let file = open(path)?;
    let mut lines = BufReader::new(file.take(LONGEST_HEADER));
    let mut line = Vec::new();
    let mut next = |line: &mut Vec<u8>| {
        line.clear();
        lines.read_until(b'\n', line).map_err(|e| Error::io("read", path, &e))
    };
    next(&mut line)?;
    first_line(path, &line)?;
    next(&mut line)?;
    parse(path, &line)
}

fn open(path: &Path) -> Result<File> {
    crate::document::open(path, "state")
}

/// The checksum that the first line states.
fn first_line<'a>(path: &Path, line: &'a [u8]) -> Result<&'a str> {
    let text = std::str::from_utf8(line).unwrap_or_default().trim_end();
    match text.split_once(' ') {
        Some((SCHEMA, checksum)) => Ok(checksum),
        Some((schema, _)) if schema.starts_with("proofmass.shard/") => {
            Err(refuse(path, format!("it is of another version: need {SCHEMA}, got {schema}")))
        }
        _ => Err(refuse(path, "it is not the state of a shard, or its beginning is damaged")),
    }
}

fn parse(path: &Path, line: &[u8]) -> Result<Header> {
    serde_json::from_slice(line)
        .map_err(|e| refuse(path, format!("the file is damaged: its header cannot be read: {e}")))
}

/// A file, read whole.
#[derive(Debug)]
pub struct Contents {
    /// Head of the file.
    pub header: Header,
    bytes: Vec<u8>,
    /// Offset at which the results begin.
    from: usize,
}

impl Contents {
    /// Reads a file and proves its checksum.
    ///
    /// # Errors
    /// As `read_head`, and when it is damaged.
    pub fn read(path: &Path) -> Result<Self> {
        let mut bytes = Vec::new();
        open(path)?.read_to_end(&mut bytes).map_err(|e| Error::io("read", path, &e))?;
        Self::parse(path, bytes)
    }

    /// The same of bytes that were read already, from this path.
    ///
    /// # Errors
    /// As [`Contents::read`].
    pub fn parse(path: &Path, bytes: Vec<u8>) -> Result<Self> {
        let end = |from: usize| bytes[from..].iter().position(|b| *b == b'\n').map(|at| from + at + 1);
        let first = end(0).unwrap_or(bytes.len());
        let checksum = first_line(path, &bytes[..first])?;
        if hexadecimal(&Sha256::digest(&bytes[first..])) != checksum {
            return Err(refuse(path, "the file is damaged: it does not have its checksum"));
        }
        let from = end(first).ok_or_else(|| refuse(path, "the file is damaged: it has no header"))?;
        let header = parse(path, &bytes[first..from])?;
        let length = header.pieces.iter().try_fold(0u64, |sum, piece| sum.checked_add(piece.bytes));
        if length != Some((bytes.len() - from) as u64) {
            return Err(refuse(path, "the file is damaged: its results have the wrong length"));
        }
        Ok(Self { header, bytes, from })
    }

    /// The file of a shard that is to be gone on with.
    ///
    /// # Errors
    /// There is none, it is damaged, or it belongs to another run than the header.
    pub fn resumed(place: &Place, header: &Header) -> Result<Self> {
        let path = place.path();
        let refuse =
            |cause: &str, hint: &str| Err(Error::new(format!("could not resume from {}", path.display()), cause, hint));
        if !path.exists() {
            let hint = "leave --resume out to start over, or give the --out of the interrupted run";
            return refuse("there is no interrupted run of this shard", hint);
        }
        let contents = Self::read(path)?;
        let same = contents.header.pieces.iter().map(|p| &p.piece).eq(header.pieces.iter().map(|p| &p.piece));
        if contents.header.run != header.run || !same {
            let cause = "it belongs to another run: the study, a file that it reads, the seed, the number of members or \
                         the version of the program is not the same";
            return refuse(cause, "leave --resume out to start over, or give the study, seed and members of that run");
        }
        Ok(contents)
    }

    /// Each piece with its results.
    pub fn pieces(&self) -> impl Iterator<Item = (&Progress, &[u8])> {
        let mut at = self.from;
        self.header.pieces.iter().map(move |piece| {
            let from = at;
            at += piece.bytes as usize;
            (piece, &self.bytes[from..at])
        })
    }
}

/// The error of results that cannot be what their header says.
pub fn damaged(path: &Path, what: &str) -> Error {
    refuse(path, what)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(command: &str) -> Header {
        let run = Run {
            command: command.into(),
            version: "1".into(),
            identity: "a".into(),
            unit: "members".into(),
            parts: vec![10],
        };
        let piece = Progress { piece: Piece { part: 0, units: 0..10 }, next: 4, bytes: 0 };
        let shard = Shard { number: 1, of: 2 };
        Header { run, input: None, document: serde_json::Value::Null, shard, pieces: vec![piece] }
    }

    #[test]
    fn what_was_written_is_read_and_every_flipped_bit_is_seen() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let place = Place::take(folder.path(), &header("study"), false).expect("free");
        place.write(&header("study"), &[b"results\nof any kind".to_vec()]).expect("written");
        let read = Contents::read(place.path()).expect("whole");
        let (progress, results) = read.pieces().next().expect("a piece");
        assert_eq!((progress.next, results), (4, &b"results\nof any kind"[..]));
        assert_eq!(read_head(place.path()).expect("whole"), read.header);
        let good = std::fs::read(place.path()).expect("read");
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 4;
            std::fs::write(place.path(), bad).expect("written");
            assert!(Contents::read(place.path()).is_err(), "byte {at}");
        }
        std::fs::write(place.path(), &good[..good.len() - 1]).expect("written");
        assert!(Contents::read(place.path()).is_err_and(|e| e.cause.contains("checksum")));
    }

    #[test]
    fn a_shard_excludes_itself_and_keeps_what_is_not_its_own() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let first = Place::take(folder.path(), &header("study"), false).expect("free");
        assert!(Place::take(folder.path(), &header("study"), false).is_err());
        let second = Header { shard: Shard { number: 2, of: 2 }, ..header("study") };
        assert!(Place::take(folder.path(), &second, false).is_ok());
        first.write(&header("study"), &[Vec::new()]).expect("written");
        drop(first);
        assert!(Place::take(folder.path(), &header("map"), false).is_err_and(|e| e.cause.contains("`study`")));
        assert!(Place::take(folder.path(), &header("map"), true).is_ok());
        std::fs::write(folder.path().join("shard-2-of-2.state"), "mine").expect("written");
        assert!(Place::take(folder.path(), &second, false).is_err());
    }
}
