//! `proofmass inspect`: what a file holds, and the command to run next.

use std::path::PathBuf;

use super::output::{remark, sayln};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::progress;
use proofmass_recording::Request;
use proofmass_recording::inspection;
use proofmass_report::inspection as report;

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The recording: text, an array, a table or a robot's log; - is standard input
    file: PathBuf,
    /// Topic, message or array to inspect, if the file has several
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// Column that holds the time
    #[arg(long, value_name = "NAME")]
    time: Option<String>,
    /// Sampling rate, Hz
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    rate_hz: Option<f64>,
    /// Use --rate-hz even against the file's own clock
    #[arg(long, requires = "rate_hz")]
    force_rate: bool,
}

/// Runs it.
///
/// # Errors
/// A file that cannot be read.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    let request = Request {
        topic: arguments.topic.clone(),
        time: arguments.time.clone(),
        rate_hz: arguments.rate_hz,
        force_rate: arguments.force_rate,
        control: progress::terminal(),
        ..Request::default()
    };
    let seen = inspection::inspect(&arguments.file, &request)?;
    let file = arguments.file.display().to_string();
    if json {
        return sayln!("{}", to_json(&report::document(&file, &seen))?);
    }
    report::tables(&seen).iter().try_for_each(|table| sayln!("{table}"))?;
    report::notes(&seen).iter().try_for_each(|note| sayln!("{note}"))?;
    match (report::obstacle(&file, &seen), report::next(&file, &seen)) {
        (Some(obstacle), _) => {
            sayln!("problem: {}", obstacle.cause)?;
            sayln!("next: {}", obstacle.hint)
        }
        (None, Some(next)) => {
            sayln!("next: {next}")?;
            match report::check(&file, &seen) {
                Some(check) => sayln!("is it good enough: {check}"),
                None => Ok(()),
            }
        }
        (None, None) => {
            remark!("no next step to suggest");
            Ok(())
        }
    }
}
