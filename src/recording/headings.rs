//! Names of the columns, and what to say of one that is not there.

use std::collections::HashMap;

use super::cells::Cells;
use super::reader::Heading;
use crate::error::nearest;

/// Headings compared with one that is not there: more would take seconds.
const COMPARED: usize = 100_000;

/// The headings of a file, in order.
#[derive(Debug, Clone)]
pub struct Headings {
    /// The names as written, without quotation marks and blanks around them.
    pub names: Vec<String>,
    /// Unit of each, where the file states it: in brackets, in a row of its own, or by its format.
    pub units: Vec<Option<String>>,
    /// Place of each name; `None` where two columns bear it.
    places: HashMap<String, Option<usize>>,
    counted: bool,
}

impl Headings {
    /// The first cells of a line.
    pub fn new(cells: &Cells, line: &[u8], width: usize) -> Self {
        let name = |i| {
            let text = text(cells.of(line, i));
            // Between quotation marks, a doubled one stands for itself.
            let quoted = cells.place(i).start.checked_sub(1).is_some_and(|before| line[before] == b'"');
            if quoted { text.replace("\"\"", "\"").trim().to_owned() } else { text.trim().trim_matches('"').to_owned() }
        };
        Self::of((0..width).map(name).collect(), false)
    }

    /// 1, 2, 3, … for a file without a header.
    pub fn counted(width: usize) -> Self {
        Self::of((1..=width).map(|n| n.to_string()).collect(), true)
    }

    fn of(names: Vec<String>, counted: bool) -> Self {
        let mut places = HashMap::with_capacity(names.len());
        for (place, name) in names.iter().enumerate() {
            places.entry(name.clone()).and_modify(|p| *p = None).or_insert(Some(place));
        }
        let units = names.iter().map(|name| bracketed(name)).collect();
        Self { names, units, places, counted }
    }

    /// Those that a format states, with their units.
    pub fn stated(columns: &[Heading]) -> Self {
        let mut headings = Self::of(columns.iter().map(|c| c.name.clone()).collect(), false);
        for (unit, column) in headings.units.iter_mut().zip(columns) {
            *unit = column.unit.clone().or(unit.take());
        }
        headings
    }

    /// Those of a file without any, of a kind whose columns are known.
    pub fn known(names: &[&str]) -> Self {
        Self::of(names.iter().map(|n| (*n).to_owned()).collect(), false)
    }

    /// Heading of a clock, with its unit where the file states it elsewhere.
    pub fn clock_heading(&self, place: usize) -> String {
        let name = &self.names[place];
        match &self.units[place] {
            Some(unit) if bracketed(name).is_none() => format!("{name} [{unit}]"),
            _ => name.clone(),
        }
    }

    /// Place of a column: by its heading, or by what stands before a unit in brackets.
    ///
    /// # Errors
    /// No such column, or two: cause and hint.
    pub fn place(&self, wanted: &str) -> Result<usize, (String, String)> {
        let known = self.places.get(wanted).or_else(|| self.places.get(wanted.strip_prefix('#')?));
        match known {
            Some(Some(place)) => return Ok(*place),
            Some(None) => {
                return Err((format!("two columns are called `{wanted}`"), "give each column its own heading".into()));
            }
            None => {}
        }
        let stem = |name: &str| name.split(['[', '(']).next().unwrap_or_default().trim() == wanted;
        let mut alike = self.names.iter().enumerate().filter(|(_, n)| n.len() > wanted.len() && stem(n));
        match (alike.next(), alike.next()) {
            (Some((place, _)), None) if !wanted.is_empty() => Ok(place),
            _ => Err((format!("there is no column `{wanted}`"), self.instead_of(wanted))),
        }
    }

    fn instead_of(&self, wanted: &str) -> String {
        if self.counted {
            return format!(
                "its first line holds numbers, not headings: its columns are called 1 to {}",
                self.names.len()
            );
        }
        if let [only] = &self.names[..] {
            return format!(
                "its only column is `{}`; columns are separated by commas, semicolons or tabs",
                shortened(only)
            );
        }
        let known = self.names.iter().take(COMPARED).map(String::as_str);
        match nearest(wanted, known.clone()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("it has: {}", known.take(40).map(shortened).collect::<Vec<_>>().join(", ")),
        }
    }
}

/// Bytes as text: UTF-8, else Latin-1, in which older programs write `m/s²` and `°/s`.
pub(super) fn text(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(|b| char::from(*b)).collect(), str::to_owned)
}

/// Returns what stands in brackets at the end of a name.
fn bracketed(name: &str) -> Option<String> {
    let open = name.trim_end().strip_suffix([']', ')'])?;
    let unit = open.rsplit_once(['[', '('])?.1.trim();
    (!unit.is_empty()).then(|| unit.to_owned())
}

/// The first forty characters.
pub(super) fn shortened(text: &str) -> String {
    let mut out: String = text.chars().take(40).collect();
    if out.len() < text.len() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_found_with_or_without_its_unit() {
        let mut cells = Cells::default();
        let line = b"timestamp [ns],w_x [rad s^-1], a ,\"b\",c,c";
        cells.cut(line, b',');
        let headings = Headings::new(&cells, line, cells.len());
        for (name, place) in
            [("timestamp [ns]", 0), ("timestamp", 0), ("#timestamp [ns]", 0), ("w_x", 1), ("a", 2), ("b", 3)]
        {
            assert_eq!(headings.place(name), Ok(place), "{name}");
        }
        assert!(headings.place("c").is_err_and(|(cause, _)| cause.contains("two columns")));
        assert!(headings.place("timestamps").is_err_and(|(_, hint)| hint.contains("did you mean")));
        assert!(headings.place("").is_err());
    }
}
