//! Why a file of poses cannot be used: cause and hint, until the file's name is known.

/// Cause and hint of an error whose file is not named yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Refusal {
    /// Cause: what is wrong with the file.
    pub cause: String,
    /// Hint at what the user can do.
    pub hint: String,
}

/// A refusal with this cause and hint.
pub(super) fn refusal(cause: impl Into<String>, hint: impl Into<String>) -> Refusal {
    Refusal { cause: cause.into(), hint: hint.into() }
}
