//! Lines before the headings of a text file: the settings that an oscilloscope or a network analyser
//! writes above its table, as `Key,Value`, comments or free text.
//!
//! Only where the first line cannot be the headings: a file that is read without this is read as
//! before. Not for comments with `#` and a row of units, which any file may have.

use crate::cells::Cells;
use crate::format::{self, Cell};
use crate::headings;
use crate::unit;

/// Lines among which the first numbers are looked for. Instruments write [`FEWEST`] to 40 lines of settings.
const LOOKED_AT: usize = 200;
/// Fewer lines than an instrument writes are no settings where the first of them has as many cells as
/// the table: it may be its headings, and what is wrong below it may be left out by `--from-s`.
const FEWEST: usize = 5;
/// Lines of numbers that are a table: a recording has two rows at least.
const LEAST: usize = 2;
/// Numbers in each of them: one stands behind the key of a setting.
const NUMBERS: usize = 2;
/// Separators, the usual one first.
const SEPARATORS: [u8; 4] = [b',', b';', b'\t', b' '];

/// Lines before the headings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Preamble {
    /// Number of lines that are neither blank nor comments.
    pub(super) lines: u64,
    /// Line of the headings, counted from one.
    pub(super) headings: u64,
    /// Separator of the table.
    pub(super) separator: u8,
    /// Cells of its lines of numbers.
    pub(super) width: usize,
}

/// A line that is neither blank nor a comment, and its number.
type Line<'a> = (u64, &'a [u8]);

/// Lines with numbers in one layout that follow one another.
#[derive(Debug, Clone, Copy)]
struct Run {
    separator: u8,
    /// Place of its first line among all.
    first: usize,
    length: usize,
    /// Cells of each line, and whether all of them hold numbers.
    width: usize,
    is_whole: bool,
}

/// Finds the lines before the headings in the first bytes of a file whose first line is cut at
/// `separator`; `None` where that line is to be read as the headings.
///
/// # Errors
/// Numbers below lines of which none is surely their headings: what is wrong, and what to do.
pub(super) fn find(head: &[u8], separator: u8) -> Result<Option<Preamble>, (String, &'static str)> {
    let lines = lines(head);
    if begins_with_headings(&lines, separator) {
        return Ok(None);
    }
    let runs: Vec<Run> = SEPARATORS.into_iter().flat_map(|separator| runs(&lines, separator)).collect();
    // A wrong separator cuts decimal commas into numbers and words. Of others the usual one is the first.
    let Some(run) = runs.iter().rev().max_by_key(|run| (run.length, run.is_whole)).copied() else { return Ok(None) };
    let mut cells = Cells::default();
    let mut has_key = |line: &Line<'_>| {
        cells.cut(line.1, run.separator);
        matches!(format::cell(cells.of(line.1, 0)), Cell::Text)
    };
    if run.first < 2 || !lines[..run.first].iter().all(&mut has_key) {
        return Ok(None);
    }
    let words = |place: usize| words(lines[place].1, run.separator);
    if words(0).len() == run.width && run.first - 1 < FEWEST {
        return Ok(None);
    }
    let number = |place: usize| lines[place].0;
    let rival =
        |other: &&Run| (other.separator, other.length) == (run.separator, run.length) && other.first != run.first;
    if let Some(other) = runs.iter().find(rival) {
        return Err((
            format!(
                "two tables of {} rows are in it, from line {} and from line {}",
                run.length,
                number(run.first),
                number(other.first)
            ),
            "keep one of them, with its headings in the line above",
        ));
    }
    let names_all = |words: &[String]| {
        // LabVIEW names a column of comments that its rows end without.
        let words = match words {
            [all @ .., last] if all.len() == run.width && last.eq_ignore_ascii_case("comment") => all,
            all => all,
        };
        words.len() == run.width && words.iter().all(|word| matches!(format::cell(word.as_bytes()), Cell::Text))
    };
    let last = words(run.first - 1);
    let has_units = last.len() == run.width && unit::are_units(&last);
    let place = run.first - 1 - usize::from(has_units && names_all(&words(run.first - 2)));
    if place + 1 == run.first && !names_all(&last) {
        return Err((
            format!(
                "the numbers begin in line {} with {} cells, and line {} above them, with {}, does not name each",
                number(run.first),
                run.width,
                number(place),
                last.len()
            ),
            "write one line right above the numbers that names every column",
        ));
    }
    Ok(Some(Preamble { lines: place as u64, headings: number(place), separator: run.separator, width: run.width }))
}

