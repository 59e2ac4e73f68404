//! `proofmass diagnose`: a recording and the model that should explain it in, a verdict out.

use std::path::{Path, PathBuf};

use super::say::{say, sayln};
use crate::diagnosis::model;
use crate::diagnosis::{self, Diagnosis, consequence, repair};
use crate::document::{to_json, writable, write_whole};
use crate::error::Result;
use crate::report::diagnosis as page;

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The recording: a CSV file with a header row
    pub recording: PathBuf,
    /// What the recording is and what is believed of it (model.toml)
    #[arg(long)]
    pub model: PathBuf,
    /// Where to write report.html, verdict.json, model.toml and the figures
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Diagnoses, prints the verdict and writes the report.
///
/// # Errors
/// A recording or model that cannot be read or judged; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let model = model::read(&arguments.model)?;
    let recording = model::read_recording(&arguments.recording, &model)?;
    arguments.out.as_deref().map_or(Ok(()), writable)?;
    let diagnosis = diagnosis::diagnose(&recording, &model)?;
    let costs = consequence::costs(&diagnosis)?;
    if let Some(folder) = &arguments.out {
        write(folder, &diagnosis, &costs)?;
    }
    if json {
        sayln!("{}", to_json(&diagnosis.verdict)?)?;
    } else {
        say(format_args!("{}", page::terminal(&diagnosis, &costs)))?;
        if let Some(folder) = &arguments.out {
            sayln!("report: {}", folder.join("report.html").display())?;
        }
    }
    Ok(())
}

fn write(folder: &Path, diagnosis: &Diagnosis, costs: &[repair::Cost]) -> Result<()> {
    let exhibits = page::exhibits(&diagnosis.detail);
    for exhibit in &exhibits {
        write_whole(&folder.join(format!("{}.svg", exhibit.name)), exhibit.figure.file_svg().as_bytes())?;
    }
    write_whole(&folder.join("verdict.json"), to_json(&diagnosis.verdict)?.as_bytes())?;
    let study = diagnosis.repair.as_ref().map(|r| repair::study_document(r, &diagnosis.verdict));
    if let Some(study) = &study {
        write_whole(&folder.join("model.toml"), study.as_bytes())?;
    }
    let html = page::page(diagnosis, costs, &exhibits, study.as_deref());
    write_whole(&folder.join("report.html"), html.as_bytes())
}
