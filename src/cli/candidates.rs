//! `proofmass candidates`: the physics that `diagnose` can name, as a table.

use crate::diagnosis;
use crate::error::{Error, Result};
use crate::report::table::Table;

/// Arguments of `candidates`.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Prints the library.
///
/// # Errors
/// None in practice; the library is part of the binary.
pub fn run(_arguments: &Arguments, json: bool) -> Result<()> {
    let library: Vec<_> = diagnosis::library().collect();
    if json {
        let text = serde_json::to_string_pretty(&library)
            .map_err(|e| Error::new("could not write the library as JSON", e.to_string(), "report this as a defect"))?;
        println!("{text}");
        return Ok(());
    }
    let mut table = Table::new(&[
        "kind",
        "id",
        "what was left out",
        "equation",
        "what points to it",
        "confusable with",
        "reference",
    ]);
    for candidate in library {
        table.row([
            candidate.kind.name().to_owned(),
            candidate.id.to_owned(),
            candidate.statement.to_owned(),
            candidate.equation.to_owned(),
            candidate.signature.to_owned(),
            candidate.confusable_with.join(", "),
            candidate.reference.to_owned(),
        ]);
    }
    print!("{table}");
    Ok(())
}
