//! Arrow files, which are Feather version 2: columns of numbers, batch by batch, plain or
//! compressed by LZ4 or Zstandard. Format: arrow.apache.org/docs/format/Columnar.html, *IPC File
//! Format*.

mod flat;

use crate::budget::{Budget, LARGEST_BYTES, Spent};
use crate::clock::stamp::Stamp;
use crate::decompress::{Codec, decompress};
use crate::element::{Element, Kind};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::reader::{Block, Choice, Heading, Log, Part, Reader};
use crate::roles;
use flat::{Table, i64_of};

const DAMAGED: &str = "the file is cut short or damaged: copy it again, or write it again";
/// No metadata are longer, bytes.
const LONGEST_METADATA: u64 = 64 << 20;
/// Rows read at once; a multiple of eight, as validity is kept in bits.
const BLOCK: usize = 16_384;
/// Types within types are followed so far.
const DEEPEST: usize = 8;
/// A field of a schema takes about so many bytes, its table and its place in a list.
const FIELD_BYTES: usize = 16;

/// A column: where its buffers stand among those of a batch.
#[derive(Debug, Clone)]
struct Column {
    heading: Heading,
    /// `None`: one bit a value.
    element: Option<Element>,
    node: usize,
    validity: usize,
    data: usize,
    /// Values per row, of which it is one.
    stride: usize,
    lane: usize,
}

#[derive(Debug)]
struct Arrow {
    input: Input,
    parts: Vec<Part>,
    columns: Vec<Column>,
    /// States where each batch begins, its metadata's bytes, and its own.
    batches: Vec<(u64, u64, u64)>,
}

/// Opens a file.
///
/// # Errors
/// A file that was not finished, or is damaged; one without columns of numbers.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let length = input.length();
    let tail = if length < 18 { Vec::new() } else { input.bytes_at(length - 10, 10, "the end of the file")? };
    if tail.get(4..) != Some(b"ARROW1") {
        return Err(
            input.fail(format!("expected ARROW1 in the last six of its {length} bytes, found something else"), DAMAGED)
        );
    }
    let size = u64::from(u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]));
    let at = (length - 10).checked_sub(size).filter(|_| size <= LONGEST_METADATA);
    let at = at.ok_or_else(|| input.truncated("the file's metadata", 0, size))?;
    let footer = input.bytes_at(at, size, "the file's metadata")?;
    let damaged = || input.fail(format!("expected the file's metadata at byte {at}, found damaged data"), DAMAGED);
    let root = Table::root(&footer).ok_or_else(damaged)?;
    let schema = root.table(1).ok_or_else(damaged)?;
    if schema.i16(0) != 0 {
        return Err(input.fail(
            "its numbers begin with the highest byte",
            "write the file again on a little-endian \
                                                                          machine",
        ));
    }
    let mut layout = Layout::new(Budget::of(length));
    let refused = |words: String| input.fail(words, "leave that column out, or write Parquet or CSV");
    for field in layout.children(&schema, 1).map_err(refused)? {
        layout.field(&field, 0).map_err(refused)?;
    }
    let batches = root.structures(3, 24).ok_or_else(damaged)?;
    let batches =
        batches.map(|b| (i64_of(b, 0) as u64, i64_of(b, 8) as u64 & 0xffff_ffff, i64_of(b, 16) as u64)).collect();
    let columns = layout.columns;
    if columns.is_empty() {
        return Err(input.fail("the Arrow table has no column of numbers", "write readings as columns of numbers"));
    }
    let names: Vec<String> = columns.iter().map(|c| c.heading.name.clone()).collect();
    let roles = roles::of(&names);
    let part = Part {
        columns: columns.iter().map(|c| c.heading.clone()).collect(),
        is_imu: roles.gyro.is_some() && roles.accelerometer.is_some(),
        ..Part::default()
    };
    Ok(Box::new(Arrow { input: input.clone(), parts: vec![part], columns, batches }))
}

/// Counts nodes and buffers as the fields of a schema take them.
#[derive(Debug)]
struct Layout {
    columns: Vec<Column>,
    has_clock: bool,
    nodes: usize,
    buffers: usize,
    budget: Budget,
}

