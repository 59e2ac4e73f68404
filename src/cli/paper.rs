//! `proofmass paper`: the twenty figures, their checks, one page.

use std::path::PathBuf;

use serde_json::json;

use super::device::{backends, on_device};
use super::numbers;
use super::output::{say, sayln};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_paper::compute;
use proofmass_paper::page;
use proofmass_simulate::ensemble::Choice;
use proofmass_trial::real;

/// Arguments of `paper`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder for report.html and the data of its figures
    #[arg(long, value_name = "DIR", default_value = "reports/paper")]
    pub out: PathBuf,
    /// Replace files in DIR even if they are not from an earlier run of this command on the same
    /// input
    #[arg(long)]
    pub force: bool,
    /// Also write the data of the figures as Parquet, next to numbers/FIGURE.csv
    #[arg(long)]
    pub parquet: bool,
    /// Folder of recordings that contains xsens_mti/; without it figures 5 to 12 are simulated
    #[arg(long, value_name = "DIR", env = "PROOFMASS_DATA")]
    pub data: Option<PathBuf>,
    /// Device to integrate the maps on: auto takes a hardware GPU if present, else the CPU
    #[arg(long, value_parser = backends(), default_value = "auto")]
    pub backend: Choice,
}

/// Computes, prints which checks hold and writes the page.
///
/// # Errors
/// A recording that cannot be used; a folder that cannot be written; Ctrl-C.
pub fn run(arguments: &Arguments, json: bool) -> Result<()> {
    if let Some(folder) = arguments.data.as_ref().filter(|f| !f.is_dir()) {
        return Err(Error::new(
            "could not use the recordings",
            format!("{} is not a folder", folder.display()),
            "omit --data and unset PROOFMASS_DATA to simulate figures 5 to 12",
        ));
    }
    let request = output::Request {
        command: "paper",
        writes: [REPORT.to_owned()].into_iter().chain(numbers::files(arguments.parquet)).collect(),
        force: arguments.force,
        ..output::Request::default()
    };
    let mut folder = Folder::open(&arguments.out, request)?;
    let data = arguments.data.clone().or_else(real::folder);
    let control = progress::terminal();
    let paper = on_device(arguments.backend, |device| compute(data.as_deref(), true, device, &control))
        .map_err(|e| e.within("could not finish the paper", "run it again; it takes about a minute"))?;
    let written = numbers::write(&mut folder, REPORT, page::page(&paper)).and_then(|()| folder.finish());
    if json {
        sayln!("{:#}", json!({ "schema": "proofmass.paper/1", "figures": paper.exhibits() }))?;
    } else {
        say(format_args!("{}", page::table(&paper)))?;
        for failure in page::failures(&paper) {
            sayln!("does not hold: {failure}")?;
        }
        if written.is_ok() {
            sayln!("report: {}", arguments.out.join(REPORT).display())?;
        }
    }
    written
}

const REPORT: &str = "report.html";
