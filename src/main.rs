//! Parse, run, exit code: the only place that prints an error.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use proofmass::cli;

fn main() -> ExitCode {
    // Silences a line that Mesa's device selection prints on machines without a desktop.
    // SAFETY: no other thread exists yet that could read the environment.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    #[cfg(unix)]
    end_quietly_on_a_closed_pipe();
    match cli::Arguments::try_parse().map_err(cli::not_understood).and_then(|a| cli::run(&a)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Where nobody can be told, the exit code still tells.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

/// `proofmass … | head` ends like any other tool when `head` has seen enough, and does not panic in `println!`.
#[cfg(unix)]
fn end_quietly_on_a_closed_pipe() {
    const SIGPIPE: i32 = 13;
    const SIG_DFL: usize = 0;
    unsafe extern "C" {
        fn signal(number: i32, handler: usize) -> usize;
    }
    // SAFETY: the C library's `signal` with its default action, before any thread or handler exists; 13 is SIGPIPE on
    // Linux, macOS and the BSDs.
    unsafe { signal(SIGPIPE, SIG_DFL) };
}
