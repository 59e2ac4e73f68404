//! `proofmass plan`: which experiment to record next.

use std::path::PathBuf;

use super::numbers;
use super::output::{sayln, screen};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_diagnosis::plan::limits::Limits;
use proofmass_diagnosis::plan::{self, Wish, asked};
use proofmass_report::plan as report;

/// Arguments of `plan`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The verdict.json that `diagnose --out DIR` wrote, or the model.toml of a driven proof mass
    #[arg(value_name = "VERDICT")]
    from: PathBuf,
    /// Description of what the next experiment may be (limits.toml)
    #[arg(long, value_name = "FILE")]
    limits: PathBuf,
    /// Law that the experiment shall show, and its strength: a share of the spring's force at the
    /// largest motion, or the value of its first parameter
    #[arg(long, value_name = "LAW=STRENGTH")]
    show: Option<String>,
    /// Probability of a right decision at which an experiment is long enough
    #[arg(long, value_name = "P", default_value_t = 0.95, allow_negative_numbers = true)]
    probability: f64,
    /// Record the two best so often under each rival, with noise, and diagnose that
    #[arg(long, value_name = "N", default_value_t = 0)]
    confirm: usize,
    /// Folder for report.html, experiment.csv, the input to play, next.csv, the next best, and plan.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long, requires = "out")]
    force: bool,
}

const EXAMPLES: &str = "Examples:
  proofmass template limits > limits.toml                                 what your shaker can do
  proofmass plan out/verdict.json --limits limits.toml                    what tells the rivals of a verdict apart
  proofmass plan out/verdict.json --limits limits.toml --out next         … with the input as a file to play
  proofmass plan out/verdict.json --limits limits.toml --confirm 5        … tried on simulated recordings
  proofmass plan model.toml --limits limits.toml --show cubic-stiffness=1%   what would show such a spring

A verdict of `explained` asks for a narrower interval of its first law. Probabilities are those of the
comparisons that `diagnose` makes, for white noise of the size that the verdict measured.";

const REPORT: &str = "report.html";
const PLAN: &str = "plan.json";
const EXPERIMENTS: [&str; 2] = ["experiment.csv", "next.csv"];

/// Plans, prints the answer and writes the experiments.
///
/// # Errors
/// Files that cannot be read; nothing to plan for; a folder that cannot be written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let control = progress::terminal();
    let wish = Wish { probability: arguments.probability, confirm: arguments.confirm };
    let limits = Limits::read(&arguments.limits)?;
    let question = asked::read(&arguments.from, arguments.show.as_deref(), &limits)?;
    let folder = arguments.out.as_deref().map(|path| Folder::open(path, outputs(arguments))).transpose()?;
    let (planned, confirmed) = plan::plan(&question, &limits, wish, &control)?;
    let document = report::document(&planned, wish.probability, &confirmed, &EXPERIMENTS);
    let written = folder.map_or(Ok(()), |mut folder| {
        for (name, proposal) in EXPERIMENTS.iter().zip(planned.proposals()) {
            folder.write(name, proposal.experiment.csv().as_bytes())?;
        }
        numbers::write(&mut folder, REPORT, report::page(&planned, wish.probability, &confirmed, &EXPERIMENTS))?;
        folder.write(PLAN, to_json(&document)?.as_bytes())?;
        folder.finish()
    });
    if json {
        sayln!("{}", to_json(&document)?)?;
    } else {
        screen(format_args!("{}", report::terminal(&planned, wish.probability, &confirmed)))?;
        if let (Some(folder), Ok(())) = (&arguments.out, &written) {
            sayln!("to play: {}", folder.join(EXPERIMENTS[0]).display())?;
            sayln!("report: {}", folder.join(REPORT).display())?;
        }
    }
    written
}

fn outputs(arguments: &Arguments) -> output::Request {
    output::Request {
        command: "plan",
        inputs: [&arguments.from, &arguments.limits].map(Clone::clone).to_vec(),
        writes: EXPERIMENTS
            .iter()
            .chain([&REPORT, &PLAN])
            .map(|name| (*name).to_owned())
            .chain(numbers::files(false))
            .collect(),
        force: arguments.force,
        ..output::Request::default()
    }
}
