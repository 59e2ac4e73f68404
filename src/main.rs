//! Parse, run, exit code: the only place that prints an error.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use proofmass::cli;
use proofmass::escape::terminal;

fn main() -> ExitCode {
    // Silences a line that Mesa's device selection prints on machines without a desktop.
    // SAFETY: no other thread exists yet that could read the environment.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    #[cfg(unix)]
    set_signals();
    match cli::Arguments::try_parse().map_err(cli::not_understood).and_then(|a| cli::run(&a)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Where nobody can be told, the exit code still tells.
            let _ = writeln!(std::io::stderr(), "error: {}", terminal(&error.to_string()));
            ExitCode::from(cli::exit_code(&error))
        }
    }
}

/// `proofmass … | head` ends like any other tool when `head` has seen enough, and does not panic in `println!`. A limit on
/// the size of files (`ulimit -f`) is an error of the write that meets it, and does not kill half-way through a file.
#[cfg(unix)]
fn set_signals() {
    // SAFETY: the default action and "ignore" run no code of ours, and no thread or handler exists yet.
    unsafe {
        libc::signal(libc::SIGPIPE, libc::SIG_DFL);
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}
