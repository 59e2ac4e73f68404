//! `proofmass paper`.

use crate::error::{Error, Result};

/// Arguments of `paper`.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Runs it.
///
/// # Errors
/// Always, until it is built.
pub fn run(_arguments: &Arguments, _json: bool) -> Result<()> {
    Err(Error::new("could not run `paper`", "not built yet", "see the README"))
}
