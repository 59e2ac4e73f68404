//! ROS 2 bags in SQLite, `.db3`, read by an own walk through the tables. Format:
//! sqlite.org/fileformat2.html.

mod record;

use crate::budget::{Budget, ENTRY_BYTES, LARGEST_BYTES};
use crate::bytes::Bytes;
use crate::decompress::{Codec, decompress};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::messages::{Encoding, MessageRows, Messages, part};
use crate::reader::{Choice, Log, Part, Reader};
use record::{Record, varint};

const HEADER_BYTES: u64 = 100;
/// Deeper trees there are none: 2^32 pages at two a page.
const DEEPEST: usize = 40;
const DAMAGED: &str = "the file is cut short or damaged: copy it again, or mend it with `sqlite3 FILE .recover`";

#[derive(Debug)]
struct Bag {
    database: Database,
    parts: Vec<Part>,
    topics: Vec<(i64, Encoding)>,
    messages: Table,
}

/// Opens a bag.
///
/// # Errors
/// A database that is damaged, not closed, or no ROS 2 bag.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let database = Database::open(input)?;
    let mut budget = Budget::of(input.length());
    let topics = database.table("topics", &mut budget)?;
    let messages = database.table("messages", &mut budget)?;
    let [id, name, kind, format] = ["id", "name", "type", "serialization_format"].map(|c| topics.column(c));
    let mut bag = Bag { database, parts: Vec::new(), topics: Vec::new(), messages };
    let mut tree = Tree::new(bag.database.clone(), topics.root);
    while let Some((row, payload)) = tree.next()? {
        let record = Record::new(&payload, row);
        let number = id.and_then(|c| record.integer(c)).unwrap_or(row);
        let text = |column: Option<usize>| column.and_then(|c| record.text(c)).unwrap_or_default();
        let readable = matches!(text(format).as_str(), "cdr" | "");
        budget.visit(ENTRY_BYTES + payload.len()).map_err(|spent| spent.of(input))?;
        bag.parts.push(part(text(name), text(kind), None, readable));
        bag.topics.push((number, Encoding::Cdr));
    }
    Ok(Box::new(bag))
}

impl Log for Bag {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let (topic, encoding) = self.topics[part];
        let input = self.database.input.clone();
        let place = |name: &str| {
            self.messages.column(name).ok_or_else(|| {
                input.fail(
                    format!("expected a column `{name}` in its table of messages, found none"),
                    "is this a ROS 2 bag?",
                )
            })
        };
        let (topic_at, data_at) = (place("topic_id")?, place("data")?);
        let tree = Tree::new(self.database, self.messages.root);
        let budget = Budget::of(input.length());
        let blobs = Blobs { tree, topic, topic_at, data_at, budget };
        Ok(Box::new(MessageRows {
            input,
            messages: Box::new(blobs),
            kind: self.parts[part].kind.clone(),
            encoding,
            choice: choice.clone(),
            stated: None,
            count: 0,
        }))
    }
}

/// The data of the messages of one topic, in the order they were written.
#[derive(Debug)]
struct Blobs {
    tree: Tree,
    topic: i64,
    topic_at: usize,
    data_at: usize,
    budget: Budget,
}

impl Messages for Blobs {
    fn next(&mut self, into: &mut Vec<u8>) -> Result<bool> {
        while let Some((row, payload)) = self.tree.next()? {
            let record = Record::new(&payload, row);
            if record.integer(self.topic_at) != Some(self.topic) {
                continue;
            }
            let data = record.bytes(self.data_at).unwrap_or_default();
            match data {
                // Messages may be compressed one by one; their size is not stated apart.
                [0x28, 0xb5, 0x2f, 0xfd, ..] => {
                    let unpacked = unpacked(data, &mut self.budget);
                    let unpacked = unpacked.map_err(|words| self.tree.database.input.fail(words, DAMAGED))?;
                    into.extend_from_slice(&unpacked);
                }
                _ => into.extend_from_slice(data),
            }
            return Ok(true);
        }
        Ok(false)
    }

    fn bytes_read(&self) -> u64 {
        self.tree.bytes
    }
}

