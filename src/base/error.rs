//! The one error type: what was tried, what was wrong, and what to do about it.
//!
//! Not for control flow inside numerics: a fit that does not converge is a result there, not an
//! error.

use std::path::Path;

/// Shorthand used throughout the crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Reason why the work ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kind {
    /// The attempt failed, for the cause stated.
    #[default]
    Failed,
    /// The user, or the system, asked the run to stop.
    Interrupted,
}

/// An error a person can act on. Printed by `main` alone; exit code 2, or 128 and the number of the
/// signal that stopped the run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{attempt}\n  cause: {cause}\n  hint:  {hint}")]
pub struct Error {
    /// Attempt, as a clause: "could not read model.toml".
    pub attempt: String,
    /// Cause, with file, line, column and need/got where they exist.
    pub cause: String,
    /// Hint at what the user can do.
    pub hint: String,
    /// Reason why the work ended.
    pub kind: Kind,
}

impl Error {
    /// An error from its three parts.
    pub fn new(attempt: impl Into<String>, cause: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { attempt: attempt.into(), cause: cause.into(), hint: hint.into(), kind: Kind::Failed }
    }

    /// A failed file operation.
    pub fn io(verb: &str, path: &Path, cause: &std::io::Error) -> Self {
        let hint = match cause.kind() {
            std::io::ErrorKind::NotFound => "check the spelling; paths inside a .toml are relative to that file",
            std::io::ErrorKind::PermissionDenied if verb == "read" => "grant yourself permission to read it",
            std::io::ErrorKind::PermissionDenied => "choose a folder you may write to, e.g. with --out DIR",
            std::io::ErrorKind::AlreadyExists | std::io::ErrorKind::NotADirectory => {
                "there is a file where a folder should be: give another, e.g. with --out DIR"
            }
            std::io::ErrorKind::StorageFull => "make room on that disk, or choose another folder with --out DIR",
            std::io::ErrorKind::FileTooLarge => {
                "allow larger files (ulimit -f unlimited), or choose another file system"
            }
            std::io::ErrorKind::IsADirectory => "give a file, not a folder",
            _ => "check the path, the permissions and the free space",
        };
        Self::new(format!("could not {verb} {}", path.display()), cause.to_string(), hint)
    }

    /// In the words of a longer work of which the one that was stopped by Ctrl-C is a part; other
    /// errors stay as they are.
    pub fn within(self, attempt: &str, hint: &str) -> Self {
        match self.kind {
            Kind::Interrupted => Self { attempt: attempt.into(), hint: hint.into(), ..self },
            Kind::Failed => self,
        }
    }
}

/// The nearest of `known` to a misspelt `word`, if any is near enough to be meant.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let known: Vec<&str> = known.into_iter().collect();
    // A key without its unit: `bias` is `bias_deg_h`.
    let without_unit = || {
        known
            .iter()
            .copied()
            .filter(|k| k.strip_prefix(word).is_some_and(|rest| rest.starts_with('_')))
            .min_by_key(|k| k.len())
    };
    known
        .iter()
        .copied()
        .map(|k| (strsim::damerau_levenshtein(word, k), k))
        // A word of which less than half is kept is another one.
        .filter(|(d, k)| *d <= 2 + k.len() / 4 && 2 * d <= word.chars().count().max(k.chars().count()))
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
        .or_else(without_unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_key_finds_its_neighbour_and_a_stranger_does_not() {
        let known = ["duration_s", "step_s", "members"];
        assert_eq!(nearest("durations", known), Some("duration_s"));
        assert_eq!(nearest("zzzzzzzzzz", known), None);
        assert_eq!([nearest("zz", ["t"]), nearest("tz", ["t"])], [None, Some("t")]);
        assert_eq!(nearest("bias", ["bias_instability_deg_h", "bias_deg_h"]), Some("bias_deg_h"));
        assert_eq!(nearest("ros", ["vins", "kalibr"]), None);
    }
}
