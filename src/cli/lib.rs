//! The command line: typed arguments, one file per subcommand. Each `run` returns when its work is
//! done and written.

#![warn(unreachable_pub)]

use std::ffi::OsString;
use std::io::Write;

use clap::{CommandFactory as _, Parser, Subcommand};

use proofmass_base::error::{Error, Kind, Result};
use proofmass_base::escape::terminal;
use proofmass_base::signal;

pub mod adapters;
pub mod allan;
pub mod bench;
pub mod candidates;
pub mod check;
pub mod chosen;
mod device;
pub mod diagnose;
pub mod export;
pub mod import;
pub mod inspect;
mod interrupted;
mod launcher;
pub mod map;
pub mod merge;
mod numbers;
pub mod output;
mod overrides;
pub mod paper;
pub mod plan;
pub mod report;
pub mod require;
mod samples;
pub mod schema;
mod sharded;
pub mod shell;
pub mod study;
mod sweep;
pub mod template;
pub mod trial;
pub mod validate;

/// How far will this inertial sensor drift, which error is to blame, and what physics does the
/// model leave out?
#[derive(Debug, Parser)]
#[command(name = "proofmass", bin_name = "proofmass", version, max_term_width = 100, after_help = EXAMPLES)]
pub struct Arguments {
    /// Print the result as one JSON document on stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// Command; without one, the default study runs
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "Examples:
  proofmass                                         the default study: how far a MEMS accelerometer drifts
  proofmass template study > study.toml             a file to start from
  proofmass study study.toml --members 100000       your own sensor
  proofmass require study.toml --limit 'p95(position_error_m, 60) < 10' --vary gyro.bias_deg_h.sd
  proofmass inspect flight.ulg                      what a recording contains, and what to run next
  proofmass report log.csv                          all that a recording says, on one page
  proofmass check turned.csv                        is this calibration determined, and does it repeat?
  proofmass allan log.csv --rate-hz 100             noise coefficients of a static log
  proofmass export sensor.toml --to kalibr          its noise as the configuration of an estimator
  proofmass diagnose log.csv                        what the usual model of this recording leaves out
  proofmass diagnose log.csv --model model.toml     what your own model of it leaves out
  proofmass plan out/verdict.json --limits limits.toml   what to record next, so that a verdict decides
  proofmass validate                                check this build against laws and closed forms

Scope of a study: one axis, small tilt, flat non-rotating Earth, until it is given a trajectory.";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate an ensemble and report how far it drifts
    Study(study::Arguments),
    /// Find the value of a key that meets a requirement, or rank parts by whether they do
    Require(require::Arguments),
    /// Merge the shards of a divided run
    Merge(merge::Arguments),
    /// Show what a recording contains, and what to run next
    Inspect(inspect::Arguments),
    /// Report all that a recording says, on one page: what a model leaves out, noise, whether it repeats
    Report(report::Arguments),
    /// Check what a recording can know of a sensor, and whether its halves or several runs agree
    Check(check::Arguments),
    /// Estimate noise coefficients from a static log
    Allan(allan::Arguments),
    /// Write a sensor as the configuration of an estimator or simulator
    Export(export::Arguments),
    /// Read a sensor from such a configuration
    Import(import::Arguments),
    /// Find the physics that a model of a recording leaves out
    Diagnose(diagnose::Arguments),
    /// Plan the experiment that tells the rivals of a verdict apart, or shows a law
    Plan(plan::Arguments),
    /// List the physics that `diagnose` can name
    Candidates(candidates::Arguments),
    /// Reproduce the paper's twenty figures, each with its checks
    Paper(paper::Arguments),
    /// Map the Duffing equation's Lyapunov exponent and period
    Map(map::Arguments),
    /// Test the diagnosis on blind cases
    Trial(trial::Arguments),
    /// Check this build against laws, parities and closed forms
    Validate(validate::Arguments),
    /// List the GPU adapters
    Adapters(adapters::Arguments),
    /// Measure speed on this machine
    Bench(bench::Arguments),
    /// Print a complete, commented file to start from
    Template(template::Arguments),
    /// Print the JSON Schema of an input file or of a document that --json prints
    Schema(schema::Arguments),
    /// Print completions for a shell
    Completions(shell::Completions),
    /// Print the manual page
    Man(shell::Man),
}

