//! A text file in pieces of whole lines, parsed by other threads before they are asked for.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use super::pack::Unpacked;
use super::regular::{Layout, Regular};
use crate::parallel;

/// Bytes of a piece, unless a line is longer.
pub(super) const PIECE_BYTES: usize = 1 << 18;
/// Threads that parse; one reads a disk's worth.
const MOST_THREADS: usize = 4;
/// Pieces on their way for each of them.
const AHEAD: usize = 2;

/// Whole lines, and what they hold where all of them are regular rows.
#[derive(Debug, Default)]
pub(crate) struct Piece {
    /// The lines, the last one maybe without an end.
    pub(crate) bytes: Vec<u8>,
    /// Holds what they hold, and whether that is to be used.
    rows: Regular,
    is_regular: bool,
}

impl Piece {
    /// Its rows, where they are regular ones.
    #[inline]
    pub(crate) fn regular(&self) -> Option<&Regular> {
        self.is_regular.then_some(&self.rows)
    }
}

/// A file being read.
#[derive(Debug)]
pub(super) struct Pieces {
    source: Source,
    parsers: Option<Parsers>,
    parsed: VecDeque<Receiver<Piece>>,
    failed: Option<io::Error>,
    /// Pieces that were used, for their room.
    spare: Vec<Piece>,
}

/// States where the bytes come from.
#[derive(Debug)]
struct Source {
    reader: Unpacked,
    /// The beginning of the next piece.
    rest: Vec<u8>,
    ended: bool,
    longest: usize,
}

impl Pieces {
    /// Of a reader; a piece without a line's end grows up to `longest` bytes.
    pub(super) fn new(reader: Unpacked, longest: usize) -> Self {
        let source = Source { reader, rest: Vec::new(), ended: false, longest };
        Self { source, parsers: None, parsed: VecDeque::new(), failed: None, spare: Vec::new() }
    }

    /// From here on rows have this layout, and are parsed beforehand.
    pub(super) fn parse(&mut self, layout: Layout) {
        self.parsers = Parsers::start(layout);
    }

    /// Takes back a piece that was used.
    pub(super) fn give_back(&mut self, piece: Piece) {
        self.spare.push(piece);
    }

    /// Bytes of the file itself that were read.
    pub(super) fn bytes_taken(&self) -> u64 {
        self.source.reader.bytes_taken()
    }

    /// The next piece; none at the end. One of more than `longest` bytes is not whole.
    ///
    /// # Errors
    /// As the reader's, once the pieces before are given.
    pub(super) fn take(&mut self) -> io::Result<Option<Piece>> {
        while self.failed.is_none()
            && let Some(parsers) = &self.parsers
            && self.parsed.len() < AHEAD * parsers.threads
        {
            let mut piece = self.spare.pop().unwrap_or_default();
            match self.source.fill(&mut piece.bytes) {
                Ok(true) => {
                    let (send, receive) = sync_channel(1);
                    parsers.jobs.send(Job { piece, send }).map_err(io::Error::other)?;
                    self.parsed.push_back(receive);
                }
                Ok(false) => break,
                Err(error) => self.failed = Some(error),
            }
        }
        if let Some(piece) = self.parsed.pop_front() {
            return piece.recv().map(Some).map_err(io::Error::other);
        }
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let mut piece = self.spare.pop().unwrap_or_default();
        piece.is_regular = false;
        Ok(self.source.fill(&mut piece.bytes)?.then_some(piece))
    }
}

impl Source {
    /// Replaces `bytes` by whole lines: the beginning that was read already, and what follows it.
    /// False at the end.
    fn fill(&mut self, bytes: &mut Vec<u8>) -> io::Result<bool> {
        // What the room was used for before need not be made zero: it is written over.
        let mut filled = self.rest.len();
        if bytes.len() < filled {
            bytes.resize(filled, 0);
        }
        bytes[..filled].copy_from_slice(&self.rest);
        self.rest.clear();
        while !self.ended && filled <= self.longest {
            let from = filled;
            filled = self.append(bytes, filled)?;
            let new = &bytes[from..filled];
            // Where a return ends the lines, a feed may follow the last one.
            let end =
                memchr::memrchr(b'\n', new).or_else(|| memchr::memrchr(b'\r', &new[..new.len().saturating_sub(1)]));
            if let Some(end) = end.filter(|_| !self.ended) {
                self.rest.extend_from_slice(&new[end + 1..]);
                filled = from + end + 1;
                break;
            }
        }
        bytes.truncate(filled);
        Ok(filled > 0)
    }

