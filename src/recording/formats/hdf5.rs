//! HDF5, also MATLAB's `.mat` of version 7.3: datasets of numbers in one or two dimensions, by the
//! HDF5 library, which must be installed: the feature `hdf5` is not a default one.
//!
//! The numbers are copied once into an unnamed temporary file, where they are read like any other
//! arrays; memory stays constant. Not for references, compound types or more than two dimensions:
//! they are passed over.

use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;

use hdf5_metno::types::{FloatSize, IntSize, TypeDescriptor};
use hdf5_metno::{Dataset, File, Group, H5Type, Hyperslab};

use crate::array::{Array, Arrays, Packing, Place, Shape};
use crate::budget::{Budget, ENTRY_BYTES, Spent};
use crate::element::{Element, Kind};
use crate::error::Result;
use crate::input::Input;
use crate::reader::Log;

/// Groups within groups are followed so far.
const DEEPEST: usize = 8;
/// Bytes that are read at once.
const PIECE_BYTES: usize = 1 << 20;

/// Opens a file.
///
/// # Errors
/// A damaged file, one that is packed or on standard input, or one without datasets of numbers.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    if input.path == Path::new("-") || input.stored_length() != input.length() {
        return Err(
            input.fail("the HDF5 library reads files only, not what is packed or piped", "unpack it into a file")
        );
    }
    let failed = |e: hdf5_metno::Error| {
        input
            .fail(format!("the HDF5 library says: {e}"), "it is cut short or damaged: copy it again, or write it again")
    };
    let file = File::open(&input.path).map_err(failed)?;
    let mut budget = Budget::of(input.length());
    let mut tables = Vec::new();
    gather(&file, 0, &mut tables, &mut budget).map_err(failed)?;
    let (mut arrays, mut copied, mut at) = (Vec::new(), VecDeque::new(), 0);
    for table in tables {
        let bytes = (table.rows * table.columns * table.element.bytes) as u64;
        let place = Place { at, stored: bytes, packing: Packing::None, skip: 0, crc32: None };
        let shape = Shape { rows: table.rows as u64, columns: table.columns as u64, in_columns: false };
        let array = Array::plain(&table.name, table.element, shape, place, &mut budget);
        if let Some(array) = array.map_err(|spent| spent.of(input))? {
            // What was never written takes no room in the file, and all of it in a copy.
            budget.unpacked(bytes).map_err(|spent| spent.of(input))?;
            arrays.push(array);
            copied.push_back(table);
            at += bytes;
        }
    }
    if arrays.is_empty() {
        return Err(
            input.fail("the HDF5 file holds no dataset of numbers in one or two dimensions", "write one with h5py")
        );
    }
    let mut numbers = Numbers { tables: copied, row: 0, ready: Vec::new(), given: 0 };
    let copy = input.unpacked_by(&mut numbers).map_err(|e| {
        input.fail(
            format!("its numbers cannot be copied to a temporary file: {e}"),
            "is the disk full, or the file damaged?",
        )
    })?;
    Ok(Box::new(Arrays::new(&copy, arrays)))
}

/// A dataset of numbers.
struct Table {
    name: String,
    dataset: Dataset,
    element: Element,
    rows: usize,
    columns: usize,
    flat: bool,
}

/// Datasets of a group and of those in it, by the last part of their names.
/// Groups may hold one another: each is charged where it is met.
fn gather(group: &Group, depth: usize, into: &mut Vec<Table>, budget: &mut Budget) -> hdf5_metno::Result<()> {
    let refused = |spent: Spent| hdf5_metno::Error::from(spent.words());
    for dataset in group.datasets()? {
        budget.visit(ENTRY_BYTES + dataset.name().len()).map_err(refused)?;
        let (rows, columns, flat) = match dataset.shape()[..] {
            [rows] => (rows, 1, true),
            [rows, columns] => (rows, columns, false),
            _ => continue,
        };
        let Some(element) = dataset.dtype()?.to_descriptor().ok().as_ref().and_then(element) else { continue };
        // Sizes whose bytes cannot be counted are none of a recording.
        if rows.checked_mul(columns).and_then(|n| n.checked_mul(8)).is_some_and(|n| n > 0) {
            let name = dataset.name().rsplit('/').next().unwrap_or_default().to_owned();
            into.push(Table { name, dataset, element, rows, columns, flat });
        }
    }
    if depth < DEEPEST {
        for inner in group.groups()? {
            budget.visit(ENTRY_BYTES).map_err(refused)?;
            gather(&inner, depth + 1, into, budget)?;
        }
    }
    Ok(())
}

/// Whole numbers keep 64 bits, so that stamps in nanoseconds stay exact; the library converts what
/// is narrower.
fn element(descriptor: &TypeDescriptor) -> Option<Element> {
    let kind = match descriptor {
        TypeDescriptor::Integer(_) => Kind::Signed,
        TypeDescriptor::Unsigned(IntSize::U8) => Kind::Unsigned,
        TypeDescriptor::Unsigned(_) => Kind::Signed,
        TypeDescriptor::Float(FloatSize::U4 | FloatSize::U8) => Kind::Float,
        _ => return None,
    };
    Some(Element::little(kind, 8))
}

/// The numbers of all datasets one behind the other, row by row, eight bytes each, lowest first.
struct Numbers {
    tables: VecDeque<Table>,
    row: usize,
    ready: Vec<u8>,
    given: usize,
}

impl Numbers {
    /// Reads the next rows; false at the end.
    fn fill(&mut self) -> hdf5_metno::Result<bool> {
        let Some(table) = self.tables.front() else { return Ok(false) };
        let count = (PIECE_BYTES / (8 * table.columns)).clamp(1, table.rows - self.row);
        let rows = self.row..self.row + count;
        self.ready = match table.element.kind {
            Kind::Float => slab::<f64>(table, rows)?.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Kind::Signed => slab::<i64>(table, rows)?.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Kind::Unsigned => slab::<u64>(table, rows)?.iter().flat_map(|v| v.to_le_bytes()).collect(),
        };
        self.given = 0;
        self.row += count;
        if self.row == table.rows {
            self.row = 0;
            self.tables.pop_front();
        }
        Ok(true)
    }
}

fn slab<T: H5Type + Clone>(table: &Table, rows: std::ops::Range<usize>) -> hdf5_metno::Result<Vec<T>> {
    Ok(if table.flat {
        table.dataset.read_slice_1d::<T, _>(rows)?.into_iter().collect()
    } else {
        table.dataset.read_slice_2d::<T, _>(Hyperslab::from(vec![rows.into(), (..).into()]))?.into_iter().collect()
    })
}

impl Read for Numbers {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.given == self.ready.len() && !self.fill().map_err(std::io::Error::other)? {
            return Ok(0);
        }
        let mut rest = &self.ready[self.given..];
        let count = rest.read(buffer)?;
        self.given += count;
        Ok(count)
    }
}
