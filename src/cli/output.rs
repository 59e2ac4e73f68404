//! Output: writes the answer of a command to stdout. A disk that is full or a stream that is closed is an
//! error here and not a panic, as it would be in `println!`; control characters in names are shown,
//! not sent.

use std::fmt::Arguments;
use std::io::{IsTerminal, Write};

use proofmass_base::error::{Error, Result};
use proofmass_base::escape::terminal;

/// Like `println!`, with an error to pass on.
macro_rules! sayln {
    ($($arg:tt)*) => { $crate::output::say(format_args!("{}\n", format_args!($($arg)*))) };
}

/// Like `eprintln!`, for words whose loss changes nothing.
macro_rules! remark {
    ($($arg:tt)*) => {{
        use std::io::Write as _;
        let text = format!($($arg)*);
        let _ = writeln!(std::io::stderr(), "{}", proofmass_base::escape::terminal(&text));
    }};
}

pub(crate) use {remark, sayln};

/// Writes to stdout.
///
/// # Errors
/// When stdout cannot be written.
pub fn say(text: Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let text = text.to_string();
    out.write_all(terminal(&text).as_bytes()).and_then(|()| out.flush()).map_err(|e| not_printed(&e))
}

/// Writes an answer to stdout: on a terminal in colour, its first sentence above all, unless
/// `NO_COLOR` asks for none (no-color.org).
///
/// # Errors
/// When stdout cannot be written.
pub fn screen(text: Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let (text, set) = (text.to_string(), |name| std::env::var_os(name).is_some_and(|v| !v.is_empty()));
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    // Painted after what is foreign in it was made harmless.
    let text = match out.is_terminal() && !set("NO_COLOR") && !dumb {
        true => painted(&terminal(&text)),
        false => terminal(&text).into_owned(),
    };
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|e| not_printed(&e))
}

/// The first paragraph bold and cyan, the title of a table bold, its rule faint.
fn painted(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let is_rule = |k: usize| lines.get(k).is_some_and(|l| l.starts_with('─'));
    let opening = lines.iter().position(|l| l.is_empty()).unwrap_or(lines.len());
    let line = |(k, line): (usize, &&str)| {
        let code = match k {
            _ if line.is_empty() => return "\n".to_owned(),
            _ if k < opening && !is_rule(k + 1) => "1;36",
            _ if is_rule(k) => "2",
            _ if is_rule(k + 2) => "1",
            _ => return format!("{line}\n"),
        };
        format!("\u{1b}[{code}m{line}\u{1b}[0m\n")
    };
    lines.iter().enumerate().map(line).collect()
}

/// Returns the error of a stdout that cannot be written.
pub fn not_printed(cause: &std::io::Error) -> Error {
    Error::new("could not print the result", cause.to_string(), "free space where the output goes, or give --out DIR")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answer_stands_out_and_numbers_stay_plain() {
        let text = "It drifts.\nBy 3 m.\n\nposition error\ntime  sd\n────  ──\n   1   3\n";
        let (bold, faint, end) = ("\u{1b}[1m", "\u{1b}[2m", "\u{1b}[0m");
        let answer = |line: &str| format!("\u{1b}[1;36m{line}{end}\n");
        let opening = answer("It drifts.") + &answer("By 3 m.");
        let rest = format!("\n{bold}position error{end}\ntime  sd\n{faint}────  ──{end}\n   1   3\n");
        assert_eq!(painted(text), opening + &rest);
    }
}
