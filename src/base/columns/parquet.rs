//! Columns as an Apache Parquet file: parquet.apache.org/docs/file-format.
//!
//! The plainest that every reader takes: data pages of version 1, plain encoding, no compression,
//! no dictionary.

use super::table::{Column, Columns, Values};
use super::thrift::Value;

/// Rows of a row group; each of its columns is one page.
const GROUP: usize = 1 << 17;
const MAGIC: &[u8; 4] = b"PAR1";
const DOUBLE: i32 = 5;
const BYTE_ARRAY: i32 = 6;
const PLAIN: i32 = 0;
const RLE: i32 = 3;

pub(crate) fn bytes(table: &Columns) -> Vec<u8> {
    let rows = table.rows();
    let mut out = MAGIC.to_vec();
    let mut groups = Vec::new();
    for from in (0..rows).step_by(GROUP) {
        let to = rows.min(from + GROUP);
        let begun = out.len();
        let chunks: Vec<Value> = table.all().iter().map(|column| chunk(&mut out, column, from, to)).collect();
        let bytes = (out.len() - begun) as i64;
        let fields = vec![(1, Value::List(chunks)), (2, Value::Long(bytes)), (3, Value::Long((to - from) as i64))];
        groups.push(Value::Struct(fields));
    }
    let root = Value::Struct(vec![(4, Value::Text("columns".into())), (5, Value::Int(table.all().len() as i32))]);
    let schema = std::iter::once(root).chain(table.all().iter().map(leaf)).collect();
    let meta = Value::Struct(vec![
        (1, Value::Int(1)),
        (2, Value::List(schema)),
        (3, Value::Long(rows as i64)),
        (4, Value::List(groups)),
        (6, Value::Text(format!("proofmass {}", env!("CARGO_PKG_VERSION")))),
    ]);
    let begun = out.len();
    meta.write(&mut out);
    let length = (out.len() - begun) as u32;
    out.extend(length.to_le_bytes());
    out.extend(MAGIC);
    out
}

fn physical(values: &Values) -> i32 {
    match values {
        Values::Numbers(_) => DOUBLE,
        Values::Words(_) => BYTE_ARRAY,
    }
}

/// A column in the schema; every one may miss values.
fn leaf(column: &Column) -> Value {
    let mut fields =
        vec![(1, Value::Int(physical(&column.values))), (3, Value::Int(1)), (4, Value::Text(column.name.clone()))];
    if let Values::Words(_) = column.values {
        fields.push((6, Value::Int(0)));
        fields.push((10, Value::Struct(vec![(1, Value::Struct(Vec::new()))])));
    }
    Value::Struct(fields)
}

/// Writes the rows `from..to` of a column as a page, and gives its metadata.
fn chunk(out: &mut Vec<u8>, column: &Column, from: usize, to: usize) -> Value {
    let offset = out.len() as i64;
    let (present, values) = match &column.values {
        Values::Numbers(all) => {
            let value = |row: usize| all.get(row).filter(|v| v.is_finite());
            let present: Vec<bool> = (from..to).map(|row| value(row).is_some()).collect();
            (present, (from..to).filter_map(value).flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
        }
        Values::Words(all) => {
            let present = (from..to).map(|row| row < all.len()).collect();
            let texts = all.iter().take(to).skip(from);
            let sized = |text: &String| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
            (present, texts.flat_map(sized).collect())
        }
    };
    let page = [levels(&present), values].concat();
    let size = Value::Int(page.len() as i32);
    let count = (to - from) as i32;
    let data =
        Value::Struct(vec![(1, Value::Int(count)), (2, Value::Int(PLAIN)), (3, Value::Int(RLE)), (4, Value::Int(RLE))]);
    Value::Struct(vec![(1, Value::Int(0)), (2, size.clone()), (3, size), (5, data)]).write(out);
    out.extend(page);
    let bytes = Value::Long(out.len() as i64 - offset);
    let meta = Value::Struct(vec![
        (1, Value::Int(physical(&column.values))),
        (2, Value::List(vec![Value::Int(PLAIN), Value::Int(RLE)])),
        (3, Value::List(vec![Value::Text(column.name.clone())])),
        (4, Value::Int(0)),
        (5, Value::Long(i64::from(count))),
        (6, bytes.clone()),
        (7, bytes),
        (9, Value::Long(offset)),
    ]);
    Value::Struct(vec![(2, Value::Long(offset)), (3, meta)])
}

/// Definition levels: a bit a row, bit-packed in groups of eight, with the length in front.
fn levels(present: &[bool]) -> Vec<u8> {
    let groups = present.len().div_ceil(8);
    let mut packed = Vec::new();
    let mut header = (groups as u64) << 1 | 1;
    while header >= 0x80 {
        packed.push(header as u8 | 0x80);
        header >>= 7;
    }
    packed.push(header as u8);
    packed.extend(present.chunks(8).map(|c| c.iter().enumerate().fold(0u8, |b, (i, p)| b | u8::from(*p) << i)));
    [&(packed.len() as u32).to_le_bytes()[..], &packed].concat()
}
