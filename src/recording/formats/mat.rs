//! MATLAB's `.mat` of version 5, also compressed (`-v7`): arrays, and arrays within structures.
//! Format: MathWorks, *MAT-File Format*, 2019.

use std::collections::HashMap;
use std::io::Read;

use crate::array::{Array, Arrays, Packing, Place, Shape};
use crate::budget::{Budget, ENTRY_BYTES, Spent};
use crate::element::{Element, Kind};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::reader::Log;

const HEADER_BYTES: u64 = 128;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Structures within structures are followed so far.
const DEEPEST: usize = 8;
/// No name, list of dimensions or list of fields is longer, bytes.
const LONGEST: u64 = 1 << 16;

/// Opens a file.
///
/// # Errors
/// A damaged file, or one without arrays of numbers.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let header = input.bytes_at(0, HEADER_BYTES, "the header of a MATLAB file")?;
    let big_endian = match &header[124..] {
        [0, 1, b'I', b'M'] => false,
        [1, 0, b'M', b'I'] => true,
        other => {
            return Err(input.fail(
                format!("expected version 1 of the format and its order of bytes at byte 124, found {other:?}"),
                "save it again in MATLAB with save(…, '-v7')",
            ));
        }
    };
    let mut found = Vec::new();
    let mut budget = Budget::of(input.length());
    let mut at = HEADER_BYTES;
    while at + 8 <= input.length() {
        let tag = input.bytes_at(at, 8, "an element")?;
        let [kind, bytes] = [0, 4].map(|i| number(&tag[i..i + 4], big_endian));
        let (begin, stored) = (at + 8, u64::from(bytes));
        if begin + stored > input.length() {
            return Err(input.truncated("a variable", begin, stored));
        }
        let place = Place { at: begin, stored, packing: Packing::None, skip: 0, crc32: None };
        let mut bytes = input.at(begin).take(stored);
        let scanned = match kind {
            MATRIX => Scan::new(&mut bytes, big_endian, &mut budget).matrix(stored, &[], place, &mut found),
            COMPRESSED => {
                let place = Place { packing: Packing::Zlib, ..place };
                let mut unpacked = flate2::read::ZlibDecoder::new(bytes);
                let read = Scan::new(&mut unpacked, big_endian, &mut budget).packed(place, &mut found);
                // The checksum stands behind the last byte, and is compared where the end is met.
                read.and_then(|()| std::io::copy(&mut unpacked, &mut std::io::sink())).and_then(|_| {
                    match unpacked.total_in() {
                        taken if taken == stored => Ok(()),
                        taken => Err(wrong(&format!("{taken} bytes in a variable that is said to have {stored}"))),
                    }
                })
            }
            other => {
                return Err(input.fail(
                    format!("expected a variable at byte {at} (type 14 or 15), found type {other}"),
                    "copy the file again, or save it again",
                ));
            }
        };
        scanned.map_err(|e| damaged(input, &e))?;
        at = begin + stored;
        if kind != COMPRESSED {
            at = at.next_multiple_of(8);
        }
    }
    if at < input.length() {
        return Err(input.truncated("a variable", at, 8));
    }
    let arrays = named(found, &mut budget).map_err(|spent| spent.of(input))?;
    if arrays.is_empty() {
        return Err(input.fail(
            "the MATLAB file holds no array of numbers",
            "save the readings as matrices of numbers; tables and timetables are objects of MATLAB's own",
        ));
    }
    Ok(Box::new(Arrays::new(input, arrays)))
}

fn damaged(input: &Input, error: &std::io::Error) -> Error {
    input.fail(format!("expected a variable, found damaged data: {error}"), "copy the file again, or save it again")
}

fn number(bytes: &[u8], big_endian: bool) -> u32 {
    let bytes = bytes.try_into().unwrap_or_default();
    if big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

/// An array by its path, before it has a name.
struct Found {
    path: Vec<String>,
    element: Element,
    shape: Shape,
    place: Place,
}

/// A variable is called by its name, a field by its own, or by its path where that is taken.
fn named(found: Vec<Found>, budget: &mut Budget) -> Result<Vec<Array>, Spent> {
    let own = |f: &Found| f.path.last().cloned().unwrap_or_default();
    // Of each name, the smallest depth and how many are called so there: one alone keeps the name.
    let mut shallowest: HashMap<String, (usize, usize)> = HashMap::new();
    for one in &found {
        let (depth, count) = shallowest.entry(own(one)).or_insert((one.path.len(), 0));
        match one.path.len().cmp(depth) {
            std::cmp::Ordering::Less => (*depth, *count) = (one.path.len(), 1),
            std::cmp::Ordering::Equal => *count += 1,
            std::cmp::Ordering::Greater => {}
        }
    }
    let mut arrays = Vec::new();
    for one in &found {
        let aside = one.path.len() > 1 && shallowest.get(&own(one)) != Some(&(one.path.len(), 1));
        let name = if aside { one.path.join(".") } else { own(one) };
        let array = Array::plain(&name, one.element, one.shape, one.place, budget)?;
        arrays.extend(array.map(|array| Array { aside, ..array }));
    }
    Ok(arrays)
}

/// An element's tag: its type, its bytes, and the bytes themselves where they stand in the tag.
type Tag = (u32, u64, Option<[u8; 4]>);

/// A variable that is read from front to back.
struct Scan<'a> {
    reader: &'a mut dyn Read,
    taken: u64,
    big_endian: bool,
    budget: &'a mut Budget,
}

