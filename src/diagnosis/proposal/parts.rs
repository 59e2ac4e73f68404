//! Hold what every proposal is made of: the user's choices, lists of columns, the refusal.

use crate::document::toml_string;
use crate::error::Error;
use crate::recording::inspection::{Column, Rows};

/// Choices of the user, each taken from the headings or the clock where absent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Named {
    /// Heading of the force on the proof mass.
    pub input: Option<String>,
    /// Heading of its reading.
    pub output: Option<String>,
    /// Sampling rate of a recording without a clock, Hz.
    pub rate_hz: Option<f64>,
    /// Heading of the clock.
    pub time: Option<String>,
    /// States that a part of the recording was cut out: of a sensor that mostly rests in it, its rest.
    pub is_cut: bool,
}

/// The refusal to choose.
pub(super) fn refused(file: &str, cause: String, hint: String) -> Error {
    Error::new(format!("could not choose a model for {file}"), cause, hint)
}

pub(super) fn list<'a>(names: impl IntoIterator<Item = &'a Column>) -> String {
    let names: Vec<String> = names.into_iter().map(|c| toml_string(&c.name)).collect();
    format!("[{}]", names.join(", "))
}

pub(super) fn environment(rows: &Rows) -> String {
    let around: Vec<&Column> = rows.columns.iter().filter(|c| c.is_environment).collect();
    if around.is_empty() { String::new() } else { format!("environment = {}\n", list(around)) }
}
