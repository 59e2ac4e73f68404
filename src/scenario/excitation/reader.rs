//! Reads the keys of the kinds of excitation, and the errors that name the key and the kind.

use std::path::{Path, PathBuf};

use super::plan::Plan;
use super::section::{Keys, Section, Value};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::units::number::Number;

/// A kind of excitation: its name, keys and reader.
pub struct Kind {
    /// Value of `excitation.kind` that selects it.
    pub name: &'static str,
    /// The keys that it takes.
    pub keys: Keys,
    /// Makes the excitation of them.
    pub plan: fn(&Reader<'_>) -> Result<Plan>,
}

/// The run that an excitation is for.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Name of the study, for messages.
    pub source: &'a str,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Seed of every random number.
    pub seed: u64,
    /// Folder that a relative `file` starts from.
    pub folder: &'a Path,
    /// Who watches the reading of a recording and may stop it.
    pub control: &'a Control,
}

/// A section being read.
pub struct Reader<'a> {
    /// The kind that the section gives.
    pub kind: &'a Kind,
    /// The section's keys as written.
    pub section: &'a Section,
    /// The run it is for.
    pub run: Run<'a>,
}

impl Reader<'_> {
    /// Why the section cannot be used.
    pub fn refuse(&self, cause: impl Into<String>, hint: impl Into<String>) -> Error {
        Error::new(format!("could not use {}", self.run.source), cause, hint)
    }

    /// Refuses keys that belong to another kind; `names` are all kinds but `rest`.
    ///
    /// # Errors
    /// Names the first key that does not belong.
    pub fn only_its_keys(&self, names: &[&str]) -> Result<()> {
        let belongs = |key: &str| self.kind.keys.iter().any(|(k, _)| *k == key);
        let Some((key, _)) = self.section.given.iter().find(|(key, _)| !belongs(key)) else { return Ok(()) };
        if self.section.kind.is_none() {
            let (last, others) = names.split_last().unwrap_or((&"", &[]));
            return Err(self.refuse(
                format!("`excitation.{key}` is given without `kind`"),
                format!("add kind = \"{}\" or \"{last}\"", others.join("\", \"")),
            ));
        }
        let hint = match self.kind.keys {
            [] => "remove the key, or choose another kind".to_owned(),
            _ => format!("it takes {}", self.taken()),
        };
        Err(self.refuse(format!("`excitation.{key}` does not belong to kind = \"{}\"", self.kind.name), hint))
    }

    fn taken(&self) -> String {
        let keys: Vec<&str> = self.kind.keys.iter().map(|(key, _)| *key).collect();
        keys.join(", ")
    }

    fn value(&self, key: &str) -> Option<&Value> {
        self.section.given.iter().find(|(k, _)| *k == key).map(|(_, value)| value)
    }

    fn missing(&self, key: &str) -> Error {
        self.refuse(
            format!("`excitation.{key}` is missing: kind = \"{}\" needs it", self.kind.name),
            format!("it takes {}", self.taken()),
        )
    }

    /// A number that may be drawn, if it is given.
    pub fn number(&self, key: &str) -> Option<Number> {
        match self.value(key) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// A number that may be drawn.
    ///
    /// # Errors
    /// It is missing.
    pub fn need(&self, key: &str) -> Result<Number> {
        self.number(key).ok_or_else(|| self.missing(key))
    }

    /// A whole number.
    ///
    /// # Errors
    /// It is missing.
    pub fn whole(&self, key: &str) -> Result<u32> {
        match self.value(key) {
            Some(Value::Whole(whole)) => Ok(*whole),
            _ => Err(self.missing(key)),
        }
    }

    /// A plain number, if it is given.
    pub fn real(&self, key: &str) -> Option<f64> {
        match self.value(key) {
            Some(Value::Real(real)) => Some(*real),
            _ => None,
        }
    }

    /// A word, if it is given.
    pub fn text(&self, key: &str) -> Option<&str> {
        match self.value(key) {
            Some(Value::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// A word.
    ///
    /// # Errors
    /// It is missing.
    pub fn need_text(&self, key: &str) -> Result<&str> {
        self.text(key).ok_or_else(|| self.missing(key))
    }

    /// A file, relative to the study.
    ///
    /// # Errors
    /// It is missing.
    pub fn file(&self, key: &str) -> Result<PathBuf> {
        self.need_text(key).map(|file| self.run.folder.join(file))
    }

    /// A table of pairs.
    ///
    /// # Errors
    /// It is missing.
    pub fn pairs(&self, key: &str) -> Result<&[[f64; 2]]> {
        match self.value(key) {
            Some(Value::Pairs(pairs)) => Ok(pairs),
            _ => Err(self.missing(key)),
        }
    }

    /// A number that all members share.
    ///
    /// # Errors
    /// It is drawn per member.
    pub fn fixed(&self, key: &str, number: Number) -> Result<f64> {
        number.fixed().ok_or_else(|| {
            self.refuse(
                format!(
                    "`excitation.{key}` is drawn per member, but all members share the shape of a {}",
                    self.kind.name
                ),
                "give one number; the size (amplitude, rms, peak, scale) may be drawn, and all numbers of a sine",
            )
        })
    }

    /// A number above zero that all members share.
    ///
    /// # Errors
    /// It is missing, drawn, or not above zero.
    pub fn positive(&self, key: &str) -> Result<f64> {
        match self.fixed(key, self.need(key)?)? {
            value if value > 0.0 => Ok(value),
            value => {
                Err(self.refuse(format!("`excitation.{key}` = {value}: need more than zero"), "give a positive number"))
            }
        }
    }

    /// When a pulse begins, s; zero unless given.
    ///
    /// # Errors
    /// It is drawn, or negative.
    pub fn start_s(&self) -> Result<f64> {
        match self.fixed("start_s", self.number("start_s").unwrap_or(Number::Fixed(0.0)))? {
            value if value >= 0.0 => Ok(value),
            value => {
                Err(self
                    .refuse(format!("`excitation.start_s` = {value} s: need zero or more"), "the run begins at zero"))
            }
        }
    }

    /// Both ends of a band, Hz.
    ///
    /// # Errors
    /// One is missing, drawn, or not above zero.
    pub fn band_hz(&self) -> Result<(f64, f64)> {
        Ok((self.positive("from_hz")?, self.positive("to_hz")?))
    }
}
