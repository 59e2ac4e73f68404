//! ROS 1 bags, version 2.0, plain or compressed by LZ4 or bzip2. Format:
//! wiki.ros.org/Bags/Format/2.0.

use std::collections::HashMap;
use std::sync::Arc;

use crate::budget::{Budget, ENTRY_BYTES, LARGEST_BYTES};
use crate::bytes::Bytes;
use crate::decompress::{Codec, decompress};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::messages::{Encoding, MessageRows, Messages, part};
use crate::reader::{Choice, Log, Part, Reader};

/// States where the records begin: behind the magic line.
const FIRST: u64 = 13;
/// No header of a record is longer, bytes.
const LONGEST_HEADER: u32 = 1 << 20;
/// States what a record of the index is charged: a million of them are a bag of a terabyte.
const RECORD_BYTES: usize = 16;

const MESSAGE: u8 = 2;
const BAG: u8 = 3;
const CHUNK: u8 = 5;
const CHUNK_INFO: u8 = 6;
const CONNECTION: u8 = 7;

const DAMAGED: &str =
    "the bag is cut short or damaged: copy it again, or mend it with `rosbag reindex` and `rosbag fix`";

/// A bag: its topics, and to which of them each connection belongs.
#[derive(Debug)]
struct Bag {
    input: Input,
    parts: Vec<Part>,
    connections: Arc<HashMap<u32, usize>>,
}

/// Opens a bag.
///
/// # Errors
/// A bag that was not closed, or is damaged.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let mut at = FIRST;
    let head = record(input, &mut at)?;
    let fields = Fields::new(&head.header);
    let index = fields.u64(b"index_pos").filter(|_| fields.op() == Some(BAG));
    let Some(index) = index else {
        return Err(input.fail(format!("expected the bag's header at byte {FIRST}, found something else"), DAMAGED));
    };
    if index == 0 || index > input.length() {
        return Err(input.fail(
            match index {
                0 => "the bag has no index: it was not closed when the recording ended".to_owned(),
                _ => format!("expected the bag's index at byte {index}, but the file has {} bytes", input.length()),
            },
            "mend it: rosbag reindex FILE.bag; or copy it again if it is cut short",
        ));
    }
    let mut budget = Budget::of(input.length());
    let mut parts: Vec<Part> = Vec::new();
    let mut places: HashMap<(String, String), usize> = HashMap::new();
    let mut connections: HashMap<u32, usize> = HashMap::new();
    let mut counts: Vec<u64> = Vec::new();
    let mut are_counted = false;
    let mut at = index;
    while at < input.length() {
        let record = record(input, &mut at)?;
        budget.visit(RECORD_BYTES).map_err(|spent| spent.of(input))?;
        let fields = Fields::new(&record.header);
        if record.length > LARGEST_BYTES {
            return Err(input.fail(format!("an index of {} bytes where few were expected", record.length), DAMAGED));
        }
        match fields.op() {
            Some(CONNECTION) => {
                let data = input.bytes_at(record.data, record.length, "a connection")?;
                let inner = Fields::new(&data);
                let topic = fields.text(b"topic").unwrap_or_default();
                let kind = inner.text(b"type").unwrap_or_default();
                let place = match places.get(&(topic.clone(), kind.clone())) {
                    Some(place) => *place,
                    None => {
                        budget.visit(ENTRY_BYTES + topic.len() + kind.len()).map_err(|spent| spent.of(input))?;
                        places.insert((topic.clone(), kind.clone()), parts.len());
                        parts.push(part(topic, kind, None, true));
                        counts.push(0);
                        parts.len() - 1
                    }
                };
                connections.extend(fields.u32(b"conn").map(|connection| (connection, place)));
            }
            Some(CHUNK_INFO) => {
                are_counted = true;
                let data = input.bytes_at(record.data, record.length, "a list of a chunk's messages")?;
                let mut data = Bytes::new(&data);
                while let (Some(connection), Some(count)) = (data.u32(), data.u32()) {
                    if let Some(place) = connections.get(&connection) {
                        counts[*place] += u64::from(count);
                    }
                }
            }
            _ => {}
        }
    }
    for (part, count) in parts.iter_mut().zip(counts) {
        part.rows = are_counted.then_some(count);
    }
    Ok(Box::new(Bag { input: input.clone(), parts, connections: Arc::new(connections) }))
}

impl Log for Bag {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let chunks = Chunks {
            input: self.input.clone(),
            connections: self.connections,
            part,
            at: FIRST,
            chunk: Vec::new(),
            within: 0,
            budget: Budget::of(self.input.length()),
        };
        Ok(Box::new(MessageRows {
            input: self.input,
            messages: Box::new(chunks),
            kind: self.parts[part].kind.clone(),
            encoding: Encoding::Ros1,
            choice: choice.clone(),
            stated: self.parts[part].rows,
            count: 0,
        }))
    }
}

