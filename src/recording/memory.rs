//! Arrays that are in memory already, read as those of a file are and where they lie: nothing of
//! them is copied but the block at hand.

use std::path::Path;
use std::sync::Arc;

use super::array::{Array, Arrays, Field, Packing, Place, Shape};
use super::budget::Budget;
use super::element::{Element, Kind};
use super::in_memory::Column;
use super::input::{Bytes, Input};
use crate::error::{Error, Result};

/// An array of numbers in memory.
#[derive(Clone)]
pub struct Numbers {
    /// Names of its columns; none: 1, 2, ….
    pub names: Vec<String>,
    /// Type and width of its numbers.
    pub element: Element,
    /// Number of rows and columns.
    pub shape: Shape,
    /// The numbers themselves, one behind the other.
    pub bytes: Bytes,
}

/// A recording in memory, in place of a file.
#[derive(Debug, Clone)]
pub struct Memory {
    input: Input,
    arrays: Vec<Array>,
}

/// Two are the same where they are the same place in memory.
impl PartialEq for Memory {
    fn eq(&self, other: &Self) -> bool {
        self.input.is(&other.input)
    }
}

struct Doubles(Vec<f64>);

impl AsRef<[u8]> for Doubles {
    fn as_ref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }
}

impl Memory {
    /// A table of arrays of one length, side by side; `name` stands for it in messages.
    ///
    /// # Errors
    /// No numbers, arrays of different lengths, as many names as there are no columns, bytes that
    /// are too few.
    pub fn new(name: &Path, numbers: Vec<Numbers>) -> Result<Self> {
        let fail = |cause: String| {
            let hint = "give arrays of one length, a row per sample and a column per channel";
            Err(Error::new(format!("could not use {}", name.display()), cause, hint))
        };
        let (mut arrays, mut parts, mut at): (Vec<Array>, Vec<Bytes>, u64) = (Vec::new(), Vec::new(), 0);
        let mut budget = Budget::of(0);
        for one in numbers {
            let stored = (*one.bytes).as_ref().len() as u64;
            let place = Place { at, stored, packing: Packing::None, skip: 0, crc32: None };
            let array = match Array::plain("", one.element, one.shape, place, &mut budget) {
                Ok(array) => array,
                Err(spent) => return fail(spent.words()),
            };
            let Some(mut array) = array.filter(|a| a.bytes() <= stored) else {
                return fail(format!("need rows of numbers, got {} × {}", one.shape.rows, one.shape.columns));
            };
            if !one.names.is_empty() && one.names.len() != array.fields.len() {
                return fail(format!("{} names are given for {} columns", one.names.len(), array.fields.len()));
            }
            let renamed = array.fields.iter_mut().zip(&one.names);
            renamed.for_each(|(field, name): (&mut Field, _)| field.name.clone_from(name));
            if let Some(first) = arrays.first().filter(|first| first.rows != array.rows) {
                return fail(format!("one column has {} rows, another {}", first.rows, array.rows));
            }
            at += stored;
            arrays.push(array);
            parts.push(one.bytes);
        }
        if arrays.is_empty() {
            return fail("there is no column of numbers".into());
        }
        Ok(Self { input: Input::of_parts(name, parts), arrays })
    }

    /// Columns of doubles.
    ///
    /// # Errors
    /// As [`Memory::new`].
    pub fn of_columns(name: &Path, columns: Vec<Column>) -> Result<Self> {
        let element = Element { kind: Kind::Float, bytes: 8, big_endian: cfg!(target_endian = "big") };
        let numbers = columns.into_iter().map(|column| Numbers {
            names: vec![column.name],
            element,
            shape: Shape { rows: column.values.len() as u64, columns: 1, in_columns: false },
            bytes: Arc::new(Doubles(column.values)),
        });
        Self::new(name, numbers.collect())
    }

    /// Its bytes as a file's, and its arrays.
    pub(super) fn opened(&self) -> (Input, Arrays) {
        (self.input.clone(), Arrays::new(&self.input, self.arrays.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{self as recording, Request};

    fn column(name: &str, values: Vec<f64>) -> Column {
        Column { name: name.into(), values }
    }

    #[test]
    fn it_is_read_as_the_same_numbers_in_a_file_are() {
        let hole = |i: usize, value: f64| if i == 700 { f64::NAN } else { value };
        let values = |scale: f64| (0..5000).map(|i| hole(i, scale * (i as f64).sin())).collect::<Vec<f64>>();
        let columns = vec![column("ax", values(1.0)), column("ay", values(2.0))];
        let lines = columns[0].values.iter().zip(&columns[1].values);
        let cell = |v: &f64| if v.is_nan() { String::new() } else { v.to_string() };
        let text: String = lines.map(|(x, y)| format!("{},{}\n", cell(x), cell(y))).collect();
        let file = tempfile::NamedTempFile::new().expect("file");
        std::fs::write(file.path(), format!("ax,ay\n{text}")).expect("written");
        let request = Request { rate_hz: Some(100.0), ..Request::default() };
        let from_file = recording::read(file.path(), &request).expect("a table");

        let memory = Memory::of_columns(Path::new("the array"), columns).expect("a table");
        let request = Request { memory: Some(memory), ..request };
        let from_memory = recording::read(Path::new("the array"), &request).expect("a table");
        assert_eq!(from_memory.columns, from_file.columns);
        assert_eq!((&from_memory.findings, from_memory.rows), (&from_file.findings, from_file.rows));
        assert!(!from_memory.findings.is_empty(), "the hole is said");
    }

    #[test]
    fn what_is_no_table_is_refused() {
        let name = Path::new("the array");
        let unequal = vec![column("a", vec![1.0, 2.0]), column("b", vec![1.0])];
        assert!(Memory::of_columns(name, unequal).is_err_and(|e| e.cause.contains("another 1")));
        assert!(Memory::of_columns(name, vec![column("a", Vec::new())]).is_err());
        assert!(Memory::of_columns(name, Vec::new()).is_err());
    }
}
