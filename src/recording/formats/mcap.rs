//! MCAP logs: messages in CDR or ROS 1 serialisation, plain or compressed by Zstandard or LZ4.
//! Format: mcap.dev/spec.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::io::Read;
use std::ops::Range;

use crate::budget::{Budget, ENTRY_BYTES, LARGEST_BYTES, Spent};
use crate::bytes::Bytes;
use crate::decompress::{Codec, decompress};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::messages::{Encoding, MessageRows, Messages, part};
use crate::reader::{Choice, Log, Part, Reader};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Opcode, length, and what the footer holds; the same of the end of the data.
const FOOTER_BYTES: u64 = 9 + 20;
const DATA_END_BYTES: u64 = 9 + 4;
/// Bytes that are read at once for a checksum.
const PIECE_BYTES: usize = 1 << 18;
/// Opcodes from here on are the writers' own.
const PRIVATE: u8 = 0x80;
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
    /// States where the records end.
    data_end: u64,
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
    let Sections { data_end, summary, footer } = Sections::of(input, end)?;
    let mut known = Known::new(Budget::of(input.length()));
    known.scan(input, summary, footer)?;
    if known.channels.is_empty() {
        known.scan(input, begin, data_end)?;
    }
    Ok(Box::new(known.log(input, data_end).map_err(|spent| spent.of(input))?))
}

/// States where the records of a log end, and where what sums them up begins and ends.
struct Sections {
    data_end: u64,
    summary: u64,
    footer: u64,
}

impl Sections {
    /// The sections of a log that ends with the magic bytes at `end`; the checksum of the summary
    /// is compared with the one that the footer states.
    fn of(input: &Input, end: u64) -> Result<Self> {
        let footer = end - FOOTER_BYTES;
        let damaged =
            |at: u64, what: &str| input.fail(format!("expected {what} at byte {at}, found something else"), DAMAGED);
        let head = record(input, &mut { footer })?;
        let data = input.bytes_at(head.data, head.length, "the footer")?;
        let mut fields = Bytes::new(&data);
        let (Some(stated), Some(_), Some(crc32), FOOTER) = (fields.u64(), fields.u64(), fields.u32(), head.op) else {
            return Err(damaged(footer, "the footer"));
        };
        // Zero stands for none, of the summary and of its checksum.
        let summary = if stated == 0 { footer } else { stated };
        let data_end = summary.checked_sub(DATA_END_BYTES).filter(|_| summary <= footer);
        let data_end = data_end.ok_or_else(|| damaged(footer, "the footer of this log"))?;
        if record(input, &mut { data_end })?.op != DATA_END {
            return Err(damaged(data_end, "the end of the data"));
        }
        // All of the summary, and of the footer what stands before the checksum.
        compare(input, "the summary", summary..footer + 9 + 16, crc32)?;
        Ok(Self { data_end, summary, footer })
    }
}

/// Compares the checksum of a section with the one that is stated; zero stands for none.
fn compare(input: &Input, what: &str, section: Range<u64>, stated: u32) -> Result<()> {
    if stated == 0 {
        return Ok(());
    }
    let mut reader = input.at(section.start).take(section.end - section.start);
    let (mut checksum, mut buffer) = (crc32fast::Hasher::new(), vec![0; PIECE_BYTES]);
    loop {
        match reader.read(&mut buffer).map_err(|e| Error::io("read", &input.path, &e))? {
            0 => break,
            count => checksum.update(&buffer[..count]),
        }
    }
    match checksum.finalize() {
        found if found == stated => Ok(()),
        found => Err(input
            .fail(format!("the checksum of {what} is {found:08x}, where {stated:08x} was expected (CRC-32)"), DAMAGED)),
    }
}

/// Holds what a log says of its channels.
#[derive(Debug)]
struct Known {
    schemas: HashMap<u16, String>,
    /// Channel, schema, topic, encoding; and the channels among them.
    channels: Vec<(u16, u16, String, String)>,
    met: HashSet<u16>,
    counts: HashMap<u16, u64>,
    budget: Budget,
}

