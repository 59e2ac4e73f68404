//! Columns of a Parquet table page by page, side by side.

use super::encoding::{deltas, hybrid, split_streams};
use super::physical::{DAMAGED, Physical};
use super::thrift::{self, Value};
use crate::bytes::Bytes;
use crate::clock::stamp::Stamp;
use crate::decompress::{Codec, LARGEST_BYTES, decompress};
use crate::element::{Element, Kind};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::reader::{Block, Reader};

/// Rows handed on at once.
const BLOCK: usize = 16_384;
/// No header of a page is longer, bytes: it may carry statistics.
const LONGEST_HEADER: u64 = 1 << 20;
/// A usual header of a page.
const USUAL_HEADER: u64 = 512;
/// Day of 1970-01-01 in the count of days that INT96 uses.
const EPOCH_DAY: i64 = 2_440_588;

const PLAIN: i64 = 0;

/// A column of a row group.
#[derive(Debug, Clone)]
pub(super) struct Chunk {
    /// How its pages are compressed; the name of what is not read.
    pub codec: Result<Codec, &'static str>,
    pub at: u64,
    /// Values in it, missing ones included.
    pub values: u64,
}

/// One column on its way.
#[derive(Debug)]
pub(super) struct Column {
    physical: Physical,
    levels: u32,
    /// Where its numbers go; `None` are time stamps.
    target: Option<usize>,
    /// The row groups that follow, the last first.
    chunks: Vec<Chunk>,
    codec: Codec,
    at: u64,
    left: u64,
    dictionary: Vec<u8>,
    /// Values of the page at hand, and how many were given.
    numbers: Vec<f64>,
    stamps: Vec<Stamp>,
    rounded: Option<usize>,
    given: usize,
}

impl Column {
    /// At its first row.
    pub(super) fn new(physical: Physical, levels: u32, target: Option<usize>, mut chunks: Vec<Chunk>) -> Self {
        chunks.reverse();
        Self {
            physical,
            levels,
            target,
            chunks,
            codec: Codec::None,
            at: 0,
            left: 0,
            dictionary: Vec::new(),
            numbers: Vec::new(),
            stamps: Vec::new(),
            rounded: None,
            given: 0,
        }
    }

    fn waiting(&self) -> usize {
        self.numbers.len().max(self.stamps.len()) - self.given
    }

    /// Numbers as they are held once a page is read.
    fn element(&self) -> Element {
        match self.physical {
            Physical::Number(element) => element,
            Physical::Bit => Element::little(Kind::Unsigned, 1),
            Physical::Int96 => Element::little(Kind::Signed, 8),
        }
    }

    /// Reads pages until values wait; none do at the end of the column.
    fn load(&mut self, input: &Input) -> Result<()> {
        while self.waiting() == 0 {
            if self.left == 0 {
                let Some(chunk) = self.chunks.pop() else { return Ok(()) };
                self.codec = chunk.codec.map_err(|name| {
                    input.fail(
                        format!(
                            "its columns are compressed by {name}; expected Zstandard, Snappy, gzip, LZ4 or nothing"
                        ),
                        "write the table again with another compression",
                    )
                })?;
                (self.at, self.left) = (chunk.at, chunk.values);
                self.dictionary.clear();
                continue;
            }
            self.page(input)?;
        }
        Ok(())
    }

