//! The answer of a study, whoever computed it: on stdout, and as files.

use std::path::Path;

use serde::Serialize;

use crate::numbers;
use crate::output::{sayln, screen};
use proofmass_base::document::to_json;
use proofmass_base::error::Result;
use proofmass_base::output::Folder;
use proofmass_numerics::statistics::jcgm101::{Linear, Stated};
use proofmass_report::study as page;
use proofmass_simulate::drift::Drift;
use proofmass_simulate::drift::document::Document;
use proofmass_study::Study;

const REPORT: &str = "report.html";
const ENVELOPE: &str = "envelope.svg";
const WINDOWS: &str = "windows.svg";
/// Every file that an answer is written as.
pub const FILES: [&str; 3] = [REPORT, ENVELOPE, WINDOWS];

/// The document of a study that was put together.
#[derive(Serialize)]
struct Merged {
    #[serde(flatten)]
    document: Document,
    /// From how many files.
    shards: usize,
}

/// Prints the answer, with what is `stated` of its last position error where digits were asked for;
/// `shards` is the number of files that it was put together from.
///
/// # Errors
/// When stdout cannot be written.
pub fn print(
    study: &Study,
    drift: &Drift,
    stated: Option<&(Stated, Linear)>,
    shards: Option<usize>,
    json: bool,
) -> Result<()> {
    let document = || Document::of(study, drift).with_digits(stated.cloned());
    match (json, shards) {
        (true, None) => sayln!("{}", to_json(&document())?),
        (true, Some(shards)) => sayln!("{}", to_json(&Merged { document: document(), shards })?),
        (false, _) => {
            screen(format_args!("{}", page::terminal(study, drift)))?;
            stated.map_or(Ok(()), |(stated, linear)| {
                sayln!("{}", page::jcgm101::sentence("Position", stated))?;
                sayln!("{}", page::jcgm101::validation(linear, &drift.expected.left_out))
            })
        }
    }
}

/// Writes the page and its figures.
///
/// # Errors
/// When the folder cannot be written.
pub fn write(folder: &mut Folder, study: &Study, drift: &Drift, stated: Option<&(Stated, Linear)>) -> Result<()> {
    folder.write(ENVELOPE, page::envelope_figure(drift).draw().file_svg().as_bytes())?;
    if let Some(figure) = page::windows_figure(&drift.compared) {
        folder.write(WINDOWS, figure.file_svg().as_bytes())?;
    }
    let mut page = page::page(study, drift);
    if let Some((stated, linear)) = stated {
        page::jcgm101::section(&mut page, stated, linear, drift);
    }
    numbers::write(folder, REPORT, page)?;
    folder.finish()
}

/// Says where the page is.
///
/// # Errors
/// When stdout cannot be written.
pub fn point_to(folder: &Path) -> Result<()> {
    sayln!("report:     {}", folder.join(REPORT).display())
}
