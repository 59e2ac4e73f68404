//! Lines of a text file one by one, in bounded memory, with the file's checksum on the way.
//!
//! A line ends with `\n`, `\r\n` or `\r`. Not for cells: see `cells`.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::document::hexadecimal;
use crate::error::{Error, Result};

/// No line of a recording is longer: a million columns take 20 MB.
const LONGEST_BYTES: usize = 64 << 20;
/// Bytes read from the file at once.
const BUFFER_BYTES: usize = 1 << 18;

/// A text file being read.
#[derive(Debug)]
pub struct Lines {
    path: PathBuf,
    reader: BufReader<Hashed>,
    line: Vec<u8>,
    number: u64,
    length_bytes: u64,
    /// The last line ended with `\r`, so a `\n` that follows belongs to it.
    returned: bool,
}

/// Opens a recording and gives its length in bytes.
///
/// # Errors
/// A folder, a pipe or a device, told before it is opened: to open a pipe is to wait for its writer.
pub fn open(path: &Path) -> Result<(File, u64)> {
    let about = std::fs::metadata(path).map_err(|e| Error::io("read", path, &e))?;
    if about.is_dir() {
        return Err(Error::io("read", path, &std::io::ErrorKind::IsADirectory.into()));
    }
    if !about.is_file() {
        // It is read more than once: for its headings, its clock and its rows.
        return Err(Error::new(
            format!("could not read {}", path.display()),
            "it is a pipe or a device, not a file",
            "save the recording as a file first",
        ));
    }
    Ok((File::open(path).map_err(|e| Error::io("read", path, &e))?, about.len()))
}

impl Lines {
    /// Opens a file at its first line.
    ///
    /// # Errors
    /// As [`open`].
    pub fn open(path: &Path) -> Result<Self> {
        let (file, length_bytes) = open(path)?;
        let reader = BufReader::with_capacity(BUFFER_BYTES, Hashed { file, digest: Some(Sha256::new()), bytes: 0 });
        Ok(Self { path: path.into(), reader, line: Vec::new(), number: 0, length_bytes, returned: false })
    }

    /// The first bytes, before any line was read.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn head(&mut self) -> Result<&[u8]> {
        self.reader.fill_buf().map_err(|e| Error::io("read", &self.path, &e))
    }

    /// Makes no checksum, which takes a good part of the time.
    pub fn without_checksum(&mut self) {
        self.reader.get_mut().digest = None;
    }

    /// Leaves out so many of the first bytes.
    pub fn skip(&mut self, bytes: usize) {
        self.reader.consume(bytes);
    }

    /// Reads the next line; false at the end of the file.
    ///
    /// # Errors
    /// When the file cannot be read, or a line is longer than 64 MB.
    pub fn advance(&mut self) -> Result<bool> {
        self.line.clear();
        let mut some = false;
        loop {
            let buffer = self.reader.fill_buf().map_err(|e| Error::io("read", &self.path, &e))?;
            if std::mem::take(&mut self.returned) && buffer.first() == Some(&b'\n') {
                self.reader.consume(1);
                continue;
            }
            if buffer.is_empty() {
                self.number += u64::from(some);
                return Ok(some);
            }
            some = true;
            let end = memchr::memchr2(b'\n', b'\r', buffer);
            let taken = end.unwrap_or(buffer.len());
            if self.line.len() + taken > LONGEST_BYTES {
                return Err(Error::new(
                    format!("could not read {}", self.path.display()),
                    format!("line {} is longer than {} MB", self.number + 1, LONGEST_BYTES >> 20),
                    "a recording is one line per sample, ended by a line feed: was it saved as one long line?",
                ));
            }
            self.line.extend_from_slice(&buffer[..taken]);
            if let Some(end) = end {
                self.returned = buffer[end] == b'\r';
                self.reader.consume(end + 1);
                self.number += 1;
                return Ok(true);
            }
            self.reader.consume(taken);
        }
    }

    /// The line, without its end.
    pub fn line(&self) -> &[u8] {
        &self.line
    }

    /// Puts the line aside; the next one is read into the room that `into` had.
    pub fn put_aside(&mut self, into: &mut Vec<u8>) {
        std::mem::swap(&mut self.line, into);
    }

    /// Number of the line in the file, the first being 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Size of the file when it was opened.
    pub fn length_bytes(&self) -> u64 {
        self.length_bytes
    }

    /// How far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.reader.get_ref().bytes
    }

    /// Reads whatever is left: SHA-256 of the whole file, hexadecimal; empty without checksum.
    ///
    /// # Errors
    /// When the file cannot be read on.
    pub fn finish(mut self) -> Result<String> {
        std::io::copy(&mut self.reader, &mut std::io::sink()).map_err(|e| Error::io("read", &self.path, &e))?;
        Ok(self.reader.into_inner().digest.map_or_else(String::new, |d| hexadecimal(&d.finalize())))
    }
}

/// A file that is digested as it is read.
#[derive(Debug)]
struct Hashed {
    file: File,
    digest: Option<Sha256>,
    bytes: u64,
}

impl Read for Hashed {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.file.read(buffer)?;
        if let Some(digest) = &mut self.digest {
            digest.update(&buffer[..count]);
        }
        self.bytes += count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Result<Vec<Vec<u8>>> {
        let file = tempfile::NamedTempFile::new().expect("file");
        std::fs::write(file.path(), text).expect("write");
        let mut lines = Lines::open(file.path())?;
        let mut out = Vec::new();
        while lines.advance()? {
            out.push(lines.line().to_vec());
            assert_eq!(lines.number(), out.len() as u64);
        }
        Ok(out)
    }

    #[test]
    fn every_kind_of_line_end_ends_a_line_once() {
        for text in [&b"a\nb\n\nc"[..], b"a\r\nb\r\n\r\nc\r\n", b"a\rb\r\rc\r"] {
            assert_eq!(lines(text).expect("text"), [&b"a"[..], b"b", b"", b"c"], "{text:?}");
        }
        let wide = vec![b'x'; BUFFER_BYTES - 1];
        let text = [&wide[..], b"\r\n1\n"].concat();
        assert_eq!(lines(&text).expect("text"), [&wide[..], b"1"], "the end of a line between two reads");
    }

    #[test]
    fn a_file_without_line_ends_is_refused_before_it_fills_the_memory() {
        let refused = lines(&vec![b'1'; LONGEST_BYTES + 1]).expect_err("one line");
        assert!(refused.cause.contains("line 1 is longer than 64 MB"), "{refused}");
    }
}
