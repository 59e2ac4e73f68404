//! NumPy's `.npz`: arrays in a zip archive, stored or deflated. Format: PKWARE's APPNOTE 6.3, with
//! zip64.

use std::io::Read;

use super::array_file::{describe, header_length};
use crate::array::{Arrays, Packing, Place};
use crate::budget::Budget;
use crate::bytes::Bytes;
use crate::error::Result;
use crate::input::Input;
use crate::reader::Log;

/// The record that ends an archive lies within this many of its last bytes.
const TAIL: u64 = 66_000;
/// No list of files is longer, bytes.
const LONGEST_LIST: u64 = 64 << 20;
/// States what an entry is charged for its head, of which 64 KiB are unpacked.
const HEAD_BYTES: usize = 1 << 10;
/// Bytes of an array that hold its header.
const HEADER: u64 = 1 << 16;

/// Opens an archive.
///
/// # Errors
/// A damaged archive, or one without arrays of numbers.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let entries = entries(input)?;
    let mut budget = Budget::of(input.length());
    let mut arrays = Vec::new();
    for entry in &entries {
        // Several entries may be of the same bytes, and the head of each is unpacked.
        budget.visit(HEAD_BYTES + entry.name.len()).map_err(|spent| spent.of(input))?;
        // The names before the data are as long as the archive says there, not as in its list.
        let local = input.bytes_at(entry.at, 30, "the header of an array in the archive")?;
        let length = |i: usize| u64::from(u16::from_le_bytes([local[i], local[i + 1]]));
        let is_named = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes) == entry.name;
        if !local.starts_with(b"PK\x03\x04")
            || !input.bytes_at(entry.at.saturating_add(30), length(26), "a name in the archive").is_ok_and(is_named)
        {
            return Err(input.fail(
                format!("expected the header of `{}` at byte {}, found something else", entry.name, entry.at),
                "the archive is damaged: copy it again",
            ));
        }
        let Some(name) = entry.name.strip_suffix(".npy") else { continue };
        let packing = match entry.method {
            0 => Packing::None,
            8 => Packing::Deflate,
            other => {
                return Err(input.fail(
                    format!(
                        "`{}` is packed by method {other}, where 0 (stored) or 8 (deflated) were expected",
                        entry.name
                    ),
                    "write the archive again with numpy.savez",
                ));
            }
        };
        let at = entry.at.saturating_add(30) + length(26) + length(28);
        if at.checked_add(entry.stored).is_none_or(|end| end > input.length()) {
            return Err(input.truncated(&format!("the array `{name}`"), at, entry.stored));
        }
        let place = Place { at, stored: entry.stored, packing, skip: 0, crc32: Some(entry.crc32) };
        let mut head = Vec::new();
        let read = place.open(input, 0).and_then(|r| r.take(HEADER).read_to_end(&mut head));
        read.map_err(|e| input.fail(format!("`{}` cannot be unpacked: {e}", entry.name), "copy the archive again"))?;
        // What is no array of numbers (text, objects) is no column; what is damaged is an error.
        if header_length(&head).is_none() {
            place.check(input, &mut budget)?;
            continue;
        }
        if let Ok((header, skip)) = describe(&head)
            && let Ok(array) = header
                .array(name, Place { skip: skip as u64, ..place }, &mut budget)
                .map_err(|spent| spent.of(input))?
        {
            let expected = array.bytes().saturating_add(skip as u64);
            if entry.size != expected {
                return Err(input.fail(
                    format!("the array `{name}` has {} bytes, where its header says {expected}", entry.size),
                    "the archive is damaged or cut short: copy it again",
                ));
            }
            arrays.push(array);
        } else {
            place.check(input, &mut budget)?;
        }
    }
    if arrays.is_empty() {
        return Err(input.fail(
            "the zip archive holds no array of numbers (.npy)",
            "is this a spreadsheet? Save it as CSV; arrays are written by numpy.savez",
        ));
    }
    Ok(Box::new(Arrays::new(input, arrays)))
}

/// A file in the archive.
struct Entry {
    name: String,
    method: u16,
    stored: u64,
    size: u64,
    at: u64,
    /// Of what it holds when it is unpacked.
    crc32: u32,
}

fn entries(input: &Input) -> Result<Vec<Entry>> {
    let tail_at = input.length().saturating_sub(TAIL);
    let tail = input.bytes_at(tail_at, input.length() - tail_at, "the end of the archive")?;
    let damaged = |what: &str| {
        input.fail(
            format!("this is a zip archive (NumPy's .npz, or a spreadsheet), and {what} of it is not there"),
            "it is cut short or damaged: copy it again; save a spreadsheet as CSV",
        )
    };
    let end = memchr::memmem::rfind(&tail, b"PK\x05\x06").ok_or_else(|| damaged("the end"))?;
    let mut count_at = (10, 2);
    let mut record = tail[end..].to_vec();
    // zip64: 20 bytes before, where the larger record lies.
    if let Some(locator) = end.checked_sub(20).map(|from| &tail[from..end]).filter(|l| l.starts_with(b"PK\x06\x07")) {
        let mut locator = Bytes::new(&locator[8..]);
        let at = locator.u64().unwrap_or_default();
        record = input.bytes_at(at, 56, "the end of the zip64 archive")?;
        count_at = (32, 8);
    }
    let number = |at: usize, bytes: usize| {
        let part = record.get(at..at + bytes)?;
        Some(part.iter().rev().fold(0u64, |sum, b| (sum << 8) | u64::from(*b)))
    };
    let wide = count_at.1 == 8;
    let fields = if wide {
        (number(32, 8), number(40, 8), number(48, 8))
    } else {
        (number(10, 2), number(12, 4), number(16, 4))
    };
    let (Some(count), Some(size), Some(at)) = fields else { return Err(damaged("the end")) };
    if size > LONGEST_LIST {
        return Err(damaged("a list of files"));
    }
    let list = input.bytes_at(at, size, "the list of files in the archive")?;
    let mut list = Bytes::new(&list);
    let mut out = Vec::new();
    for _ in 0..count {
        match entry(&mut list) {
            Some(entry) => out.push(entry),
            None => return Err(damaged("an entry in the list of files")),
        }
    }
    if !list.is_empty() {
        return Err(damaged("the number of files in its list"));
    }
    Ok(out)
}

fn entry(list: &mut Bytes<'_>) -> Option<Entry> {
    let head = list.take(46).filter(|h| h.starts_with(b"PK\x01\x02"))?;
    let mut at = Bytes::new(&head[10..]);
    let method = at.u16()?;
    // Time and date.
    at.take(4)?;
    let crc32 = at.u32()?;
    let (mut stored, mut size) = (u64::from(at.u32()?), u64::from(at.u32()?));
    let (name, extra, comment) = (at.u16()?, at.u16()?, at.u16()?);
    at.take(8)?;
    let mut place = u64::from(at.u32()?);
    let name = String::from_utf8_lossy(list.take(usize::from(name))?).into_owned();
    let mut extra = Bytes::new(list.take(usize::from(extra))?);
    list.take(usize::from(comment))?;
    while let (Some(id), Some(length)) = (extra.u16(), extra.u16()) {
        let Some(field) = extra.take(usize::from(length)) else { break };
        let mut field = Bytes::new(field);
        if id == 1 {
            for value in [&mut size, &mut stored, &mut place] {
                if *value == u64::from(u32::MAX) {
                    *value = field.u64()?;
                }
            }
        }
    }
    Some(Entry { name, method, stored, size, at: place, crc32 })
}
