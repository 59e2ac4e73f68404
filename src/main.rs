//! The command: everything it does is `cli`'s.

use std::process::ExitCode;

use proofmass::cli;

fn main() -> ExitCode {
    // Silences a line that Mesa's device selection prints on machines without a desktop.
    // SAFETY: no other thread exists yet that could read the environment.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    ExitCode::from(cli::main(std::env::args_os()))
}
