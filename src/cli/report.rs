//! `proofmass report`: from a recording to all that is known of it, on one page.

use std::path::{Path, PathBuf};

use super::allan::{self, Scales};
use super::chosen::{Asked, Clock, Headings, Part, model_for};
use super::numbers;
use super::output::{remark, sayln, screen};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Kind, Result};
use proofmass_base::number::rounded;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_diagnosis::model::{self, Model, Seconds};
use proofmass_diagnosis::proposal::{self, Suited, WORTHWHILE_S};
use proofmass_diagnosis::recordings::Recordings;
use proofmass_diagnosis::{self as diagnosis, check, repaired};
use proofmass_recording::Request;
use proofmass_recording::inspection::{self, Inspection, Stretch};
use proofmass_recording::noise::Noise;
use proofmass_report::diagnosis as page;
use proofmass_report::log::{self as report, Log, Made};
use proofmass_study::name_for;

/// Arguments of `report`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The recording: text with a header row, an array, a table or a robot's log
    #[arg(value_name = "RECORDING")]
    recording: PathBuf,
    /// Description of the recording and of the model to be tested (model.toml); absent: chosen by the
    /// recording's headings and said first
    #[arg(long)]
    model: Option<PathBuf>,
    /// Columns of a driven recording, where no model is given
    #[command(flatten)]
    headings: Headings,
    /// Clock of the recording, where no model is given
    #[command(flatten)]
    clock: Clock,
    /// Part of the recording that is used
    #[command(flatten)]
    part: Part,
    /// Folder for report.html, report.json and repaired.toml [default: reports/NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long)]
    force: bool,
}

const EXAMPLES: &str = "Examples:
  proofmass report still.csv                        noise, whether its halves agree, and what a datasheet would leave out
  proofmass report turned.csv --out turned          a calibration, how well it is determined, its noise at rest
  proofmass report decay.csv                        the physics that a linear resonator leaves out
  proofmass report flight.csv --model model.toml    beside motion capture

It does what `inspect`, `diagnose`, `check` and `allan` do, on one page. A part that does not suit the recording
is left out, and the page says why.";

const REPORT: &str = "report.html";
const DOCUMENT: &str = "report.json";
const REPAIRED: &str = "repaired.toml";

/// Makes the report.
///
/// # Errors
/// A recording or model that cannot be read or judged; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let control = progress::terminal();
    let file = arguments.recording.display().to_string();
    let mut asked = arguments.asked();
    let mut look = arguments.look(&asked, &control)?;
    let seen = inspection::inspect(&arguments.recording, &look)?;
    if let Some(rest) = arguments.rest(&seen) {
        (asked.part.from_s, asked.part.to_s) = (Some(rest.from_s), Some(rest.to_s));
        (look.from_s, look.to_s) = (Some(rest.from_s), Some(rest.to_s));
    }
    let seconds = asked.part.seconds();
    let (model, proposed) = model_for(&arguments.recording, arguments.model.as_deref(), &asked, &control)?;
    let recording = model::read_part(&arguments.recording, &model, seconds, &control)?;
    let path = arguments.folder();
    let folder = Folder::open(&path, arguments.outputs(&model))?;
    let train = std::slice::from_ref(&recording);
    let diagnosis = page::worded(diagnosis::diagnose_all(Recordings { train, test: &[] }, &model, &control)?);
    let costs = page::costs(&diagnosis, &control)?;
    let exhibits = page::exhibits(&diagnosis.detail);
    let study = repaired::document(diagnosis.repair.as_ref(), &diagnosis.detail, &diagnosis.verdict);
    let checked = part(match model {
        Model::Driven(_) | Model::Response(_) => Ok(Err("halves of it do not move alike".to_owned())),
        _ => check::check(train, &model, &control).map(Ok),
    })?;
    let noise = part(at_rest(&arguments.recording, look, &seen, &model))?;
    let log = Log {
        file: &file,
        seen: &seen,
        recording: &recording,
        proposed: proposed.as_deref(),
        diagnosis: &diagnosis,
        costs: &costs,
        exhibits: &exhibits,
        repaired: study.as_deref(),
        checked: &checked,
        noise: &noise,
    };
    let document = report::document(&log);
    let written = write(folder, &log, &to_json(&document)?);
    if json {
        sayln!("{}", to_json(&document)?)?;
    } else {
        screen(format_args!("{}", report::terminal(&log)))?;
        if written.is_ok() {
            sayln!("report: {}", path.join(REPORT).display())?;
        }
    }
    written
}

