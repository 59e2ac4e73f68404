//! Rows of a CSV file one by one, in bounded memory, with the file's checksum on the way.
//!
//! Not for clocks or gaps: a row is a row here, and a missing cell is NaN.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use csv::ByteRecord;
use sha2::{Digest, Sha256};

use super::format;
use crate::document::hexadecimal;
use crate::error::{Error, Result, nearest};

/// A line longer than this is no row of a recording; a million columns are shorter.
const LONGEST_HEADER_BYTES: u64 = 32 << 20;

/// A CSV file being read.
#[derive(Debug)]
pub struct Rows {
    path: PathBuf,
    table: csv::Reader<BufReader<Hashed>>,
    record: ByteRecord,
    /// The first row where there is no header: already read, not yet given.
    first: Option<ByteRecord>,
    names: Vec<String>,
    /// Place in the row of each column wanted.
    places: Vec<usize>,
    width: usize,
    length_bytes: u64,
    findings: Vec<String>,
}

/// What is known of a file once it has been read to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// SHA-256 of all its bytes, hexadecimal.
    pub sha256: String,
    /// What was found and survived.
    pub findings: Vec<String>,
}

/// Opens a recording and gives its length in bytes.
///
/// # Errors
/// A folder, a pipe or a device, told before it is opened: to open a pipe is to wait for its writer.
pub fn open(path: &Path) -> Result<(File, u64)> {
    let about = std::fs::metadata(path).map_err(|e| Error::io("read", path, &e))?;
    if about.is_dir() {
        return Err(Error::io("read", path, &std::io::ErrorKind::IsADirectory.into()));
    }
    if !about.is_file() {
        // It is read more than once: for its headings, its rate and its rows.
        return Err(Error::new(
            format!("could not read {}", path.display()),
            "it is a pipe or a device, not a file",
            "save the recording as a file first",
        ));
    }
    Ok((File::open(path).map_err(|e| Error::io("read", path, &e))?, about.len()))
}

impl Rows {
    /// Opens a file for the columns of these headings, in this order. None named: all numeric columns but clocks.
    ///
    /// # Errors
    /// A file that is no table, or a column that is not there; the nearest heading is named.
    pub fn open(path: &Path, columns: &[String]) -> Result<Self> {
        let (file, length_bytes) = open(path)?;
        let mut reader = BufReader::with_capacity(1 << 18, Hashed { file, digest: Sha256::new(), bytes: 0 });
        let format = format::sniff(path, reader.fill_buf().map_err(|e| Error::io("read", path, &e))?)?;
        reader.consume(format.skip);
        let table = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(format.separator)
            .comment(Some(b'#'))
            .from_reader(reader);
        let mut rows = Self {
            path: path.into(),
            table,
            record: ByteRecord::new(),
            first: None,
            names: Vec::new(),
            places: Vec::new(),
            width: 0,
            length_bytes,
            findings: Vec::new(),
        };
        rows.read_header(columns)?;
        Ok(rows)
    }

    fn read_header(&mut self, columns: &[String]) -> Result<()> {
        let some = self.advance()?;
        let header = std::mem::take(&mut self.record);
        if !some || header.as_slice().len() as u64 > LONGEST_HEADER_BYTES {
            return Err(self.fail("its first line is no header", "begin with one line that names the columns"));
        }
        self.refuse_open_quote(&header)?;
        self.width = header.len();
        let mut headings: Vec<String> =
            header.iter().map(|c| String::from_utf8_lossy(c).trim().trim_matches('"').to_owned()).collect();
        if header.iter().all(|c| format::number(c).is_some()) {
            headings = (1..=self.width).map(|n| n.to_string()).collect();
            self.findings.push("the file has no header; its columns are called 1, 2, 3, … here".into());
            self.first = Some(header);
        }
        self.places = if columns.is_empty() {
            self.numeric_places(&headings)?
        } else {
            columns.iter().map(|c| self.place(c, &headings)).collect::<Result<_>>()?
        };
        self.names = self.places.iter().map(|p| headings[*p].clone()).collect();
        Ok(())
    }

    fn numeric_places(&mut self, headings: &[String]) -> Result<Vec<usize>> {
        if self.first.is_none() && self.advance()? {
            self.first = Some(std::mem::take(&mut self.record));
        }
        let numeric = |place: usize| match &self.first {
            Some(row) => row.get(place).is_some_and(|c| format::number(c).is_some()),
            None => true,
        };
        let places: Vec<usize> =
            (0..self.width).filter(|p| numeric(*p) && !format::names_a_clock(&headings[*p])).collect();
        match places.len() {
            0 => Err(self.fail("no column holds numbers", self.why_no_numbers())),
            1..=64 => Ok(places),
            n => Err(self.fail(&format!("it has {n} columns of numbers"), "name the columns wanted")),
        }
    }