    fn page(&mut self, input: &Input) -> Result<()> {
        let page_at = self.at;
        let fail = |words: &str| -> Error { input.fail(format!("the page at byte {page_at}: {words}"), DAMAGED) };
        let mut length = USUAL_HEADER;
        let (header, taken) = loop {
            let bytes = input.bytes_at(page_at, length.min(input.length().saturating_sub(page_at)), "a page")?;
            let mut rest = Bytes::new(&bytes);
            if let Some(header) = thrift::structure(&mut rest) {
                break (PageHeader::of(&header), rest.taken() as u64);
            }
            if length >= LONGEST_HEADER || bytes.len() < length as usize {
                return Err(fail("expected its header, found damaged data"));
            }
            length *= 8;
        };
        let header = header.ok_or_else(|| fail("expected its sizes, found none"))?;
        if header.stored > LARGEST_BYTES || header.size > LARGEST_BYTES {
            return Err(fail("expected at most 256 MiB"));
        }
        let data = input.bytes_at(page_at + taken, header.stored, "a page")?;
        self.at = page_at + taken + header.stored;
        match header.kind {
            // An index is passed over.
            1 => Ok(()),
            2 => {
                let bytes = decompress(self.codec, &data, header.size).map_err(|w| fail(&w))?;
                self.dictionary =
                    self.plain(&bytes, header.values).ok_or_else(|| fail("a dictionary that is cut short"))?;
                Ok(())
            }
            0 | 3 => {
                // A page without values would be met for ever.
                if header.values as u64 > self.left || header.values == 0 && self.left > 0 && header.stored == 0 {
                    return Err(fail("expected no more values than its column has, and one at least"));
                }
                self.left -= header.values as u64;
                let levels_bytes = if header.kind == 3 { header.levels } else { 0 };
                let (levels, packed) =
                    data.split_at_checked(levels_bytes).ok_or_else(|| fail("levels that are longer than it"))?;
                let levels = levels.to_vec();
                let size = header.size.checked_sub(levels_bytes as u64).ok_or_else(|| fail("levels longer than it"))?;
                let codec = if header.is_packed { self.codec } else { Codec::None };
                let body = if codec == Codec::None && size == packed.len() as u64 {
                    if levels_bytes == 0 { data } else { packed.to_vec() }
                } else {
                    decompress(codec, packed, size).map_err(|w| fail(&w))?
                };
                self.values(&header, &levels, body).ok_or_else(|| {
                    fail(&format!(
                        "expected {} values in encoding {}, found damaged data",
                        header.values, header.encoding
                    ))
                })
            }
            _ => Err(fail("expected a page of data, found another kind")),
        }
    }

    /// Values of a page whose levels stand before them, or apart.
    fn values(&mut self, header: &PageHeader, levels: &[u8], body: Vec<u8>) -> Option<()> {
        let (mut begin, count) = (0, header.values);
        let mut present = None;
        if self.levels > 0 {
            let width = u32::BITS - self.levels.leading_zeros();
            let packed = if header.kind == 3 {
                &levels[header.repetition.min(levels.len())..]
            } else {
                let mut bytes = Bytes::new(&body);
                let packed = bytes.counted()?;
                begin = bytes.taken();
                packed
            };
            // Most pages lack nothing: one run of the highest level.
            let found = hybrid(packed, width, count)?;
            if found.iter().any(|l| *l != self.levels) {
                present = Some(found.iter().map(|l| *l == self.levels).collect::<Vec<bool>>());
            }
        }
        let stored = present.as_ref().map_or(count, |p| p.iter().filter(|p| **p).count());
        let element = self.element();
        let bytes = body.get(begin..)?;
        let decoded;
        let raw: &[u8] = match (header.encoding, self.physical) {
            (PLAIN, Physical::Number(_)) => bytes.get(..stored.checked_mul(element.bytes)?)?,
            (PLAIN, _) => {
                decoded = self.plain(bytes, stored)?;
                &decoded
            }
            (2 | 8, _) => {
                let (width, packed) = bytes.split_first().or((stored == 0).then_some((&0, &[][..])))?;
                let indices = hybrid(packed, u32::from(*width), stored)?;
                let mut gathered = Vec::with_capacity(stored * element.bytes);
                for index in indices {
                    let at = (index as usize).checked_mul(element.bytes)?;
                    gathered.extend_from_slice(self.dictionary.get(at..at + element.bytes)?);
                }
                decoded = gathered;
                &decoded
            }
            (3, Physical::Bit) => {
                let packed = Bytes::new(bytes).counted()?;
                decoded = hybrid(packed, 1, stored)?.into_iter().map(|b| b as u8).collect();
                &decoded
            }
            (5, Physical::Number(Element { kind: Kind::Signed | Kind::Unsigned, .. })) => {
                let numbers = deltas(bytes, stored)?;
                decoded = numbers.iter().flat_map(|n| n.to_le_bytes().into_iter().take(element.bytes)).collect();
                &decoded
            }
            (9, Physical::Number(_)) => {
                decoded = split_streams(bytes.get(..stored.checked_mul(element.bytes)?)?, element.bytes);
                &decoded
            }
            _ => return None,
        };
        if raw.len() != stored * element.bytes {
            return None;
        }
        self.given = 0;
        self.numbers.clear();
        self.stamps.clear();
        self.rounded = None;
        let mut each = raw.chunks_exact(element.bytes);
        match (self.target, &present) {
            (Some(_), None) => element.decode(raw, &mut self.numbers),
            (Some(_), Some(present)) => {
                let mut next =
                    |p: &bool| if *p { each.next().map_or(f64::NAN, |n| element.value(n)) } else { f64::NAN };
                self.numbers.extend(present.iter().map(&mut next));
            }
            (None, None) => self.stamps.extend(each.map(|n| element.stamp(n))),
            (None, Some(present)) => {
                let mut next = |p: &bool| {
                    if *p { each.next().map_or(Stamp::MISSING, |n| element.stamp(n)) } else { Stamp::MISSING }
                };
                self.stamps.extend(present.iter().map(&mut next));
            }
        }
        if element.bytes == 8 && element.kind != Kind::Float && self.target.is_some() {
            let first = raw.chunks_exact(8).position(|n| element.is_rounded(n));
            // Counted among those that are there.
            self.rounded = first.and_then(|first| match &present {
                None => Some(first),
                Some(present) => present.iter().enumerate().filter(|p| *p.1).nth(first).map(|p| p.0),
            });
        }
        Some(())
    }

