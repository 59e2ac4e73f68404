//! Named columns of equal length, and the files that the next tool reads them from: CSV, Parquet
//! and NPY.
//!
//! Not for reading: recordings come in through `recording`.

mod csv;
mod npy;
mod parquet;
mod table;
mod thrift;

pub use table::{Column, Columns, Values};

/// A file of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values with one row of headings; a missing number is an empty cell, and
    /// every other one reads back as the same `f64`.
    Csv,
    /// Apache Parquet: doubles and UTF-8 strings without compression; missing numbers are nulls.
    Parquet,
    /// A NumPy array, rows × columns of numbers; headings and words are lost, missing numbers are
    /// NaN.
    Npy,
}

impl Format {
    /// That of a file name's ending, in any case.
    pub fn of(ending: &str) -> Option<Self> {
        match ending.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "parquet" => Some(Self::Parquet),
            "npy" => Some(Self::Npy),
            _ => None,
        }
    }

    /// The table as the bytes of a file in this format.
    pub fn bytes(self, table: &Columns) -> Vec<u8> {
        match self {
            Self::Csv => csv::text(table).into_bytes(),
            Self::Parquet => parquet::bytes(table),
            Self::Npy => npy::bytes(table),
        }
    }
}