    /// What may have kept all cells of the first row from being numbers.
    fn why_no_numbers(&self) -> &'static str {
        let comma = |cell: &[u8]| with_comma(&String::from_utf8_lossy(cell));
        match &self.first {
            Some(row) if row.iter().any(comma) => POINT,
            _ => "name the columns wanted",
        }
    }

    fn place(&self, wanted: &str, headings: &[String]) -> Result<usize> {
        let mut found = headings.iter().enumerate().filter(|(_, h)| *h == wanted).map(|(i, _)| i);
        match (found.next(), found.next()) {
            (Some(place), None) => Ok(place),
            (Some(_), Some(_)) => {
                Err(self.fail(&format!("two columns are called `{wanted}`"), "give each column its own heading"))
            }
            (None, _) => {
                let hint = self.instead_of(wanted, headings);
                Err(self.fail(&format!("there is no column `{wanted}`"), &hint))
            }
        }
    }

    /// What to ask for instead of a column that is not there.
    fn instead_of(&self, wanted: &str, headings: &[String]) -> String {
        if !self.findings.is_empty() {
            return format!("its first line holds numbers, no headings: its columns are called 1 to {}", self.width);
        }
        if self.width == 1 {
            return format!(
                "its only column is `{}`; columns are told apart by commas, semicolons or tabs",
                shortened(&headings[0])
            );
        }
        let known = headings.iter().take(1000).map(String::as_str);
        match nearest(wanted, known.clone()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("it has: {}", known.take(40).map(shortened).collect::<Vec<_>>().join(", ")),
        }
    }

    /// A quotation mark that is never closed takes all that follows for one cell.
    fn refuse_open_quote(&self, record: &ByteRecord) -> Result<()> {
        match record.as_slice().contains(&b'\n') {
            false => Ok(()),
            true => Err(self.fail(
                &format!("a quotation mark in line {} is not closed in that line", line_of(record)),
                "remove it, or close it",
            )),
        }
    }

    /// Headings of the columns given, in order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Size of the file, for a progress bar.
    pub fn length_bytes(&self) -> u64 {
        self.length_bytes
    }

    /// How far it has been read.
    pub fn bytes_read(&self) -> u64 {
        self.table.get_ref().get_ref().bytes
    }

    /// Writes the next row into `values`, as long as [`Rows::names`]; a missing cell is NaN. False at the end.
    ///
    /// # Errors
    /// A row with too few or too many cells and a cell that is text, each with its line.
    pub fn next(&mut self, values: &mut [f64]) -> Result<bool> {
        match self.first.take() {
            Some(first) => self.record = first,
            None if self.advance()? => {}
            None => return Ok(false),
        }
        if self.record.len() != self.width {
            self.refuse_open_quote(&self.record)?;
            let line = line_of(&self.record);
            let got = self.record.len();
            let last = !self.advance()?;
            if last && got < self.width {
                self.findings.push(format!("the last line ({line}) is cut short; it was left out"));
                return Ok(false);
            }
            return Err(self.fail(
                &format!("line {line} has {got} cells, the header {}", self.width),
                "every row needs as many cells as the header; was the log interrupted, or is the decimal sign a comma?",
            ));
        }
        for (value, place) in values.iter_mut().zip(&self.places) {
            let cell = self.record.get(*place).unwrap_or_default();
            *value = match format::number(cell) {
                Some(number) => number,
                None => return Err(self.no_number(&self.record, *place)),
            };
        }
        Ok(true)
    }

    fn no_number(&self, record: &ByteRecord, place: usize) -> Error {
        if let Err(error) = self.refuse_open_quote(record) {
            return error;
        }
        let text = String::from_utf8_lossy(record.get(place).unwrap_or_default()).into_owned();
        let line = line_of(record);
        let (what, hint) = if text.trim().parse::<f64>().is_ok() {
            (
                "is larger than any reading: powers of it leave double precision",
                "check the exponent and the unit of the column",
            )
        } else if with_comma(&text) {
            ("is no number", POINT)
        } else if line == 2 {
            ("is no number", "one line of headings is read; if this is a second one (units), delete it")
        } else {
            ("is no number", "leave missing numbers empty; name other columns if this one is text")
        };
        self.fail(&format!("line {line}, column {}: `{}` {what}", place + 1, shortened(&text)), hint)
    }

    /// Reads a row into `record`; false at the end.
    fn advance(&mut self) -> Result<bool> {
        self.table.read_byte_record(&mut self.record).map_err(|e| self.fail(&e.to_string(), "is the file complete?"))
    }

    fn fail(&self, cause: &str, hint: &str) -> Error {
        Error::new(format!("could not read {}", self.path.display()), cause, hint)
    }

    /// Reads whatever is left for the checksum.
    ///
    /// # Errors
    /// When the file cannot be read on.
    pub fn finish(self) -> Result<Source> {
        let mut rest = self.table.into_inner();
        std::io::copy(&mut rest, &mut std::io::sink()).map_err(|e| Error::io("read", &self.path, &e))?;
        let sha256 = hexadecimal(&rest.into_inner().digest.finalize());
        Ok(Source { sha256, findings: self.findings })
    }
}

/// The first forty characters.
fn shortened(text: &str) -> String {
    let mut out: String = text.chars().take(40).collect();
    if out.len() < text.len() {
        out.push('…');
    }
    out
}

/// What to do about decimal commas.
const POINT: &str = "write numbers with a decimal point, not a comma";

/// Whether a cell would be a number with a point for its comma.
fn with_comma(text: &str) -> bool {
    text.replacen(',', ".", 1).trim().parse::<f64>().is_ok()
}

fn line_of(record: &ByteRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}

/// A file that is digested as it is read.
#[derive(Debug)]
struct Hashed {
    file: File,
    digest: Sha256,
    bytes: u64,
}

impl Read for Hashed {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.digest.update(&buffer[..count]);
        self.bytes += count as u64;
        Ok(count)
    }
}
