//! `proofmass study`.

use crate::error::{Error, Result};

/// Arguments of `study`.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Runs it.
///
/// # Errors
/// Always, until it is built.
pub fn run(_arguments: &Arguments, _json: bool) -> Result<()> {
    Err(Error::new("could not run `study`", "not built yet", "see the README"))
}

/// The default study.
pub fn run_default(_json: bool) -> Result<()> {
    Err(Error::new("could not run the default study", "not built yet", "see the README"))
}
