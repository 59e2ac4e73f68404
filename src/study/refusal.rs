//! The error of a study that cannot be used.

use crate::error::Error;

/// Why a study cannot be used.
pub(super) fn refuse(name: &str, cause: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::new(format!("could not use {name}"), cause, hint)
}
