//! Parquet tables: flat columns of numbers, page by page. Format:
//! parquet.apache.org/docs/file-format.
//!
//! An own reader: rows stream in constant memory, and what is damaged ends in words.

mod column;
mod columns;
mod encoding;
mod page_header;
mod physical;
#[cfg(test)]
mod round_trip;
mod thrift;

use crate::budget::{Budget, Spent};
use crate::bytes::Bytes;
use crate::decompress::Codec;
use crate::element::{Element, Kind};
use crate::error::{Error, Result};
use crate::input::Input;
use crate::reader::{Choice, Heading, Log, Part, Reader};
use crate::roles;
use column::Chunk;
use columns::Columns;
use physical::{DAMAGED, Physical};
use thrift::Value;

/// No table's metadata are longer, bytes.
const LONGEST_FOOTER: u64 = 256 << 20;

/// A column of numbers.
#[derive(Debug, Clone)]
struct Column {
    /// Its place among the columns of a row group.
    leaf: usize,
    heading: Heading,
    physical: Physical,
    /// Levels of values that may be missing.
    levels: u32,
}

#[derive(Debug)]
struct Parquet {
    input: Input,
    parts: Vec<Part>,
    columns: Vec<Column>,
    /// Per row group, its rows and the chunk of each leaf.
    groups: Vec<(u64, Vec<Chunk>)>,
}

/// Opens a table.
///
/// # Errors
/// A file that was not finished, or is damaged; one without columns of numbers.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let length = input.length();
    let tail = if length < 12 { Vec::new() } else { input.bytes_at(length - 8, 8, "the end of the table")? };
    if tail.get(4..) != Some(b"PAR1") {
        return Err(input.fail(
            match tail.get(4..) {
                Some(b"PARE") => "its metadata are encrypted".to_owned(),
                _ => format!("expected PAR1 in the last four of its {length} bytes, found something else"),
            },
            DAMAGED,
        ));
    }
    let size = Bytes::new(&tail).u32().map_or(0, u64::from);
    let at = (length - 8).checked_sub(size).filter(|_| size <= LONGEST_FOOTER);
    let at = at.ok_or_else(|| input.truncated("the table's metadata", 0, size))?;
    let footer = input.bytes_at(at, size, "the table's metadata")?;
    let mut budget = Budget::of(length);
    let Some(meta) = thrift::structure(&mut Bytes::new(&footer), &mut budget) else {
        budget.visit(thrift::VALUE_BYTES).map_err(|spent| spent.of(input))?;
        return Err(input.fail(format!("expected the table's metadata at byte {at}, found damaged data"), DAMAGED));
    };
    let mut schema = meta.list(2).iter();
    let root = schema.next();
    let mut leaves = Leaves { schema, path: Vec::new(), has_clock: false, budget, found: Vec::new() };
    if let Some(root) = root {
        leaves.below(root.size(5).unwrap_or_default(), 0, false).map_err(|spent| spent.of(input))?;
    }
    let columns: Vec<Column> = leaves.found.into_iter().flatten().collect();
    let mut groups = Vec::new();
    for group in meta.list(4) {
        let chunks = group.list(1).iter().map(|c| chunk(input, c)).collect::<Result<Vec<Chunk>>>()?;
        groups.push((group.size(3).unwrap_or_default(), chunks));
    }
    let names: Vec<String> = columns.iter().map(|c| c.heading.name.clone()).collect();
    let roles = roles::of(&names);
    let part = Part {
        rows: meta.size(3),
        columns: columns.iter().map(|c| c.heading.clone()).collect(),
        is_imu: roles.gyro.is_some() && roles.accelerometer.is_some(),
        ..Part::default()
    };
    if columns.is_empty() {
        return Err(input.fail(
            "the Parquet table has no flat column of numbers",
            "write readings as columns of numbers, one row per sample",
        ));
    }
    Ok(Box::new(Parquet { input: input.clone(), parts: vec![part], columns, groups }))
}

/// All leaves of a schema in order; those that are no numbers keep their place.
struct Leaves<'a, 'b> {
    schema: std::slice::Iter<'a, Value<'b>>,
    path: Vec<String>,
    has_clock: bool,
    budget: Budget,
    found: Vec<Option<Column>>,
}

