//! Recordings that are packed as a whole: `.gz` and `.zst`, unpacked as they are read.
//!
//! Not for compression inside a format, which knows the sizes: see `decompress`.

use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::budget::most_unpacked;
use super::input::{Cursor, Input};
use crate::error::Result;

/// Holds what the file's bytes are packed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pack {
    /// Stored without compression.
    None,
    /// gzip, RFC 1952.
    Gzip,
    /// Zstandard, RFC 8878.
    Zstandard,
}

/// Returns how a file is packed, by its first bytes.
pub fn of(head: &[u8]) -> Pack {
    match head {
        [0x1f, 0x8b, ..] => Pack::Gzip,
        [0x28, 0xb5, 0x2f, 0xfd, ..] => Pack::Zstandard,
        _ => Pack::None,
    }
}

impl Pack {
    /// Name for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "text",
            Self::Gzip => "gzip",
            Self::Zstandard => "Zstandard",
        }
    }
}

/// A file that is unpacked as it is read, and how many of its own bytes were.
pub(super) struct Unpacked {
    reader: Box<dyn Read + Send>,
    taken: Arc<AtomicU64>,
    given: u64,
    bounded: bool,
}

impl std::fmt::Debug for Unpacked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Unpacked({} of {} bytes)", self.given, self.bytes_taken())
    }
}

impl Unpacked {
    /// From the beginning of a file.
    ///
    /// # Errors
    /// A kind of packing that this build was made without.
    pub(super) fn new(input: &Input, pack: Pack) -> Result<Self> {
        let taken = Arc::new(AtomicU64::new(0));
        let source = Counted { cursor: input.at(0), taken: Arc::clone(&taken) };
        let reader: Box<dyn Read + Send> = match pack {
            Pack::None => Box::new(source),
            #[cfg(feature = "gzip")]
            Pack::Gzip => Box::new(flate2::read::MultiGzDecoder::new(source)),
            #[cfg(feature = "zstd")]
            Pack::Zstandard => Box::new(super::zstandard::Frames::new(source)),
            #[allow(unreachable_patterns, reason = "which of them remain is a matter of features")]
            other => {
                return Err(input.fail(
                    format!("this is {} data, and this build reads none", other.name()),
                    "unpack it first, or build with the feature of its name",
                ));
            }
        };
        Ok(Self { reader, taken, given: 0, bounded: pack != Pack::None })
    }

    /// Bytes of the file itself that were read.
    pub(super) fn bytes_taken(&self) -> u64 {
        self.taken.load(Ordering::Relaxed)
    }
}

impl Read for Unpacked {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.given += count as u64;
        if self.bounded && self.given > most_unpacked(self.bytes_taken()) {
            return Err(io::Error::other(format!(
                "{} bytes of the file became more than {}: more than a thousandfold, which no log compresses to",
                self.bytes_taken(),
                self.given
            )));
        }
        Ok(count)
    }
}

struct Counted {
    cursor: Cursor,
    taken: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.cursor.read(buffer)?;
        self.taken.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}
