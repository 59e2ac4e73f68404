//! Headers of the pages of a Parquet column.

use super::thrift::Value;

/// Holds what the header of a page says.
pub(super) struct PageHeader {
    pub kind: i64,
    pub size: u64,
    pub stored: u64,
    pub values: usize,
    pub encoding: i64,
    /// Bytes of levels before the values, and of those that repeat among them, in pages of
    /// version 2.
    pub levels: usize,
    pub repetition: usize,
    pub is_packed: bool,
    /// Of its bytes as they are stored, where the writer states it.
    pub crc32: Option<u32>,
}

impl PageHeader {
    /// Reads it; `None` where a field that it must have is not there.
    pub(super) fn of(header: &Value<'_>) -> Option<Self> {
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
            crc32: header.integer(4).map(|n| n as u32),
            is_packed: inner.field(7) != Some(&Value::Bool(false)),
        })
    }
}
