//! States what is truly there in a case of the second generator, and which names that makes right,
//! honest or false.

use serde::{Deserialize, Serialize};

/// Kind of recording, as in model.toml.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Input and output of one proof mass.
    Driven,
    /// A sensor at rest.
    Static,
    /// An IMU hand-rotated.
    Tumble,
    /// Stepped-sine sweeps of a resonator.
    Response,
}

impl Kind {
    /// All, in the order of the report.
    pub const ALL: [Self; 4] = [Self::Driven, Self::Static, Self::Tumble, Self::Response];

    /// Value of `kind` in model.toml.
    pub fn name(self) -> &'static str {
        match self {
            Self::Driven => "driven",
            Self::Static => "static",
            Self::Tumble => "tumble",
            Self::Response => "response",
        }
    }
}

/// Relation of a truth to the library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Exactly as a statement of the library says.
    Letter,
    /// Its form departs from a statement of the library.
    Near,
    /// No statement of the library describes it.
    Foreign,
    /// The base model is right; only the noise is real.
    Null,
}

impl Family {
    /// All, in the order of the report.
    pub const ALL: [Self; 4] = [Self::Letter, Self::Near, Self::Foreign, Self::Null];

    /// Name of the family in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Letter => "to the letter",
            Self::Near => "near",
            Self::Foreign => "foreign",
            Self::Null => "null",
        }
    }
}

/// A number that a verdict may give an interval for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Library id of the effect.
    pub id: String,
    /// Column, where there are several.
    pub channel: Option<String>,
    /// Symbol as in verdict.json.
    pub name: String,
    /// True value in the unit of verdict.json.
    pub value: f64,
}

/// An effect that is present in a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Names of which any one is right.
    pub right: Vec<String>,
    /// Twice the log-likelihood that it adds over the best base model: the square of the
    /// signal-to-noise ratio of a matched filter.
    pub evidence: f64,
    /// Root-mean-square over that of the noise.
    pub over_noise: f64,
}

/// The truth of one case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Holds what is there; without an entry the base model is right, or what is there has no name.
    pub effects: Vec<Effect>,
    /// Names that are right as well, whatever the verdict.
    pub also: Vec<String>,
    /// Names that point to the right place, but explain nothing: right next to `unexplained` or in
    /// a tie.
    pub tolerable: Vec<String>,
    /// Evidence of everything together.
    pub evidence: f64,
    /// Evidence of what the nearest statement of the library leaves, where it is known.
    pub departure: Option<f64>,
    /// Rms of the noise in the reading, column units, and rows: what a repaired model that explains
    /// has to reach.
    pub floor: Option<[f64; 2]>,
    /// Intervals are held against these.
    pub parameters: Vec<Parameter>,
    /// Columns next to others that show an effect, in which nothing acts: any name there is false.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub silent: Vec<String>,
}

/// Evidence that a test must see: 24 candidates tried at 0.1 % on the third of the data that is
/// held out ask for (3.94 + 2.33)² ≈ 39 there to be seen in 99 of 100, three times that in the
/// whole.
pub(crate) const SEEN: f64 = 120.0;

impl Truth {
    /// Ids right under any verdict.
    pub fn allows(&self, id: &str) -> bool {
        self.also.iter().any(|a| a == id) || self.effects.iter().any(|e| e.right.iter().any(|r| r == id))
    }

    /// Ids right where nothing is explained.
    pub fn tolerates(&self, id: &str) -> bool {
        self.allows(id) || self.tolerable.iter().any(|t| t == id)
    }

    /// Returns whether a good test sees that something is missing.
    pub fn is_detectable(&self) -> bool {
        self.evidence >= SEEN
    }

    /// Names of what is there, alternatives joined by "|".
    pub fn words(&self) -> String {
        let words: Vec<String> = self.effects.iter().map(|e| e.right.join("|")).collect();
        if words.is_empty() { "–".into() } else { words.join(" + ") }
    }
}

/// One detectable effect of a name.
pub(crate) fn effect(right: &[&str]) -> Effect {
    Effect { right: right.iter().map(|r| (*r).to_owned()).collect(), evidence: 0.0, over_noise: 0.0 }
}
