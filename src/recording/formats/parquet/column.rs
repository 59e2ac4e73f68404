//! One column of a Parquet table, page by page.

use super::encoding::{Deltas, Hybrid, split_streams};
use super::page_header::PageHeader;
use super::physical::{DAMAGED, Physical};
use super::thrift;
use crate::budget::{Budget, LARGEST_BYTES, Spent};
use crate::bytes::Bytes;
use crate::clock::stamp::Stamp;
use crate::decompress::{Codec, decompress};
use crate::element::{Element, Kind};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::reader::Block;

/// Rows handed on at once.
pub(super) const BLOCK: usize = 16_384;
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
    /// States how its pages are compressed; the name of what is not read.
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
    /// States where its numbers go; `None` are time stamps.
    target: Option<usize>,
    /// The row groups that follow, the last first.
    chunks: Vec<Chunk>,
    codec: Codec,
    /// Byte of the file up to which it was read.
    pub at: u64,
    left: u64,
    dictionary: Vec<u8>,
    page: Page,
}

/// A page that is given piece by piece: what is packed stays packed until it is asked for.
#[derive(Debug, Default)]
struct Page {
    /// States where it begins in the file.
    at: u64,
    encoding: i64,
    /// Values that are still to be given, missing ones included.
    left: usize,
    /// Which values are there, where some may be missing.
    levels: Option<(Vec<u8>, Hybrid)>,
    body: Vec<u8>,
    values: Packed,
}

