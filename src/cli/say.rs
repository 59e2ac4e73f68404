//! What a command answers, on stdout. A disk that is full or a stream that is closed is an error here and not a panic, as
//! it would be in `println!`.

use std::fmt::Arguments;
use std::io::Write;

use crate::error::{Error, Result};

/// Writes to stdout.
///
/// # Errors
/// When stdout cannot be written.
pub fn say(text: Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_fmt(text).and_then(|()| out.flush()).map_err(|e| {
        Error::new("could not print the result", e.to_string(), "make room where it goes to, or give --out DIR")
    })
}

/// Like `println!`, with an error to pass on.
macro_rules! sayln {
    ($($arg:tt)*) => { $crate::cli::say::say(format_args!("{}\n", format_args!($($arg)*))) };
}

/// Like `eprintln!`, for words whose loss changes nothing.
macro_rules! remark {
    ($($arg:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($arg)*);
    }};
}

pub(crate) use {remark, sayln};
