//! `proofmass diagnose`: a recording and the model that should explain it in, a verdict out.

use std::path::PathBuf;

use super::chosen::{Asked, Clock, Headings, Part, model_for};
use super::numbers;
use super::output::{remark, sayln, screen};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_diagnosis::gate::Gate;
use proofmass_diagnosis::model::{self, Model};
use proofmass_diagnosis::recordings::Recordings;
use proofmass_diagnosis::{self as diagnosis, repair, repaired};
use proofmass_recording::Recording;
use proofmass_report::diagnosis::{self as page, Diagnosis};
use proofmass_report::inspection::in_a_line;

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The recording: text with a header row, an array, a table or a robot's log; several of one
    /// sensor are fitted together (kind = "driven")
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<PathBuf>,
    /// Recordings of the same sensor used for validation only, never fitted (kind = "driven")
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    pub test: Vec<PathBuf>,
    /// Description of the recording and of the model to be tested (model.toml); absent: chosen by
    /// the recording's headings and said first
    #[arg(long)]
    pub model: Option<PathBuf>,
    /// Columns of a driven recording, where no model is given
    #[command(flatten)]
    pub headings: Headings,
    /// Clock of each recording, where no model is given
    #[command(flatten)]
    pub clock: Clock,
    /// Part of each recording that is used
    #[command(flatten)]
    pub part: Part,
    /// Use the model's rate_hz even against a recording's own clock; also `force_rate` in the model
    #[arg(long)]
    pub force_rate: bool,
    /// Folder for report.html, verdict.json, repaired.toml, the figures and their numbers
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long, requires = "out")]
    pub parquet: bool,
    /// Also write which rules acted, what each changed and on what number (`trace` in verdict.json;
    /// kind = "driven")
    #[arg(long)]
    pub trace: bool,
    /// Switch off a rule of the search or of the conclusion, to see what it is worth
    #[arg(long, value_name = "GATE", value_parser = gate, hide = true)]
    pub without: Vec<Gate>,
}

/// The gate of this id.
///
/// # Errors
/// There is none; the ids are listed.
pub(super) fn gate(id: &str) -> std::result::Result<Gate, String> {
    let ids = || Gate::ALL.iter().map(|g| g.id()).collect::<Vec<_>>().join(", ");
    Gate::of_id(id).ok_or_else(|| format!("no such gate; the gates are {}", ids()))
}

/// Diagnoses, prints the verdict and writes the report.
///
/// # Errors
/// A recording or model that cannot be read or judged; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let control = progress::terminal();
    let seconds = arguments.part.seconds();
    let Arguments { part, headings, clock, .. } = arguments;
    let asked = Asked { part: part.clone(), headings: headings.clone(), clock: clock.clone() };
    let (mut model, proposal) = model_for(&arguments.recordings[0], arguments.model.as_deref(), &asked, &control)?;
    if arguments.force_rate {
        model = model.with_forced_rate();
    }
    model = model.without(&arguments.without);
    let read = |paths: &[PathBuf]| -> Result<Vec<Recording>> {
        paths.iter().map(|path| model::read_part(path, &model, seconds, &control)).collect()
    };
    let (train, test) = (read(&arguments.recordings)?, read(&arguments.test)?);
    for note in train.iter().filter_map(|recording| model::memory_note(recording, &model)) {
        remark!("{note}");
    }
    let outputs = || outputs(arguments, &model);
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, outputs())).transpose()?;
    let answer = diagnosis::diagnose_all(Recordings { train: &train, test: &test }, &model, &control)?;
    let mut diagnosis = page::worded(answer);
    if arguments.trace {
        diagnosis = diagnosis.with_trace();
    }
    if let Some(text) = &proposal {
        let words = in_a_line(text);
        diagnosis.verdict.findings.insert(0, format!("no model was given; it was chosen by the headings: {words}"));
    }
    let costs = page::costs(&diagnosis, &control)?;
    // The answer of long work is said even where its report cannot be written.
    let written = folder.map_or(Ok(()), |folder| write(folder, &diagnosis, &costs, proposal.as_deref()));
    if json {
        sayln!("{}", to_json(&diagnosis.verdict)?)?;
    } else {
        screen(format_args!("{}", page::terminal(&diagnosis, &costs)))?;
        if let (Some(folder), Ok(())) = (&arguments.out, &written) {
            sayln!("report: {}", folder.join(REPORT).display())?;
        }
    }
    written
}

const REPORT: &str = "report.html";
const VERDICT: &str = "verdict.json";
/// Never a name that an input carries: model.toml is what the user believes.
const REPAIRED: &str = "repaired.toml";
/// The same sensor with the constants that a navigator subtracts left in.
const UNCORRECTED: &str = "uncorrected.toml";
/// The model that was chosen where none was given: to be edited and given with --model.
const PROPOSED: &str = "proposed.toml";

fn outputs(arguments: &Arguments, model: &Model) -> output::Request {
    output::Request {
        command: "diagnose",
        inputs: arguments.recordings.iter().chain(&arguments.test).chain(&arguments.model).cloned().collect(),
        reads: model.files(),
        writes: [REPORT, VERDICT, REPAIRED, UNCORRECTED, PROPOSED]
            .map(str::to_owned)
            .into_iter()
            .chain(numbers::files(arguments.parquet))
            .collect(),
        force: arguments.force,
        keeps: false,
    }
}

fn write(mut folder: Folder, diagnosis: &Diagnosis, costs: &[repair::Cost], proposal: Option<&str>) -> Result<()> {
    let exhibits = page::exhibits(&diagnosis.detail);
    for exhibit in &exhibits {
        folder.write(&format!("{}.svg", exhibit.name), exhibit.figure.file_svg().as_bytes())?;
    }
    if let Some(text) = proposal {
        folder.write(PROPOSED, text.as_bytes())?;
    }
    folder.write(VERDICT, to_json(&diagnosis.verdict)?.as_bytes())?;
    let study = repaired::document(diagnosis.repair.as_ref(), &diagnosis.detail, &diagnosis.verdict);
    if let Some(study) = &study {
        folder.write(REPAIRED, study.as_bytes())?;
    }
    if let Some(study) = repaired::uncorrected(&diagnosis.detail, &diagnosis.verdict) {
        folder.write(UNCORRECTED, study.as_bytes())?;
    }
    numbers::write(&mut folder, REPORT, page::page(diagnosis, costs, &exhibits, study.as_deref()))?;
    folder.finish()
}
