//! Rows of an SQLite table: sqlite.org/fileformat2.html, *Record Format*.

use crate::bytes::Bytes;

/// No table of SQLite has more columns: sqlite.org/limits.html.
const MOST_COLUMNS: usize = 32_767;

/// A number of one to nine bytes, the highest first.
pub(crate) fn varint(bytes: &mut Bytes<'_>) -> Option<u64> {
    let mut value = 0u64;
    for i in 0..9 {
        let byte = bytes.u8()?;
        if i == 8 {
            return Some((value << 8) | u64::from(byte));
        }
        value = (value << 7) | u64::from(byte & 0x7f);
        if byte & 0x80 == 0 {
            break;
        }
    }
    Some(value)
}

/// A row of a table.
pub(crate) struct Record<'a> {
    row: i64,
    /// Type and place of each value.
    values: Vec<(u64, &'a [u8])>,
}

impl<'a> Record<'a> {
    /// Takes a record apart; what is damaged ends it.
    pub(super) fn new(payload: &'a [u8], row: i64) -> Self {
        let mut values = Vec::new();
        let mut head = Bytes::new(payload);
        let size = varint(&mut head).map_or(0, |s| usize::try_from(s).unwrap_or(usize::MAX));
        let mut body = Bytes::new(payload.get(size..).unwrap_or_default());
        while head.taken() < size && values.len() < MOST_COLUMNS {
            let Some(kind) = varint(&mut head) else { break };
            let length = match kind {
                0..=4 => kind,
                5 => 6,
                6 | 7 => 8,
                8..=11 => 0,
                _ => (kind - 12) / 2,
            };
            let Some(value) = usize::try_from(length).ok().and_then(|l| body.take(l)) else { break };
            values.push((kind, value));
        }
        Self { row, values }
    }

    /// A whole number; the row's own where the column stands for it.
    pub(super) fn integer(&self, column: usize) -> Option<i64> {
        let (kind, bytes) = self.values.get(column)?;
        match kind {
            0 => Some(self.row),
            1..=6 => {
                let negative = bytes.first().is_some_and(|b| b & 0x80 != 0);
                Some(bytes.iter().fold(if negative { -1 } else { 0 }, |sum: i64, b| (sum << 8) | i64::from(*b)))
            }
            8 => Some(0),
            9 => Some(1),
            _ => None,
        }
    }

    pub(super) fn bytes(&self, column: usize) -> Option<&'a [u8]> {
        self.values.get(column).filter(|v| v.0 >= 12).map(|v| v.1)
    }

    pub(super) fn text(&self, column: usize) -> Option<String> {
        self.bytes(column).map(|b| String::from_utf8_lossy(b).into_owned())
    }
}
