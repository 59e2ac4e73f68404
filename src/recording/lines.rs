//! Lines of a text file one by one, in bounded memory, unpacked as they are read.
//!
//! A line ends with `\n`, `\r\n` or `\r`. Not for cells: see `cells`.

use std::ops::Range;

use super::input::{Checksum, Input};
use super::pack::{Pack, Unpacked};
use super::pieces::{Piece, Pieces};
use super::regular::{Layout, Regular};
use crate::error::{Error, Result};

/// No line of a recording is longer: a million columns take 20 MB.
const LONGEST_BYTES: usize = 64 << 20;

/// A text file being read.
#[derive(Debug)]
pub struct Lines {
    input: Input,
    pack: Pack,
    pieces: Pieces,
    /// States whether a checksum is wanted, and the one that is being made.
    digested: bool,
    checksum: Option<Checksum>,
    piece: Piece,
    /// States where the next line begins in the piece.
    at: usize,
    /// The line at hand, in the piece, and its row among regular ones.
    line: Range<usize>,
    row: usize,
    number: u64,
    /// The last line ended with `\r`, so a `\n` that follows belongs to it.
    returned: bool,
    /// A line that is kept: in the piece, or put aside from the one before.
    kept: Option<Range<usize>>,
    aside: Vec<u8>,
}

impl Lines {
    /// Opens a file at its first line.
    ///
    /// # Errors
    /// As `Unpacked::new`.
    pub fn open(input: Input, pack: Pack) -> Result<Self> {
        let pieces = Pieces::new(Unpacked::new(&input, pack)?, LONGEST_BYTES);
        Ok(Self {
            input,
            pack,
            pieces,
            digested: true,
            checksum: None,
            piece: Piece::default(),
            at: 0,
            line: 0..0,
            row: 0,
            number: 0,
            returned: false,
            kept: None,
            aside: Vec::new(),
        })
    }

    /// The first bytes, before any line was read.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn head(&mut self) -> Result<&[u8]> {
        if self.number == 0 && self.at == 0 && self.piece.bytes.is_empty() {
            self.load()?;
        }
        Ok(&self.piece.bytes)
    }

    /// From the next piece on, rows have this layout and are parsed beforehand.
    pub fn parse(&mut self, layout: Layout) {
        self.pieces.parse(layout);
    }

    /// The next piece; false at the end. The line that is kept is put aside.
    fn load(&mut self) -> Result<bool> {
        if let Some(kept) = self.kept.take() {
            self.aside.clear();
            self.aside.extend_from_slice(&self.piece.bytes[kept]);
        }
        let Some(piece) = self.pieces.take().map_err(|e| failed(&self.input, self.pack, &e))? else { return Ok(false) };
        self.pieces.give_back(std::mem::replace(&mut self.piece, piece));
        (self.at, self.line, self.row) = (0, 0..0, 0);
        Ok(true)
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

    /// Leaves out this many of the first bytes.
    pub fn skip(&mut self, bytes: usize) {
        self.at = self.piece.bytes.len().min(self.at + bytes);
    }

    /// Reads the next line; false at the end of the file.
    ///
    /// # Errors
    /// When the file cannot be read, or a line is longer than 64 MB.
    #[inline]
    pub fn advance(&mut self) -> Result<bool> {
        loop {
            if let Some(regular) = self.piece.regular() {
                if let Some(line) = regular.lines.get(self.row) {
                    self.line = line.start as usize..line.end as usize;
                    self.row += 1;
                    self.number += 1;
                    return Ok(true);
                }
            } else if self.advance_within()? {
                return Ok(true);
            }
            if !self.load()? {
                return Ok(false);
            }
        }
    }

    /// The next line of a piece that was not parsed; false at its end.
    fn advance_within(&mut self) -> Result<bool> {
        let mut rest = &self.piece.bytes[self.at..];
        if !rest.is_empty() && std::mem::take(&mut self.returned) && rest[0] == b'\n' {
            self.at += 1;
            rest = &rest[1..];
        }
        if rest.is_empty() {
            return Ok(false);
        }
        let end = memchr::memchr2(b'\n', b'\r', rest);
        let length = end.unwrap_or(rest.len());
        if length > LONGEST_BYTES {
            return Err(Error::new(
                format!("could not read {}", self.input.path.display()),
                format!("line {} is longer than {} MB", self.number + 1, LONGEST_BYTES >> 20),
                "a recording is one line per sample, ended by a line feed: was it saved as one long line?",
            ));
        }
        self.returned = end.is_some_and(|e| rest[e] == b'\r');
        self.line = self.at..self.at + length;
        self.at += length + usize::from(end.is_some());
        self.number += 1;
        Ok(true)
    }

    /// Passes lines of the piece at hand that were parsed, at most this many: the piece's rows, and
    /// which of them. Never its first one, which follows a line of another piece; none where that
    /// is next, or nothing was parsed.
    #[inline]
    pub fn pass(&mut self, most: usize) -> Option<(&Regular, Range<usize>)> {
        let rows = self.piece.regular()?;
        let end = rows.lines.len().min(self.row.saturating_add(most));
        if self.row == 0 || end <= self.row {
            return None;
        }
        let passed = self.row..end;
        self.line = rows.lines[end - 1].start as usize..rows.lines[end - 1].end as usize;
        self.number += passed.len() as u64;
        self.row = end;
        Some((self.piece.regular()?, passed))
    }

    /// The line, without its end.
    #[inline]
    pub fn line(&self) -> &[u8] {
        &self.piece.bytes[self.line.clone()]
    }

    /// The numbers of the line at hand, where it was parsed: those of the piece, and its row among
    /// them.
    #[inline]
    pub fn regular(&self) -> Option<(&Regular, usize)> {
        self.piece.regular().map(|regular| (regular, self.row.saturating_sub(1)))
    }

    /// Keeps the line at hand while others are read.
    #[inline]
    pub fn keep(&mut self) {
        self.kept = Some(self.line.clone());
    }

    /// The line that was kept last.
    #[inline]
    pub fn kept(&self) -> &[u8] {
        self.kept.as_ref().map_or(&self.aside, |kept| &self.piece.bytes[kept.clone()])
    }

    /// Number of the line in the file, the first being 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Size of the file when it was opened.
    pub fn length_bytes(&self) -> u64 {
        self.input.length()
    }

    /// Returns how far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.pieces.bytes_taken()
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

/// Returns what went wrong on the way from the disk to the text.
fn failed(input: &Input, pack: Pack, error: &std::io::Error) -> Error {
    match pack {
        Pack::None => Error::io("read", &input.path, error),
        _ if error.kind() == std::io::ErrorKind::UnexpectedEof => input.fail(
            format!(
                "expected more {} data, but the file ends after {} bytes: it is cut short",
                pack.name(),
                input.length()
            ),
            "copy it again, or unpack the rest of it yourself",
        ),
        _ => input
            .fail(format!("its {} data cannot be unpacked: {error}", pack.name()), "copy it again; is it complete?"),
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
        let wide = vec![b'x'; super::super::pieces::PIECE_BYTES - 1];
        let text = [&wide[..], b"\r\n1\n"].concat();
        assert_eq!(lines(&text).expect("text"), [&wide[..], b"1"], "the end of a line between two reads");
    }

    #[test]
    fn a_file_without_line_ends_is_refused_before_it_fills_the_memory() {
        let refused = lines(&vec![b'1'; LONGEST_BYTES + 1]).expect_err("one line");
        assert!(refused.cause.contains("line 1 is longer than 64 MB"), "{refused}");
    }
}
