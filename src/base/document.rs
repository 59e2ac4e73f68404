//! Documents in and out: TOML with errors a person can act on, results as JSON, files written whole
//! or not at all.
//!
//! Not for recordings: those stream, see `recording`.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result, nearest};

mod mistaken;
mod whole;

pub use mistaken::number_advice;
pub use whole::{Staged, UNFINISHED, write_whole};

/// Parses a TOML document. `name` stands in messages for where it came from.
///
/// # Errors
/// File, line and column; an unknown key also names the nearest known one.
pub fn parse_toml<T: DeserializeOwned>(name: &str, text: &str) -> Result<T> {
    toml::from_str(text).map_err(|error| {
        let at = error.span().map(|span| {
            let before = &text[..span.start.min(text.len())];
            let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
            (before.matches('\n').count() + 1, column)
        });
        let place = at.map_or(String::new(), |(line, column)| format!("{name}:{line}:{column}: "));
        let message = error.message();
        let hint = mistaken::hint(name, text, at.map(|at| at.0), message).unwrap_or_else(|| hint(message));
        Error::new(format!("could not read {name}"), format!("{place}{}", plain(message)), hint)
    })
}

/// Reads and parses a TOML file.
///
/// # Errors
/// As [`parse_toml`], and when the file cannot be read.
pub fn read_toml<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let (name, text) = (path.display().to_string(), read_text(path)?);
    parse_toml(&name, &text)
}

/// Reads a JSON file.
///
/// # Errors
/// A file that cannot be read; one that is no JSON, or lacks what is needed, with line and column.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    parse_json(&path.display().to_string(), &read_text(path)?)
}

/// Parses a JSON document; `name` stands in messages for where it came from.
///
/// # Errors
/// Text that is not such a document.
pub fn parse_json<T: DeserializeOwned>(name: &str, text: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|error| {
        let hint = "give a whole file that this program wrote";
        Error::new(format!("could not read {name}"), error.to_string(), hint)
    })
}

/// A TOML document that was changed after it was read; `name` stands in messages for where it came
/// from.
///
/// # Errors
/// As [`parse_toml`], without a place.
pub fn from_table<T: DeserializeOwned>(name: &str, table: toml::Table) -> Result<T> {
    let fail = |error: toml::de::Error| {
        let message = error.message();
        Error::new(format!("could not read {name}"), plain(message), hint(message))
    };
    toml::Value::Table(table).try_into().map_err(fail)
}

/// Opens a file, `what` for people.
///
/// # Errors
/// A folder, a pipe or a device, told before it is opened: to open a pipe is to wait for its
/// writer.
pub(crate) fn open(path: &Path, what: &str) -> Result<File> {
    let about = std::fs::metadata(path).map_err(|e| Error::io("read", path, &e))?;
    if about.is_dir() {
        return Err(Error::io("read", path, &std::io::ErrorKind::IsADirectory.into()));
    }
    if !about.is_file() {
        return Err(Error::new(
            format!("could not read {}", path.display()),
            "it is a pipe or a device, not a file",
            format!("save the {what} as a file first"),
        ));
    }
    File::open(path).map_err(|e| Error::io("read", path, &e))
}

/// Most bytes of a document: no study is a thousandth of it, and a device that never ends is
/// refused.
const LONGEST_BYTES: u64 = 16 << 20;

/// States what editors put before UTF-8 text; it belongs to no key.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Reads a text file whole.
///
/// # Errors
/// A file that cannot be read, is too long for a document, or holds something else than UTF-8 text
/// (the line is named).
pub fn read_text(path: &Path) -> Result<String> {
    let fail =
        |cause: String, hint: &str| Error::new(format!("could not read {}", path.display()), cause, hint.to_owned());
    let file = open(path, "document")?;
    let mut bytes = Vec::new();
    file.take(LONGEST_BYTES + 1).read_to_end(&mut bytes).map_err(|e| Error::io("read", path, &e))?;
    if bytes.len() as u64 > LONGEST_BYTES {
        return Err(fail(
            format!("it is longer than {} MiB", LONGEST_BYTES >> 20),
            "is this the recording? give the .toml",
        ));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(fail("this is UTF-16 text".into(), "save it as UTF-8"));
    }
    if bytes.starts_with(BYTE_ORDER_MARK) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..valid].iter().filter(|b| **b == b'\n').count() + 1;
        fail(
            format!("line {line} holds bytes that are not UTF-8 text"),
            "save it as UTF-8; is this a text file at all?",
        )
    })
}

