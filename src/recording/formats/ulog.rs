//! PX4's ULog: messages whose fields the log itself names. Format:
//! docs.px4.io/main/en/dev_log/ulog_file_format.

use std::collections::{HashMap, HashSet};

use crate::budget::{Budget, ENTRY_BYTES, Spent};
use crate::bytes::Bytes;
use crate::dropped::{Dropped, Reason};
use crate::element::{Element, Kind};
use crate::error::Result;
use crate::feed::Feed;
use crate::finding::Finding;
use crate::input::Input;
use crate::reader::{BLOCK_ROWS, Block, Choice, Heading, Log, Part, Reader};
use crate::records::{self, Field, Strays};

/// Behind magic, version and time.
const FIRST: u64 = 16;
/// Length and type of a message.
const HEAD: usize = 3;
/// Types of messages there are; at anything else the log is damaged.
const TYPES: &[u8] = b"BFIMPQALCDSOR";
/// A message that stands here and there, for finding back into a damaged log.
const SYNC: &[u8] = b"\x08\x00S\x2f\x73\x13\x20\x25\x0c\xbb\x12";
/// Bytes that are searched for it at once.
const SEARCHED: usize = 1 << 16;
/// Formats within formats are followed so far.
const DEEPEST: usize = 8;
/// No message has more fields.
const MOST_FIELDS: usize = 4096;

/// A field of a format takes about so many bytes, next to its name.
const FIELD_BYTES: usize = 16;

/// A message that was logged, under the number that stands for it.
#[derive(Debug, Clone)]
struct Logged {
    id: u16,
    fields: Vec<Field>,
}

#[derive(Debug)]
struct Ulog {
    input: Input,
    parts: Vec<Part>,
    logged: Vec<Logged>,
}

/// Opens a log.
///
/// # Errors
/// A file that ends before its first message.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    if input.length() < FIRST + HEAD as u64 {
        return Err(input.truncated("the header of a ULog", 0, FIRST + HEAD as u64));
    }
    let mut formats: HashMap<String, String> = HashMap::new();
    let mut subscriptions: Vec<(u16, u8, String)> = Vec::new();
    let mut counts: HashMap<u16, u64> = HashMap::new();
    let mut messages = Messages::new(input);
    while let Some((kind, data)) = messages.next()? {
        match kind {
            b'F' => {
                let text = String::from_utf8_lossy(data);
                if let Some((name, fields)) = text.split_once(':') {
                    formats.insert(name.to_owned(), fields.to_owned());
                }
            }
            b'A' => {
                let mut bytes = Bytes::new(data);
                if let (Some(instance), Some(id)) = (bytes.u8(), bytes.u16()) {
                    subscriptions.push((id, instance, String::from_utf8_lossy(bytes.rest()).into_owned()));
                }
            }
            b'D' => {
                if let Some(id) = Bytes::new(data).u16() {
                    *counts.entry(id).or_default() += 1;
                }
            }
            _ => {}
        }
    }
    let mut layout = Layout { formats: &formats, budget: Budget::of(input.length()), offset: 0, fields: Vec::new() };
    let mut log = Ulog { input: input.clone(), parts: Vec::new(), logged: Vec::new() };
    let mut topics = HashSet::new();
    for (id, instance, name) in subscriptions {
        layout.budget.visit(ENTRY_BYTES + name.len()).map_err(|spent| spent.of(input))?;
        let topic = if instance == 0 { name.clone() } else { format!("{name}.{instance}") };
        if !topics.insert(topic.clone()) {
            continue;
        }
        let mut fields = layout.of(&name).map_err(|spent| spent.of(input))?;
        let mut headings: Vec<Heading> = fields.iter().map(|f| f.heading.clone()).collect();
        let is_imu = records::inertial(&mut headings);
        fields.iter_mut().zip(&headings).for_each(|(field, heading)| field.heading = heading.clone());
        let rows = counts.get(&id).copied().unwrap_or(0);
        log.parts.push(Part {
            name: topic,
            kind: String::new(),
            rows: Some(rows),
            columns: headings,
            is_imu: is_imu && rows > 0,
        });
        log.logged.push(Logged { id, fields });
    }
    prefer_combined(&mut log.parts);
    Ok(Box::new(log))
}

/// Several messages repeat the readings of the sensor that is flown by: that one is meant where
/// none is named.
fn prefer_combined(parts: &mut [Part]) {
    if parts.iter().any(|p| p.name == "sensor_combined" && p.is_imu) {
        parts.iter_mut().filter(|p| p.name != "sensor_combined").for_each(|p| p.is_imu = false);
    }
}

/// Lays out the fields of messages, those of formats within formats included; padding and text are
/// none.
struct Layout<'a> {
    formats: &'a HashMap<String, String>,
    budget: Budget,
    offset: usize,
    fields: Vec<Field>,
}

