//! NumPy's `.npy`: one array, plain or of records. Format: numpy.lib.format, versions 1 to 3.

use crate::array::{Array, Arrays, Field, Packing, Place, Shape};
use crate::budget::{Budget, Spent};
use crate::element::{Element, Kind};
use crate::error::Result;
use crate::input::Input;
use crate::reader::Log;

/// No description of an array is longer, bytes.
const LONGEST_HEADER: usize = 1 << 20;

/// Opens a file.
///
/// # Errors
/// A damaged header, or numbers of a kind that is not read.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let start = input.head()?;
    let needed = header_length(&start).unwrap_or(usize::MAX);
    let head = if needed > start.len() && needed <= LONGEST_HEADER {
        input.bytes_at(0, needed as u64, "the header of an array")?
    } else {
        start
    };
    let fail = |cause: String| {
        input.fail(cause, "write it again with numpy.save, as an array of numbers with one or two dimensions")
    };
    let (header, data) = describe(&head).map_err(fail)?;
    let place =
        Place { at: data as u64, stored: input.length() - data as u64, packing: Packing::None, skip: 0, crc32: None };
    let mut budget = Budget::of(input.length());
    let array = header.array("", place, &mut budget).map_err(|spent| spent.of(input))?.map_err(fail)?;
    if array.bytes() > place.stored {
        return Err(input.truncated("the numbers of the array", place.at, array.bytes()));
    }
    Ok(Box::new(Arrays::new(input, vec![array])))
}

/// Holds what the header of an array says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    descr: String,
    fortran: bool,
    shape: Vec<u64>,
}

/// Bytes of magic, version and header.
pub(super) fn header_length(head: &[u8]) -> Option<usize> {
    match head {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, low, high, ..] => {
            Some(10 + usize::from(u16::from_le_bytes([*low, *high])))
        }
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _, a, b, c, d, ..] => {
            12usize.checked_add(u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => None,
    }
}

/// Reads the header at the beginning of an array, and where its numbers begin.
///
/// # Errors
/// What is expected and what is there.
pub(crate) fn describe(head: &[u8]) -> Result<(Header, usize), String> {
    let data = header_length(head).ok_or("expected the beginning of a NumPy array of version 1 to 3")?;
    let begin = if head.get(6) == Some(&1) { 10 } else { 12 };
    let text =
        head.get(begin..data).ok_or_else(|| format!("expected a header of {data} bytes, the file is shorter"))?;
    let text = String::from_utf8_lossy(text);
    let descr = value_of(&text, "descr").ok_or("its header names no `descr`")?;
    let fortran = value_of(&text, "fortran_order").ok_or("its header names no `fortran_order`")?;
    let shape = value_of(&text, "shape").ok_or("its header names no `shape`")?;
    let numbers: Result<Vec<u64>, _> = shape
        .trim_matches(['(', ')'])
        .split(',')
        .map(str::trim)
        .filter(|n| !n.is_empty())
        .map(|n| n.trim_end_matches('L').parse::<u64>())
        .collect();
    let shape = numbers.map_err(|_| format!("its shape `{}` is invalid", short(shape)))?;
    Ok((Header { descr: descr.to_owned(), fortran: fortran == "True", shape }, data))
}

fn short(text: &str) -> String {
    text.chars().take(60).collect()
}

/// The value of a key in a Python dictionary as it is printed.
fn value_of<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let at = [format!("'{key}':"), format!("\"{key}\":")].iter().find_map(|k| text.find(k).map(|i| i + k.len()))?;
    let rest = text[at..].trim_start();
    let mut depth = 0;
    let mut quote = None;
    for (i, c) in rest.char_indices() {
        match (quote, c) {
            (Some(q), c) if q == c => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '(' | '[') => depth += 1,
            (None, ')' | ']') => depth -= 1,
            (None, ',' | '}') if depth == 0 => return Some(rest[..i].trim()),
            _ => {}
        }
    }
    None
}

/// A type as NumPy prints it: `<f8`.
fn element(descr: &str) -> Result<Element, String> {
    let plain = descr.trim().trim_matches(['\'', '"']);
    let kind = match plain.as_bytes() {
        [_, b'i', ..] => Some(Kind::Signed),
        [_, b'u' | b'b', ..] => Some(Kind::Unsigned),
        [_, b'f', ..] => Some(Kind::Float),
        _ => None,
    };
    let bytes = plain.get(2..).and_then(|n| n.parse::<usize>().ok());
    match (kind, bytes) {
        (Some(kind), Some(bytes @ (1 | 2 | 4 | 8))) if kind != Kind::Float || bytes > 1 => {
            Ok(Element { kind, bytes, big_endian: plain.starts_with('>') })
        }
        _ => Err(format!("expected integers or floats, found numbers of the type `{}`", short(plain))),
    }
}

impl Header {
    /// The array that is described, named by `name`; in words why it is none: numbers of a kind
    /// that is not read, more than two dimensions.
    ///
    /// # Errors
    /// More columns than the budget has visits for.
    pub(crate) fn array(&self, name: &str, place: Place, budget: &mut Budget) -> Result<Result<Array, String>, Spent> {
        if self.descr.starts_with('[') {
            budget.visit(self.descr.len())?;
            return Ok(self.records(place));
        }
        let (element, shape) = match self.table() {
            Ok(table) => table,
            Err(words) => return Ok(Err(words)),
        };
        let array = Array::plain(name, element, shape, place, budget)?;
        Ok(array.ok_or_else(|| format!("an array of {} × {} is not a table", shape.rows, shape.columns)))
    }

    /// Numbers of one kind, in one or two dimensions.
    fn table(&self) -> Result<(Element, Shape), String> {
        let element = element(&self.descr)?;
        let (rows, columns) = match self.shape[..] {
            [rows] => (rows, 1),
            [rows, columns] => (rows, columns),
            _ => return Err(format!("expected one or two dimensions, found {}", self.shape.len())),
        };
        Ok((element, Shape { rows, columns, in_columns: self.fortran }))
    }

    /// Records: a name, a type and maybe a length for each field.
    fn records(&self, place: Place) -> Result<Array, String> {
        let [rows] = self.shape[..] else { return Err("expected a list of records".into()) };
        let (mut fields, mut offset) = (Vec::new(), 0);
        let inner = self.descr.trim_start_matches('[').trim_end_matches(']');
        for record in
            inner.split("(").filter_map(|r| r.split_once([')', '('])).map(|(r, _)| r).filter(|r| r.contains('\''))
        {
            let mut parts = record.split(',').map(|p| p.trim().trim_matches(['\'', '"']));
            let (Some(name), Some(kind)) = (parts.next(), parts.next()) else {
                return Err(format!("the record `{}` is invalid", short(record)));
            };
            let element = element(kind)?;
            fields.push(Field { name: name.to_owned(), element, offset });
            offset += element.bytes as u64;
        }
        let nested = inner.matches('(').count() != fields.len();
        if nested || fields.is_empty() || rows == 0 || offset.checked_mul(rows).is_none() {
            return Err("expected records of single numbers".into());
        }
        Ok(Array { fields, rows, row_bytes: Some(offset), place, aside: false })
    }
}
