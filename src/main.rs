//! Parse, run, exit code: the only place that prints an error.

use std::process::ExitCode;

use clap::Parser;
use proofmass::cli;

fn main() -> ExitCode {
    // Silences a line that Mesa's device selection prints on machines without a desktop.
    // SAFETY: no other thread exists yet that could read the environment.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    match cli::run(&cli::Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
