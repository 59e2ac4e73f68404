//! `proofmass study`: a study in, how far its sensors drift out. Without any subcommand: the
//! default study.

pub mod answer;
mod emit;
pub(super) mod in_motion;
#[cfg(feature = "mpi")]
mod ranks;
mod shard;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::device::backends;
use super::interrupted::keep;
use super::launcher;
use super::numbers;
use super::output::remark;
use super::overrides::Changed;
use super::samples;
use super::sweep;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_base::shard::{MOST as MOST_SHARDS, Shard};
use proofmass_report::study as report;
use proofmass_simulate::decision::digits;
use proofmass_simulate::decision::further::Questions;
use proofmass_simulate::decision::risk::Exceeds;
use proofmass_simulate::decision::statistic::Limit;
use proofmass_simulate::drift;
use proofmass_simulate::ensemble::{Backends, Choice, Keeper, Options};
use proofmass_study::{Axis, Study, StudyText};

const EXAMPLES: &str = "Examples:
  proofmass study study.toml --members 100000
  proofmass study study.toml --set gyro.bias_deg_h=4 --set 'accelerometer.bias_mg={ mean = 0.0, sd = 2.0 }'
  proofmass study --set gyro.bias_deg_h.sd=40 --out worse      the default study, with a worse gyro
  proofmass study study.toml --sweep gyro.bias_deg_h.sd=1:20:log8 --limit 'p95(position_error_m, 60) < 10'
  proofmass study study.toml --digits 2                        as many members as two stable digits need
  proofmass study study.toml --shard 3/16 --out shards         one of sixteen parts, for `proofmass merge shards`
  proofmass study study.toml --emit slurm --shards 64 > run.sh  all of them as a Slurm job array, and the merge
  proofmass study study.toml --variance                        whose variance the last position error has, source by source
  proofmass study study.toml --risk 'abs(position_error_m, 60) > 100'   how probable such a drift is, down to one in 10¹⁰
  proofmass study --preset tactical                            the default study with a tactical-grade sensor, after a still start
  proofmass study study.toml --samples 3 log.csv && proofmass allan log.csv

Scope: one axis, small tilt, flat non-rotating Earth, until the study is given a trajectory.";

/// Arguments of `study`.
#[derive(Debug, Default, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The study (study.toml); without one, the default study
    pub study: Option<PathBuf>,
    /// Backend that integrates the members
    #[arg(long, value_parser = backends(), default_value = "auto")]
    pub backend: Choice,
    /// Number of members, overriding the study's
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub members: Option<u64>,
    /// Changes to the study.
    #[command(flatten)]
    pub changed: Changed,
    /// Simulate at several values of a key with the same members: a curve; given twice, a map
    #[arg(long, value_name = "KEY=FROM:TO:N|logN")]
    pub sweep: Vec<Axis>,
    /// Use as many members as needed for the last position error, along a trajectory the horizontal
    /// one (mean, standard uncertainty, both ends of the 95 % interval) to be stable to this many
    /// digits of the uncertainty (JCGM 101)
    #[arg(long, value_name = "N", conflicts_with_all = ["members", "sweep"],
          value_parser = clap::value_parser!(u32).range(1..=4))]
    pub digits: Option<u32>,
    /// Share the variance of the last position error among its sources, each alone, with its
    /// interactions and as Shapley has it, with 95 % intervals; on the CPU, with at most 16384
    /// members
    #[arg(long, conflicts_with_all = ["sweep", "limit", "shard", "emit"])]
    pub variance: bool,
    /// Find the probability that an error exceeds a limit, e.g. 'abs(position_error_m, 60) > 100',
    /// down to one in 10¹⁰, with its 95 % interval; on the CPU, with as many members as that takes
    #[arg(long, value_name = "EVENT", conflicts_with_all = ["sweep", "limit", "shard", "emit"])]
    pub risk: Option<Exceeds>,
    /// With --sweep: find where this requirement is just met, e.g. 'p95(position_error_m, 60) < 10'
    #[arg(long, value_name = "EXPR")]
    pub limit: Option<Limit>,
    /// Folder for report.html and the figures [default: reports/NAME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long)]
    pub force: bool,
    /// Compute only this part of the work, e.g. 3/16: writes DIR/shard-3-of-16.state for
    /// `proofmass merge DIR`
    #[arg(long, value_name = "K/N", conflicts_with_all = ["sweep", "digits", "limit"])]
    pub shard: Option<Shard>,
    /// Print a batch script that runs all shards and then the merge; with --out, write it into DIR
    #[arg(long, value_enum, value_name = "SYSTEM", requires = "shards", 
          conflicts_with_all = ["shard", "resume", "sweep", "digits", "limit"])]
    pub emit: Option<emit::Target>,
    /// Number of shards in that script
    #[arg(long, value_name = "N", requires = "emit", value_parser = clap::value_parser!(u64).range(1..=MOST_SHARDS))]
    pub shards: Option<u64>,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long)]
    pub parquet: bool,
    /// Also write simulated readings of N members as a recording: FILE ends in .csv, .parquet or
    /// .npy
    #[arg(long, num_args = 2, value_names = ["N", "FILE"], allow_negative_numbers = true)]
    pub samples: Vec<OsString>,
    /// Resume a run that was stopped by Ctrl-C
    #[arg(long)]
    pub resume: bool,
}