fn wrong(words: &str) -> std::io::Error {
    std::io::Error::other(words.to_owned())
}

impl<'a> Scan<'a> {
    fn new(reader: &'a mut dyn Read, big_endian: bool, budget: &'a mut Budget) -> Self {
        Self { reader, taken: 0, big_endian, budget }
    }

    /// The variable in a packed element, whose place in the file is `outer`.
    fn packed(&mut self, outer: Place, found: &mut Vec<Found>) -> std::io::Result<()> {
        match self.tag()? {
            (MATRIX, bytes, _) => self.matrix(bytes, &[], outer, found),
            _ => Ok(()),
        }
    }

    fn array<const N: usize>(&mut self) -> std::io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.reader.read_exact(&mut bytes)?;
        self.taken += N as u64;
        Ok(bytes)
    }

    fn skip(&mut self, bytes: u64) -> std::io::Result<()> {
        let passed = std::io::copy(&mut Read::take(&mut self.reader, bytes), &mut std::io::sink())?;
        self.taken += passed;
        if passed < bytes { Err(std::io::ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
    }

    fn tag(&mut self) -> std::io::Result<Tag> {
        let first = number(&self.array::<4>()?, self.big_endian);
        let second = self.array::<4>()?;
        match first >> 16 {
            0 => Ok((first, u64::from(number(&second, self.big_endian)), None)),
            bytes @ 1..=4 => Ok((first & 0xffff, u64::from(bytes), Some(second))),
            _ => Err(wrong("an invalid tag")),
        }
    }

    /// A short element, whole.
    fn element(&mut self) -> std::io::Result<Vec<u8>> {
        let (_, bytes, small) = self.tag()?;
        if let Some(small) = small {
            return Ok(small[..bytes as usize].to_vec());
        }
        if bytes > LONGEST {
            return Err(wrong("a name or a list of dimensions that is too long"));
        }
        let mut data = vec![0; bytes as usize];
        self.reader.read_exact(&mut data)?;
        self.taken += bytes;
        self.skip(bytes.next_multiple_of(8) - bytes)?;
        Ok(data)
    }

    /// The content of a matrix of this many bytes, which lies within `outer` of the file.
    fn matrix(&mut self, bytes: u64, path: &[String], outer: Place, found: &mut Vec<Found>) -> std::io::Result<()> {
        if bytes == 0 {
            return Ok(());
        }
        let end = self.taken.saturating_add(bytes);
        let flags = self.element()?;
        let class = number(flags.get(..4).ok_or_else(|| wrong("no flags"))?, self.big_endian) & 0xff;
        let dimensions: Vec<u64> =
            self.element()?.chunks_exact(4).map(|d| u64::from(number(d, self.big_endian))).collect();
        let name = String::from_utf8_lossy(&self.element()?).into_owned();
        let path_bytes: usize = path.iter().map(String::len).sum();
        let visited = self.budget.visit(ENTRY_BYTES + path_bytes + name.len());
        visited.map_err(|spent| std::io::Error::other(spent.words()))?;
        // A field bears its name in its structure.
        let path = if name.is_empty() { path.to_vec() } else { [path, &[name]].concat() };
        match (class, &dimensions[..]) {
            (2, [1, 1]) if path.len() < DEEPEST => {
                let length = self.element()?;
                let length =
                    number(length.get(..4).ok_or_else(|| wrong("no length of names"))?, self.big_endian) as usize;
                let names = self.element()?;
                for name in names.chunks_exact(length.max(1)) {
                    let (kind, bytes, _) = self.tag()?;
                    if kind != MATRIX {
                        return Err(wrong("a field that is not a matrix"));
                    }
                    let name = crate::bytes::until_zero(name);
                    self.matrix(bytes, &[&path[..], &[name]].concat(), outer, found)?;
                }
            }
            (6..=15, [rows, columns]) if *rows > 0 && *columns > 0 => {
                let (kind, bytes, small) = self.tag()?;
                let skip = if small.is_some() { self.taken - 4 } else { self.taken };
                let shape = Shape { rows: *rows, columns: *columns, in_columns: true };
                if let Some(element) = self.kind(kind)
                    && rows.checked_mul(*columns).and_then(|n| n.checked_mul(element.bytes as u64)) == Some(bytes)
                {
                    let place = match outer.packing {
                        Packing::None => Place { at: outer.at + skip, stored: bytes, ..outer },
                        _ => Place { skip, ..outer },
                    };
                    found.push(Found { path, element, shape, place });
                }
            }
            _ => {}
        }
        // What follows the numbers (an imaginary part) is passed over, and so is what was not
        // understood.
        match end.checked_sub(self.taken) {
            Some(rest) => self.skip(rest),
            None => Err(wrong("a matrix that is longer than it says")),
        }
    }

    fn kind(&self, kind: u32) -> Option<Element> {
        let (kind, bytes) = match kind {
            1 => (Kind::Signed, 1),
            2 => (Kind::Unsigned, 1),
            3 => (Kind::Signed, 2),
            4 => (Kind::Unsigned, 2),
            5 => (Kind::Signed, 4),
            6 => (Kind::Unsigned, 4),
            7 => (Kind::Float, 4),
            9 => (Kind::Float, 8),
            12 => (Kind::Signed, 8),
            13 => (Kind::Unsigned, 8),
            _ => return None,
        };
        Some(Element { kind, bytes, big_endian: self.big_endian })
    }
}
