//! The noise of a static log as a page: coefficients first, then each channel's curve and spectrum
//! with what it supports.

mod document;
mod figure;
mod fragment;
mod study;
mod words;

pub use document::{Document, document};
pub use fragment::{Fragment, fragments};
pub use study::study;
pub use words::{answer, notes, tables};

use super::html::Page;
use proofmass_base::number::rounded;
use proofmass_recording::finding::sentences;
use proofmass_recording::noise::Noise;

/// The report page of `allan`.
pub fn page(file: &str, noise: &Noise, fragments: &[Fragment]) -> Page {
    let mut page = Page::new(&format!("Noise of {file}"), &words::lede(noise));
    words::tables(noise).iter().for_each(|t| page.table(t));
    page.paragraph(words::TABLE_NOTE);
    if !noise.source.findings.is_empty() {
        page.subsection("Found in the file");
        page.list(&sentences(&noise.source.findings));
    }
    let together = figure::together(noise);
    if !together.is_empty() {
        page.section("All axes");
        let drawn: Vec<_> = together.iter().map(|chart| chart.draw()).collect();
        let row: Vec<_> = drawn.iter().map(|figure| (figure, figure::TOGETHER)).collect();
        page.figure_row(&row);
    }
    for channel in &noise.channels {
        page.section(&channel.name);
        if channel.curve.is_empty() {
            page.paragraph("No Allan curve: the channel is constant or has fewer than three samples.");
            continue;
        }
        page.callout(&words::verdict(channel));
        page.figure_row(&[
            (&figure::curve(channel).draw(), &figure::curve_caption(channel)),
            (&figure::density(channel).draw(), &figure::density_caption(channel)),
        ]);
        page.list(&words::sentences(channel));
    }
    page.section("For a study");
    page.paragraph(
        "If a scale was given, study.toml next to this page is complete: `proofmass study study.toml` simulates this \
        sensor and compares the result with the log. Each fragment below is a sensor for a study of your own. Terms \
        that the data do not support are set to zero; quantisation is already part of the measured white noise, so \
        none is added.",
    );
    for fragment in fragments {
        page.subsection(&fragment.name);
        page.preformatted(&fragment.toml);
    }
    page.section("Conventions and method");
    page.list(&words::CONVENTIONS);
    page.section("Provenance");
    page.list(&[
        format!("proofmass {}", env!("CARGO_PKG_VERSION")),
        format!("{file}, SHA-256 {}", noise.source.sha256),
        format!("{} samples at {} Hz", noise.source.samples, rounded(noise.source.rate_hz, 6)),
    ]);
    page
}
