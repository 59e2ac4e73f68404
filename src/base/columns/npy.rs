//! Columns as a NumPy array file, version 1.0 (numpy.org, *NPY format*): doubles, rows × columns,
//! headings lost.

use super::table::{Columns, Values};

/// Its beginning: the magic word and the version.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// The columns of numbers, side by side; missing ones are NaN.
pub(crate) fn bytes(table: &Columns) -> Vec<u8> {
    let numbers: Vec<&Vec<f64>> = table
        .all()
        .iter()
        .filter_map(|column| match &column.values {
            Values::Numbers(values) => Some(values),
            Values::Words(_) => None,
        })
        .collect();
    let shape = format!("({}, {})", table.rows(), numbers.len());
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    // With its length and a line feed at the end, the header fills a multiple of 64 bytes.
    let before = MAGIC.len() + 2;
    let padded = (before + header.len() + 1).next_multiple_of(64) - before;
    let header = format!("{header:<width$}\n", width = padded - 1);
    let mut out = MAGIC.to_vec();
    out.extend((header.len() as u16).to_le_bytes());
    out.extend(header.as_bytes());
    for row in 0..table.rows() {
        numbers.iter().for_each(|n| out.extend(n.get(row).copied().unwrap_or(f64::NAN).to_le_bytes()));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_is_aligned_and_rows_follow_each_other() {
        let mut table = Columns::default();
        table.numbers("a", vec![1.0, 2.0]);
        table.numbers("b", vec![3.0]);
        let bytes = bytes(&table);
        let length = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
        assert_eq!((10 + length) % 64, 0);
        let numbers: Vec<f64> =
            bytes[10 + length..].as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        assert!(numbers[..3] == [1.0, 3.0, 2.0] && numbers[3].is_nan() && numbers.len() == 4);
    }
}