impl Known {
    fn new(budget: Budget) -> Self {
        let (schemas, channels, met, counts) = Default::default();
        Self { schemas, channels, met, counts, budget }
    }

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
                    self.learn(record.op, &data).map_err(|spent| spent.of(input))?;
                }
                CHUNK => {
                    let chunk = chunk(input, &record, &mut self.budget)?;
                    let mut bytes = Bytes::new(&chunk);
                    while let Some((op, data)) = next(&mut bytes) {
                        self.learn(op, data).map_err(|spent| spent.of(input))?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Takes in a record: one too short to be understood names nothing, one told again costs nothing.
    fn learn(&mut self, op: u8, data: &[u8]) -> Result<(), Spent> {
        let mut bytes = Bytes::new(data);
        match op {
            SCHEMA => {
                if let (Some(id), Some(name)) = (bytes.u16(), bytes.text())
                    && self.schemas.get(&id) != Some(&name)
                {
                    self.budget.visit(ENTRY_BYTES + name.len())?;
                    self.schemas.insert(id, name);
                }
            }
            CHANNEL => {
                if let (Some(id), Some(schema), Some(topic), Some(encoding)) =
                    (bytes.u16(), bytes.u16(), bytes.text(), bytes.text())
                    && self.met.insert(id)
                {
                    self.budget.visit(ENTRY_BYTES + topic.len() + encoding.len())?;
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
        Ok(())
    }

    fn log(mut self, input: &Input, data_end: u64) -> Result<Mcap, Spent> {
        let mut log = Mcap { input: input.clone(), parts: Vec::new(), channels: Vec::new(), data_end };
        let mut places: HashMap<(String, String), usize> = HashMap::new();
        for (id, schema, topic, encoding) in self.channels {
            // Any number of channels may be of one schema.
            self.budget.visit(self.schemas.get(&schema).map_or(0, String::len))?;
            let kind = self.schemas.get(&schema).cloned().unwrap_or_default();
            let (encoding, readable) = match encoding.as_str() {
                "cdr" => (Encoding::Cdr, true),
                "ros1" => (Encoding::Ros1, true),
                _ => (Encoding::Cdr, false),
            };
            let count = self.counts.get(&id).copied();
            match places.entry((topic.clone(), kind.clone())) {
                Entry::Occupied(place) => {
                    let place = *place.get();
                    log.channels[place].0.insert(id);
                    log.parts[place].rows = log.parts[place].rows.zip(count).map(|(a, b)| a.saturating_add(b));
                }
                Entry::Vacant(place) => {
                    place.insert(log.parts.len());
                    log.parts.push(part(topic, kind, count, readable));
                    log.channels.push((HashSet::from([id]), encoding));
                }
            }
        }
        Ok(log)
    }
}

impl Log for Mcap {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let (channels, encoding) = self.channels[part].clone();
        let end = self.data_end;
        let stated = self.input.bytes_at(end + 9, 4, "the end of the data")?;
        compare(&self.input, "the data", 0..end, Bytes::new(&stated).u32().unwrap_or_default())?;
        let (input, at) = (self.input.clone(), MAGIC.len() as u64);
        let budget = Budget::of(input.length());
        let records = Records { input, channels, at, end, chunk: Vec::new(), within: 0, budget };
        Ok(Box::new(MessageRows {
            input: self.input,
            messages: Box::new(records),
            kind: self.parts[part].kind.clone(),
            encoding,
            choice: choice.clone(),
            stated: self.parts[part].rows,
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

fn chunk(input: &Input, record: &Record, budget: &mut Budget) -> Result<Vec<u8>> {
    let fail = |words: String| -> Error { input.fail(format!("the chunk at byte {}: {words}", record.data), DAMAGED) };
    if record.length > LARGEST_BYTES {
        return Err(fail("expected at most 256 MiB".into()));
    }
    let data = input.bytes_at(record.data, record.length, "a chunk")?;
    let mut bytes = Bytes::new(&data);
    let mut parts = || {
        bytes.take(16)?;
        let size = bytes.u64()?;
        let crc32 = bytes.u32()?;
        let compression = bytes.text()?;
        let length = bytes.u64()?;
        Some((size, crc32, compression, bytes.take(usize::try_from(length).ok()?)?))
    };
    let Some((size, crc32, compression, records)) = parts() else {
        return Err(fail("it ends before its records".into()));
    };
    let codec = match compression.as_str() {
        "" => Codec::None,
        "zstd" => Codec::Zstandard,
        "lz4" => Codec::Lz4Frame,
        other => return Err(fail(format!("compressed by `{other}`, where zstd, lz4 or nothing were expected"))),
    };
    let records = decompress(codec, records, size, budget).map_err(fail)?;
    match crc32fast::hash(&records) {
        // Zero stands for none.
        found if crc32 == 0 || found == crc32 => Ok(records),
        found => Err(fail(format!("its checksum is {found:08x}, where {crc32:08x} was expected (CRC-32)"))),
    }
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
    budget: Budget,
}

/// Returns what a message's data say of it: its channel, and the message behind sequence and two
/// times.
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
                    self.chunk = chunk(&self.input, &record, &mut self.budget)?;
                    self.within = 0;
                }
                MESSAGE if record.length <= LARGEST_BYTES => {
                    let data = self.input.bytes_at(record.data, record.length, "a message")?;
                    if let Some(found) = message(&self.channels, &data) {
                        into.extend_from_slice(found);
                        return Ok(true);
                    }
                }
                1..DATA_END | PRIVATE.. => {}
                other => {
                    return Err(self.input.fail(
                        format!("expected a record before byte {}, found one of type {other}", record.data),
                        DAMAGED,
                    ));
                }
            }
        }
    }

    fn bytes_read(&self) -> u64 {
        self.at
    }
}
