//! `proofmass diagnose`: a recording and the model that should explain it in, a verdict out.

use std::path::PathBuf;

use super::numbers;
use super::say::{remark, sayln, screen};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_diagnosis::model::{self, Model};
use proofmass_diagnosis::recordings::Recordings;
use proofmass_diagnosis::{self as diagnosis, consequence, repair, repaired};
use proofmass_recording::Recording;
use proofmass_report::diagnosis::{self as page, Diagnosis};

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
    /// What was recorded and the model to be tested (model.toml)
    #[arg(long)]
    pub model: PathBuf,
    /// Topic, message or array to read, if a recording has several; also `topic` in the model
    #[arg(long, value_name = "TOPIC")]
    pub topic: Option<String>,
    /// Use each recording from this many seconds after its first row
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub from_s: Option<f64>,
    /// Use each recording up to this many seconds after its first row
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub to_s: Option<f64>,
    /// Use the model's rate_hz even against a recording's own clock; also `force_rate` in the model
    #[arg(long)]
    pub force_rate: bool,
    /// Where to write report.html, verdict.json, repaired.toml, the figures and their numbers
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long, requires = "out")]
    pub parquet: bool,
}

/// Diagnoses, prints the verdict and writes the report.
///
/// # Errors
/// A recording or model that cannot be read or judged; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let mut model = model::read(&arguments.model)?;
    if let Some(topic) = &arguments.topic {
        model = model.of_topic(topic);
    }
    if arguments.force_rate {
        model = model.with_forced_rate();
    }
    let control = progress::terminal();
    let seconds = model::Seconds { from_s: arguments.from_s, to_s: arguments.to_s };
    let read = |paths: &[PathBuf]| -> Result<Vec<Recording>> {
        paths.iter().map(|path| model::read_part(path, &model, seconds, &control)).collect()
    };
    let (train, test) = (read(&arguments.recordings)?, read(&arguments.test)?);
    for note in train.iter().filter_map(|recording| model::memory_note(recording, &model)) {
        remark!("{note}");
    }
    let outputs = || outputs(arguments, &model);
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, outputs())).transpose()?;
    let diagnosis = page::worded(diagnosis::diagnose_all(Recordings { train: &train, test: &test }, &model, &control)?);
    let costs = consequence::costs(diagnosis.repair.as_ref(), &control)
        .map_err(|s| s.during("could not state the cost in metres", "start it again"))?;
    // The answer of long work is said even where its report cannot be written.
    let written = folder.map_or(Ok(()), |folder| write(folder, &diagnosis, &costs));
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

fn outputs(arguments: &Arguments, model: &Model) -> output::Request {
    let reads = match model {
        Model::Tumble(tumble) => tumble.poses.iter().cloned().collect(),
        Model::Trajectory(model) => {
            model.reference.iter().flat_map(|r| [Some(r.file.clone()), r.times.clone()]).flatten().collect()
        }
        Model::Driven(_) | Model::Static(_) | Model::Response(_) => Vec::new(),
    };
    output::Request {
        command: "diagnose",
        inputs: arguments.recordings.iter().chain(&arguments.test).chain([&arguments.model]).cloned().collect(),
        reads,
        writes: [REPORT, VERDICT, REPAIRED, UNCORRECTED]
            .map(str::to_owned)
            .into_iter()
            .chain(numbers::files(arguments.parquet))
            .collect(),
        force: arguments.force,
        keeps: false,
    }
}

fn write(mut folder: Folder, diagnosis: &Diagnosis, costs: &[repair::Cost]) -> Result<()> {
    let exhibits = page::exhibits(&diagnosis.detail);
    for exhibit in &exhibits {
        folder.write(&format!("{}.svg", exhibit.name), exhibit.figure.file_svg().as_bytes())?;
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