/// The lines of these bytes that are neither blank nor comments.
fn lines(head: &[u8]) -> Vec<Line<'_>> {
    let mut out = Vec::new();
    let (mut at, mut number) = (0, 0);
    while at < head.len() {
        let end = memchr::memchr2(b'\n', b'\r', &head[at..]).map_or(head.len(), |length| at + length);
        number += 1;
        let line = &head[at..end];
        if !line.trim_ascii().is_empty() && !line.trim_ascii_start().starts_with(b"#") {
            out.push((number, line));
        }
        at = end + if head[end..].starts_with(b"\r\n") { 2 } else { 1 };
    }
    out
}

/// Places of the cells of a line that hold numbers, or nothing.
fn numeric(cells: &Cells, line: &[u8], separator: u8) -> Vec<usize> {
    let is_number = |place: &usize| match format::cell(cells.of(line, *place)) {
        Cell::Number(_) | Cell::TooLarge => true,
        Cell::DecimalComma(_) => separator != b',',
        Cell::Text => false,
    };
    (0..cells.len()).filter(is_number).collect()
}

/// The cells of a line as text.
fn words(line: &[u8], separator: u8) -> Vec<String> {
    let mut cells = Cells::default();
    cells.cut(line, separator);
    (0..cells.len()).map(|i| headings::text(cells.of(line, i)).trim().to_owned()).collect()
}

