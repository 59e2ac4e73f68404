//! FlatBuffers, of which Arrow's metadata are made: google.github.io/flatbuffers, *internals*.

/// A table within a buffer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table<'a> {
    bytes: &'a [u8],
    at: usize,
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}

fn u16_at(bytes: &[u8], at: usize) -> Option<usize> {
    array(bytes, at).map(|b| usize::from(u16::from_le_bytes(b)))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    array(bytes, at).map(|b| u32::from_le_bytes(b) as usize)
}

impl<'a> Table<'a> {
    /// The root of a buffer.
    pub(super) fn root(bytes: &'a [u8]) -> Option<Self> {
        Some(Self { bytes, at: u32_at(bytes, 0)? })
    }

    /// Place of a field's value.
    fn field(&self, index: usize) -> Option<usize> {
        let back = i32::from_le_bytes(array(self.bytes, self.at)?);
        let table = usize::try_from(i64::try_from(self.at).ok()? - i64::from(back)).ok()?;
        let size = u16_at(self.bytes, table)?;
        let entry = 4 + 2 * index;
        if entry + 2 > size {
            return None;
        }
        let offset = u16_at(self.bytes, table.checked_add(entry)?)?;
        (offset > 0).then_some(self.at + offset)
    }

    fn target(&self, index: usize) -> Option<usize> {
        let at = self.field(index)?;
        at.checked_add(u32_at(self.bytes, at)?)
    }

    /// A byte; `or` where the field is left out.
    pub(super) fn u8(&self, index: usize, or: u8) -> u8 {
        self.field(index).and_then(|at| self.bytes.get(at).copied()).unwrap_or(or)
    }

    /// A number of 16 bits.
    pub(super) fn i16(&self, index: usize) -> i16 {
        self.field(index).and_then(|at| array(self.bytes, at)).map_or(0, i16::from_le_bytes)
    }

    /// A number of 32 bits.
    pub(super) fn i32(&self, index: usize) -> i32 {
        self.field(index).and_then(|at| array(self.bytes, at)).map_or(0, i32::from_le_bytes)
    }

    /// A number of 64 bits.
    pub(super) fn i64(&self, index: usize) -> i64 {
        self.field(index).and_then(|at| array(self.bytes, at)).map_or(0, i64::from_le_bytes)
    }

    /// A table within.
    pub(super) fn table(&self, index: usize) -> Option<Self> {
        self.target(index).map(|at| Self { bytes: self.bytes, at })
    }

    /// Text.
    pub(super) fn text(&self, index: usize) -> Option<String> {
        let at = self.target(index)?;
        let bytes = self.bytes.get(at + 4..)?.get(..u32_at(self.bytes, at)?)?;
        Some(String::from_utf8_lossy(bytes).into_owned())
    }

    /// Structures of this many bytes, one after the other.
    pub(super) fn structures(&self, index: usize, bytes: usize) -> Option<std::slice::ChunksExact<'a, u8>> {
        let at = self.target(index)?;
        let count = u32_at(self.bytes, at)?;
        Some(self.bytes.get(at + 4..)?.get(..count.checked_mul(bytes)?)?.chunks_exact(bytes))
    }

    /// Returns how many entries a list says that it has.
    pub(super) fn length(&self, index: usize) -> usize {
        self.target(index).and_then(|at| u32_at(self.bytes, at)).unwrap_or_default()
    }

    /// Tables in a list; none where there is no list.
    pub(super) fn tables(&self, index: usize) -> Vec<Table<'a>> {
        let places = || -> Option<Vec<Table<'a>>> {
            let begin = self.target(index)?.checked_add(4)?;
            let each = self.structures(index, 4)?;
            each.enumerate()
                .map(|(i, offset)| {
                    let at = (begin + 4 * i).checked_add(u32::from_le_bytes(offset.try_into().ok()?) as usize)?;
                    Some(Table { bytes: self.bytes, at })
                })
                .collect()
        };
        places().unwrap_or_default()
    }
}

/// A number of 64 bits within a structure.
pub(super) fn i64_of(bytes: &[u8], at: usize) -> i64 {
    array(bytes, at).map_or(0, i64::from_le_bytes)
}