impl Layout {
    fn new(budget: Budget) -> Self {
        Self { columns: Vec::new(), has_clock: false, nodes: 0, buffers: 0, budget }
    }

    /// Fields in a list. Several may be the same one: each is charged where it is met.
    fn children<'a>(&mut self, field: &Table<'a>, index: usize) -> Result<Vec<Table<'a>>, String> {
        self.budget.visit(field.length(index).saturating_mul(FIELD_BYTES)).map_err(Spent::words)?;
        Ok(field.tables(index))
    }

    fn field(&mut self, field: &Table<'_>, depth: usize) -> Result<(), String> {
        let name = field.text(0).unwrap_or_default();
        self.budget.visit(name.len()).map_err(Spent::words)?;
        let kind = field.u8(2, 0);
        let (node, first) = (self.nodes, self.buffers);
        self.nodes += 1;
        if depth > DEEPEST {
            return Err(format!("the column `{name}` is nested too deeply"));
        }
        if field.table(4).is_some() {
            // Its numbers point into a dictionary.
            self.buffers += 2;
            return Ok(());
        }
        if let Some((element, unit)) = number(field) {
            self.buffers += 2;
            if depth == 0 {
                let heading = match unit {
                    Some(unit) if !self.has_clock => Heading::clock(&name, unit),
                    _ => Heading::named(name),
                };
                self.has_clock |= heading.clock;
                self.columns.push(Column {
                    heading,
                    element,
                    node,
                    validity: first,
                    data: first + 1,
                    stride: 1,
                    lane: 0,
                });
            }
            return Ok(());
        }
        match kind {
            // Nothing; bytes and text; fixed bytes and decimals.
            1 => {}
            4 | 5 | 19 | 20 => self.buffers += 3,
            7 | 8 | 9 | 11 | 15 => self.buffers += 2,
            // Lists and maps; structures.
            12 | 17 | 21 | 13 => {
                self.buffers += if kind == 13 { 1 } else { 2 };
                for child in self.children(field, 5)? {
                    self.field(&child, depth + 1)?;
                }
            }
            // Lists of one length, which are the columns of an array.
            16 => {
                self.buffers += 1;
                let stride = field.table(3).map_or(0, |t| t.i32(0)).clamp(0, 64) as usize;
                for child in self.children(field, 5)? {
                    let data = self.buffers + 1;
                    let element = number(&child).filter(|_| depth == 0 && child.table(4).is_none());
                    self.field(&child, depth + 1)?;
                    if let Some((Some(element), _)) = element {
                        self.budget.visit(stride * (FIELD_BYTES + name.len())).map_err(Spent::words)?;
                        self.columns.extend((0..stride).map(|lane| Column {
                            heading: Heading::named(format!("{name}.{}", lane + 1)),
                            element: Some(element),
                            node,
                            validity: first,
                            data,
                            stride,
                            lane,
                        }));
                    }
                }
            }
            _ => return Err(format!("the column `{name}` is of type {kind}, which is not read")),
        }
        Ok(())
    }
}

/// Returns how a number is stored, and the unit of a date.
fn number(field: &Table<'_>) -> Option<(Option<Element>, Option<&'static str>)> {
    let kind = field.table(3);
    let of = |kind, bytes| Some((Some(Element::little(kind, bytes)), None));
    match (field.u8(2, 0), kind) {
        (2, Some(kind)) => {
            let sign = if kind.u8(1, 0) != 0 { Kind::Signed } else { Kind::Unsigned };
            of(sign, usize::try_from(kind.i32(0) / 8).ok().filter(|b| [1, 2, 4, 8].contains(b))?)
        }
        (3, kind) => of(Kind::Float, [2, 4, 8].get(kind.map_or(0, |k| k.i16(0)) as usize).copied()?),
        (6, _) => Some((None, None)),
        (10, Some(kind)) => {
            let unit = ["s", "ms", "us", "ns"].get(kind.i16(0) as usize).copied()?;
            Some((Some(Element::little(Kind::Signed, 8)), Some(unit)))
        }
        (18, _) => of(Kind::Signed, 8),
        _ => None,
    }
}

