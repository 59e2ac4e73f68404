//! `proofmass candidates`: the physics that `diagnose` can name, in words and pictures.

use std::path::{Path, PathBuf};

use super::output::sayln;
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::{self, Folder};
use proofmass_diagnosis as diagnosis;
use proofmass_diagnosis::candidate::{Candidate, Kind};
use proofmass_report::signature;

/// Arguments of `candidates`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Only those of one kind of recording: driven, static, tumble, trajectory or response
    #[arg(long, value_name = "KIND", value_parser = kind)]
    kind: Option<Kind>,
    /// Write a picture of what each would show to DIR/KIND-ID.svg, as far as one can be drawn
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command
    #[arg(long, requires = "figures")]
    force: bool,
}

fn kind(text: &str) -> Result<Kind, String> {
    let all = Kind::ALL.map(Kind::name).join(", ");
    Kind::ALL.into_iter().find(|k| k.name() == text).ok_or_else(|| format!("need one of {all}"))
}

/// Prints the library, by kind of recording.
///
/// # Errors
/// The folder of pictures cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let library: Vec<&Candidate> =
        diagnosis::library().filter(|c| arguments.kind.is_none_or(|kind| c.kind == kind)).collect();
    let without = arguments.figures.as_deref().map(|path| draw(&library, path, arguments.force)).transpose()?;
    if json {
        sayln!("{}", to_json(&library)?)?;
        return Ok(());
    }
    if let (Some(without), Some(path)) = (without, &arguments.figures) {
        sayln!("figures: {} in {}", library.len() - without.len(), path.display())?;
        if !without.is_empty() {
            sayln!("without one: {}", without.join(", "))?;
        }
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

/// Writes the pictures; returns the candidates that have none.
fn draw(library: &[&Candidate], path: &Path, force: bool) -> Result<Vec<String>> {
    let request = output::Request {
        command: "candidates",
        writes: library.iter().map(|candidate| signature::file(candidate)).collect(),
        force,
        ..output::Request::default()
    };
    let mut folder = Folder::open(path, request)?;
    let mut without = Vec::new();
    for candidate in library {
        match signature::figure(candidate) {
            Some(figure) => folder.write(&signature::file(candidate), figure.file_svg().as_bytes())?,
            None => without.push(format!("{} {}", candidate.kind.name(), candidate.id)),
        }
    }
    folder.finish()?;
    Ok(without)
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