impl Leaves<'_, '_> {
    fn below(&mut self, children: u64, levels: u32, repeated: bool) -> Result<(), Spent> {
        for _ in 0..children {
            let Some(node) = self.schema.next() else { return Ok(()) };
            let repetition = node.integer(3).unwrap_or_default();
            let (levels, repeated) = (levels + u32::from(repetition > 0), repeated || repetition == 2);
            self.path.push(node.text(4).unwrap_or_default());
            match node.size(5).unwrap_or_default() {
                0 => {
                    let leaf = self.found.len();
                    self.budget.visit(self.path.iter().map(String::len).sum())?;
                    let column = physical(node).filter(|_| !repeated).map(|physical| {
                        let name = self.path.join(".");
                        let heading = match unit(node, physical) {
                            Some(unit) if !self.has_clock => Heading::clock(&name, unit),
                            _ => Heading::named(name),
                        };
                        Column { leaf, heading, physical, levels }
                    });
                    self.has_clock |= column.as_ref().is_some_and(|c| c.heading.clock);
                    self.found.push(column);
                }
                below if self.path.len() < 16 => self.below(below, levels, repeated)?,
                _ => return Ok(()),
            }
            self.path.pop();
        }
        Ok(())
    }
}

fn physical(node: &Value<'_>) -> Option<Physical> {
    let (logical, converted) = (node.field(10), node.integer(6));
    let is = |id: i16| logical.is_some_and(|l| l.field(id).is_some());
    if is(5) || converted == Some(5) {
        return None;
    }
    let unsigned = matches!(converted, Some(11..=14))
        || logical.and_then(|l| l.field(10)).is_some_and(|i| i.field(2) == Some(&Value::Bool(false)));
    let whole = if unsigned { Kind::Unsigned } else { Kind::Signed };
    Some(match node.integer(1)? {
        0 => Physical::Bit,
        1 => Physical::Number(Element::little(whole, 4)),
        2 => Physical::Number(Element::little(whole, 8)),
        3 => Physical::Int96,
        4 => Physical::Number(Element::little(Kind::Float, 4)),
        5 => Physical::Number(Element::little(Kind::Float, 8)),
        7 if is(15) && node.integer(2) == Some(2) => Physical::Number(Element::little(Kind::Float, 2)),
        _ => return None,
    })
}

/// The unit of a column of dates.
fn unit(node: &Value<'_>, physical: Physical) -> Option<&'static str> {
    let stamp = node.field(10).and_then(|l| l.field(8)).and_then(|t| t.field(2));
    let of = |id: i16| stamp.is_some_and(|s| s.field(id).is_some());
    match (physical, node.integer(6)) {
        (Physical::Int96, _) => Some("ns"),
        _ if of(3) => Some("ns"),
        (_, Some(10)) => Some("us"),
        _ if of(2) => Some("us"),
        (_, Some(9)) => Some("ms"),
        _ if of(1) => Some("ms"),
        _ => None,
    }
}

fn chunk(input: &Input, chunk: &Value<'_>) -> Result<Chunk> {
    let fail = |words: String| -> Error { input.fail(words, DAMAGED) };
    let meta = chunk.field(3).ok_or_else(|| fail("expected the metadata of a column, found none".into()))?;
    if chunk.text(1).is_some() {
        return Err(input.fail("its columns lie in other files", "join them: read and write the table again"));
    }
    let codec = match meta.integer(4) {
        Some(0) => Ok(Codec::None),
        Some(1) => Ok(Codec::Snappy),
        Some(2) => Ok(Codec::Gzip),
        Some(6) => Ok(Codec::Zstandard),
        Some(7) => Ok(Codec::Lz4Block),
        Some(3) => Err("LZO"),
        Some(4) => Err("Brotli"),
        Some(5) => Err("Hadoop's LZ4"),
        _ => Err("a codec that is not known"),
    };
    let at = meta.size(9).ok_or_else(|| fail("expected the place of a column's pages, found none".into()))?;
    let dictionary = meta.size(11).filter(|d| *d > 0 && *d < at);
    Ok(Chunk { codec, at: dictionary.unwrap_or(at), values: meta.size(5).unwrap_or_default() })
}

impl Log for Parquet {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, _: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        let wanted = choice.places.iter().enumerate().map(|(target, place)| (Some(target), *place));
        let all = choice.time.map(|place| (None, place)).into_iter().chain(wanted);
        let columns = all
            .map(|(target, place)| {
                let column = self.columns[place].clone();
                let chunks: Option<Vec<Chunk>> = self.groups.iter().map(|g| g.1.get(column.leaf).cloned()).collect();
                let chunks =
                    chunks.ok_or_else(|| self.input.fail("expected every column in every row group", DAMAGED))?;
                Ok(column::Column::new(column.physical, column.levels, target, chunks))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Box::new(Columns::new(self.input, columns)))
    }
}
