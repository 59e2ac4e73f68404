//! Parse, run, exit code: the only place that prints an error.

use std::process::ExitCode;

use clap::Parser;
use proofmass::cli;

fn main() -> ExitCode {
    match cli::run(&cli::Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