/// A message of Zstandard, whose frame states its size (RFC 8878, 3.1.1.1).
fn unpacked(data: &[u8], budget: &mut Budget) -> Result<Vec<u8>, String> {
    let mut bytes = Bytes::new(data);
    let size = || -> Option<u64> {
        bytes.take(4)?;
        let descriptor = bytes.u8()?;
        if descriptor & 0x20 == 0 {
            bytes.u8()?;
        }
        bytes.take([0, 1, 2, 4][usize::from(descriptor & 3)])?;
        match descriptor >> 6 {
            0 => bytes.u8().filter(|_| descriptor & 0x20 != 0).map(u64::from),
            1 => bytes.u16().map(|n| u64::from(n) + 256),
            2 => bytes.u32().map(u64::from),
            _ => bytes.u64(),
        }
    };
    let mut size = size;
    let size = size().ok_or("a compressed message that does not state its size")?;
    decompress(Codec::Zstandard, data, size, budget)
}

/// The pages of a database.
#[derive(Debug, Clone)]
struct Database {
    input: Input,
    page_bytes: u64,
    /// Bytes of a page that hold data.
    usable: usize,
}

/// A table: its first page and its columns.
#[derive(Debug, Clone)]
struct Table {
    root: u32,
    columns: Vec<String>,
}

impl Table {
    fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }
}

impl Database {
    fn open(input: &Input) -> Result<Self> {
        let head = input.bytes_at(0, HEADER_BYTES, "the header of an SQLite database")?;
        let page_bytes = match u16::from_be_bytes([head[16], head[17]]) {
            1 => 65_536,
            bytes => u64::from(bytes),
        };
        if !page_bytes.is_power_of_two() || page_bytes < 512 {
            return Err(input.fail(format!("expected pages of 512 to 65536 bytes, found {page_bytes}"), DAMAGED));
        }
        let beside =
            input.path.with_file_name(format!("{}-wal", input.path.file_name().unwrap_or_default().to_string_lossy()));
        if head[19] == 2 && std::fs::metadata(&beside).is_ok_and(|about| about.len() > 0) {
            return Err(input.fail(
                "part of its messages stand in the write-ahead log next to it",
                format!("finish it first: sqlite3 {} 'PRAGMA wal_checkpoint(TRUNCATE)'", input.path.display()),
            ));
        }
        Ok(Self { input: input.clone(), page_bytes, usable: page_bytes as usize - usize::from(head[20]) })
    }

    /// A table by its name, as the schema in the first page describes it.
    fn table(&self, name: &str, budget: &mut Budget) -> Result<Table> {
        let mut tree = Tree::new(self.clone(), 1);
        let mut known = Vec::new();
        while let Some((row, payload)) = tree.next()? {
            budget.visit(ENTRY_BYTES + payload.len()).map_err(|spent| spent.of(&self.input))?;
            let record = Record::new(&payload, row);
            if record.text(0).as_deref() != Some("table") {
                continue;
            }
            let found = record.text(1).unwrap_or_default();
            if found == name {
                let root = record.integer(3).and_then(|n| u32::try_from(n).ok()).unwrap_or_default();
                return Ok(Table { root, columns: columns(&record.text(4).unwrap_or_default()) });
            }
            if known.len() < 40 {
                known.push(found);
            }
        }
        Err(self.input.fail(
            format!("expected a table `{name}`, as ROS 2 bags have it; the database has {}", known.join(", ")),
            "is this a ROS 2 bag? Export the readings as CSV otherwise",
        ))
    }

    fn page(&self, number: u32) -> Result<Vec<u8>> {
        let at = u64::from(number).checked_sub(1).map(|n| n * self.page_bytes);
        let at = at.ok_or_else(|| self.input.fail("expected the number of a page, found 0", DAMAGED))?;
        self.input.bytes_at(at, self.page_bytes, &format!("page {number} of the database"))
    }
}

impl Database {
    /// The record of a row, of which what does not fit stands on further pages.
    fn payload(&self, size: u64, rest: &[u8]) -> Result<Option<Vec<u8>>> {
        if size > LARGEST_BYTES || size > self.input.length() {
            return Ok(None);
        }
        let (size, usable) = (size as usize, self.usable);
        let most = usable.saturating_sub(35);
        let local = if size <= most {
            size
        } else {
            let least = (usable.saturating_sub(12) * 32 / 255).saturating_sub(23);
            let local = least + (size - least) % (usable - 4);
            if local <= most { local } else { least }
        };
        let Some(front) = rest.get(..local) else { return Ok(None) };
        let mut out = front.to_vec();
        let mut next = rest.get(local..local + 4).map(|b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]));
        while out.len() < size {
            let Some(number) = next.filter(|n| *n > 0) else { return Ok(None) };
            let page = self.page(number)?;
            next = Some(u32::from_be_bytes([page[0], page[1], page[2], page[3]]));
            out.extend_from_slice(&page[4..usable.min(4 + size - out.len())]);
        }
        Ok(Some(out))
    }
}

