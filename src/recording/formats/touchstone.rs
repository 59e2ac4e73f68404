//! Touchstone files (`.s1p`, `.s2p`): S parameters as network analysers write them, a row per
//! frequency. Format: IBIS Open Forum, *Touchstone File Format Specification*, 1.1 and 2.0.
//!
//! Y, Z, G and H parameters and more than two ports are refused in words; noise parameters are
//! counted and left out.

mod head;

use crate::clock::stamp::Stamp;
use crate::dropped::{Dropped, Reason};
use crate::error::Result;
use crate::format::{self, Cell};
use crate::headings;
use crate::input::Input;
use crate::reader::{BLOCK_ROWS, Block, Choice, Heading, Log, Part, Reader};
pub(super) use head::begins;
use head::{Content, Head, Keyword};

/// Numbers of a row of noise parameters: frequency, least noise figure, reflection of the source
/// there (two), resistance.
const NOISE_NUMBERS: usize = 5;

const WRAPPED: &str = "every row begins on a new line; does the file's name state its number of ports (.s1p, .s2p)?";

/// A file whose head is read.
#[derive(Debug)]
struct Touchstone {
    parts: [Part; 1],
    rows: Rows,
}

/// Opens a file and reads what stands before its numbers.
///
/// # Errors
/// Other parameters than S, more than two ports, what is no option or keyword: with its line.
pub(crate) fn open(input: &Input) -> Result<Box<dyn Log>> {
    let mut content = Content::open(input)?;
    let head = Head::read(&mut content)?;
    let parts_of = |name: &str| [Heading::named(format!("{name}_re")), Heading::named(format!("{name}_im"))];
    let parameters = head.names().iter().flat_map(|name| parts_of(name));
    let columns = std::iter::once(Heading::in_unit("frequency_hz", "Hz")).chain(parameters).collect();
    let part = Part { columns, ..Part::default() };
    let rows = Rows {
        content,
        head,
        choice: Choice::default(),
        row: Vec::new(),
        given: 0,
        noise: None,
        is_cut: false,
        ended: false,
    };
    Ok(Box::new(Touchstone { parts: [part], rows }))
}

impl Log for Touchstone {
    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn open(self: Box<Self>, _part: usize, choice: &Choice) -> Result<Box<dyn Reader>> {
        Ok(Box::new(Rows { choice: choice.clone(), ..self.rows }))
    }
}

/// Rows on their way.
#[derive(Debug)]
struct Rows {
    content: Content,
    head: Head,
    choice: Choice,
    /// The row at hand: frequency in Hz, real and imaginary part of each parameter.
    row: Vec<f64>,
    given: usize,
    /// Rows of noise parameters, once they have begun.
    noise: Option<usize>,
    /// The file ends within a row.
    is_cut: bool,
    ended: bool,
}

impl Rows {
    /// Reads the next row; false at the end. It begins on a new line and may go on over further ones.
    fn advance(&mut self) -> Result<bool> {
        let (need, before) = (1 + 2 * self.head.names().len(), self.row.first().copied());
        self.row.clear();
        while self.row.len() < need {
            let Some(line) = self.content.next()?.filter(|_| !self.ended) else { return self.end() };
            match Keyword::of(&line) {
                // Option lines behind the first are passed over, as the format has it.
                _ if line.starts_with('#') => continue,
                None => {}
                Some(Keyword { name, .. }) if self.row.is_empty() && name == "noise data" => {
                    self.noise = Some(0);
                    continue;
                }
                Some(Keyword { name, .. }) if self.row.is_empty() && name == "end" => {
                    self.ended = true;
                    continue;
                }
                Some(Keyword { name, .. }) => {
                    let cause = format!(
                        "need {need} numbers a row, [Noise Data] or [End], got [{}]",
                        headings::shortened(&name)
                    );
                    return Err(self.content.fail(&cause, "remove the line, or complete the row before it"));
                }
            }
            let (is_first, words) = (self.row.is_empty(), line.split_whitespace().count());
            // A row of five numbers whose frequency is no higher than the last begins the noise parameters.
            let may_be_noise = is_first && !self.head.is_second && need > NOISE_NUMBERS && words == NOISE_NUMBERS;
            if may_be_noise && before.is_some_and(|f| number(&line).is_some_and(|first| first * self.head.hertz <= f)) {
                self.noise.get_or_insert(0);
            }
            let (got, most) = (self.row.len() + words, self.noise.map_or(need, |_| NOISE_NUMBERS));
            if got > most || (self.noise.is_some() && got < most) {
                let of = if self.noise.is_some() { "noise parameters" } else { "S parameters" };
                let cause = format!("need {most} numbers in a row of {of}, got {got} up to the end of this line");
                return Err(self.content.fail(&cause, WRAPPED));
            }
            self.append(&line)?;
            if let Some(rows) = &mut self.noise {
                *rows += 1;
                self.row.clear();
            }
        }
        self.convert();
        self.given += 1;
        Ok(true)
    }

    /// Appends the numbers of a line.
    fn append(&mut self, line: &str) -> Result<()> {
        for (place, word) in line.split_whitespace().enumerate() {
            let Cell::Number(value) = format::cell(word.as_bytes()) else {
                let cause = format!("column {}: need a number, got `{}`", place + 1, headings::shortened(word));
                return Err(self.content.fail(&cause, "write numbers with a decimal point, and comments behind `!`"));
            };
            self.row.push(value);
        }
        Ok(())
    }

    /// Returns false, where as many rows were given as the file states.
    fn end(&mut self) -> Result<bool> {
        self.is_cut |= !self.row.is_empty();
        self.row.clear();
        match self.head.stated.filter(|stated| *stated != self.given) {
            None => Ok(false),
            Some(stated) => {
                let cause = format!("need {stated} rows, as [Number of Frequencies] states, got {}", self.given);
                Err(self.content.fail(&cause, "is the file complete? Copy it again, or correct that number"))
            }
        }
    }

    /// Turns the numbers of the file into hertz, real and imaginary parts.
    fn convert(&mut self) {
        self.row[0] *= self.head.hertz;
        for pair in self.row[1..].chunks_exact_mut(2) {
            let [re, im] = self.head.form.parts(pair[0], pair[1]);
            (pair[0], pair[1]) = (re, im);
        }
    }
}

/// The first number of a line.
fn number(line: &str) -> Option<f64> {
    format::number(line.split_whitespace().next()?.as_bytes())
}

impl Reader for Rows {
    fn next(&mut self, block: &mut Block) -> Result<bool> {
        while block.rows < BLOCK_ROWS && self.advance()? {
            block.rows += 1;
            block.stamps.extend(self.choice.time.map(|place| Stamp::of_float(self.row[place])));
            for (column, place) in block.columns.iter_mut().zip(&self.choice.places) {
                column.push(self.row[*place]);
            }
        }
        Ok(block.rows > 0)
    }

    fn bytes_read(&self) -> u64 {
        self.content.bytes_read()
    }

    fn dropped(&self) -> Vec<Dropped> {
        let noise = self.noise.filter(|rows| *rows > 0);
        let noise = noise.map(|rows| Dropped { reason: Reason::NoiseParameters, rows, first_row: self.given });
        let cut = self.is_cut.then_some(Dropped { reason: Reason::CutShort, rows: 1, first_row: 0 });
        noise.into_iter().chain(cut).collect()
    }
}
