//! `proofmass study` of a study with a trajectory.

use std::path::Path;

use crate::cli::say::{say, sayln};
use crate::document::to_json;
use crate::ensemble::{Choice, Keeper};
use crate::error::Result;
use crate::output::{self, Folder};
use crate::progress;
use crate::report::strapdown as page;
use crate::strapdown::answer::answer_kept;
use crate::strapdown::document::Document;
use crate::strapdown::kept::Kept;
use crate::study::Study;
use crate::study::in_motion::InMotion;

const REPORT: &str = "report.html";
const INFLATED: &str = "inflated.toml";

/// What the command line asks for.
pub(super) struct Asked<'a> {
    /// The run, as its outputs are listed for a study of one axis.
    pub request: output::Request,
    /// Whether to go on with one that was stopped.
    pub resume: bool,
    /// Backend to integrate on.
    pub backend: Choice,
    /// Folder of the results.
    pub path: &'a Path,
}

/// Runs it, prints the answer and writes the report.
///
/// # Errors
/// As `study`; there is no stopped run to resume.
pub(super) fn run(asked: Asked<'_>, study: &Study, motion: &InMotion, json: bool) -> Result<()> {
    let Asked { request, resume, backend, path } = asked;
    let mut kept = match resume {
        true => Kept::resume(path, &study.identity)?,
        false => Kept::new(path, &study.identity),
    };
    let writes =
        if motion.flown.is_some() { vec![REPORT.to_owned(), INFLATED.to_owned()] } else { vec![REPORT.to_owned()] };
    let mut folder = Folder::open(path, output::Request { writes, ..request })?;
    folder.state(Keeper::FILES, resume)?;
    let answer = answer_kept(study, motion, backend, &mut kept, &progress::terminal())?;
    if json {
        sayln!("{}", to_json(&Document::of(study, &answer, page::findings(&answer)))?)?;
    } else {
        say(format_args!("{}", page::terminal(&answer)))?;
    }
    folder.write(REPORT, page::page(study, &answer).finish().as_bytes())?;
    if let Some(inflated) = page::inflated_toml(study, &answer) {
        folder.write(INFLATED, inflated.as_bytes())?;
    }
    folder.finish()?;
    if !json {
        sayln!("report:     {}", path.join(REPORT).display())?;
    }
    kept.forget()
}