/// States how the values of a page are packed, and how far they were given.
#[derive(Debug, Default)]
enum Packed {
    /// One after the other, from this byte, or value, on.
    #[default]
    Nothing,
    Plain(usize),
    Bits {
        at: usize,
        given: usize,
    },
    Dictionary(Hybrid),
    Runs(Hybrid),
    Deltas(Deltas),
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
            page: Page::default(),
        }
    }

    /// Returns in which page, from which byte, and encoding it stands.
    pub(super) fn place(&self) -> (u64, i64) {
        (self.page.at, self.page.encoding)
    }

    /// Values that wait to be given.
    pub(super) fn waiting(&self) -> usize {
        self.page.left
    }

    /// Bytes in memory.
    pub(super) fn held(&self) -> u64 {
        let levels = self.page.levels.as_ref().map_or(0, |l| l.0.len());
        (self.dictionary.len() + self.page.body.len() + levels) as u64
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
    pub(super) fn load(&mut self, input: &Input, mut held: Held<'_>) -> Result<()> {
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
                (self.dictionary, self.page) = (Vec::new(), Page::default());
                continue;
            }
            self.read_page(input, &mut held)?;
        }
        Ok(())
    }

    fn read_page(&mut self, input: &Input, held: &mut Held<'_>) -> Result<()> {
        let page_at = self.at;
        let fail = |words: &str| -> Error { input.fail(format!("the page at byte {page_at}: {words}"), DAMAGED) };
        let mut length = USUAL_HEADER;
        let (header, taken) = loop {
            let bytes = input.bytes_at(page_at, length.min(input.length().saturating_sub(page_at)), "a page")?;
            let mut rest = Bytes::new(&bytes);
            if let Some(header) = thrift::structure(&mut rest, &mut Budget::of(0)) {
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
        // Before anything is allocated: the page as it is stored, and as it is held.
        let spent = |spent: Spent| fail(&spent.words());
        held.budget.rows(header.values as u64, 1).map_err(spent)?;
        self.page = Page::default();
        let (page, dictionary) = (header.stored + header.size, self.dictionary.len() as u64);
        held.budget.held(held.by_others + dictionary + page).map_err(spent)?;
        held.budget.unpacked(header.stored).map_err(spent)?;
        let data = input.bytes_at(page_at + taken, header.stored, "a page")?;
        self.at = page_at + taken + header.stored;
        if let Some(stated) = header.crc32
            && crc32fast::hash(&data) != stated
        {
            return Err(fail(&format!("its checksum is not {stated:08x}, as its header states (CRC-32)")));
        }
        match header.kind {
            // An index is passed over.
            1 => Ok(()),
            2 => {
                let bytes = decompress(self.codec, &data, header.size, held.budget).map_err(|w| fail(&w))?;
                self.dictionary = plain(self.physical, &bytes, header.values)
                    .ok_or_else(|| fail("a dictionary that is cut short"))?;
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
                let levels = levels.get(header.repetition..).unwrap_or_default().to_vec();
                let size = header.size.checked_sub(levels_bytes as u64).ok_or_else(|| fail("levels longer than it"))?;
                let codec = if header.is_packed { self.codec } else { Codec::None };
                let body = if codec == Codec::None && size == packed.len() as u64 {
                    if levels_bytes == 0 { data } else { packed.to_vec() }
                } else {
                    decompress(codec, packed, size, held.budget).map_err(|w| fail(&w))?
                };
                let apart = (header.kind == 3).then_some(levels);
                self.page = self.begin(&header, apart, body).ok_or_else(|| damaged(input, page_at, header.encoding))?;
                self.page.at = page_at;
                Ok(())
            }
            _ => Err(fail("expected a page of data, found another kind")),
        }
    }

    /// A page whose levels stand before its values, or apart.
    fn begin(&self, header: &PageHeader, apart: Option<Vec<u8>>, body: Vec<u8>) -> Option<Page> {
        let (mut begin, count) = (0, header.values);
        let mut levels = None;
        if self.levels > 0 {
            let packed = match apart {
                Some(packed) => packed,
                None => {
                    let mut bytes = Bytes::new(&body);
                    let packed = bytes.counted()?.to_vec();
                    begin = bytes.taken();
                    packed
                }
            };
            let width = u32::BITS - self.levels.leading_zeros();
            levels = Some((packed, Hybrid::new(width, 0, count)?));
        }
        let bytes = body.get(begin..)?;
        let (values, body) = match (header.encoding, self.physical) {
            (PLAIN, Physical::Bit) => (Packed::Bits { at: begin, given: 0 }, body),
            (PLAIN, _) => (Packed::Plain(begin), body),
            (2 | 8, _) => match bytes.first() {
                Some(width) => (Packed::Dictionary(Hybrid::new(u32::from(*width), begin + 1, count)?), body),
                None => (Packed::Nothing, body),
            },
            (3, Physical::Bit) => {
                let packed = Bytes::new(bytes).counted()?.to_vec();
                (Packed::Runs(Hybrid::new(1, 0, count)?), packed)
            }
            (5, Physical::Number(Element { kind: Kind::Signed | Kind::Unsigned, .. })) => {
                (Packed::Deltas(Deltas::new(&body, begin, count)?), body)
            }
            (9, Physical::Number(element)) => {
                // Its streams lie as far apart as there are values that are not missing.
                let stored = levels.as_ref().map_or(Some(count), |l| self.present(&l.0, count))?;
                let streams = bytes.get(..stored.checked_mul(element.bytes)?)?;
                (Packed::Plain(0), split_streams(streams, element.bytes))
            }
            _ => return None,
        };
        Some(Page { at: 0, encoding: header.encoding, left: count, levels, body, values })
    }

    /// Returns how many of a page's values are there.
    fn present(&self, levels: &[u8], count: usize) -> Option<usize> {
        let mut hybrid = Hybrid::new(u32::BITS - self.levels.leading_zeros(), 0, count)?;
        let (mut found, mut present) = (vec![0; BLOCK], 0);
        for from in (0..count).step_by(BLOCK) {
            let part = &mut found[..BLOCK.min(count - from)];
            hybrid.fill(levels, part)?;
            present += part.iter().filter(|l| **l == self.levels).count();
        }
        Some(present)
    }

    /// Gives so many values of the page at hand, no more than wait.
    pub(super) fn give(&mut self, count: usize, block: &mut Block) -> Option<()> {
        self.page.left = self.page.left.checked_sub(count)?;
        let mut present = None;
        if let Some((bytes, levels)) = &mut self.page.levels {
            let mut found = vec![0; count];
            levels.fill(bytes, &mut found)?;
            // Most pages lack nothing: one run of the highest level.
            if found.iter().any(|l| *l != self.levels) {
                present = Some(found.iter().map(|l| *l == self.levels).collect::<Vec<bool>>());
            }
        }
        let stored = present.as_ref().map_or(count, |p| p.iter().filter(|p| **p).count());
        let element = self.element();
        let raw = self.unpacked(stored, element.bytes)?;
        let mut each = raw.chunks_exact(element.bytes);
        match (self.target, &present) {
            (Some(target), None) => element.decode(&raw, &mut block.columns[target]),
            (Some(target), Some(present)) => {
                let mut next =
                    |p: &bool| if *p { each.next().map_or(f64::NAN, |n| element.value(n)) } else { f64::NAN };
                block.columns[target].extend(present.iter().map(&mut next));
            }
            (None, None) => block.stamps.extend(each.map(|n| element.stamp(n))),
            (None, Some(present)) => {
                let mut next = |p: &bool| {
                    if *p { each.next().map_or(Stamp::MISSING, |n| element.stamp(n)) } else { Stamp::MISSING }
                };
                block.stamps.extend(present.iter().map(&mut next));
            }
        }
        if let Some(target) = self.target
            && element.bytes == 8
            && element.kind != Kind::Float
        {
            let first = raw.chunks_exact(8).position(|n| element.is_rounded(n));
            // Counted among those that are there.
            block.rounded[target] = first.and_then(|first| match &present {
                None => Some(first),
                Some(present) => present.iter().enumerate().filter(|p| *p.1).nth(first).map(|p| p.0),
            });
        }
        Some(())
    }

    /// The next values of the page as numbers of [`Column::element`], of so many bytes each.
    fn unpacked(&mut self, count: usize, bytes: usize) -> Option<Vec<u8>> {
        let body = &self.page.body;
        let mut out = Vec::with_capacity(count * bytes);
        match &mut self.page.values {
            Packed::Nothing if count == 0 => {}
            Packed::Nothing => return None,
            Packed::Plain(at) => {
                let length = count * self.physical.stored_bytes();
                out = plain(self.physical, body.get(*at..*at + length)?, count)?;
                *at += length;
            }
            Packed::Bits { at, given } => {
                let bit = |i: usize| body.get(*at + i / 8).map(|b| b >> (i % 8) & 1);
                out.extend((*given..*given + count).map(bit).collect::<Option<Vec<u8>>>()?);
                *given += count;
            }
            Packed::Dictionary(indices) => {
                let mut found = vec![0; count];
                indices.fill(body, &mut found)?;
                for index in found {
                    let at = (index as usize).checked_mul(bytes)?;
                    out.extend_from_slice(self.dictionary.get(at..at + bytes)?);
                }
            }
            Packed::Runs(runs) => {
                let mut found = vec![0; count];
                runs.fill(body, &mut found)?;
                out.extend(found.into_iter().map(|b| b as u8));
            }
            Packed::Deltas(deltas) => {
                for _ in 0..count {
                    out.extend_from_slice(deltas.next(body)?.to_le_bytes().get(..bytes)?);
                }
            }
        }
        Some(out)
    }
}

/// Values one after the other, as numbers of [`Column::element`].
fn plain(physical: Physical, bytes: &[u8], count: usize) -> Option<Vec<u8>> {
    match physical {
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

/// Holds what a column may still take, and what the other ones hold.
pub(super) struct Held<'a> {
    pub budget: &'a mut Budget,
    pub by_others: u64,
}

/// Says which page is damaged.
pub(super) fn damaged(input: &Input, page_at: u64, encoding: i64) -> Error {
    input.fail(
        format!("the page at byte {page_at}: expected more values in encoding {encoding}, found damaged data"),
        DAMAGED,
    )
}
