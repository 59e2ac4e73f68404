//! `proofmass check`: what a recording can know of a sensor, and whether it says it twice.

use std::path::PathBuf;

use super::chosen::{Asked, Clock, Part, model_for};
use super::numbers;
use super::output::{remark, sayln, screen};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_diagnosis::check;
use proofmass_diagnosis::model;
use proofmass_recording::Recording;
use proofmass_report::check as report;

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The recording, checked by its halves; several of one sensor are checked against one another
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Description of the recordings (model.toml); absent: chosen by the headings of the first
    #[arg(long)]
    model: Option<PathBuf>,
    /// Clock of each recording, where no model is given
    #[command(flatten)]
    clock: Clock,
    /// Part of each recording that is used
    #[command(flatten)]
    part: Part,
    /// Folder for report.html, check.json and sensor.toml, the sensor with its spread from run to run
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    force: bool,
}

const EXAMPLES: &str = "Examples:
  proofmass check turned.csv                        what its motion determines, and whether its halves agree
  proofmass check monday.csv tuesday.csv friday.csv which calibration is the odd one
  proofmass check still.csv                         which noise its length determines, and how long to record
  proofmass check turned.csv --model model.toml     poses, columns and gravity as you state them
  proofmass check flight.csv --model model.toml     beside motion capture: scale, axes, clocks, lever arm
  proofmass check *.csv --out spread                sensor.toml for a study: mean and spread of the runs

A calibration is fitted to still poses, and its halves are made of whole poses, so that each determines
what the whole does; intervals are scaled by what the fit leaves, and by how long its errors last. Of a
log at rest, means and the noise coefficients of `proofmass allan` are compared; sizes as ratios; a channel
in which a diagnosis finds something besides noise is marked. A flight is halved in time, or into every
other twentieth of it where its halves are not moved alike.";

const REPORT: &str = "report.html";
const CHECK: &str = "check.json";
const SENSOR: &str = "sensor.toml";

/// Checks, prints the answer and writes the sensor.
///
/// # Errors
/// Recordings or a model that cannot be read or checked; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let control = progress::terminal();
    let seconds = arguments.part.seconds();
    let asked = Asked { part: arguments.part.clone(), clock: arguments.clock.clone(), ..Asked::default() };
    let (model, _) = model_for(&arguments.recordings[0], arguments.model.as_deref(), &asked, &control)?;
    let read = |path: &PathBuf| model::read_part(path, &model, seconds, &control);
    let recordings: Vec<Recording> = arguments.recordings.iter().map(read).collect::<Result<_>>()?;
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, outputs(arguments))).transpose()?;
    let checked = check::check(&recordings, &model, &control)?;
    let checked = check::with_besides(checked, &recordings, &model, &control)?;
    let files: Vec<String> = arguments.recordings.iter().map(|path| path.display().to_string()).collect();
    let document = report::document(&files, &checked);
    let sensor = recordings.first().and_then(|first| checked.sensor_toml(first.rate_hz));
    let written = folder.map_or(Ok(()), |mut folder| {
        numbers::write(&mut folder, REPORT, report::page(&files, &recordings, &checked))?;
        folder.write(CHECK, to_json(&document)?.as_bytes())?;
        if let Some(sensor) = &sensor {
            folder.write(SENSOR, sensor.as_bytes())?;
        }
        folder.finish()
    });
    if json {
        sayln!("{}", to_json(&document)?)?;
    } else {
        screen(format_args!("{}", report::terminal(&files, &checked)))?;
        if let (Some(folder), Ok(())) = (&arguments.out, &written) {
            sayln!("report: {}", folder.join(REPORT).display())?;
            match &sensor {
                Some(_) => sayln!("sensor: {}", folder.join(SENSOR).display())?,
                None => remark!("no {SENSOR} was written: nothing was compared that a study has a key for"),
            }
        }
    }
    written
}

fn outputs(arguments: &Arguments) -> output::Request {
    output::Request {
        command: "check",
        inputs: arguments.recordings.iter().chain(&arguments.model).cloned().collect(),
        writes: [REPORT, CHECK, SENSOR].map(str::to_owned).into_iter().chain(numbers::files(false)).collect(),
        force: arguments.force,
        ..output::Request::default()
    }
}
