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
use proofmass_simulate::decision::further::Further;
use proofmass_simulate::drift::Drift;
use proofmass_simulate::drift::document::Document;
use proofmass_study::Study;

const REPORT: &str = "report.html";
const ENVELOPE: &str = "envelope.svg";
const WINDOWS: &str = "windows.svg";
/// Every file that an answer is written as.
pub const FILES: [&str; 3] = [REPORT, ENVELOPE, WINDOWS];

/// The document of a study with what its own crate does not know of.
#[derive(Serialize)]
pub(super) struct Extended<'a, D: Serialize> {
    #[serde(flatten)]
    pub document: D,
    /// Number of files that it was put together from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shards: Option<usize>,
    #[serde(flatten)]
    pub further: &'a Further,
}

/// Answers next to the drift, where they were asked for.
#[derive(Debug, Clone, Copy)]
pub struct Beside<'a> {
    /// The last position error to a number of digits.
    pub stated: Option<&'a (Stated, Linear)>,
    /// Answers to questions about one error of it.
    pub further: &'a Further,
}

impl Default for Beside<'_> {
    fn default() -> Self {
        Self { stated: None, further: Further::NONE }
    }
}

/// Prints the answer; `shards` is the number of files that it was put together from.
///
/// # Errors
/// When stdout cannot be written.
pub fn print(study: &Study, drift: &Drift, beside: Beside<'_>, shards: Option<usize>, json: bool) -> Result<()> {
    let Beside { stated, further } = beside;
    if json {
        let document = Document::of(study, drift).with_digits(stated.cloned()).with_findings(page::beyond_scope(drift));
        return match shards.is_none() && further.is_empty() {
            true => sayln!("{}", to_json(&document)?),
            false => sayln!("{}", to_json(&Extended { document, shards, further })?),
        };
    }
    screen(format_args!("{}", page::terminal(study, drift)))?;
    if let Some((stated, linear)) = stated {
        sayln!("{}", page::jcgm101::sentence("Position", stated))?;
        sayln!("{}", page::jcgm101::validation(linear, &drift.expected.left_out))?;
    }
    page::further::terminal(further).iter().try_for_each(|text| screen(format_args!("\n{text}")))
}

/// Writes the page and its figures.
///
/// # Errors
/// When the folder cannot be written.
pub fn write(folder: &mut Folder, study: &Study, drift: &Drift, beside: Beside<'_>) -> Result<()> {
    folder.write(ENVELOPE, page::envelope_figure(drift).draw().file_svg().as_bytes())?;
    if let Some(figure) = page::windows_figure(&drift.compared) {
        folder.write(WINDOWS, figure.file_svg().as_bytes())?;
    }
    let mut page = page::page(study, drift, beside.further);
    if let Some((stated, linear)) = beside.stated {
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