/// More allowed words than these are not listed next to a wrong one.
const FEW_WORDS: usize = 6;

/// The parser's words for types, in those of a person who writes numbers.
fn plain(message: &str) -> String {
    let mut out = message.replace(" as i128", "").replace("invalid type: map", "invalid type: a section");
    // Many allowed words stand in the hint, where none is near; here they would hide the wrong one.
    if let Some((wrong, known)) = out.split_once(", expected one of ")
        && known.matches('`').count() > 2 * FEW_WORDS
    {
        out = wrong.to_owned();
    }
    for (theirs, ours) in [
        ("expected u64", "expected a whole number, zero or more"),
        ("expected u32", "expected a whole number from 0 to 4294967295"),
        ("expected usize", "expected a whole number, zero or more"),
        ("expected f64", "expected a number"),
        ("expected variant identifier", "expected a word in quotes"),
        ("expected a sequence", "expected a list"),
        ("expected struct Range", "expected { quantity = …, from = …, to = …, points = … }"),
        ("expected an array of length 2", "expected a pair, [from, to]"),
        ("expected 2 elements in sequence", "expected a pair"),
    ] {
        out = out.replace(theirs, ours);
    }
    out
}

fn hint(message: &str) -> String {
    // serde: "unknown field `membrs`, expected one of `name`, `members`"
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown field") || message.starts_with("unknown variant") {
        let word = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        return match nearest(word, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known here: {}", known.join(", ")),
        };
    }
    match message {
        m if m.starts_with("missing field") => "add that key; `proofmass template` prints an example of every file",
        m if m.contains("a standard deviation is zero or more") => "a spread has no sign: leave the minus out",
        m if m.starts_with("duplicate key") => "keep one of the two",
        m if m.contains("map, expected a sequence") => {
            "a section that may come several times has two brackets, [[so]]; a list has one, [1.0, 2.0]"
        }
        m if m.contains("drawn number") || m.contains("{ mean") => {
            "e.g. bias_mg = 0.5, bias_mg = { mean = 0.0, sd = 1.0 } or bias_mg = { min = -1.0, max = 1.0 }"
        }
        m if m.starts_with("invalid") => {
            "numbers stand without quotes, words with them; `proofmass template` prints an example"
        }
        _ => "`proofmass template` prints an example; numbers need a digit on both sides of the point",
    }
    .into()
}

/// A result as one indented JSON document.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub fn to_json(result: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(result)
        .map_err(|e| Error::new("could not write the result as JSON", e.to_string(), "report this as a defect"))
}

/// A string as TOML writes it, quotes included.
pub fn toml_string(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// Bytes as hexadecimal digits, two each: how checksums are written.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Sample {
        #[serde(default)]
        #[allow(dead_code, reason = "only its name matters here")]
        members: u32,
    }

    #[test]
    fn an_unknown_key_is_placed_and_named() {
        let error = parse_toml::<Sample>("study.toml", "\nmembrs = 3\n").expect_err("misspelt");
        assert!(error.cause.starts_with("study.toml:2:1:"), "{}", error.cause);
        assert_eq!(error.hint, "did you mean `members`?");
    }

    #[test]
    fn a_wrong_type_is_said_in_words_for_people() {
        let error = parse_toml::<Sample>("study.toml", "members = -5").expect_err("negative");
        assert!(error.cause.contains("whole number") && !error.cause.contains("u32"), "{error}");
        let twice = parse_toml::<Sample>("study.toml", "members = 1\nmembers = 2").expect_err("twice");
        assert_eq!(twice.hint, "keep one of the two");
    }

    #[test]
    fn what_is_no_text_is_refused_with_its_line() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("x.toml");
        for (bytes, words) in [(&b"a = 1\nb = \"\xe9\"\n"[..], "line 2"), (b"\xff\xfea\0", "UTF-16")] {
            std::fs::write(&path, bytes).expect("written");
            let error = read_text(&path).expect_err("no text");
            assert!(error.cause.contains(words), "{error}");
        }
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_text() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("x.toml");
        std::fs::write(&path, "\u{feff}members = 3\n").expect("written");
        assert_eq!(read_text(&path).expect("text"), "members = 3\n");
    }
}
