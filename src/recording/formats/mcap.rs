//! MCAP logs: messages in CDR or ROS 1 serialisation, plain or compressed by Zstandard or LZ4.
//! Format: mcap.dev/spec.

use std::collections::{HashMap, HashSet};

use crate::bytes::Bytes;
use crate::decompress::{Codec, LARGEST_BYTES, decompress};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::messages::{Encoding, MessageRows, Messages, part};
use crate::reader::{Choice, Log, Part, Reader};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Opcode, length, and what the footer holds.
const FOOTER_BYTES: u64 = 9 + 20;
/// Records but chunks and attachments are no longer, bytes.
const LONGEST: u64 = 64 << 20;

const FOOTER: u8 = 2;
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const STATISTICS: u8 = 11;
const DATA_END: u8 = 15;

const DAMAGED: &str = "the log is cut short or damaged: copy it again, or mend it with `mcap recover`";

#[derive(Debug)]
struct Mcap {
    input: Input,
    parts: Vec<Part>,
    /// Per part, its channels and how its messages are serialised.
    channels: Vec<(HashSet<u16>, Encoding)>,
}

/// Opens a log.
///
/// # Errors
/// A log that was not closed, or is damaged.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let begin = MAGIC.len() as u64;
    let end = input.length().saturating_sub(begin);
    let closed = end > begin + FOOTER_BYTES && input.bytes_at(end, begin, "the end of the log")? == MAGIC;
    if !closed {
        return Err(input.fail(
            "expected the log to end as it begins, found something else: it was not closed, or is cut short",
            "mend it with `mcap recover FILE.mcap`, or copy it again",
        ));
    }
    let mut at = end - FOOTER_BYTES;
    let footer = record(input, &mut at)?;
    let data = input.bytes_at(footer.data, footer.length, "the footer")?;
    let summary = Bytes::new(&data).u64().filter(|_| footer.op == FOOTER);
    let Some(summary) = summary else {
        return Err(
            input.fail(format!("expected the footer at byte {}, found something else", end - FOOTER_BYTES), DAMAGED)
        );
    };
    let mut known = Known::default();
    if summary > begin && summary < end {
        known.scan(input, summary, end)?;
    }
    if known.channels.is_empty() {
        known.scan(input, begin, end)?;
    }
    Ok(Box::new(known.log(input)))
}

/// What a log says of its channels.
#[derive(Debug, Default)]
struct Known {
    schemas: HashMap<u16, String>,
    /// Channel, schema, topic, encoding.
    channels: Vec<(u16, u16, String, String)>,
    counts: HashMap<u16, u64>,
}