    /// Reads this many bytes more behind those that are filled, unless the file ends: how many are
    /// filled then.
    fn append(&mut self, bytes: &mut Vec<u8>, mut filled: usize) -> io::Result<usize> {
        let room = filled + PIECE_BYTES;
        if bytes.len() < room {
            bytes.resize(room, 0);
        }
        while filled < room && !self.ended {
            match self.reader.read(&mut bytes[filled..room]) {
                Ok(0) => self.ended = true,
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(filled)
    }
}

/// A piece to parse, and where it goes.
struct Job {
    piece: Piece,
    send: SyncSender<Piece>,
}

/// Threads of a file's own, which end with it: those that share out other work may all be waiting
/// for its rows.
#[derive(Debug)]
struct Parsers {
    jobs: Sender<Job>,
    threads: usize,
}

impl Parsers {
    /// None where no thread can be started.
    fn start(layout: Layout) -> Option<Self> {
        let (jobs, receive) = channel::<Job>();
        let (layout, receive) = (Arc::new(layout), Arc::new(Mutex::new(receive)));
        let start = |_: usize| {
            let (layout, receive) = (Arc::clone(&layout), Arc::clone(&receive));
            let work = move || {
                loop {
                    let job = receive.lock().unwrap_or_else(PoisonError::into_inner).recv();
                    let Ok(Job { mut piece, send }) = job else { return };
                    piece.is_regular = layout.read(&piece.bytes, &mut piece.rows);
                    // Nobody waits for it any more where reading was given up.
                    let _ = send.send(piece);
                }
            };
            thread::Builder::new().spawn(work).is_ok()
        };
        let threads = (0..parallel::threads().clamp(1, MOST_THREADS)).filter(|i| start(*i)).count();
        (threads > 0).then_some(Self { jobs, threads })
    }
}

#[cfg(test)]
mod tests {
    use super::super::input::Input;
    use super::super::pack::Pack;
    use super::super::reader::Choice;
    use super::*;

    fn pieces(text: &[u8]) -> Pieces {
        let input = Input::of_bytes(std::path::Path::new("log.csv"), text.to_vec());
        Pieces::new(Unpacked::new(&input, Pack::None).expect("bytes"), 1 << 20)
    }

    #[test]
    fn pieces_are_whole_lines_in_their_order_parsed_or_not() {
        let line = |i: usize| format!("{i},{}\n", 0.25 * i as f64);
        let text: String = (0..100_000).map(line).collect();
        for parsed in [false, true] {
            let mut pieces = pieces(text.as_bytes());
            if parsed {
                let choice = Choice { time: None, places: vec![1] };
                pieces.parse(Layout::new(b',', 2, &choice).expect("a layout"));
            }
            let (mut bytes, mut values) = (Vec::new(), Vec::new());
            while let Some(piece) = pieces.take().expect("read") {
                assert!(piece.bytes.ends_with(b"\n") && piece.regular().is_some() == parsed);
                values.extend(piece.regular().map(|r| r.columns[0].clone()).unwrap_or_default());
                bytes.extend_from_slice(&piece.bytes);
                pieces.give_back(piece);
            }
            assert_eq!(bytes, text.as_bytes());
            let whole: Vec<f64> = (0..100_000).map(|i| 0.25 * f64::from(i)).collect();
            assert_eq!(values, if parsed { whole } else { Vec::new() });
        }
    }

    #[test]
    fn returns_end_lines_too_and_a_line_without_end_is_given_up() {
        let mut returns = pieces(&b"12345\r".repeat(100_000));
        let first = returns.take().expect("read").expect("a piece");
        assert!(first.bytes.len() <= PIECE_BYTES && first.bytes.ends_with(b"\r"));
        let first = pieces(&vec![b'1'; 3 << 20]).take().expect("read").expect("a piece");
        assert!(first.bytes.len() > 1 << 20 && first.bytes.len() < 2 << 20);
    }
}