impl Log for Arrow {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, _: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let wanted = choice.places.iter().enumerate().map(|(target, place)| (Some(target), *place));
        let all = choice.time.map(|place| (None, place)).into_iter().chain(wanted);
        let columns = all.map(|(target, place)| (target, self.columns[place].clone())).collect();
        let mut batches = self.batches;
        batches.reverse();
        let budget = Budget::of(self.input.length());
        Ok(Box::new(Rows { input: self.input, columns, batches, batch: Batch::default(), budget, bytes_read: 0 }))
    }
}

/// A buffer of a batch: in the file, or decompressed.
#[derive(Debug)]
enum Buffer {
    InFile { at: u64, length: u64 },
    Held(Vec<u8>),
}

impl Buffer {
    fn bytes(&self, input: &Input, from: usize, count: usize) -> Result<Vec<u8>> {
        let short = |length: u64| {
            input.fail(format!("expected {} bytes in a column, found {length}", from.saturating_add(count)), DAMAGED)
        };
        match self {
            Self::InFile { at, length } if (from + count) as u64 <= *length => {
                input.bytes_at(at + from as u64, count as u64, "a column")
            }
            Self::InFile { length, .. } => Err(short(*length)),
            Self::Held(bytes) => {
                bytes.get(from..from + count).map(<[u8]>::to_vec).ok_or_else(|| short(bytes.len() as u64))
            }
        }
    }
}

/// States where a buffer is stored, and its bytes when it is decompressed.
struct Stored {
    at: u64,
    length: u64,
    size: Option<u64>,
}

/// Rows of one batch: per column its numbers, and which of them are there.
#[derive(Debug, Default)]
struct Batch {
    rows: usize,
    given: usize,
    buffers: Vec<(Buffer, Option<Buffer>)>,
}

#[derive(Debug)]
struct Rows {
    input: Input,
    columns: Vec<(Option<usize>, Column)>,
    /// Those that follow, the last first.
    batches: Vec<(u64, u64, u64)>,
    batch: Batch,
    budget: Budget,
    bytes_read: u64,
}

impl Rows {
    /// Reads the description of a batch, and what of it is compressed. The batch before is gone by
    /// then.
    fn load(&mut self, (at, metadata, body): (u64, u64, u64)) -> Result<()> {
        let fail = |words: &str| -> Error { self.input.fail(format!("the batch at byte {at}: {words}"), DAMAGED) };
        if !(8..=LONGEST_METADATA).contains(&metadata) {
            return Err(fail("expected its metadata, found none"));
        }
        let bytes = self.input.bytes_at(at, metadata, "a batch")?;
        let begin = if bytes.starts_with(&[0xff; 4]) { 8 } else { 4 };
        let header = || {
            let message = Table::root(bytes.get(begin..)?)?;
            (message.u8(1, 0) == 3).then(|| message.table(2)).flatten()
        };
        let header = header().ok_or_else(|| fail("expected the description of its rows, found damaged data"))?;
        let codec = match header.table(3).map(|c| c.u8(0, 0)) {
            None => Codec::None,
            Some(0) => Codec::Lz4Frame,
            Some(1) => Codec::Zstandard,
            Some(_) => return Err(fail("expected LZ4 or Zstandard, found another compression")),
        };
        let body_at = at + metadata;
        let rows = usize::try_from(header.i64(0)).map_err(|_| fail("expected a number of rows, found none"))?;
        self.budget.rows(rows as u64, self.columns.len()).map_err(|spent| fail(&spent.words()))?;
        let nodes: Vec<&[u8]> = header.structures(1, 16).map(Iterator::collect).unwrap_or_default();
        let places: Vec<&[u8]> = header.structures(2, 16).map(Iterator::collect).unwrap_or_default();
        let place = |index: usize| -> Result<Stored> {
            let place = places.get(index).ok_or_else(|| fail("expected a buffer for each column"))?;
            let (offset, length) = (i64_of(place, 0) as u64, i64_of(place, 8) as u64);
            if offset.checked_add(length).is_none_or(|end| end > body) {
                return Err(fail("expected its columns within it, found one beyond"));
            }
            let at = body_at + offset;
            if codec == Codec::None || length == 0 {
                return Ok(Stored { at, length, size: None });
            }
            if !(8..=LARGEST_BYTES).contains(&length) {
                return Err(fail("expected the size of a column, found none"));
            }
            let size = i64_of(&self.input.bytes_at(at, 8, "a column")?, 0);
            Ok(Stored { at: at + 8, length: length - 8, size: (size != -1).then_some(size as u64) })
        };
        let mut stored = Vec::new();
        for (_, column) in &self.columns {
            let missing = nodes.get(column.node).map_or(0, |n| i64_of(n, 8));
            let validity = if missing == 0 { None } else { Some(place(column.validity)?) };
            stored.push((place(column.data)?, validity));
        }
        // All columns of a batch are held at a time.
        let sizes = stored.iter().flat_map(|(data, validity)| [data.size, validity.as_ref().and_then(|v| v.size)]);
        let held = sizes.flatten().fold(0, u64::saturating_add);
        self.budget.held(held).map_err(|spent| fail(&spent.words()))?;
        let budget = &mut self.budget;
        let mut buffer = |stored: Stored| -> Result<Buffer> {
            let Stored { at, length, size } = stored;
            let Some(size) = size else { return Ok(Buffer::InFile { at, length }) };
            let data = self.input.bytes_at(at, length, "a column")?;
            decompress(codec, &data, size, budget).map(Buffer::Held).map_err(|w| fail(&w))
        };
        let buffers = stored
            .into_iter()
            .map(|(data, validity)| Ok((buffer(data)?, validity.map(&mut buffer).transpose()?)))
            .collect::<Result<Vec<_>>>()?;
        self.batch = Batch { rows, given: 0, buffers };
        self.bytes_read += metadata + body;
        Ok(())
    }
}

