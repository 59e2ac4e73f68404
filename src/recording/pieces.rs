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
    pub bytes: Vec<u8>,
    pub regular: Option<Regular>,
}

/// A file being read.
#[derive(Debug)]
pub(super) struct Pieces {
    reader: Unpacked,
    /// The beginning of the next piece.
    rest: Vec<u8>,
    ended: bool,
    longest: usize,
    parsers: Option<Parsers>,
    parsed: VecDeque<Receiver<Piece>>,
    failed: Option<io::Error>,
}

impl Pieces {
    /// Of a reader; a piece without a line's end grows up to `longest` bytes.
    pub(super) fn new(reader: Unpacked, longest: usize) -> Self {
        let (rest, parsed) = (Vec::new(), VecDeque::new());
        Self { reader, rest, ended: false, longest, parsers: None, parsed, failed: None }
    }

    /// From here on rows have this layout, and are parsed beforehand.
    pub(super) fn parse(&mut self, layout: Layout) {
        self.parsers = Parsers::start(layout);
    }

    /// Bytes of the file itself that were read.
    pub(super) fn bytes_taken(&self) -> u64 {
        self.reader.bytes_taken()
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
            match read(&mut self.reader, &mut self.rest, &mut self.ended, self.longest) {
                Ok(Some(bytes)) => {
                    let (send, receive) = sync_channel(1);
                    parsers.jobs.send(Job { bytes, send }).map_err(io::Error::other)?;
                    self.parsed.push_back(receive);
                }
                Ok(None) => break,
                Err(error) => self.failed = Some(error),
            }
        }
        if let Some(piece) = self.parsed.pop_front() {
            return piece.recv().map(Some).map_err(io::Error::other);
        }
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let bytes = read(&mut self.reader, &mut self.rest, &mut self.ended, self.longest)?;
        Ok(bytes.map(|bytes| Piece { bytes, regular: None }))
    }
}

/// Whole lines: the beginning that was read already, and what follows it.
fn read(reader: &mut Unpacked, rest: &mut Vec<u8>, ended: &mut bool, longest: usize) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = std::mem::take(rest);
    while !*ended && bytes.len() <= longest {
        let from = bytes.len();
        *ended = !append(reader, &mut bytes)?;
        // Where a return ends the lines, a feed may follow the last one.
        let end = memchr::memrchr(b'\n', &bytes[from..])
            .or_else(|| memchr::memrchr(b'\r', &bytes[from..bytes.len().saturating_sub(1).max(from)]));
        if let Some(end) = end.filter(|_| !*ended) {
            rest.reserve(PIECE_BYTES + bytes.len() - from);
            rest.extend_from_slice(&bytes[from + end + 1..]);
            bytes.truncate(from + end + 1);
            break;
        }
    }
    Ok((!bytes.is_empty()).then_some(bytes))
}

/// Reads so many bytes more; false at the end.
fn append(reader: &mut Unpacked, bytes: &mut Vec<u8>) -> io::Result<bool> {
    let mut filled = bytes.len();
    bytes.resize(filled + PIECE_BYTES, 0);
    while filled < bytes.len() {
        match reader.read(&mut bytes[filled..]) {
            Ok(0) => {
                bytes.truncate(filled);
                return Ok(false);
            }
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(true)
}

/// A piece to parse, and where it goes.
struct Job {
    bytes: Vec<u8>,
    send: SyncSender<Piece>,
}

/// Threads of a file's own, which end with it: those that share out other work may all be waiting for its rows.
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
                    let Ok(Job { bytes, send }) = job else { return };
                    let regular = layout.regular(&bytes);
                    // Nobody waits for it any more where reading was given up.
                    let _ = send.send(Piece { bytes, regular });
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
                pieces.parse(Layout { separator: b',', width: 2, choice });
            }
            let (mut bytes, mut values) = (Vec::new(), Vec::new());
            while let Some(piece) = pieces.take().expect("read") {
                assert!(piece.bytes.ends_with(b"\n") && piece.regular.is_some() == parsed);
                values.extend(piece.regular.map(|r| r.values).unwrap_or_default());
                bytes.extend(piece.bytes);
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
