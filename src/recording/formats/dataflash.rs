//! ArduPilot's DataFlash logs: messages whose fields the log itself names (FMT). Format: ArduPilot,
//! libraries/AP_Logger.

use std::collections::BTreeMap;

use crate::bytes::until_zero;
use crate::dropped::{Dropped, Reason};
use crate::element::{Element, Kind};
use crate::error::Result;
use crate::feed::Feed;
use crate::finding::Finding;
use crate::input::Input;
use crate::reader::{BLOCK_ROWS, Block, Choice, Heading, Log, Part, Reader};
use crate::records::{self, Field, Strays};

const MAGIC: [u8; 2] = [0xa3, 0x95];
const HEAD: usize = 3;
/// The message that describes messages: its type and its bytes.
const FORMAT: u8 = 128;
const FORMAT_BYTES: usize = 89;

/// A type of message.
#[derive(Debug, Clone)]
struct Message {
    length: usize,
    name: String,
    fields: Vec<Field>,
    /// States where the number of the sensor stands, of those that have several.
    instance: Option<usize>,
}

#[derive(Debug)]
struct DataFlash {
    input: Input,
    parts: Vec<Part>,
    /// Type and number of the sensor, by part.
    kinds: Vec<(u8, Option<u8>)>,
    messages: BTreeMap<u8, Message>,
}

/// Opens a log.
///
/// # Errors
/// A file without any description of a message.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let mut counts: BTreeMap<(u8, Option<u8>), u64> = BTreeMap::new();
    let mut walk = Walk::new(input, BTreeMap::new());
    while let Some((kind, instance, _)) = walk.next()? {
        *counts.entry((kind, instance)).or_default() += 1;
    }
    let messages = walk.messages;
    if messages.is_empty() {
        return Err(input.fail(
            format!("expected messages that describe themselves (FMT), found none in {} bytes", input.length()),
            "is this a DataFlash log (.bin), as ArduPilot writes it? Telemetry logs (.tlog) are not",
        ));
    }
    let (mut parts, mut kinds) = (Vec::new(), Vec::new());
    for ((kind, instance), rows) in &counts {
        let Some(message) = messages.get(kind) else { continue };
        let several = counts.range((*kind, None)..=(*kind, Some(u8::MAX))).nth(1).is_some();
        let name = match instance.filter(|_| several) {
            Some(instance) => format!("{}.{instance}", message.name),
            None => message.name.clone(),
        };
        let columns: Vec<Heading> = message.fields.iter().map(|f| f.heading.clone()).collect();
        let has = |wanted: &str| columns.iter().any(|c| c.name == wanted);
        let is_imu = ["gx", "gy", "gz", "ax", "ay", "az"].into_iter().all(has);
        parts.push(Part { name, kind: String::new(), rows: Some(*rows), columns, is_imu });
        kinds.push((*kind, *instance));
    }
    Ok(Box::new(DataFlash { input: input.clone(), parts, kinds, messages }))
}

/// Returns what an FMT message says.
fn described(record: &[u8]) -> Option<(u8, Message)> {
    let (kind, length) = (*record.get(3)?, usize::from(*record.get(4)?));
    let name = until_zero(record.get(5..9)?);
    let (format, names) = (until_zero(record.get(9..25)?), until_zero(record.get(25..89)?));
    let mut offset = HEAD;
    let mut fields = Vec::new();
    let mut instance = None;
    for (letter, name) in format.bytes().zip(names.split(',')) {
        let (element, bytes, scale) = stored(letter)?;
        if let Some(element) = element {
            let heading = match name {
                "TimeUS" => Heading::clock("TimeUS", "us"),
                "TimeMS" => Heading::clock("TimeMS", "ms"),
                _ => Heading::named(name),
            };
            if name == "I" && element.bytes == 1 {
                instance = Some(offset);
            }
            fields.push(Field { heading, element, offset, scale });
        }
        offset += bytes;
    }
    let mut headings: Vec<Heading> = fields.iter().map(|f| f.heading.clone()).collect();
    records::inertial(&mut headings);
    fields.iter_mut().zip(headings).for_each(|(field, heading)| field.heading = heading);
    (offset <= length && length > HEAD).then_some((kind, Message { length, name, fields, instance }))
}

