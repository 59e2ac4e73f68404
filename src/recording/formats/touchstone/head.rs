//! Lines before the numbers of a Touchstone file: the option line, and the keywords of
//! version 2.

use crate::error::{Error, Result};
use crate::headings;
use crate::input::Input;
use crate::lines::Lines;
use crate::pack::Pack;

/// Words of an option line: the unit of frequency, and its hertz.
const UNITS: [(&str, f64); 4] = [("hz", 1.0), ("khz", 1e3), ("mhz", 1e6), ("ghz", 1e9)];
/// Words for the form of a number.
const FORMS: [(&str, Form); 3] = [("ma", Form::Magnitude), ("db", Form::Decibel), ("ri", Form::Parts)];
/// Endings of names that state the number of ports.
const ENDINGS: [(&str, usize); 2] = [(".s1p", 1), (".s2p", 2)];

/// Form of a complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    /// Magnitude, and angle in degrees.
    Magnitude,
    /// 20 log₁₀ of the magnitude, and angle in degrees.
    Decibel,
    /// Real and imaginary part.
    Parts,
}

impl Form {
    /// Real and imaginary part of a pair.
    pub(super) fn parts(self, first: f64, second: f64) -> [f64; 2] {
        let size = match self {
            Self::Parts => return [first, second],
            Self::Magnitude => first,
            Self::Decibel => 10f64.powf(first / 20.0),
        };
        let (sine, cosine) = second.to_radians().sin_cos();
        [size * cosine, size * sine]
    }
}

/// States how the numbers are to be read.
#[derive(Debug)]
pub(super) struct Head {
    /// Hertz of one unit of frequency.
    pub hertz: f64,
    /// Form of the parameters.
    pub form: Form,
    /// States whether the file is of version 2.
    pub is_second: bool,
    /// Rows that the file states.
    pub stated: Option<usize>,
    ports: usize,
    /// S12 stands before S21.
    is_12_first: bool,
}

impl Head {
    /// Parameters in the order of a row.
    pub(super) fn names(&self) -> &'static [&'static str] {
        match (self.ports, self.is_12_first) {
            (1, _) => &["s11"],
            (_, false) => &["s11", "s21", "s12", "s22"],
            (_, true) => &["s11", "s12", "s21", "s22"],
        }
    }

    /// Reads to the first number.
    ///
    /// # Errors
    /// Words that are no option or keyword, what is not read, no number at all: with the line.
    pub(super) fn read(content: &mut Content) -> Result<Self> {
        let mut head =
            Self { hertz: 1e9, form: Form::Magnitude, is_second: false, stated: None, ports: 0, is_12_first: false };
        let (mut optioned, mut ordered, mut informing, mut passing) = (false, false, false, false);
        while let Some(line) = content.next()? {
            if let Some(options) = line.strip_prefix('#').filter(|_| !informing) {
                if !std::mem::replace(&mut optioned, true) {
                    head.options(options, content)?;
                }
                continue;
            }
            let Some(Keyword { name, value }) = Keyword::of(&line) else {
                match (head.is_second, passing) {
                    (true, true) => continue,
                    (true, false) => {
                        return Err(
                            content.fail(&format!("need a keyword, got `{}`", headings::shortened(&line)), KEYWORDS)
                        );
                    }
                    (false, _) => head.ports = content.ports(&line)?,
                }
                content.held = Some(line);
                return Ok(head);
            };
            let fail = |need: &str| {
                Err(content.fail(&format!("need {need}, got `{}`", headings::shortened(&value)), KEYWORDS))
            };
            if informing && name != "end information" {
                continue;
            }
            informing = name == "begin information";
            passing = informing || name == "reference";
            match name.as_str() {
                "version" if value.starts_with("2.") => head.is_second = true,
                "version" => return fail("version 2.0"),
                "number of ports" => match value.parse() {
                    Ok(ports @ 1..=2) => head.ports = ports,
                    _ => return fail("1 or 2 ports"),
                },
                "two-port data order" => {
                    (ordered, head.is_12_first) = (true, value == "12_21");
                    if !matches!(value.as_str(), "12_21" | "21_12") {
                        return fail("12_21 or 21_12");
                    }
                }
                "number of frequencies" => match value.parse() {
                    Ok(rows) => head.stated = Some(rows),
                    Err(_) => return fail("a number of rows"),
                },
                "matrix format" if value.eq_ignore_ascii_case("full") => {}
                "matrix format" => return fail("a full matrix"),
                "number of noise frequencies" | "reference" | "begin information" | "end information" => {}
                "network data" if head.ports == 0 => return fail("[Number of Ports] before the data"),
                "network data" if head.ports == 2 && !ordered => return fail("[Two-Port Data Order] before the data"),
                "network data" => return Ok(head),
                other => return Err(content.fail(&format!("[{}] is not read", headings::shortened(other)), KEYWORDS)),
            }
        }
        Err(content
            .fail("need rows of numbers behind the option line, got the end of the file", "is the file complete?"))
    }

    /// Reads the words of an option line, in any order.
    fn options(&mut self, options: &str, content: &Content) -> Result<()> {
        let options = options.to_lowercase();
        let mut words = options.split_whitespace();
        while let Some(word) = words.next() {
            let unit = UNITS.iter().find(|(name, _)| *name == word);
            let form = FORMS.iter().find(|(name, _)| *name == word);
            match (unit, form, word) {
                (Some((_, hertz)), ..) => self.hertz = *hertz,
                (_, Some((_, form)), _) => self.form = *form,
                (.., "s") => {}
                // S parameters are ratios: they are read against whatever resistance is stated.
                (.., "r") if words.next().is_some_and(|ohm| ohm.parse::<f64>().is_ok()) => {}
                (.., "r") => return Err(content.fail("need a resistance in ohm behind R", OPTIONS)),
                (.., "y" | "z" | "g" | "h") => {
                    return Err(
                        content.fail(&format!("need S parameters, got {}", word.to_uppercase()), "export S parameters")
                    );
                }
                _ => return Err(content.fail(&format!("need an option, got `{}`", headings::shortened(word)), OPTIONS)),
            }
        }
        Ok(())
    }
}