/// Returns whether the first line can be the headings: it holds numbers itself, several or all
/// cells below it and a row of units do, or the lines there go on as they begin.
fn begins_with_headings(lines: &[Line<'_>], separator: u8) -> bool {
    let mut cells = Cells::default();
    let mut read = |place: usize| {
        lines.get(place).map(|(_, line)| {
            cells.cut(line, separator);
            (cells.len(), numeric(&cells, line, separator))
        })
    };
    let Some((width, own)) = read(0) else { return true };
    let has_units = lines.get(1).is_some_and(|(_, line)| {
        let units = words(line, separator);
        units.len() == width && unit::are_units(&units)
    });
    let first = if has_units { 2 } else { 1 };
    let Some((below, places)) = read(first) else { return true };
    if own.len() == width || below == width && (places.len() >= NUMBERS || places.len() == width) {
        return true;
    }
    // The last line may be cut short.
    let mut others = (first..lines.len().min(LOOKED_AT).saturating_sub(1)).filter_map(read);
    !places.is_empty() && others.all(|(count, own)| count == width && places.iter().all(|place| own.contains(place)))
}

/// Lines of numbers in one layout that begin early enough, each as long as it goes.
fn runs(lines: &[Line<'_>], separator: u8) -> Vec<Run> {
    let mut out: Vec<Run> = Vec::new();
    let mut cells = Cells::default();
    let mut before = None;
    for (place, (_, line)) in lines.iter().enumerate() {
        cells.cut(line, separator);
        let places = numeric(&cells, line, separator);
        let filled = places.iter().filter(|place| !cells.of(line, **place).trim_ascii().is_empty()).count();
        let (width, is_whole) = (cells.len(), places.len() == cells.len());
        let layout = (filled >= NUMBERS).then_some((width, places));
        match out.last_mut() {
            Some(run) if layout.is_some() && layout == before => run.length += 1,
            _ if layout.is_some() => out.push(Run { separator, first: place, length: 1, width, is_whole }),
            _ => {}
        }
        before = layout;
    }
    out.retain(|run| run.length >= LEAST && run.first < LOOKED_AT);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: &str =
        "Model,SDS 2104X\nRecord Length,12\nVertical Scale,CH1:0.5\n! saved, by hand\n\nSampling 5 MSa/s\n";

    fn rows(count: usize, width: usize) -> String {
        (0..count).map(|n| vec![format!("{n}.5"); width].join(",") + "\n").collect()
    }

    fn found(text: &str) -> Result<Option<Preamble>, String> {
        find(text.as_bytes(), b',').map_err(|(cause, _)| cause)
    }

    #[test]
    fn headings_below_settings_are_found_with_their_line() {
        for width in [2, 3, 5] {
            let names: Vec<String> = (0..width).map(|n| format!("column {n}")).collect();
            let text = format!("{SETTINGS}{}\n{}", names.join(","), rows(30, width));
            let expected = Preamble { lines: 5, headings: 7, separator: b',', width };
            assert_eq!(found(&text), Ok(Some(expected)), "{width} columns");
            assert_eq!(found(&text.replace('\n', "\r\n")), Ok(Some(expected)), "{width} columns");
            let semicolons = text.replace(',', ";").replace('.', ",");
            assert_eq!(find(semicolons.as_bytes(), b';'), Ok(Some(Preamble { separator: b';', ..expected })));
        }
        let units = format!("{SETTINGS}time,voltage\n(ms),(mV)\n{}", rows(9, 2));
        assert_eq!(found(&units), Ok(Some(Preamble { lines: 5, headings: 7, separator: b',', width: 2 })));
        let title = format!("Run of Friday\nf,x,y\n{}", rows(9, 3));
        assert_eq!(found(&title), Ok(Some(Preamble { lines: 1, headings: 2, separator: b',', width: 3 })));
    }

    #[test]
    fn a_table_that_begins_with_its_headings_or_its_numbers_has_none() {
        for begin in [
            "",
            "a,b\n",
            "# by, hand\na,b\n",
            "a,b\n(m),(V)\n",
            "a,b\nm,furlong\n",
            "a,b\nm,\n",
            "a,b\nx\n",
            "a,1\nx,y\nx,y\n",
            "#a,b\n",
        ] {
            assert_eq!(found(&format!("{begin}{}", rows(40, 2))), Ok(None), "{begin:?}");
        }
        let spoiled = rows(40, 2).replacen("7.5,7.5", "7.5,x", 1).replacen("30.5,30.5", "30.5", 1);
        assert_eq!(found(&format!("a,b\n{spoiled}")), Ok(None), "rows with faults");
        let notes: String = (0..300).map(|n| if n == 250 { "7,8\n" } else { "1,ok\n" }).collect();
        assert_eq!(found(&format!("a,note\n{notes}")), Ok(None), "a column of words");
        let late: String = (0..300).map(|n| if n > 2 { "7,8\n" } else { "1,ok\n" }).collect();
        assert_eq!(found(&format!("a,note\n{late}")), Ok(None), "words in its first rows alone");
        let labelled: String = (0..40).map(|n| format!("{n},{n}.5,name {n}\n")).collect();
        assert_eq!(found(&format!("a,b,label\ns,m,\n{labelled}")), Ok(None), "units of all but a column of words");
        assert_eq!(found(&format!("{}a,b\n{}", "Key,Value\n".repeat(LOOKED_AT), rows(40, 2))), Ok(None), "too late");
        assert_eq!(found("a\n1\n2\n3\n"), Ok(None));
        assert_eq!(found("a,b\n1,5,2,5\n2,5,3,5\n"), Ok(None), "decimal commas have words of their own");
        assert_eq!(found(""), Ok(None));
    }

    #[test]
    fn where_no_line_is_surely_the_headings_it_is_said_with_the_line() {
        let few = found(&format!("{SETTINGS}time,voltage\n{}", rows(9, 3))).expect_err("two names for three columns");
        assert!(few.contains("line 8 with 3 cells") && few.contains("line 7 above them, with 2"), "{few}");
        let numbered = found(&format!("{SETTINGS}time,1\n{}", rows(9, 2))).expect_err("a number is no heading");
        assert!(numbered.contains("line 7 above them"), "{numbered}");
        let blocks = format!("{SETTINGS}t,a\n{}t,b\n{}", rows(9, 2), rows(9, 2));
        let two = found(&blocks).expect_err("two tables");
        assert!(two.contains("from line 8 and from line 18"), "{two}");
    }
}
