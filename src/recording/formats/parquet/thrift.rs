//! Thrift's compact protocol, of which Parquet's metadata are made: apache.org/thrift, *compact
//! protocol*.

use crate::bytes::Bytes;

/// Structures within structures are followed so far.
const DEEPEST: usize = 16;

/// A value of a field.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value<'a> {
    /// True or false.
    Bool(bool),
    /// A whole number of any width.
    Integer(i64),
    /// A double.
    Double(f64),
    /// Text or bytes.
    Binary(&'a [u8]),
    /// A list or a set.
    List(Vec<Value<'a>>),
    /// Fields by their number.
    Struct(Vec<(i16, Value<'a>)>),
}

impl<'a> Value<'a> {
    /// A field of a structure.
    pub(super) fn field(&self, id: i16) -> Option<&Value<'a>> {
        match self {
            Self::Struct(fields) => fields.iter().find(|f| f.0 == id).map(|f| &f.1),
            _ => None,
        }
    }

    /// A whole number in a field.
    pub(super) fn integer(&self, id: i16) -> Option<i64> {
        match self.field(id)? {
            Self::Integer(value) => Some(*value),
            _ => None,
        }
    }

    /// One that is not negative.
    pub(super) fn size(&self, id: i16) -> Option<u64> {
        self.integer(id).and_then(|n| u64::try_from(n).ok())
    }

    /// Text in a field.
    pub(super) fn text(&self, id: i16) -> Option<String> {
        self.field(id)?.plain_text()
    }

    /// This as text.
    pub(super) fn plain_text(&self) -> Option<String> {
        match self {
            Self::Binary(bytes) => Some(String::from_utf8_lossy(bytes).into_owned()),
            _ => None,
        }
    }

    /// A list in a field; empty where there is none.
    pub(super) fn list(&self, id: i16) -> &[Value<'a>] {
        match self.field(id) {
            Some(Self::List(values)) => values,
            _ => &[],
        }
    }
}

/// Reads a structure; `None` where it is damaged.
pub(super) fn structure<'a>(bytes: &mut Bytes<'a>) -> Option<Value<'a>> {
    nested(bytes, 0)
}

fn varint(bytes: &mut Bytes<'_>) -> Option<u64> {
    let mut value = 0u64;
    for shift in (0..70).step_by(7) {
        let byte = bytes.u8()?;
        value |= u64::from(byte & 0x7f).checked_shl(shift).unwrap_or_default();
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

fn zigzag(bytes: &mut Bytes<'_>) -> Option<i64> {
    let n = varint(bytes)?;
    Some((n >> 1) as i64 ^ -((n & 1) as i64))
}

fn nested<'a>(bytes: &mut Bytes<'a>, depth: usize) -> Option<Value<'a>> {
    if depth > DEEPEST {
        return None;
    }
    let mut fields = Vec::new();
    let mut id = 0i16;
    loop {
        let head = bytes.u8()?;
        if head == 0 {
            return Some(Value::Struct(fields));
        }
        id = match head >> 4 {
            0 => i16::try_from(zigzag(bytes)?).ok()?,
            step => id.checked_add(i16::from(step))?,
        };
        let value = match head & 15 {
            1 => Value::Bool(true),
            2 => Value::Bool(false),
            kind => value(bytes, kind, depth)?,
        };
        fields.push((id, value));
    }
}

fn value<'a>(bytes: &mut Bytes<'a>, kind: u8, depth: usize) -> Option<Value<'a>> {
    Some(match kind {
        1 | 2 => Value::Bool(bytes.u8()? == 1),
        3 => Value::Integer(i64::from(bytes.u8()? as i8)),
        4..=6 => Value::Integer(zigzag(bytes)?),
        7 => Value::Double(bytes.array().map(f64::from_le_bytes)?),
        8 => {
            let length = usize::try_from(varint(bytes)?).ok()?;
            Value::Binary(bytes.take(length)?)
        }
        9 | 10 => {
            let head = bytes.u8()?;
            let count = match head >> 4 {
                15 => usize::try_from(varint(bytes)?).ok()?,
                few => usize::from(few),
            };
            // Each element takes a byte at least.
            if count > bytes.len() || depth > DEEPEST {
                return None;
            }
            Value::List((0..count).map(|_| value(bytes, head & 15, depth + 1)).collect::<Option<_>>()?)
        }
        11 => {
            let count = usize::try_from(varint(bytes)?).ok()?;
            if count > 0 {
                let kinds = bytes.u8()?;
                for _ in 0..count {
                    value(bytes, kinds >> 4, depth + 1).filter(|_| depth < DEEPEST)?;
                    value(bytes, kinds & 15, depth + 1)?;
                }
            }
            Value::List(Vec::new())
        }
        12 => nested(bytes, depth + 1)?,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_structure_is_read_and_a_broken_one_is_none() {
        // Field 1 = i32 -2 (zigzag 3), field 3 = "ab", field 4 = list of two i32 (1, 2), stop.
        let bytes = [0x15, 3, 0x28, 2, b'a', b'b', 0x19, 0x25, 2, 4, 0];
        let value = structure(&mut Bytes::new(&bytes)).expect("a structure");
        assert_eq!((value.integer(1), value.text(3).as_deref(), value.list(4).len()), (Some(-2), Some("ab"), 2));
        for cut in 0..bytes.len() {
            assert_eq!(structure(&mut Bytes::new(&bytes[..cut])), None, "{cut}");
        }
        assert_eq!(structure(&mut Bytes::new(&[0x1c; 100])), None, "nested without end");
    }
}
