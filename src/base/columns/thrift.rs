//! Thrift's compact protocol, written: of it Parquet's metadata are made
//! (apache.org/thrift, *compact protocol*).

/// A value of a field.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    /// A whole number of 32 bits.
    Int(i32),
    /// A whole number of 64 bits.
    Long(i64),
    /// A string, UTF-8.
    Text(String),
    /// A list of values of one kind.
    List(Vec<Value>),
    /// Fields by their numbers, which rise.
    Struct(Vec<(i16, Value)>),
}

impl Value {
    /// The kind's number in the protocol.
    fn kind(&self) -> u8 {
        match self {
            Self::Int(_) => 5,
            Self::Long(_) => 6,
            Self::Text(_) => 8,
            Self::List(_) => 9,
            Self::Struct(_) => 12,
        }
    }

    /// Appends the value's bytes.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        match self {
            Self::Int(value) => zigzag(out, i64::from(*value)),
            Self::Long(value) => zigzag(out, *value),
            Self::Text(text) => {
                varint(out, text.len() as u64);
                out.extend(text.as_bytes());
            }
            Self::List(values) => {
                let kind = values.first().map_or(5, Self::kind);
                match values.len() {
                    few @ 0..15 => out.push((few as u8) << 4 | kind),
                    many => {
                        out.push(0xf0 | kind);
                        varint(out, many as u64);
                    }
                }
                values.iter().for_each(|value| value.write(out));
            }
            Self::Struct(fields) => {
                let mut before = 0;
                for (id, value) in fields {
                    // Steps of up to 15 share a byte with the kind; Parquet's fields take no longer
                    // ones.
                    out.push(((id - before) as u8) << 4 | value.kind());
                    value.write(out);
                    before = *id;
                }
                out.push(0);
            }
        }
    }
}

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn zigzag(out: &mut Vec<u8>, value: i64) {
    varint(out, ((value << 1) ^ (value >> 63)) as u64);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_structure_has_the_bytes_of_the_protocol() {
        // Field 1 = i32 -2 (zigzag 3), field 3 = "ab", field 4 = list of two i32 (1, 2), stop.
        let list = Value::List(vec![Value::Int(1), Value::Int(2)]);
        let value = Value::Struct(vec![(1, Value::Int(-2)), (3, Value::Text("ab".into())), (4, list)]);
        let mut bytes = Vec::new();
        value.write(&mut bytes);
        assert_eq!(bytes, [0x15, 3, 0x28, 2, b'a', b'b', 0x19, 0x25, 2, 4, 0]);
    }
}