impl Reader for Rows {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        while self.batch.given >= self.batch.rows {
            let Some(batch) = self.batches.pop() else { return Ok(false) };
            // Two batches are never held at a time.
            self.batch.buffers.clear();
            self.load(batch)?;
        }
        let from = self.batch.given;
        let count = (self.batch.rows - from).min(BLOCK);
        for ((target, column), (data, validity)) in self.columns.iter().zip(&self.batch.buffers) {
            let bits = |buffer: &Buffer| buffer.bytes(&self.input, from / 8, count.div_ceil(8));
            let is_set = |bits: &[u8], i: usize| bits[i / 8] >> (i % 8) & 1 == 1;
            let missing = validity.as_ref().map(bits).transpose()?;
            let is_there = |i: usize| missing.as_ref().is_none_or(|m| is_set(m, i));
            let Some(element) = column.element else {
                let bits = bits(data)?;
                let value = |i| is_there(i).then(|| is_set(&bits, i));
                match target {
                    Some(target) => {
                        let number = |i| value(i).map_or(f64::NAN, |set| f64::from(u8::from(set)));
                        block.columns[*target].extend((0..count).map(number));
                    }
                    None => {
                        let stamp = |i| value(i).map_or(Stamp::MISSING, |set| Stamp::of_integer(i64::from(set)));
                        block.stamps.extend((0..count).map(stamp));
                    }
                }
                continue;
            };
            let width = element.bytes * column.stride;
            let place = from.checked_mul(width).filter(|p| p.checked_add(count * width).is_some());
            let place = place.ok_or_else(|| self.input.fail("expected fewer rows", DAMAGED))?;
            let bytes = data.bytes(&self.input, place, count * width)?;
            let lane = column.lane * element.bytes..(column.lane + 1) * element.bytes;
            let numbers = bytes.chunks_exact(width).map(|row| &row[lane.clone()]).enumerate();
            match target {
                Some(target) => {
                    let out = &mut block.columns[*target];
                    if column.stride == 1 && missing.is_none() {
                        element.decode(&bytes, out);
                    } else {
                        out.extend(numbers.clone().map(|(i, n)| if is_there(i) { element.value(n) } else { f64::NAN }));
                    }
                    block.rounded[*target] = numbers.clone().position(|(i, n)| is_there(i) && element.is_rounded(n));
                }
                None => {
                    let stamp = |(i, n): (usize, &[u8])| if is_there(i) { element.stamp(n) } else { Stamp::MISSING };
                    block.stamps.extend(numbers.map(stamp));
                }
            }
        }
        self.batch.given += count;
        block.rows = count;
        Ok(true)
    }

    fn bytes_read(&self) -> u64 {
        self.bytes_read.min(self.input.length())
    }
}