/// The whole command, from its words (the first is its own name) to its exit code: the only place
/// that prints an error.
pub fn main(words: impl IntoIterator<Item = OsString>) -> u8 {
    #[cfg(unix)]
    set_signals();
    match Arguments::try_parse_from(words).map_err(not_understood).and_then(|a| run(&a)) {
        Ok(code) => code,
        Err(error) => {
            // Where nobody can be told, the exit code still tells.
            let _ = writeln!(std::io::stderr(), "error: {}", terminal(&error.to_string()));
            exit_code(&error)
        }
    }
}

/// `proofmass … | head` ends like any other tool when `head` has seen enough, and does not panic in
/// `println!`. A limit on the size of files (`ulimit -f`) is an error of the write that meets it,
/// and does not kill half-way through a file.
#[cfg(unix)]
fn set_signals() {
    // SAFETY: the default action and "ignore" run no code of ours.
    unsafe {
        libc::signal(libc::SIGPIPE, libc::SIG_DFL);
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

/// Explains what is wrong with a command line, as attempt, cause and hint; `--help` and `--version`
/// are answered and end the process.
pub fn not_understood(error: clap::Error) -> Error {
    if !error.use_stderr() {
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        match printed {
            Ok(()) => std::process::exit(0),
            Err(e) => return output::not_printed(&e),
        }
    }
    let text = error.render().to_string();
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|l| !l.is_empty()).collect();
    let is_hint =
        |line: &&str| ["tip:", "Usage:", "For more information", "Options:"].iter().any(|h| line.starts_with(h));
    let cause: Vec<&str> = lines.iter().take_while(|l| !is_hint(l)).map(|l| l.trim_start_matches("error: ")).collect();
    let tips = lines.iter().filter_map(|l| l.strip_prefix("tip: "));
    let usage = lines.iter().find_map(|l| l.strip_prefix("Usage: "));
    let see = usage.map_or("see `proofmass --help`".to_owned(), |u| format!("usage: {u}; see --help"));
    let hint: Vec<String> = tips.map(str::to_owned).chain([see]).collect();
    // The parser's words for a number that is none are a programmer's.
    let cause =
        ["invalid digit found in string", "invalid float literal"].iter().fold(cause.join(" "), |c, technical| {
            let plain = if technical.contains("digit") {
                "need a whole number, zero or more, in digits"
            } else {
                "need a number"
            };
            c.replace(technical, plain)
        });
    Error::new("could not understand the command line", cause, hint.join("; "))
}

/// The exit code of an error: 2, or as a shell counts, 128 and the number of the signal that
/// stopped the run.
pub fn exit_code(error: &Error) -> u8 {
    match error.kind {
        Kind::Failed => 2,
        Kind::Interrupted => signal::stopped_by().map_or(130, signal::Signal::exit_code),
    }
}

/// Does what the arguments ask. Returns the exit code: 0, or 1 where a comparison that was asked for
/// finds the new one worse.
///
/// # Errors
/// Whatever stopped the work, as attempt, cause and hint.
pub fn run(arguments: &Arguments) -> Result<u8> {
    signal::listen_for_interrupt();
    let json = arguments.json;
    let done = match &arguments.command {
        None => study::run_default(json),
        Some(Command::Study(a)) => study::run(a, json),
        Some(Command::Require(a)) => require::run(a, json),
        Some(Command::Merge(a)) => merge::run(a, json),
        Some(Command::Inspect(a)) => inspect::run(a, json),
        Some(Command::Report(a)) => report::run(a, json),
        Some(Command::Check(a)) => check::run(a, json),
        Some(Command::Allan(a)) => allan::run(a, json),
        Some(Command::Export(a)) => export::run(a, json),
        Some(Command::Import(a)) => import::run(a, json),
        Some(Command::Diagnose(a)) => diagnose::run(a, json),
        Some(Command::Plan(a)) => plan::run(a, json),
        Some(Command::Candidates(a)) => candidates::run(a, json),
        Some(Command::Paper(a)) => paper::run(a, json),
        Some(Command::Map(a)) => map::run(a, json),
        Some(Command::Trial(a)) => return trial::run(a, json),
        Some(Command::Validate(a)) => validate::run(a, json),
        Some(Command::Adapters(a)) => adapters::run(a, json),
        Some(Command::Bench(a)) => bench::run(a, json),
        Some(Command::Template(a)) => template::run(a, json),
        Some(Command::Schema(a)) => schema::run(a),
        Some(Command::Completions(a)) => shell::completions(a, Arguments::command()),
        Some(Command::Man(a)) => shell::man(a, Arguments::command()),
    };
    done.map(|()| 0)
}
