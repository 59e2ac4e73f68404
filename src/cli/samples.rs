//! `study --samples N FILE`: simulated readings as a recording.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use super::output::remark;
use proofmass_base::columns::{Columns, Format, Values};
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_simulate::ensemble;
use proofmass_study::Study;

/// Request for samples.
pub(super) struct Request<'a> {
    /// `N FILE`, or nothing.
    pub samples: &'a [OsString],
    /// Path of the study.
    pub study: Option<&'a Path>,
    /// Replace FILE though it is the user's.
    pub force: bool,
}

/// Writes the recording, if one is asked for.
///
/// # Errors
/// No number of members, an ending that is not known, too many numbers; FILE is the user's or
/// cannot be written.
pub(super) fn write(asked: &Request<'_>, study: &Study) -> Result<()> {
    let [count, file] = asked.samples else { return Ok(()) };
    study.along_one_axis()?;
    let fail = |cause: String, hint: &str| Err(Error::new("could not write samples", cause, hint));
    let Some(members) = count.to_str().and_then(|n| n.parse::<u64>().ok()) else {
        let cause = format!("need a number of members, got `{}`", count.display());
        return fail(cause, "for example --samples 3 log.csv");
    };
    let file = Path::new(file);
    let Some(format) = file.extension().and_then(OsStr::to_str).and_then(Format::of) else {
        let cause = format!("{} names no format by its ending", file.display());
        return fail(cause, "end it in .csv, .parquet or .npy");
    };
    let Some(name) = file.file_name().and_then(OsStr::to_str) else {
        return fail(format!("{} names no file", file.display()), "for example --samples 3 log.csv");
    };
    let parent = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let request = output::Request {
        command: "study --samples",
        inputs: asked.study.iter().map(|path| path.to_path_buf()).collect(),
        reads: study.reads.clone(),
        writes: vec![name.to_owned()],
        force: asked.force,
        keeps: true,
    };
    let mut folder = Folder::open(parent, request)?;
    let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
    let columns = ensemble::samples(&job, members, &progress::terminal())?;
    folder.write(name, &format.bytes(&columns))?;
    folder.finish()?;
    let lost = missing(&columns);
    if lost > 0 {
        remark!("note: {lost} readings of members that diverged are missing in {}", file.display());
    }
    let s = if members == 1 { "" } else { "s" };
    remark!("wrote {} samples of {members} member{s} to {}", columns.rows(), file.display());
    Ok(())
}

fn missing(columns: &Columns) -> usize {
    let of = |values: &Values| match values {
        Values::Numbers(values) => values.iter().filter(|v| !v.is_finite()).count(),
        Values::Words(_) => 0,
    };
    columns.all().iter().map(|column| of(&column.values)).sum()
}