const OPTIONS: &str = "an option line is `# GHz S MA R 50`: Hz, kHz, MHz or GHz; S; MA, DB or RI; R and a resistance";
const KEYWORDS: &str = "read are [Version] 2.0, [Number of Ports], [Two-Port Data Order], [Number of Frequencies], \
                        [Reference], [Matrix Format] Full, [Network Data], [Noise Data] and [End]; else export version 1";

/// A line of a keyword: `[Number of Ports] 2`.
pub(super) struct Keyword {
    /// Its name in lower case.
    pub name: String,
    /// Words behind it.
    pub value: String,
}

impl Keyword {
    /// Returns that of a line, if it is one's.
    pub(super) fn of(line: &str) -> Option<Self> {
        let (name, value) = line.strip_prefix('[')?.split_once(']')?;
        Some(Self { name: name.trim().to_lowercase(), value: value.trim().to_owned() })
    }
}

/// Lines of a file without comments and blanks.
#[derive(Debug)]
pub(super) struct Content {
    input: Input,
    lines: Lines,
    /// The line at hand is to be given once more.
    held: Option<String>,
}

impl Content {
    /// Begins at the first line.
    pub(super) fn open(input: &Input) -> Result<Self> {
        let mut lines = Lines::open(input.clone(), Pack::None)?;
        lines.without_checksum();
        if lines.head()?.starts_with(MARK) {
            lines.skip(MARK.len());
        }
        Ok(Self { input: input.clone(), lines, held: None })
    }

    /// The next line that holds more than a comment.
    pub(super) fn next(&mut self) -> Result<Option<String>> {
        if let Some(line) = self.held.take() {
            return Ok(Some(line));
        }
        while self.lines.advance()? {
            let line = headings::text(self.lines.line());
            let line = line.split('!').next().unwrap_or_default().trim();
            if !line.is_empty() {
                return Ok(Some(line.to_owned()));
            }
        }
        Ok(None)
    }

    /// An error at the line at hand.
    pub(super) fn fail(&self, cause: &str, hint: &str) -> Error {
        self.input.fail(format!("line {}: {cause}", self.lines.number()), hint)
    }

    /// Returns how far the file was read.
    pub(super) fn bytes_read(&self) -> u64 {
        self.lines.bytes_read()
    }

    /// Number of ports of a file of version 1: by its name, else by the numbers of its first line.
    fn ports(&self, first: &str) -> Result<usize> {
        let name = self.input.path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let name = name.trim_end_matches(".gz").trim_end_matches(".zst");
        if let Some((_, ports)) = ENDINGS.iter().find(|(ending, _)| name.ends_with(ending)) {
            return Ok(*ports);
        }
        match first.split_whitespace().count() {
            3 => Ok(1),
            9 => Ok(2),
            got => Err(self.fail(
                &format!("need 3 numbers of one port or 9 of two in the first row, got {got}"),
                "name the file .s1p or .s2p where its rows go over several lines; more ports are not read",
            )),
        }
    }
}

/// The mark of UTF-8.
const MARK: &[u8] = &[0xef, 0xbb, 0xbf];

/// Returns whether a file begins as these do: comments behind `!`, and an option line or the
/// version.
pub(in crate::formats) fn begins(head: &[u8]) -> bool {
    let text = headings::text(head.strip_prefix(MARK).unwrap_or(head));
    let mut lines = text.split(['\n', '\r']).map(str::trim).filter(|line| !line.is_empty()).peekable();
    let mut commented = false;
    while lines.next_if(|line| line.starts_with('!')).is_some() {
        commented = true;
    }
    let Some(first) = lines.next().map(str::to_lowercase) else { return false };
    let Some(options) = first.strip_prefix('#') else { return first.starts_with("[version]") };
    // A comment of another table begins so, too: two options tell, one of them of this format alone.
    let has = |known: fn(&str) -> bool| options.split_whitespace().filter(|word| known(word)).count();
    let own = has(|word| UNITS.iter().any(|(name, _)| *name == word) || FORMS.iter().any(|(name, _)| *name == word));
    commented || (own > 0 && own + has(|word| matches!(word, "s" | "r" | "y" | "z" | "g" | "h")) > 1)
}