impl Layout<'_> {
    /// Returns the fields of the messages of a format.
    fn of(&mut self, name: &str) -> Result<Vec<Field>, Spent> {
        // Behind the number that stands for the message.
        self.offset = 2;
        self.expand(name, "", 0)?;
        Ok(std::mem::take(&mut self.fields))
    }

    fn expand(&mut self, name: &str, prefix: &str, depth: usize) -> Result<(), Spent> {
        let formats = self.formats;
        let Some(fields) = formats.get(name).filter(|_| depth < DEEPEST) else { return Ok(()) };
        self.budget.visit(fields.len())?;
        for (kind, name) in fields.split(';').filter_map(|f| f.trim().split_once(' ')) {
            let (kind, count) = match kind.split_once('[') {
                Some((kind, count)) => (kind, count.trim_end_matches(']').parse().unwrap_or(0usize)),
                None => (kind, 0),
            };
            for index in 0..count.max(1) {
                if self.fields.len() >= MOST_FIELDS || self.offset > usize::from(u16::MAX) {
                    return Ok(());
                }
                // Of a format without fields, or without any format, there may be any number.
                self.budget.visit(FIELD_BYTES + prefix.len() + name.len())?;
                let full = match count {
                    0 => format!("{prefix}{name}"),
                    _ => format!("{prefix}{name}.{}", index + 1),
                };
                let Some(element) = element(kind) else {
                    self.expand(kind, &format!("{full}."), depth + 1)?;
                    continue;
                };
                let heading = match full.as_str() {
                    "timestamp" => Heading::clock("timestamp", "us"),
                    _ => Heading::named(full),
                };
                if !name.starts_with("_padding") && kind != "char" {
                    self.fields.push(Field { heading, element, offset: self.offset, scale: 1.0 });
                }
                self.offset += element.bytes;
            }
        }
        Ok(())
    }
}

fn element(kind: &str) -> Option<Element> {
    let (kind, bytes) = match kind {
        "int8_t" => (Kind::Signed, 1),
        "int16_t" => (Kind::Signed, 2),
        "int32_t" => (Kind::Signed, 4),
        "int64_t" => (Kind::Signed, 8),
        "uint8_t" | "bool" | "char" => (Kind::Unsigned, 1),
        "uint16_t" => (Kind::Unsigned, 2),
        "uint32_t" => (Kind::Unsigned, 4),
        "uint64_t" => (Kind::Unsigned, 8),
        "float" => (Kind::Float, 4),
        "double" => (Kind::Float, 8),
        _ => return None,
    };
    Some(Element::little(kind, bytes))
}

/// All messages of a log.
#[derive(Debug)]
struct Messages {
    feed: Feed,
    strays: Strays,
    /// A message of data that the end of the file cuts.
    cut: Option<u16>,
    /// Bytes of the message before, to be passed.
    held: usize,
}

impl Messages {
    fn new(input: &Input) -> Self {
        Self { feed: Feed::new(input, FIRST), strays: Strays::default(), cut: None, held: 0 }
    }

    /// The next message: its type and its data.
    fn next(&mut self) -> Result<Option<(u8, &[u8])>> {
        self.feed.pass(std::mem::take(&mut self.held));
        loop {
            let at = self.feed.place();
            let ahead = self.feed.ahead(HEAD)?;
            if ahead.len() < HEAD {
                self.strays.add(at, ahead.len() as u64);
                return Ok(None);
            }
            let (length, kind) = (usize::from(u16::from_le_bytes([ahead[0], ahead[1]])), ahead[2]);
            if TYPES.contains(&kind) {
                let found = self.feed.ahead(HEAD + length)?.len();
                if found >= HEAD + length {
                    self.held = HEAD + length;
                    return Ok(Some((kind, &self.feed.ahead(HEAD + length)?[HEAD..HEAD + length])));
                }
                let id = self.feed.ahead(HEAD + 2)?.get(HEAD..HEAD + 2).and_then(|b| Bytes::new(b).u16());
                self.cut = id.filter(|_| kind == b'D');
                if self.cut.is_none() {
                    self.strays.add(at, found as u64);
                }
                self.feed.pass(found);
                return Ok(None);
            }
            // Damaged: go on where the log marks a beginning.
            self.pass_strays(1);
            loop {
                let ahead = self.feed.ahead(SEARCHED)?;
                let length = ahead.len();
                if let Some(place) = memchr::memmem::find(ahead, SYNC) {
                    self.pass_strays(place);
                    break;
                }
                if length < SYNC.len() {
                    self.pass_strays(length);
                    return Ok(None);
                }
                self.pass_strays(length - (SYNC.len() - 1));
            }
        }
    }

    fn pass_strays(&mut self, bytes: usize) {
        self.strays.add(self.feed.place(), bytes as u64);
        self.feed.pass(bytes);
    }
}

impl Log for Ulog {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let logged = self.logged[part].clone();
        Ok(Box::new(Rows { messages: Messages::new(&self.input), logged, choice: choice.clone() }))
    }
}

#[derive(Debug)]
struct Rows {
    messages: Messages,
    logged: Logged,
    choice: Choice,
}

impl Reader for Rows {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        while block.rows < BLOCK_ROWS {
            let Some((kind, data)) = self.messages.next()? else { break };
            if kind == b'D' && Bytes::new(data).u16() == Some(self.logged.id) {
                records::push(&self.logged.fields, &self.choice, data, block);
            }
        }
        Ok(block.rows > 0)
    }

    fn bytes_read(&self) -> u64 {
        self.messages.feed.place()
    }

    fn dropped(&self) -> Vec<Dropped> {
        let cut = self.messages.cut == Some(self.logged.id);
        cut.then_some(Dropped { reason: Reason::CutShort, rows: 1, first_row: 0 }).into_iter().collect()
    }

    fn findings(&self) -> Vec<Finding> {
        self.messages.strays.finding().into_iter().collect()
    }
}
