//! Arrays of numbers within a file, row by row whatever their order, each through a reader of its
//! own: memory stays constant.

use std::collections::HashMap;
use std::io::Read;

use super::budget::{Budget, ENTRY_BYTES, Spent};
use super::element::Element;
use super::input::Input;
use super::reader::{Block, Choice, Heading, Log, Part, Reader};
use super::roles;
#[cfg(feature = "npy")]
use crate::error::Error;
use crate::error::Result;

/// Bytes of an array that are read at once.
const PIECE_BYTES: usize = 1 << 18;
/// A row of more bytes than this is none of a recording.
const LONGEST_ROW_BYTES: u64 = 1 << 24;
/// A table of more columns is none of a recording.
const MOST_COLUMNS: u64 = 100_000;
/// States what a column is charged next to its name: as many as there may be in one array have
/// room.
const COLUMN_BYTES: usize = ENTRY_BYTES / 4;
/// Of a table that has this many times as many columns as rows, the columns are the samples.
const LYING: u64 = 64;

/// States how bytes of a file are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packing {
    /// Stored without compression.
    None,
    /// DEFLATE, RFC 1951.
    #[cfg(feature = "gzip")]
    Deflate,
    /// The same with the header of RFC 1950.
    #[cfg(feature = "gzip")]
    Zlib,
}

/// States where the numbers of an array begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// First byte in the file.
    pub at: u64,
    /// Bytes in the file.
    pub stored: u64,
    /// States how they are packed.
    pub packing: Packing,
    /// Bytes to pass over when they are unpacked.
    pub skip: u64,
    /// CRC-32 of all bytes when they are unpacked, where the file states it.
    pub crc32: Option<u32>,
}

impl Place {
    /// A reader of the numbers from `offset` bytes on.
    ///
    /// # Errors
    /// What is packed ends before.
    pub fn open(&self, input: &Input, offset: u64) -> std::io::Result<Box<dyn Read + Send>> {
        let skip = self.skip.saturating_add(offset);
        match self.packing {
            Packing::None => {
                Ok(Box::new(input.at(self.at.saturating_add(skip)).take(self.stored.saturating_sub(skip))))
            }
            #[cfg(feature = "gzip")]
            Packing::Deflate => {
                passed(Box::new(flate2::read::DeflateDecoder::new(input.at(self.at).take(self.stored))), skip)
            }
            #[cfg(feature = "gzip")]
            Packing::Zlib => {
                passed(Box::new(flate2::read::ZlibDecoder::new(input.at(self.at).take(self.stored))), skip)
            }
        }
    }
}

#[cfg(feature = "npy")]
impl Place {
    /// Reads the whole place and compares its checksum with the one that the file states.
    ///
    /// # Errors
    /// They differ, it cannot be unpacked, or not within the budget.
    pub(crate) fn check(&self, input: &Input, budget: &mut Budget) -> Result<()> {
        let Some(stated) = self.crc32 else { return Ok(()) };
        let damaged = |words: String| input.fail(words, "the file is damaged: copy it again, or write it again");
        let mut reader = Self { skip: 0, ..*self }.open(input, 0).map_err(|e| Error::io("read", &input.path, &e))?;
        let (mut checksum, mut buffer) = (crc32fast::Hasher::new(), vec![0; PIECE_BYTES]);
        loop {
            match reader.read(&mut buffer) {
                Ok(0) => break,
                Ok(count) => {
                    budget.unpacked(count as u64).map_err(|spent| spent.of(input))?;
                    checksum.update(&buffer[..count]);
                }
                Err(e) => return Err(damaged(format!("the array at byte {} cannot be unpacked: {e}", self.at))),
            }
        }
        match checksum.finalize() {
            found if found == stated => Ok(()),
            found => Err(damaged(format!(
                "the array at byte {} has the checksum {found:08x}, where {stated:08x} was expected (CRC-32)",
                self.at
            ))),
        }
    }
}

/// A reader that has passed over this many bytes.
#[cfg(feature = "gzip")]
fn passed(mut reader: Box<dyn Read + Send>, skip: u64) -> std::io::Result<Box<dyn Read + Send>> {
    let passed = std::io::copy(&mut reader.by_ref().take(skip), &mut std::io::sink())?;
    if passed < skip { Err(std::io::ErrorKind::UnexpectedEof.into()) } else { Ok(reader) }
}

/// A column of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    pub name: String,
    pub element: Element,
    /// Bytes from the beginning of the row to its number; of an array in columns, from that of the
    /// array to the column.
    pub offset: u64,
}

