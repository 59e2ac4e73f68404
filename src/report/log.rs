//! One page of a recording: what a model of it leaves out, whether it can be trusted, its noise at rest, and
//! what the file holds.
//!
//! Chain: the finished parts → answers → terminal, document, page. Each part is shown as its own command
//! shows it.

mod document;

pub use document::{Document, document};

use std::fmt::Write as _;

use super::diagnosis::{self, Diagnosis, Exhibit};
use super::html::Page;
use super::{allan, check, inspection};
use proofmass_diagnosis::check::Checked;
use proofmass_diagnosis::repair::Cost;
use proofmass_recording::Recording;
use proofmass_recording::inspection::Inspection;
use proofmass_recording::noise::Noise;

/// A part of a report, or why there is none.
pub type Made<T> = Result<T, String>;

/// Everything that is known of a recording.
#[derive(Debug)]
pub struct Log<'a> {
    /// Path as it was given.
    pub file: &'a str,
    /// First look at the file.
    pub seen: &'a Inspection,
    /// The recording as it was diagnosed.
    pub recording: &'a Recording,
    /// The model that was chosen, where none was given.
    pub proposed: Option<&'a str>,
    /// The diagnosis.
    pub diagnosis: &'a Diagnosis,
    /// Errors of a navigator that keeps the old model.
    pub costs: &'a [Cost],
    /// Figures of the diagnosis.
    pub exhibits: &'a [Exhibit],
    /// The repaired sensor as TOML, where there is one.
    pub repaired: Option<&'a str>,
    /// Agreement of its halves.
    pub checked: &'a Made<Checked>,
    /// Noise at rest.
    pub noise: &'a Made<Noise>,
}

impl Log<'_> {
    fn name(&self) -> String {
        let path = std::path::Path::new(self.file);
        path.file_name().map_or_else(|| self.file.to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Questions and their answers in a sentence or two.
    fn answers(&self) -> [(&'static str, String); 3] {
        let verdict = &self.diagnosis.verdict;
        let checked = match self.checked {
            Ok(checked) => check::answer(&[self.name()], checked),
            Err(why) => format!("not checked: {why}"),
        };
        let noise = match self.noise {
            Ok(noise) => allan::answer(noise),
            Err(why) => format!("not estimated: {why}"),
        };
        [
            ("what the model leaves out", format!("{}: {}", verdict.verdict.name(), verdict.sentence)),
            ("does it say so twice", checked),
            ("noise at rest", noise),
        ]
    }
}

/// The text of a terminal: an answer a line.
pub fn terminal(log: &Log<'_>) -> String {
    let mut out = String::new();
    for (question, answer) in log.answers() {
        let _ = writeln!(out, "{:<27}{answer}", format!("{question}:"));
    }
    for note in inspection::notes(log.seen) {
        let _ = writeln!(out, "{:<27}{note}", "the file:");
    }
    out
}

/// The page: answers first, then each part as its own command shows it.
pub fn page(log: &Log<'_>) -> Page {
    let left_out = diagnosis::page(log.diagnosis, log.costs, log.exhibits, log.repaired);
    let notes = inspection::notes(log.seen);
    let lede = notes.first().map_or("", String::as_str);
    let mut page = Page::new(&format!("Report on {}", log.name()), lede);
    let mut first = super::table::Table::new(&["", ""]);
    log.answers().into_iter().for_each(|(question, answer)| first.row([question.to_owned(), answer]));
    page.table(&first);
    page.chapter("What the model leaves out", "left-out-", left_out);
    match log.checked {
        Ok(checked) => {
            let recordings = std::slice::from_ref(log.recording);
            page.chapter("Does it say so twice", "check-", check::page(&[log.file.to_owned()], recordings, checked));
        }
        Err(why) => missing(&mut page, "Does it say so twice", why),
    }
    match log.noise {
        Ok(noise) => {
            let fragments = allan::fragments(&log.name(), noise);
            page.chapter("Noise at rest", "noise-", allan::page(&log.name(), noise, &fragments));
        }
        Err(why) => missing(&mut page, "Noise at rest", why),
    }
    page.section("What the file holds");
    page.list(&notes);
    inspection::tables(log.seen).iter().for_each(|table| page.table(table));
    if let Some(model) = log.proposed {
        page.paragraph("No model was given; this one was chosen by the headings:");
        page.preformatted(model);
    }
    page
}

fn missing(page: &mut Page, heading: &str, why: &str) {
    page.section(heading);
    page.paragraph(&format!("Not made: {why}."));
}
