//! Columns as comma-separated values (RFC 4180, line feeds).

use std::borrow::Cow;
use std::fmt::Write;

use super::table::{Columns, Values};
use crate::escape::line;

/// The table as CSV text: a header row, then a line per row.
pub(crate) fn text(table: &Columns) -> String {
    let mut out = String::new();
    let headings: Vec<Cow<'_, str>> = table.all().iter().map(|c| cell(&c.name)).collect();
    out += &headings.join(",");
    out.push('\n');
    for row in 0..table.rows() {
        for (place, column) in table.all().iter().enumerate() {
            if place > 0 {
                out.push(',');
            }
            match &column.values {
                Values::Numbers(values) => {
                    if let Some(value) = values.get(row).filter(|v| v.is_finite()) {
                        // Writing into a string cannot fail.
                        let _ = write!(out, "{value:?}");
                    }
                }
                Values::Words(values) => out += &values.get(row).map_or(Cow::Borrowed(""), |v| cell(v)),
            }
        }
        out.push('\n');
    }
    out
}

/// A cell, in quotation marks where it must be.
fn cell(text: &str) -> Cow<'_, str> {
    let text = line(text);
    match text.contains([',', '"']) {
        true => Cow::Owned(format!("\"{}\"", text.replace('"', "\"\""))),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_they_were_and_missing_ones_are_empty() {
        let mut table = Columns::default();
        let values = [0.1 + 0.2, f64::NAN, -5e-324, 1e300];
        table.numbers("a_m", values.to_vec());
        table.numbers("a_m", vec![1.0]);
        table.words("what", ["a,b", "a \"b\"", "", "line\nbreak"].map(str::to_owned).to_vec());
        let text = text(&table);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "a_m,a_m_2,what");
        assert_eq!(lines[1].split(',').next().and_then(|c| c.parse().ok()), Some(values[0]));
        assert_eq!(lines[2], ",,\"a \"\"b\"\"\"");
        assert_eq!(lines[3].split(',').next().and_then(|c| c.parse().ok()), Some(values[2]));
        assert!(lines[1].ends_with("1.0,\"a,b\"") && lines[4].ends_with(",,line\\u000abreak"));
    }
}