/// An array of numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Array {
    pub fields: Vec<Field>,
    pub rows: u64,
    /// Bytes from row to row, where rows follow one another; absent where columns do.
    pub row_bytes: Option<u64>,
    /// States where its numbers lie.
    pub place: Place,
    /// It is given where it is asked for by name alone.
    pub aside: bool,
}

/// Dimensions of a plain array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Number of rows.
    pub rows: u64,
    /// Number of columns.
    pub columns: u64,
    /// Columns follow one another, not rows.
    pub in_columns: bool,
}

impl Array {
    /// An array of one kind of number: its columns are `name`, or `name.1`, `name.2`, …, or 1, 2, …
    /// without a name. One that lies on its side is turned. `None` where it is no table: without
    /// rows or columns, or with rows of more than 16 MiB.
    ///
    /// # Errors
    /// More columns than the budget has visits for.
    pub(crate) fn plain(
        name: &str,
        element: Element,
        shape: Shape,
        place: Place,
        budget: &mut Budget,
    ) -> Result<Option<Self>, Spent> {
        let Shape { mut rows, mut columns, mut in_columns } = shape;
        if rows > 0 && columns / rows >= LYING || (rows == 1 && columns > 1) {
            (rows, columns, in_columns) = (columns, rows, !in_columns);
        }
        let bytes = element.bytes as u64;
        let row_bytes = columns.saturating_mul(bytes);
        let all = row_bytes.saturating_mul(rows);
        if row_bytes > LONGEST_ROW_BYTES || all == 0 || all > i64::MAX as u64 || columns > MOST_COLUMNS {
            return Ok(None);
        }
        budget.visit((columns as usize).saturating_mul(COLUMN_BYTES + name.len()))?;
        let step = if in_columns { rows * bytes } else { bytes };
        let field = |c: u64| Field {
            name: match (name, columns) {
                ("", _) => (c + 1).to_string(),
                (name, 1) => name.to_owned(),
                (name, _) => format!("{name}.{}", c + 1),
            },
            element,
            offset: c * step,
        };
        let fields = (0..columns).map(field).collect();
        let row_bytes = (!in_columns || columns == 1).then_some(row_bytes);
        Ok(Some(Self { fields, rows, row_bytes, place, aside: false }))
    }

    /// All bytes of its numbers.
    pub(crate) fn bytes(&self) -> u64 {
        let columns = || self.fields.iter().map(|f| f.element.bytes as u64 * self.rows).sum();
        self.row_bytes.map_or_else(columns, |b| b.saturating_mul(self.rows))
    }
}

/// The arrays of a file; those of one length are one table.
#[derive(Debug)]
pub(crate) struct Arrays {
    input: Input,
    arrays: Vec<Array>,
    parts: Vec<Part>,
    /// Per part, the columns by their array and place in it.
    columns: Vec<Vec<(usize, usize)>>,
}

impl Arrays {
    /// Those of a file.
    pub(crate) fn new(input: &Input, arrays: Vec<Array>) -> Self {
        let mut tables: HashMap<u64, usize> = HashMap::new();
        let (mut parts, mut columns): (_, Vec<Vec<(usize, usize)>>) = (Vec::new(), Vec::new());
        for (index, array) in arrays.iter().enumerate() {
            let table = *tables.entry(array.rows).or_insert(columns.len());
            if table == columns.len() {
                columns.push(Vec::new());
            }
            columns[table].extend((0..array.fields.len()).map(|column| (index, column)));
        }
        for places in &columns {
            let length = places.first().map_or(0, |(index, _)| arrays[*index].rows);
            let names: Vec<String> = places.iter().map(|(i, c)| arrays[*i].fields[*c].name.clone()).collect();
            let roles = roles::of(&names);
            let heading =
                |((i, _), name): (&(usize, usize), String)| Heading { aside: arrays[*i].aside, ..Heading::named(name) };
            parts.push(Part {
                name: names
                    .first()
                    .filter(|n| *n != "1")
                    .and_then(|n| n.split('.').next())
                    .unwrap_or_default()
                    .to_owned(),
                kind: format!("{length} rows"),
                rows: Some(length),
                columns: places.iter().zip(names).map(heading).collect(),
                is_imu: roles.gyro.is_some() && roles.accelerometer.is_some(),
            });
        }
        // Where no name tells, the longest table is the recording; single numbers and the like are
        // no rows.
        if !parts.iter().any(|p| p.is_imu) {
            let longest = parts.iter().filter_map(|p| p.rows).max();
            let mut longest = parts.iter_mut().filter(|p| p.rows == longest && p.rows > Some(1));
            if let Some(part) = longest.next() {
                part.is_imu = true;
            }
        }
        Self { input: input.clone(), arrays, parts, columns }
    }
}

