//! What a command answers, on stdout. A disk that is full or a stream that is closed is an error here and not a panic, as
//! it would be in `println!`; control characters in names are shown, not sent.

use std::fmt::Arguments;
use std::io::Write;

use crate::error::{Error, Result};
use crate::escape::terminal;

/// Writes to stdout.
///
/// # Errors
/// When stdout cannot be written.
pub fn say(text: Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let text = text.to_string();
    out.write_all(terminal(&text).as_bytes()).and_then(|()| out.flush()).map_err(|e| not_printed(&e))
}

/// What is said when stdout cannot be written.
pub fn not_printed(cause: &std::io::Error) -> Error {
    Error::new("could not print the result", cause.to_string(), "make room where it goes to, or give --out DIR")
}

/// Like `println!`, with an error to pass on.
macro_rules! sayln {
    ($($arg:tt)*) => { $crate::cli::say::say(format_args!("{}\n", format_args!($($arg)*))) };
}

/// Like `eprintln!`, for words whose loss changes nothing.
macro_rules! remark {
    ($($arg:tt)*) => {{
        use std::io::Write as _;
        let text = format!($($arg)*);
        let _ = writeln!(std::io::stderr(), "{}", $crate::escape::terminal(&text));
    }};
}

pub(crate) use {remark, sayln};
