//! `proofmass completions` and `proofmass man`: what a shell and a manual need, made from the
//! command line itself.

use clap_complete::Shell;

use super::output::say;
use proofmass_base::error::{Error, Result};

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  proofmass completions bash > ~/.local/share/bash-completion/completions/proofmass")]
pub struct Completions {
    /// Shell to write the completions for
    #[arg(value_enum)]
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  proofmass man | man -l -")]
pub struct Man {}

/// Prints the completions of a command line for a shell.
///
/// # Errors
/// Stdout cannot be written.
pub fn completions(arguments: &Completions, mut command: clap::Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "proofmass", &mut script);
    say(format_args!("{}", String::from_utf8_lossy(&script)))
}

/// Prints the manual page: the command and, one after the other, its subcommands.
///
/// # Errors
/// Stdout cannot be written.
pub fn man(_: &Man, mut command: clap::Command) -> Result<()> {
    command.build();
    let mut page = Vec::new();
    let failed =
        |e: std::io::Error| Error::new("could not make the manual page", e.to_string(), "report this as a defect");
    clap_mangen::Man::new(command.clone()).render(&mut page).map_err(failed)?;
    for sub in command.get_subcommands().filter(|c| c.get_name() != "help") {
        let named = sub.clone().bin_name(format!("proofmass {}", sub.get_name()));
        let of = clap_mangen::Man::new(named);
        page.extend(format!(".SH \"PROOFMASS {}\"\n", sub.get_name().to_uppercase()).into_bytes());
        of.render_description_section(&mut page).map_err(failed)?;
        of.render_synopsis_section(&mut page).map_err(failed)?;
        of.render_options_section(&mut page).map_err(failed)?;
        of.render_extra_section(&mut page).map_err(failed)?;
    }
    say(format_args!("{}", String::from_utf8_lossy(&page)))
}