impl Log for Arrays {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let mut streams: Vec<Stream> = Vec::new();
        let mut rows = 0;
        let mut budget = Budget::of(self.input.length());
        let wanted = choice.places.iter().enumerate().map(|(target, place)| (Some(target), *place));
        for (target, place) in choice.time.map(|place| (None, place)).into_iter().chain(wanted) {
            let (index, column) = self.columns[part][place];
            let array = &self.arrays[index];
            let field = &array.fields[column];
            #[cfg(feature = "npy")]
            if streams.iter().all(|s| s.array != index) {
                array.place.check(&self.input, &mut budget)?;
            }
            rows = array.rows;
            let pick = |offset| Pick { element: field.element, offset, target };
            match array.row_bytes {
                Some(row_bytes) => match streams.iter_mut().find(|s| s.array == index) {
                    Some(stream) => stream.picks.push(pick(field.offset as usize)),
                    None => {
                        let (row_bytes, picks) = (row_bytes as usize, vec![pick(field.offset as usize)]);
                        streams.push(Stream::new(&self.input, array, index, 0, row_bytes, picks, &mut budget)?);
                    }
                },
                None => {
                    let (bytes, picks) = (field.element.bytes, vec![pick(0)]);
                    streams.push(Stream::new(&self.input, array, index, field.offset, bytes, picks, &mut budget)?);
                }
            }
        }
        // A row of all arrays stands in memory, whatever its length.
        let row_bytes = streams.iter().fold(0, |sum: usize, s| sum.saturating_add(s.row_bytes)).max(1);
        budget.held(row_bytes as u64).map_err(|spent| spent.of(&self.input))?;
        let piece = (PIECE_BYTES / row_bytes).max(1);
        Ok(Box::new(Rows { input: self.input, streams, rows, given: 0, piece, bytes_read: 0 }))
    }
}

/// A column of a stream and where its numbers go: `None` are time stamps.
#[derive(Debug)]
struct Pick {
    element: Element,
    offset: usize,
    target: Option<usize>,
}

struct Stream {
    array: usize,
    reader: Box<dyn Read + Send>,
    row_bytes: usize,
    picks: Vec<Pick>,
    buffer: Vec<u8>,
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Stream of array {}", self.array)
    }
}

impl Stream {
    fn new(
        input: &Input,
        array: &Array,
        index: usize,
        offset: u64,
        row_bytes: usize,
        picks: Vec<Pick>,
        budget: &mut Budget,
    ) -> Result<Self> {
        // What is packed is unpacked from its beginning for each stream.
        let passed = if array.place.packing == Packing::None { 0 } else { array.place.skip.saturating_add(offset) };
        let given = array.rows.saturating_mul(row_bytes as u64);
        budget.unpacked(passed.saturating_add(given)).map_err(|spent| spent.of(input))?;
        let reader = array.place.open(input, offset).map_err(|e| damaged(input, &e))?;
        Ok(Self { array: index, reader, row_bytes, picks, buffer: Vec::new() })
    }
}

fn damaged(input: &Input, error: &std::io::Error) -> crate::error::Error {
    input.fail(
        format!("expected more numbers of an array, but its data end or are damaged: {error}"),
        "it is cut short or damaged: copy it again, or write it again",
    )
}

#[derive(Debug)]
struct Rows {
    input: Input,
    streams: Vec<Stream>,
    rows: u64,
    given: u64,
    /// Rows read at once.
    piece: usize,
    bytes_read: u64,
}

impl Reader for Rows {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        let count = (self.rows - self.given).min(self.piece as u64) as usize;
        if count == 0 {
            return Ok(false);
        }
        for stream in &mut self.streams {
            stream.buffer.resize(count * stream.row_bytes, 0);
            stream.reader.read_exact(&mut stream.buffer).map_err(|e| damaged(&self.input, &e))?;
            self.bytes_read += stream.buffer.len() as u64;
            for pick in &stream.picks {
                let at = pick.offset..pick.offset + pick.element.bytes;
                let numbers = stream.buffer.chunks_exact(stream.row_bytes).map(|row| &row[at.clone()]);
                let Some(target) = pick.target else {
                    block.stamps.extend(numbers.map(|n| pick.element.stamp(n)));
                    continue;
                };
                if pick.element.bytes == 8 {
                    block.rounded[target] = numbers.clone().position(|n| pick.element.is_rounded(n));
                }
                if stream.row_bytes == pick.element.bytes {
                    pick.element.decode(&stream.buffer, &mut block.columns[target]);
                } else {
                    block.columns[target].extend(numbers.map(|n| pick.element.value(n)));
                }
            }
        }
        self.given += count as u64;
        block.rows = count;
        Ok(true)
    }

    fn bytes_read(&self) -> u64 {
        self.bytes_read
    }
}