impl Known {
    fn scan(&mut self, input: &Input, from: u64, to: u64) -> Result<()> {
        let mut at = from;
        while at < to {
            let record = record(input, &mut at)?;
            match record.op {
                SCHEMA | CHANNEL | STATISTICS => {
                    if record.length > LONGEST {
                        return Err(
                            input.fail(format!("a record of {} bytes where few were expected", record.length), DAMAGED)
                        );
                    }
                    let data = input.bytes_at(record.data, record.length, "a record")?;
                    self.learn(record.op, &data);
                }
                CHUNK => {
                    let chunk = chunk(input, &record)?;
                    let mut bytes = Bytes::new(&chunk);
                    while let Some((op, data)) = next(&mut bytes) {
                        self.learn(op, data);
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// What is too short to be understood names nothing.
    fn learn(&mut self, op: u8, data: &[u8]) {
        let mut bytes = Bytes::new(data);
        match op {
            SCHEMA => {
                if let (Some(id), Some(name)) = (bytes.u16(), bytes.text()) {
                    self.schemas.insert(id, name);
                }
            }
            CHANNEL => {
                if let (Some(id), Some(schema), Some(topic), Some(encoding)) =
                    (bytes.u16(), bytes.u16(), bytes.text(), bytes.text())
                    && self.channels.iter().all(|c| c.0 != id)
                {
                    self.channels.push((id, schema, topic, encoding));
                }
            }
            // Messages, schemas, channels, attachments, metadata, chunks, first and last time.
            STATISTICS if bytes.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8 + 4).is_some() => {
                while let (Some(id), Some(count)) = (bytes.u16(), bytes.u64()) {
                    self.counts.insert(id, count);
                }
            }
            _ => {}
        }
    }

    fn log(self, input: &Input) -> Mcap {
        let mut log = Mcap { input: input.clone(), parts: Vec::new(), channels: Vec::new() };
        for (id, schema, topic, encoding) in self.channels {
            let kind = self.schemas.get(&schema).cloned().unwrap_or_default();
            let (encoding, readable) = match encoding.as_str() {
                "cdr" => (Encoding::Cdr, true),
                "ros1" => (Encoding::Ros1, true),
                _ => (Encoding::Cdr, false),
            };
            let count = self.counts.get(&id).copied();
            match log.parts.iter().position(|p| p.name == topic && p.kind == kind) {
                Some(place) => {
                    log.channels[place].0.insert(id);
                    log.parts[place].rows = log.parts[place].rows.zip(count).map(|(a, b)| a.saturating_add(b));
                }
                None => {
                    log.parts.push(part(topic, kind, count, readable));
                    log.channels.push((HashSet::from([id]), encoding));
                }
            }
        }
        log
    }
}

impl Log for Mcap {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let (channels, encoding) = self.channels[part].clone();
        let end = self.input.length() - MAGIC.len() as u64;
        let (input, at) = (self.input.clone(), MAGIC.len() as u64);
        let records = Records { input, channels, at, end, chunk: Vec::new(), within: 0 };
        Ok(Box::new(MessageRows {
            input: self.input,
            messages: Box::new(records),
            kind: self.parts[part].kind.clone(),
            encoding,
            choice: choice.clone(),
            count: 0,
        }))
    }
}

struct Record {
    op: u8,
    data: u64,
    length: u64,
}

/// The record at a place, which moves behind it.
fn record(input: &Input, at: &mut u64) -> Result<Record> {
    let head = input.bytes_at(*at, 9, "a record")?;
    let mut bytes = Bytes::new(&head);
    let (op, length) = (bytes.u8().unwrap_or_default(), bytes.u64().unwrap_or_default());
    let data = *at + 9;
    match data.checked_add(length).filter(|end| *end <= input.length()) {
        Some(end) => *at = end,
        None => return Err(input.truncated("the data of a record", data, length)),
    }
    Ok(Record { op, data, length })
}

/// The next record of a chunk.
fn next<'a>(bytes: &mut Bytes<'a>) -> Option<(u8, &'a [u8])> {
    let (op, length) = (bytes.u8()?, bytes.u64()?);
    Some((op, bytes.take(usize::try_from(length).ok()?)?))
}

fn chunk(input: &Input, record: &Record) -> Result<Vec<u8>> {
    let fail = |words: String| -> Error { input.fail(format!("the chunk at byte {}: {words}", record.data), DAMAGED) };
    if record.length > LARGEST_BYTES {
        return Err(fail("expected at most 256 MiB".into()));
    }
    let data = input.bytes_at(record.data, record.length, "a chunk")?;
    let mut bytes = Bytes::new(&data);
    let mut parts = || {
        bytes.take(16)?;
        let size = bytes.u64()?;
        bytes.u32()?;
        let compression = bytes.text()?;
        let length = bytes.u64()?;
        Some((size, compression, bytes.take(usize::try_from(length).ok()?)?))
    };
    let Some((size, compression, records)) = parts() else { return Err(fail("it ends before its records".into())) };
    let codec = match compression.as_str() {
        "" => Codec::None,
        "zstd" => Codec::Zstandard,
        "lz4" => Codec::Lz4Frame,
        other => return Err(fail(format!("compressed by `{other}`, where zstd, lz4 or nothing were expected"))),
    };
    decompress(codec, records, size).map_err(fail)
}

/// The messages of some channels.
#[derive(Debug)]
struct Records {
    input: Input,
    channels: HashSet<u16>,
    at: u64,
    end: u64,
    chunk: Vec<u8>,
    within: usize,
}

/// What a message's data say of it: its channel, and the message behind sequence and two times.
fn message<'a>(channels: &HashSet<u16>, data: &'a [u8]) -> Option<&'a [u8]> {
    let mut bytes = Bytes::new(data);
    let channel = bytes.u16()?;
    bytes.take(4 + 8 + 8)?;
    channels.contains(&channel).then(|| bytes.rest())
}

impl Messages for Records {
    fn next(&mut self, into: &mut Vec<u8>) -> Result<bool> {
        loop {
            let mut bytes = Bytes::new(&self.chunk[self.within..]);
            if !bytes.is_empty() {
                let Some((op, data)) = next(&mut bytes) else {
                    return Err(self.input.fail(
                        format!(
                            "expected a whole record in the chunk that ends at byte {}, found half of one",
                            self.at
                        ),
                        DAMAGED,
                    ));
                };
                let found = if op == MESSAGE { message(&self.channels, data) } else { None };
                let taken = bytes.taken();
                into.extend_from_slice(found.unwrap_or_default());
                let some = found.is_some();
                self.within += taken;
                if some {
                    return Ok(true);
                }
                continue;
            }
            if self.at >= self.end {
                return Ok(false);
            }
            let record = record(&self.input, &mut self.at)?;
            match record.op {
                CHUNK => {
                    self.chunk = chunk(&self.input, &record)?;
                    self.within = 0;
                }
                MESSAGE if record.length <= LARGEST_BYTES => {
                    let data = self.input.bytes_at(record.data, record.length, "a message")?;
                    if let Some(found) = message(&self.channels, &data) {
                        into.extend_from_slice(found);
                        return Ok(true);
                    }
                }
                DATA_END => self.at = self.end,
                _ => {}
            }
        }
    }

    fn bytes_read(&self) -> u64 {
        self.at
    }
}