/// A record of the file: its header, and where its data lie.
struct Record {
    header: Vec<u8>,
    data: u64,
    length: u64,
}

/// The record at a place, which moves behind it.
fn record(input: &Input, at: &mut u64) -> Result<Record> {
    let four = |at: u64| -> Result<u32> {
        let bytes = input.bytes_at(at, 4, "the length of a record")?;
        Ok(u32::from_le_bytes(bytes.try_into().unwrap_or_default()))
    };
    let length = four(*at)?;
    if length > LONGEST_HEADER {
        return Err(input.fail(format!("expected a record at byte {at}, found a header of {length} bytes"), DAMAGED));
    }
    let header = input.bytes_at(*at + 4, u64::from(length), "the header of a record")?;
    let data = *at + 8 + u64::from(length);
    let length = u64::from(four(data - 4)?);
    if data + length > input.length() {
        return Err(input.truncated("the data of a record", data, length));
    }
    *at = data + length;
    Ok(Record { header, data, length })
}

/// The fields of a header: name=value, each with its length before it.
struct Fields<'a> {
    bytes: &'a [u8],
}

impl<'a> Fields<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn get(&self, name: &[u8]) -> Option<&'a [u8]> {
        let mut bytes = Bytes::new(self.bytes);
        while let Some(field) = bytes.counted() {
            let equals = memchr::memchr(b'=', field)?;
            if &field[..equals] == name {
                return Some(&field[equals + 1..]);
            }
        }
        None
    }

    fn op(&self) -> Option<u8> {
        self.get(b"op")?.first().copied()
    }

    fn u32(&self, name: &[u8]) -> Option<u32> {
        Bytes::new(self.get(name)?).u32()
    }

    fn u64(&self, name: &[u8]) -> Option<u64> {
        Bytes::new(self.get(name)?).u64()
    }

    fn text(&self, name: &[u8]) -> Option<String> {
        self.get(name).map(|b| String::from_utf8_lossy(b).into_owned())
    }
}

/// The messages of a topic's connections, chunk by chunk.
#[derive(Debug)]
struct Chunks {
    input: Input,
    connections: Arc<HashMap<u32, usize>>,
    part: usize,
    at: u64,
    chunk: Vec<u8>,
    within: usize,
    budget: Budget,
}

impl Chunks {
    fn damaged(&self, what: &str) -> Error {
        self.input.fail(format!("expected {what} in the chunk that ends at byte {}, found none", self.at), DAMAGED)
    }

    /// Reads the next chunk; false at the end of the bag.
    fn load(&mut self) -> Result<bool> {
        while self.at < self.input.length() {
            let record = record(&self.input, &mut self.at)?;
            let fields = Fields::new(&record.header);
            if fields.op() != Some(CHUNK) {
                continue;
            }
            let codec = match fields.get(b"compression") {
                Some(b"none") => Codec::None,
                Some(b"lz4") => Codec::Lz4Frame,
                Some(b"bz2") => Codec::Bzip2,
                other => {
                    let name = String::from_utf8_lossy(other.unwrap_or(b"nothing")).into_owned();
                    return Err(self.input.fail(
                        format!("its chunks are compressed by {name}, where lz4, bz2 or none were expected"),
                        "rosbag decompress FILE.bag makes one that can be read",
                    ));
                }
            };
            let size = u64::from(fields.u32(b"size").unwrap_or_default());
            if record.length > LARGEST_BYTES {
                return Err(self.damaged("at most 256 MiB"));
            }
            let data = self.input.bytes_at(record.data, record.length, "a chunk")?;
            self.chunk =
                decompress(codec, &data, size, &mut self.budget).map_err(|words| self.input.fail(words, DAMAGED))?;
            self.within = 0;
            return Ok(true);
        }
        Ok(false)
    }
}

impl Messages for Chunks {
    fn next(&mut self, into: &mut Vec<u8>) -> Result<bool> {
        loop {
            let mut rest = Bytes::new(&self.chunk[self.within..]);
            if rest.is_empty() {
                if !self.load()? {
                    return Ok(false);
                }
                continue;
            }
            let (Some(header), Some(data)) = (rest.counted(), rest.counted()) else {
                return Err(self.damaged("a whole record"));
            };
            let fields = Fields::new(header);
            let wanted = fields.op() == Some(MESSAGE)
                && fields.u32(b"conn").is_some_and(|connection| self.connections.get(&connection) == Some(&self.part));
            let taken = rest.taken();
            if wanted {
                into.extend_from_slice(data);
            }
            self.within += taken;
            if wanted {
                return Ok(true);
            }
        }
    }

    fn bytes_read(&self) -> u64 {
        self.at
    }
}
