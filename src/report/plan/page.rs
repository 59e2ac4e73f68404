//! The answer as a page: what to play, what it decides, and what is in the way.

use super::figure;
use super::sentences;
use super::words::{experiment, percent, rivals};
use crate::html::Page;
use crate::table::Table;
use proofmass_base::number::short;
use proofmass_diagnosis::plan::confirm::Confirmed;
use proofmass_diagnosis::plan::question::Purpose;
use proofmass_diagnosis::plan::search::{Planned, Proposal};

/// The report page of `plan`; `files` are the names of the experiments' files, in order.
pub fn page(planned: &Planned, wish: f64, confirmed: &[Confirmed], files: &[&str]) -> Page {
    let mut page = Page::new("The next experiment", &sentences::answer(planned, wish));
    page.list(&sentences::all(planned, wish, confirmed)[1..]);
    page.section("What each decides");
    page.table(&table(planned, files));
    page.paragraph(
        "A probability is that of a right decision by `diagnose`, were this rival true, for white noise of the size that \
         the verdict measured and over the values that its intervals hold likely. What is stated first is the mean of \
         the rivals.",
    );
    page.section("To play");
    let drawn: Vec<_> =
        planned.best.iter().zip(files).map(|(p, file)| figure::input(&p.experiment, file).draw()).collect();
    for figure in &drawn {
        page.figure(figure, "Acceleration of the base.");
    }
    page.section("Provenance");
    page.list(&[format!("proofmass {}", env!("CARGO_PKG_VERSION"))]);
    page
}

/// A row for each experiment: how probably it decides for each rival.
fn table(planned: &Planned, files: &[&str]) -> Table {
    let narrows = match &planned.question.purpose {
        Purpose::Narrow(interval) => Some(interval),
        Purpose::Decide | Purpose::Show(_) => None,
    };
    let mut headings = vec!["experiment".to_owned(), "file".to_owned()];
    match narrows {
        Some(interval) => headings.push(format!("95 % interval of {} / {}", interval.parameter, interval.unit)),
        None => headings.extend(rivals(planned).into_iter().chain(["none of them"]).map(|id| format!("if {id}"))),
    }
    let mut table = Table::new(&headings.iter().map(String::as_str).collect::<Vec<_>>());
    let all = planned.best.iter().zip(files.iter().map(|f| (*f).to_owned()));
    let broadband = planned.broadband.iter().map(|p| (p, "for comparison".to_owned()));
    for (proposal, file) in all.chain(broadband) {
        let mut row = vec![experiment(&proposal.experiment), file];
        match narrows {
            Some(_) => row.push(half_width(proposal)),
            None => row.extend(proposal.each.iter().map(|p| percent(*p))),
        }
        table.row(row);
    }
    table
}

fn half_width(proposal: &Proposal) -> String {
    proposal.half_width.map_or("–".to_owned(), |half| format!("± {}", short(half)))
}