    /// Values one after the other, as numbers of [`Column::element`].
    fn plain(&self, bytes: &[u8], count: usize) -> Option<Vec<u8>> {
        match self.physical {
            Physical::Number(element) => bytes.get(..count.checked_mul(element.bytes)?).map(<[u8]>::to_vec),
            Physical::Bit => {
                (bytes.len() >= count.div_ceil(8)).then(|| (0..count).map(|i| bytes[i / 8] >> (i % 8) & 1).collect())
            }
            Physical::Int96 => {
                let mut out = Vec::new();
                for stamp in bytes.get(..count.checked_mul(12)?)?.chunks_exact(12) {
                    let mut parts = Bytes::new(stamp);
                    let (of_day, day) = (parts.u64()? as i64, i64::from(parts.u32()?));
                    let all = (day - EPOCH_DAY).wrapping_mul(86_400_000_000_000).wrapping_add(of_day);
                    out.extend_from_slice(&all.to_le_bytes());
                }
                Some(out)
            }
        }
    }
}

/// What the header of a page says.
struct PageHeader {
    kind: i64,
    size: u64,
    stored: u64,
    values: usize,
    encoding: i64,
    /// Bytes of levels before the values, and of those that repeat among them, in pages of
    /// version 2.
    levels: usize,
    repetition: usize,
    is_packed: bool,
}

impl PageHeader {
    fn of(header: &Value<'_>) -> Option<Self> {
        let kind = header.integer(1)?;
        let (inner, encoding) = match kind {
            0 => (header.field(5)?, 2),
            2 => (header.field(7)?, 2),
            3 => (header.field(8)?, 4),
            _ => (header, 1),
        };
        let bytes = |id| inner.size(id).and_then(|n| usize::try_from(n).ok()).unwrap_or_default();
        let (definition, repetition) = if kind == 3 { (bytes(5), bytes(6)) } else { (0, 0) };
        Some(Self {
            kind,
            size: header.size(2)?,
            stored: header.size(3)?,
            values: inner.size(1).and_then(|n| usize::try_from(n).ok()).unwrap_or_default(),
            encoding: inner.integer(encoding).unwrap_or_default(),
            levels: definition.checked_add(repetition)?,
            repetition,
            is_packed: inner.field(7) != Some(&Value::Bool(false)),
        })
    }
}

/// Columns side by side.
#[derive(Debug)]
pub(super) struct Columns {
    input: Input,
    columns: Vec<Column>,
    bytes_read: u64,
}

impl Columns {
    /// At their first row.
    pub(super) fn new(input: Input, columns: Vec<Column>) -> Self {
        Self { input, columns, bytes_read: 0 }
    }
}

impl Reader for Columns {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        for column in &mut self.columns {
            let before = column.at;
            column.load(&self.input)?;
            self.bytes_read += column.at.saturating_sub(before);
        }
        let waiting = || self.columns.iter().map(Column::waiting);
        let count = waiting().min().unwrap_or(0).min(BLOCK);
        if count == 0 {
            return match waiting().max() {
                Some(0) | None => Ok(false),
                Some(_) => Err(self.input.fail("expected columns of one length, found a shorter one", DAMAGED)),
            };
        }
        for column in &mut self.columns {
            let part = column.given..column.given + count;
            match column.target {
                Some(target) => {
                    block.columns[target].extend_from_slice(&column.numbers[part.clone()]);
                    block.rounded[target] = column.rounded.filter(|r| part.contains(r)).map(|r| r - part.start);
                }
                None => block.stamps.extend_from_slice(&column.stamps[part.clone()]),
            }
            column.given += count;
        }
        block.rows = count;
        Ok(true)
    }

    fn bytes_read(&self) -> u64 {
        self.bytes_read.min(self.input.length())
    }
}