/// Names of the columns in a CREATE TABLE statement.
fn columns(sql: &str) -> Vec<String> {
    let body = sql.split_once('(').map_or("", |(_, rest)| rest).rsplit_once(')').map_or("", |(front, _)| front);
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (i, c) in body.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&body[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(&body[start..]);
    let name = |part: &&str| part.split_whitespace().next().map(|n| n.trim_matches(['"', '`', '[', ']']).to_owned());
    parts.iter().filter_map(name).collect()
}

/// A page on the way down, and its next cell.
#[derive(Debug)]
struct Level {
    page: Vec<u8>,
    /// States where its own header begins.
    begin: usize,
    next: usize,
}

/// All rows of a table in order.
#[derive(Debug)]
struct Tree {
    database: Database,
    levels: Vec<Level>,
    begin: Option<u32>,
    /// Bytes of the pages and of the rows that were met.
    bytes: u64,
    given: u64,
}

impl Tree {
    fn new(database: Database, root: u32) -> Self {
        Self { database, levels: Vec::new(), begin: Some(root), bytes: 0, given: 0 }
    }

    fn damaged(&self, words: &str) -> Error {
        self.database.input.fail(format!("expected {words} in a table of the database, found none"), DAMAGED)
    }

    /// Counts the pages and the rows: what is met again would be met for ever.
    fn pass(&mut self, pages: u64, rows: u64) -> Result<()> {
        (self.bytes, self.given) = (self.bytes.saturating_add(pages), self.given.saturating_add(rows));
        let again = self.bytes.max(self.given) > self.database.input.length();
        if again { Err(self.damaged("a tree without circles")) } else { Ok(()) }
    }

    fn descend(&mut self, page: u32) -> Result<()> {
        if self.levels.len() == DEEPEST {
            return Err(self.damaged("a tree without circles"));
        }
        let begin = if page == 1 { HEADER_BYTES as usize } else { 0 };
        let data = self.database.page(page)?;
        self.pass(self.database.page_bytes, 0)?;
        if !matches!(data[begin], 5 | 13) {
            return Err(self.damaged("a page of a table"));
        }
        self.levels.push(Level { page: data, begin, next: 0 });
        Ok(())
    }

    /// The next row: its number and its record.
    fn next(&mut self) -> Result<Option<(i64, Vec<u8>)>> {
        if let Some(root) = self.begin.take() {
            self.descend(root)?;
        }
        loop {
            let Some(level) = self.levels.last_mut() else { return Ok(None) };
            let (page, begin, next) = (&level.page, level.begin, level.next);
            let two = |at: usize| page.get(at..at + 2).map(|b| usize::from(u16::from_be_bytes([b[0], b[1]])));
            let four = |at: usize| page.get(at..at + 4).map(|b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]));
            let interior = page[begin] == 5;
            let cells = two(begin + 3).unwrap_or_default();
            let pointers = begin + if interior { 12 } else { 8 };
            level.next += 1;
            if interior {
                let child = match next.cmp(&cells) {
                    std::cmp::Ordering::Less => two(pointers + 2 * next).and_then(four),
                    std::cmp::Ordering::Equal => four(begin + 8),
                    std::cmp::Ordering::Greater => {
                        self.levels.pop();
                        continue;
                    }
                };
                match child {
                    Some(child) => self.descend(child)?,
                    None => return Err(self.damaged("a page below")),
                }
                continue;
            }
            if next >= cells {
                self.levels.pop();
                continue;
            }
            let cell = two(pointers + 2 * next).and_then(|at| page.get(at..));
            let head = cell.and_then(|cell| {
                let mut bytes = Bytes::new(cell);
                Some((varint(&mut bytes)?, varint(&mut bytes)? as i64, bytes.rest()))
            });
            let Some((size, row, rest)) = head else { return Err(self.damaged("a row")) };
            let Some(payload) = self.database.payload(size, rest)? else { return Err(self.damaged("a whole row")) };
            self.pass(0, payload.len() as u64)?;
            return Ok(Some((row, payload)));
        }
    }
}
