//! `proofmass require`: a study and a requirement in, which value of a key meets it, or which parts
//! do, out.

use std::path::PathBuf;

use super::output::{say, sayln};
use super::overrides::Changed;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_report::require as page;
use proofmass_simulate::decision::document::{Document, Found};
use proofmass_simulate::decision::parts::{self, Asked, Catalogue};
use proofmass_simulate::decision::require::{self, Question};
use proofmass_simulate::decision::statistic::Limit;
use proofmass_study::{Study, StudyText};

const EXAMPLES: &str = "EXPR is STAT(QUANTITY, TIME_S) < NUMBER
  STAT      mean sd p01 p05 p50 p95 p99 of the signed error; abs95, the 95 % of its absolute value;
            cep50 cep95 of horizontal_error_m
  QUANTITY  position_error_m velocity_error_m_s acceleration_error_m_s2 tilt_error_rad
            with a [trajectory]: horizontal_error_m spherical_error_m position_error_ned_m.north (.east .down)
            velocity_error_ned_m_s.north (.east .down) attitude_error_rad.roll (.pitch .heading)

Examples:
  proofmass require study.toml --limit 'p95(position_error_m, 60) < 10' --vary gyro.bias_deg_h.sd
  proofmass require study.toml --limit 'abs95(position_error_m, 60) < 10' --vary gyro.bias_deg_h.sd accelerometer.bias_mg.sd
  proofmass require study.toml --limit 'sd(position_error_m, 30) < 2' --parts parts.toml
  proofmass require flight.toml --limit 'cep95(horizontal_error_m, 60) < 10' --vary gyro.bias_deg_h.sd

parts.toml:
  [[part]]
  name = \"tactical\"
  price = 1450.0
  [part.accelerometer]
  bias_mg = { mean = 0.0, sd = 0.3 }
  [part.gyro]
  bias_deg_h = { mean = 0.0, sd = 1.0 }";

/// Arguments of `require`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, group = clap::ArgGroup::new("what").required(true).multiple(true).args(["vary", "parts"]))]
pub struct Arguments {
    /// The study (study.toml)
    pub study: PathBuf,
    /// Requirement that must hold, e.g. 'p95(position_error_m, 60) < 10'
    #[arg(long, value_name = "EXPR")]
    pub limit: Limit,
    /// Key to vary: a dotted path of study.toml, e.g. the sd of a draw; several keys are scaled by
    /// one common factor
    #[arg(long, value_name = "KEY", num_args = 1..)]
    pub vary: Vec<String>,
    /// Parts to rank by whether they meet the requirement (parts.toml)
    #[arg(long, value_name = "FILE")]
    pub parts: Option<PathBuf>,
    /// Relative half-width of the value's 95 % interval at which the search stops
    #[arg(long, value_name = "FRACTION", default_value_t = 0.01)]
    pub tolerance: f64,
    /// Maximum number of members per value or part [default: a few minutes' work]
    #[arg(long, value_name = "N")]
    pub members: Option<u64>,
    /// Changes to the study.
    #[command(flatten)]
    pub changed: Changed,
    /// Folder for report.html; without it, nothing is written
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// Smallest tolerance: a hundredth of the usual one takes ten thousand times its members.
const FINEST: f64 = 1e-4;

/// Searches, prints the answer and writes the report.
///
/// # Errors
/// A study, a key or a catalogue that cannot be used; Ctrl-C; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let Arguments { limit, tolerance, .. } = arguments;
    if !(FINEST..=1.0).contains(tolerance) {
        return Err(Error::new(
            "could not understand the command line",
            format!("--tolerance is {tolerance}: need a number from {FINEST} to 1"),
            "0.01, which is the default, stops at 1 % of the value",
        ));
    }
    let control = progress::terminal();
    let source = StudyText::read(&arguments.study, arguments.changed.overrides(None), &control)?;
    let study = source.study()?;
    let catalogue = arguments.parts.as_deref().map(Catalogue::read).transpose()?;
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, outputs(arguments, &study))).transpose()?;
    for key in &arguments.vary {
        if source.is_drawn(key)? {
            control.remark(&format!(
                "note: members draw `{key}`; here every member gets the same value. {key}.sd varies the spread."
            ));
        }
    }
    let (vary, most) = (arguments.vary.clone(), arguments.members);
    let question = Question { limit: limit.clone(), vary, tolerance: *tolerance, most };
    let answer = match question.vary.is_empty() {
        true => None,
        false => Some(require::answer(&source, &question, &control)?),
    };
    let judged =
        catalogue.map(|parts| parts::judge(&source, &Asked { limit, parts: &parts, most }, &control)).transpose()?;
    let found = Found { answer, parts: judged };
    if json {
        sayln!("{}", to_json(&Document::of(&study, limit, &found))?)?;
    } else {
        say(format_args!("{}", page::terminal(limit, &found)))?;
    }
    let Some(mut folder) = folder else { return Ok(()) };
    if let Some(figure) = page::figure(limit, &found) {
        folder.write(CURVE, figure.file_svg().as_bytes())?;
    }
    folder.write(REPORT, page::page(&study, limit, &found).finish().as_bytes())?;
    folder.finish()?;
    if let (Some(path), false) = (&arguments.out, json) {
        sayln!("report:     {}", path.join(REPORT).display())?;
    }
    Ok(())
}

const REPORT: &str = "report.html";
const CURVE: &str = "curve.svg";

fn outputs(arguments: &Arguments, study: &Study) -> output::Request {
    output::Request {
        command: "require",
        inputs: [arguments.study.clone()].into_iter().chain(arguments.parts.clone()).collect(),
        reads: study.reads.clone(),
        writes: [REPORT, CURVE].map(str::to_owned).into(),
        force: arguments.force,
        keeps: false,
    }
}