/// A part, or in words why there is none; a stop is no reason.
fn part<T>(made: Result<Made<T>>) -> Result<Made<T>> {
    match made {
        Err(error) if error.kind == Kind::Interrupted => Err(error),
        Err(error) => Ok(Err(format!("{} ({})", error.cause, error.hint))),
        made => made,
    }
}

/// Noise of the whole log, where it is at rest, or of the longest rest in it.
fn at_rest(recording: &Path, mut look: Request, seen: &Inspection, model: &Model) -> Result<Made<Noise>> {
    let longest = seen.rows.as_ref().and_then(|rows| proposal::longest(&rows.still));
    match (model, longest) {
        (Model::Driven(_) | Model::Response(_), _) => return Ok(Err("it is never at rest".to_owned())),
        (Model::Static(_), _) => {}
        (_, Some(rest)) if rest.to_s - rest.from_s >= WORTHWHILE_S => {
            (look.from_s, look.to_s) = (Some(rest.from_s), Some(rest.to_s));
        }
        (_, rest) => {
            let longest = rest.map_or(0.0, |rest| rest.to_s - rest.from_s);
            let words = format!(
                "its longest rest lasts {} s, and less than {WORTHWHILE_S} s tell little of noise",
                rounded(longest, 2)
            );
            return Ok(Err(words));
        }
    }
    allan::Asked::new(look, &Scales::default())?.analyse(recording).map(Ok)
}

impl Arguments {
    fn asked(&self) -> Asked {
        Asked { part: self.part.clone(), headings: self.headings.clone(), clock: self.clock.clone() }
    }

    /// Returns how the file is looked at: by the clock and in the part that the model states, or as was asked.
    fn look(&self, asked: &Asked, control: &Control) -> Result<Request> {
        let stated = self.model.as_deref().map(model::read).transpose()?;
        // Steps of a sweep have no rate.
        let Some(model) = stated.filter(|model| !matches!(model, Model::Response(_))) else {
            return Ok(asked.request(control));
        };
        let read = model::requested(&self.recording, &model, asked.part.seconds())?;
        let topic = asked.part.topic.clone().or_else(|| read.topic.clone());
        let control = control.clone();
        Ok(Request { topic, control, columns: Vec::new(), samples: None, at_most: None, ..read })
    }

    /// The rest that is judged of a sensor that moves in the other time, where nothing else was asked for.
    fn rest(&self, seen: &Inspection) -> Option<Stretch> {
        let is_free = self.model.is_none() && self.part.seconds() == Seconds::default();
        let Some(Suited::RestFor(rest)) = seen.rows.as_ref().and_then(proposal::suited).filter(|_| is_free) else {
            return None;
        };
        remark!(
            "the sensor lies still from {} to {} s and moves in the other time: this rest is judged",
            rounded(rest.from_s, 4),
            rounded(rest.to_s, 4)
        );
        Some(rest)
    }

    fn folder(&self) -> PathBuf {
        let stem = self.recording.file_stem().unwrap_or_default().to_string_lossy();
        self.out.clone().unwrap_or_else(|| Path::new("reports").join(name_for(&stem)))
    }

    fn outputs(&self, model: &Model) -> output::Request {
        output::Request {
            command: "report",
            inputs: std::iter::once(&self.recording).chain(&self.model).cloned().collect(),
            reads: model.files(),
            writes: [REPORT, DOCUMENT, REPAIRED].map(str::to_owned).into_iter().chain(numbers::files(false)).collect(),
            force: self.force,
            keeps: false,
        }
    }
}

fn write(mut folder: Folder, log: &Log<'_>, document: &str) -> Result<()> {
    if let Some(study) = log.repaired {
        folder.write(REPAIRED, study.as_bytes())?;
    }
    numbers::write(&mut folder, REPORT, report::page(log))?;
    folder.write(DOCUMENT, document.as_bytes())?;
    folder.finish()
}
