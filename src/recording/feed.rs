//! Bytes of a file from front to back with a look ahead, in bounded memory.

use std::io::Read;

use super::input::{Cursor, Input};
use crate::error::{Error, Result};

/// Bytes read at once.
const PIECE: usize = 1 << 17;

/// A file being read.
#[derive(Debug)]
pub struct Feed {
    input: Input,
    cursor: Cursor,
    buffer: Vec<u8>,
    start: usize,
}

impl Feed {
    /// From a place in the file on.
    pub fn new(input: &Input, at: u64) -> Self {
        Self { input: input.clone(), cursor: input.at(at), buffer: Vec::new(), start: 0 }
    }

    /// Place in the file of the next byte.
    pub fn place(&self) -> u64 {
        self.cursor.place() - (self.buffer.len() - self.start) as u64
    }

    /// The bytes that follow: `count` of them at least, unless the file ends before.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn ahead(&mut self, count: usize) -> Result<&[u8]> {
        if self.buffer.len() - self.start < count {
            self.buffer.drain(..self.start);
            self.start = 0;
            let missing = (count - self.buffer.len()).max(PIECE) as u64;
            let read = self.cursor.by_ref().take(missing).read_to_end(&mut self.buffer);
            read.map_err(|e| Error::io("read", &self.input.path, &e))?;
        }
        Ok(&self.buffer[self.start..])
    }

    /// Passes over bytes that were looked at.
    pub fn pass(&mut self, count: usize) {
        self.start = self.buffer.len().min(self.start + count);
    }
}
