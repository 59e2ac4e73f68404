//! Right or wrong: one verdict against its truth, by fixed rules.
//!
//! - Nothing planted: `adequate` is right; all else is a false alarm, `undecidable` too: it claims
//!   that something may be missing.
//! - Physics of the library: the named set must be the planted set. `undecidable` also counts as
//!   right when every planted effect stands in a tie of at most two and every tie holds a planted
//!   effect. What is not searched for, as it resembles what is, may have the name of either.
//! - Foreign physics: only `unexplained` is right.

use serde::{Deserialize, Serialize};

use super::case::Case;
use super::said::{Ending, Said};

/// Worth of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mark {
    /// Exactly what was planted.
    Named,
    /// Undecidable, the truth among at most two.
    Tied,
    /// Part of what was planted, nothing else.
    Partial,
    /// All of it and something more.
    Extra,
    /// An effect that is not there, named with confidence.
    Wrong,
    /// A real mismatch, no name.
    Unexplained,
    /// No decision between several, or too weak to say.
    Undecided,
    /// Adequate, though something was planted.
    Silent,
    /// The diagnosis ended with an error.
    Error,
}

impl Mark {
    /// Name of the mark in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::Tied => "tied with one other",
            Self::Partial => "part of it",
            Self::Extra => "and something more",
            Self::Wrong => "wrong name",
            Self::Unexplained => "unexplained",
            Self::Undecided => "undecided",
            Self::Silent => "silent",
            Self::Error => "error",
        }
    }

    /// Returns whether the planted effects were named, alone or in a tie of two.
    pub fn is_named(self) -> bool {
        matches!(self, Self::Named | Self::Tied)
    }

    /// Returns whether a false name was given with confidence.
    pub fn is_confidently_wrong(self) -> bool {
        matches!(self, Self::Wrong | Self::Extra)
    }
}

/// The mark of a verdict on a case.
pub fn judge(case: &Case, said: &Said) -> Mark {
    let truth = case.names();
    let ids = said.ids();
    let allows = |id: &String| truth.iter().any(|names| names.contains(id));
    let hit = truth.iter().filter(|names| names.iter().any(|name| ids.contains(name))).count();
    match said.outcome {
        Ending::Error => Mark::Error,
        Ending::Adequate => Mark::Silent,
        Ending::Unexplained => Mark::Unexplained,
        Ending::Undecidable => {
            let tight = said.groups.iter().all(|g| g.len() <= 2 && g.iter().any(allows));
            if !truth.is_empty() && hit == truth.len() && tight { Mark::Tied } else { Mark::Undecided }
        }
        Ending::Explained => {
            let (inside, outside): (Vec<_>, Vec<_>) = ids.iter().partition(|id| allows(id));
            // Both names of one effect are one too many.
            match (inside.len(), outside.len()) {
                (named, 0) if named == truth.len() && hit == named && hit > 0 => Mark::Named,
                (named, 0) if named > 0 && hit < truth.len() => Mark::Partial,
                (named, _) if named > 0 && hit == truth.len() => Mark::Extra,
                _ => Mark::Wrong,
            }
        }
    }
}

/// Returns whether a verdict on a null raised an alarm: a name, a mismatch claimed, or one that may
/// be there.
pub(crate) fn is_alarm(said: &Said) -> bool {
    is_detected(said)
}

/// Returns whether the mismatch was noticed at all, whatever it was called.
pub(crate) fn is_detected(said: &Said) -> bool {
    !matches!(said.outcome, Ending::Adequate | Ending::Error)
}

/// For each planted parameter that the verdict gives an interval for: whether the interval covers
/// the truth.
pub(crate) fn coverage(case: &Case, said: &Said) -> Vec<Covered> {
    if judge(case, said) != Mark::Named {
        return Vec::new();
    }
    let numbers = said.numbers.iter();
    numbers
        .filter_map(|n| {
            let truth = case.parameter(&n.id, &n.channel, &n.name)?;
            // The file holds nine digits: a step read off them exactly may still differ in the
            // last.
            let air = 1e-6 * truth.abs();
            let covers = n.ci95[0] - air <= truth && truth <= n.ci95[1] + air;
            Some(Covered { id: n.id.clone(), name: n.name.clone(), truth, value: n.value, covers })
        })
        .collect()
}

/// An interval compared with the planted value.
#[derive(Debug, Clone, PartialEq)]
pub struct Covered {
    /// Library id of the effect.
    pub id: String,
    /// Symbol of the parameter.
    pub name: String,
    /// Planted value.
    pub truth: f64,
    /// Estimated value.
    pub value: f64,
    /// States whether the interval holds the truth.
    pub covers: bool,
}