/// Runs a study, prints the answer and writes the report.
///
/// # Errors
/// A study that cannot be used, a backend that is not there, Ctrl-C, a folder that cannot be
/// written.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    if arguments.variance {
        launcher::refuse_ranks("study --variance")?;
    }
    if arguments.risk.is_some() {
        launcher::refuse_ranks("study --risk")?;
    }
    let questions = Questions { variance: arguments.variance, risk: arguments.risk };
    #[cfg(feature = "mpi")]
    if launcher::ranks().is_some() && arguments.shard.is_none() && arguments.emit.is_none() {
        let ready = || {
            let study = of_one_value(source(arguments)?.study()?)?;
            Ok(ranks::Asked { out: folder(arguments, &study), outputs: outputs(arguments, &study), study })
        };
        let Arguments { backend, force, resume, .. } = *arguments;
        let request = ranks::Request { read: &ready, input: arguments.study.as_deref(), backend, force, resume };
        return ranks::run(&request, json);
    }
    let source = source(arguments)?;
    let study = source.study()?;
    let path = folder(arguments, &study);
    questions.check(&study)?;
    if let (Some(target), Some(shards)) = (arguments.emit, arguments.shards) {
        let study = of_one_value(study)?;
        let Arguments { backend, force, .. } = *arguments;
        let (input, written) = (arguments.study.as_deref(), arguments.out.is_some());
        let (out, arguments) = (&path, arguments.changed.as_arguments(arguments.members));
        let request = emit::Request { target, shards, input, out, written, backend, arguments, force };
        return emit::run(&study, &request);
    }
    if let Some(shard) = arguments.shard {
        let study = of_one_value(study)?;
        say_what_has_no_effect(&study);
        let Arguments { backend, force, resume, .. } = *arguments;
        let request = shard::Request { shard, input: arguments.study.as_deref(), out: &path, backend, force, resume };
        return match &study.in_motion {
            Some(motion) => in_motion::shard(&study, motion, &request, json),
            None => shard::run(&study, &request, json),
        };
    }
    launcher::refuse_ranks("study")?;
    let asked = sweep::Asked {
        study: arguments.study.as_deref(),
        axes: &arguments.sweep,
        limit: arguments.limit.as_ref(),
        backend: arguments.backend,
        out: arguments.out.as_deref(),
        force: arguments.force,
        resume: arguments.resume,
    };
    // Digits are asked of one study, not of each value of its [sweep].
    if let (None, Some(plan)) = (arguments.digits, sweep::plan(&asked, &study)?) {
        return sweep::run(&asked, &source, &study, &plan, json);
    }
    say_what_has_no_effect(&study);
    let control = progress::terminal();
    let study = match arguments.digits {
        Some(digits) => digits::sized(&source, digits, &control)?,
        None => study,
    };
    let Arguments { samples, force, .. } = arguments;
    samples::write(&samples::Request { samples, study: arguments.study.as_deref(), force: *force }, &study)?;
    let path = folder(arguments, &study);
    if let Some(motion) = &study.in_motion {
        let request = outputs(arguments, &study);
        let Arguments { resume, backend, digits, .. } = *arguments;
        let asked = in_motion::Asked { request, resume, backend, digits, questions, path: &path };
        return in_motion::run(asked, &study, motion, json);
    }
    let mut keeper = match arguments.resume {
        true => Keeper::resume(&path, &study.identity)?,
        false => Keeper::new(&path, &study.identity),
    };
    let mut folder = Folder::open(&path, outputs(arguments, &study))?;
    keep(&mut folder, arguments.resume)?;
    let (options, mut backends) =
        (Options { backend: arguments.backend, control, ..Options::default() }, Backends::default());
    let drift = drift::answer(&study, &options.control, |job, _| backends.run(job, &options, &mut keeper))?;
    let stated = arguments.digits.and_then(|digits| digits::stated(&drift, digits));
    let further = questions.answer(&study, &options.control).map_err(|error| keeper.kept(error))?;
    let beside = answer::Beside { stated: stated.as_ref(), further: &further };
    // The answer comes before the report: a disk that is full costs the report, not the run.
    answer::print(&study, &drift, beside, None, json)?;
    answer::write(&mut folder, &study, &drift, beside).map_err(|error| keeper.kept(error))?;
    if !json {
        answer::point_to(&path)?;
    }
    keeper.forget()
}

fn say_what_has_no_effect(study: &Study) {
    if let Some(words) = report::without_effect(study) {
        remark!("note: {words}");
    }
}

/// The text of the study that the arguments ask for.
fn source(arguments: &Arguments) -> Result<StudyText> {
    let overrides = arguments.changed.overrides(arguments.members);
    match &arguments.study {
        Some(path) => StudyText::read(path, overrides, &progress::terminal()),
        None => StudyText::of_default(overrides, &progress::terminal()),
    }
}

/// Refuses to divide a study at several values of a key, which is several studies.
fn of_one_value(study: Study) -> Result<Study> {
    match study.sweep {
        None => Ok(study),
        Some(_) => Err(Error::new(
            format!("could not divide {}", study.name),
            "its [sweep] asks for several studies, and shards are of one",
            "leave [sweep] out and give each value with --set KEY=VALUE and its own --out",
        )),
    }
}

/// Returns where its results go.
fn folder(arguments: &Arguments, study: &Study) -> PathBuf {
    arguments.out.clone().unwrap_or_else(|| Path::new("reports").join(&study.name))
}

/// The default study.
///
/// # Errors
/// As [`run`].
pub fn run_default(json: bool) -> Result<()> {
    run(&Arguments::default(), json)
}

fn outputs(arguments: &Arguments, study: &Study) -> output::Request {
    output::Request {
        command: "study",
        inputs: arguments.study.iter().cloned().collect(),
        reads: study.reads.clone(),
        writes: answer::FILES.map(str::to_owned).into_iter().chain(numbers::files(arguments.parquet)).collect(),
        force: arguments.force,
        keeps: false,
    }
}
