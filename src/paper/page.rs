//! The paper as one page: the story in order, each figure with its caption and its checks.

mod chaos;
mod diagram;
mod growth;
mod mechanics;
mod section;
mod tilt;

use crate::Paper;
use crate::check::Provenance;
use proofmass_report::html::Page;
use proofmass_report::table::Table;

/// One line per figure, for a terminal.
pub fn table(paper: &Paper) -> Table {
    let mut table = Table::new(&["figure", "what it shows", "source", "checks that hold"]);
    for e in paper.exhibits() {
        let hold = e.checks.iter().filter(|c| c.holds).count();
        table.row([
            e.figure.to_string(),
            e.title.clone(),
            words(e.source).into(),
            format!("{hold} of {}", e.checks.len()),
        ]);
    }
    table
}

/// Every check that does not hold, as a sentence.
pub fn failures(paper: &Paper) -> Vec<String> {
    paper
        .exhibits()
        .iter()
        .flat_map(|e| e.checks.iter().filter(|c| !c.holds).map(move |c| (e.figure, c)))
        .map(|(figure, c)| {
            format!("figure {figure}, {}: expected {} ± {}, got {}", c.name, c.expected, c.tolerance, c.got)
        })
        .collect()
}

fn words(source: Provenance) -> &'static str {
    match source {
        Provenance::Simulated => "simulated",
        Provenance::Recorded => "recorded",
    }
}

/// The report page of `paper`.
pub fn page(paper: &Paper) -> Page {
    let exhibits = paper.exhibits();
    let all: usize = exhibits.iter().map(|e| e.checks.len()).sum();
    let hold: usize = exhibits.iter().flat_map(|e| &e.checks).filter(|c| c.holds).count();
    let lede = format!(
        "An inertial sensor knows where it is by integrating acceleration twice, and so integrates every error of its \
         reading twice as well. Twenty figures, recomputed from equations and recordings, show how fast that goes wrong and \
         why: noise, tilt, motion, the sensor's own mechanics and, in the end, chaos. {hold} of {all} checks hold."
    );
    let mut page = Page::new("Why an inertial sensor drifts, in twenty figures", &lede);
    page.paragraph(
        "The figures follow the paper \"MEMS Modelling in the Context of Inertial Navigation\" in its order and numbering. \
         Captions say what is computed, from what, and with which equation. The checks follow each figure: the expected \
         number, the computed one, the tolerance, and the source of the expectation. Where a claim of the paper does not \
         hold, the text says so.",
    );
    page.paragraph(
        "Eq. 1 is the whole idea: distance is the double integral of acceleration, d(t) = ∬ a dt². Eq. 2 is the whole \
         trouble: the sensor reads a + aₙ, so the distance is off by ∬ aₙ dt². A constant aₙ becomes ½aₙt²; everything below \
         is about what else aₙ can be.",
    );
    growth::write(&mut page, paper);
    tilt::write(&mut page, paper);
    mechanics::write(&mut page, paper);
    chaos::write(&mut page, paper);
    page.section("All checks at a glance");
    page.table(&table(paper));
    for failure in failures(paper) {
        page.callout(&failure);
    }
    page
}
