//! `proofmass candidates`: the physics that `diagnose` can name.

use super::output::sayln;
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_diagnosis as diagnosis;
use proofmass_diagnosis::candidate::{Candidate, Kind};

/// Arguments of `candidates`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Only those of one kind of recording: driven, static, tumble, trajectory or response
    #[arg(long, value_name = "KIND", value_parser = kind)]
    kind: Option<Kind>,
}

fn kind(text: &str) -> Result<Kind, String> {
    let all = Kind::ALL.map(Kind::name).join(", ");
    Kind::ALL.into_iter().find(|k| k.name() == text).ok_or_else(|| format!("need one of {all}"))
}

/// Prints the library, by kind of recording.
///
/// # Errors
/// None in practice; the library is part of the binary.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let library: Vec<&Candidate> =
        diagnosis::library().filter(|c| arguments.kind.is_none_or(|kind| c.kind == kind)).collect();
    if json {
        sayln!("{}", to_json(&library)?)?;
        return Ok(());
    }
    let mut kind = "";
    for candidate in library {
        if candidate.kind.name() != kind {
            kind = candidate.kind.name();
            sayln!("── kind = \"{kind}\" ──\n")?;
        }
        sayln!("{}", card(candidate))?;
    }
    Ok(())
}

/// One candidate, a line per property: seven columns of sentences would fit no terminal.
fn card(candidate: &Candidate) -> String {
    let parameters: Vec<String> = candidate.parameters.iter().map(|p| format!("{} [{}]", p.name, p.unit)).collect();
    let lines = [
        ("left out", candidate.statement.to_owned()),
        ("equation", candidate.equation.to_owned()),
        ("parameters", parameters.join(", ")),
        ("acts in", candidate.acts.to_owned()),
        ("points to it", candidate.signature.to_owned()),
        ("confusable with", candidate.confusable_with.join(", ")),
        ("reference", candidate.reference.to_owned()),
    ];
    let body: String =
        lines.iter().filter(|(_, text)| !text.is_empty()).map(|(name, text)| format!("  {name:<16}{text}\n")).collect();
    format!("{}\n{body}", candidate.id)
}
