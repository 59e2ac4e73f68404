//! Lines of a text file one by one, in bounded memory, unpacked as they are read.
//!
//! A line ends with `\n`, `\r\n` or `\r`. Not for cells: see `cells`.

use std::io::{BufRead, BufReader};

use super::input::{Checksum, Input};
use super::pack::{Pack, Unpacked};
use crate::error::{Error, Result};

/// No line of a recording is longer: a million columns take 20 MB.
const LONGEST_BYTES: usize = 64 << 20;
/// Bytes read from the file at once.
const BUFFER_BYTES: usize = 1 << 18;

/// A text file being read.
#[derive(Debug)]
pub struct Lines {
    input: Input,
    pack: Pack,
    reader: BufReader<Unpacked>,
    /// Whether a checksum is wanted, and the one that is being made.
    digested: bool,
    checksum: Option<Checksum>,
    line: Vec<u8>,
    number: u64,
    /// The last line ended with `\r`, so a `\n` that follows belongs to it.
    returned: bool,
}

impl Lines {
    /// Opens a file at its first line.
    ///
    /// # Errors
    /// As [`Unpacked::new`].
    pub fn open(input: Input, pack: Pack) -> Result<Self> {
        let reader = BufReader::with_capacity(BUFFER_BYTES, Unpacked::new(&input, pack)?);
        let (line, checksum) = (Vec::new(), None);
        Ok(Self { input, pack, reader, digested: true, checksum, line, number: 0, returned: false })
    }

    /// The first bytes, before any line was read.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn head(&mut self) -> Result<&[u8]> {
        match self.reader.fill_buf() {
            Ok(head) => Ok(head),
            Err(error) => Err(failed(&self.input, self.pack, &error)),
        }
    }

    /// Makes no checksum, which takes a good part of the time.
    pub fn without_checksum(&mut self) {
        self.digested = false;
    }

    /// The file will be read to its end: its checksum is begun, where one is wanted.
    pub fn begin(&mut self) {
        if self.digested && self.checksum.is_none() {
            self.checksum = Some(self.input.checksum());
        }
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
            let buffer = self.reader.fill_buf().map_err(|e| failed(&self.input, self.pack, &e))?;
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
                    format!("could not read {}", self.input.path.display()),
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
        self.input.length()
    }

    /// How far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.reader.get_ref().bytes_taken()
    }

    /// SHA-256 of the whole file, hexadecimal, and its size; empty without checksum.
    ///
    /// # Errors
    /// When the file cannot be read on.
    pub fn finish(self) -> Result<(String, u64)> {
        match self.checksum {
            Some(checksum) => checksum.finish(&self.input.path),
            None if self.digested => self.input.checksum().finish(&self.input.path),
            None => Ok((String::new(), self.input.length())),
        }
    }
}

/// What went wrong on the way from the disk to the text.
fn failed(input: &Input, pack: Pack, error: &std::io::Error) -> Error {
    match pack {
        Pack::None => Error::io("read", &input.path, error),
        _ if error.kind() == std::io::ErrorKind::UnexpectedEof => input.fail(
            format!(
                "expected more {} data, but the file ends after {} bytes: it is cut short",
                pack.name(),
                input.length()
            ),
            "copy it again, or unpack what is left of it yourself",
        ),
        _ => input.fail(format!("its {} data cannot be unpacked: {error}", pack.name()), "copy it again; is it whole?"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Result<Vec<Vec<u8>>> {
        let file = tempfile::NamedTempFile::new().expect("file");
        std::fs::write(file.path(), text).expect("write");
        let mut lines = Lines::open(Input::open(file.path())?, Pack::None)?;
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
