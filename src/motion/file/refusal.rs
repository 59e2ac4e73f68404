//! Why a file of poses cannot be used: cause and hint, until the file's name is known.

/// Cause and hint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Refusal {
    /// What is wrong.
    pub cause: String,
    /// What to do.
    pub hint: String,
}

/// One of them.
pub(super) fn refusal(cause: impl Into<String>, hint: impl Into<String>) -> Refusal {
    Refusal { cause: cause.into(), hint: hint.into() }
}