/// A letter of a format: how its number is stored, if it is one, its bytes, and its scale.
fn stored(letter: u8) -> Option<(Option<Element>, usize, f64)> {
    let number = |kind, bytes, scale| Some((Some(Element::little(kind, bytes)), bytes, scale));
    match letter {
        b'b' => number(Kind::Signed, 1, 1.0),
        b'B' | b'M' => number(Kind::Unsigned, 1, 1.0),
        b'h' => number(Kind::Signed, 2, 1.0),
        b'H' => number(Kind::Unsigned, 2, 1.0),
        b'i' => number(Kind::Signed, 4, 1.0),
        b'I' => number(Kind::Unsigned, 4, 1.0),
        b'q' => number(Kind::Signed, 8, 1.0),
        b'Q' => number(Kind::Unsigned, 8, 1.0),
        b'g' => number(Kind::Float, 2, 1.0),
        b'f' => number(Kind::Float, 4, 1.0),
        b'd' => number(Kind::Float, 8, 1.0),
        b'c' => number(Kind::Signed, 2, 0.01),
        b'C' => number(Kind::Unsigned, 2, 0.01),
        b'e' => number(Kind::Signed, 4, 0.01),
        b'E' => number(Kind::Unsigned, 4, 0.01),
        b'L' => number(Kind::Signed, 4, 1e-7),
        b'n' => Some((None, 4, 1.0)),
        b'N' => Some((None, 16, 1.0)),
        b'Z' | b'a' => Some((None, 64, 1.0)),
        _ => None,
    }
}

/// Passes through all messages.
#[derive(Debug)]
struct Walk {
    feed: Feed,
    messages: BTreeMap<u8, Message>,
    strays: Strays,
    /// Type and sensor of a message that the end of the file cuts.
    cut: Option<(u8, Option<u8>)>,
    held: usize,
}

/// A message: its type, the number of its sensor, and all its bytes.
type Found<'a> = (u8, Option<u8>, &'a [u8]);

impl Walk {
    fn new(input: &Input, messages: BTreeMap<u8, Message>) -> Self {
        Self { feed: Feed::new(input, 0), messages, strays: Strays::default(), cut: None, held: 0 }
    }

    /// The next message but FMT: its type, the number of its sensor, and all its bytes.
    fn next(&mut self) -> Result<Option<Found<'_>>> {
        loop {
            self.feed.pass(std::mem::take(&mut self.held));
            let ahead = self.feed.ahead(FORMAT_BYTES.max(256))?;
            if ahead.is_empty() {
                return Ok(None);
            }
            let kind = ahead.get(2).copied().filter(|_| ahead.starts_with(&MAGIC));
            let length = kind.and_then(|kind| match kind {
                FORMAT => Some(FORMAT_BYTES),
                _ => self.messages.get(&kind).map(|m| m.length),
            });
            let (Some(kind), Some(length)) = (kind, length) else {
                // On to what looks like the beginning of a message.
                let next = memchr::memchr(MAGIC[0], &ahead[1..]).map_or(ahead.len(), |i| i + 1);
                self.strays.add(self.feed.place(), next as u64);
                self.feed.pass(next);
                continue;
            };
            if ahead.len() < length {
                let rest = ahead.len();
                let message = self.messages.get(&kind).filter(|_| kind != FORMAT);
                let instance = message.and_then(|m| ahead.get(m.instance?).copied());
                // Of which sensor it is must stand in what is left of it.
                self.cut = message.filter(|m| m.instance.is_some() == instance.is_some()).map(|_| (kind, instance));
                if self.cut.is_none() {
                    self.strays.add(self.feed.place(), rest as u64);
                }
                self.feed.pass(rest);
                return Ok(None);
            }
            self.held = length;
            if kind == FORMAT {
                if let Some((kind, message)) = described(&ahead[..length]) {
                    self.messages.entry(kind).or_insert(message);
                }
                continue;
            }
            let instance = self.messages.get(&kind).and_then(|m| ahead.get(m.instance?).copied());
            return Ok(Some((kind, instance, &self.feed.ahead(length)?[..length])));
        }
    }
}

impl Log for DataFlash {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let wanted = self.kinds[part];
        let message = self.messages[&wanted.0].clone();
        // Descriptions are learnt as they come, as when the messages were counted.
        let walk = Walk::new(&self.input, BTreeMap::new());
        Ok(Box::new(Rows { walk, message, wanted, choice: choice.clone() }))
    }
}

#[derive(Debug)]
struct Rows {
    walk: Walk,
    message: Message,
    wanted: (u8, Option<u8>),
    choice: Choice,
}

impl Reader for Rows {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        while block.rows < BLOCK_ROWS {
            let Some((kind, instance, record)) = self.walk.next()? else { break };
            if (kind, instance) == self.wanted {
                records::push(&self.message.fields, &self.choice, record, block);
            }
        }
        Ok(block.rows > 0)
    }

    fn bytes_read(&self) -> u64 {
        self.walk.feed.place()
    }

    fn dropped(&self) -> Vec<Dropped> {
        let cut = self.walk.cut == Some(self.wanted);
        cut.then_some(Dropped { reason: Reason::CutShort, rows: 1, first_row: 0 }).into_iter().collect()
    }

    fn findings(&self) -> Vec<Finding> {
        self.walk.strays.finding().into_iter().collect()
    }
}
