//! The probability that an error of a study exceeds a limit: on a terminal and on a page.

use super::moment::moment;
use crate::figure::{Axis, Chart, Ink, Mark};
use crate::html::Page;
use crate::table::Table;
use proofmass_base::number::{significant, superscript};
use proofmass_numerics::statistics::Estimate;
use proofmass_numerics::statistics::subset::REPEATS;
use proofmass_simulate::decision::risk::{Exceeds, Risk};
use proofmass_simulate::decision::watched::Watched;

/// Explains how it was found.
fn method(risk: &Risk) -> String {
    format!(
        "By subset simulation: the members with the largest tenth of the errors are varied until they make a sample of \
         their own, and so on down to the limit; {} members in {REPEATS} independent repeats, on the CPU. Intervals are \
         of 95 %, from the repeats. The probability is that of the study as it is written: tails of a distribution that \
         nobody has measured are not in it.",
        risk.members
    )
}

/// The answer with its table, for a terminal.
pub(super) fn terminal(risk: &Risk) -> String {
    let table = if risk.exceeded.is_empty() { String::new() } else { table(risk).to_string() };
    format!("{}\n{table}", sentence(risk))
}

/// Adds it to the section of a page that says how far it drifts.
pub(crate) fn append(page: &mut Page, risk: &Risk) {
    page.subsection("How probable a large error is");
    page.paragraph(&sentence(risk));
    if !risk.exceeded.is_empty() {
        page.figure(
            &chart(risk).draw().named("risk"),
            "The probability that the error exceeds a value; red: the limit, with its 95 % interval. Intervals of the \
             values stand in the table.",
        );
        page.table(&table(risk));
    }
    page.paragraph(&method(risk));
}

fn sentence(risk: &Risk) -> String {
    let Exceeds { quantity, is_absolute, time_s, limit } = risk.event;
    let (words, unit) = quantity.words();
    let size = if is_absolute && quantity != Watched::HORIZONTAL { "size of the " } else { "" };
    let event = format!("the {size}{words} after {} exceeds {limit} {unit}", moment(time_s));
    match risk.probability {
        Some(Estimate { value, ci95: [low, high] }) => format!(
            "Probability that {event}: {} ({} to {}), one sensor in {}; {} members.",
            significant(value, 2),
            significant(low, 2),
            significant(high, 2),
            significant(1.0 / value, 2),
            risk.members
        ),
        None => format!(
            "Probability that {event}: below 10{}; {} members.",
            superscript(-(risk.exceeded.len() as i32)),
            risk.members
        ),
    }
}

fn table(risk: &Risk) -> Table {
    let mut table = Table::new(&["one sensor in", &heading(risk), "95 % interval"]);
    for exceeded in &risk.exceeded {
        let [low, high] = exceeded.error.ci95.map(|end| significant(end, 4));
        let one_in = format!("{:.0}", 1.0 / exceeded.probability);
        table.row([one_in, significant(exceeded.error.value, 4), format!("{low} to {high}")]);
    }
    table
}

/// The error with its unit.
fn heading(risk: &Risk) -> String {
    let (words, unit) = risk.event.quantity.words();
    format!("{words} / {unit}")
}

fn chart(risk: &Risk) -> Chart {
    let points: Vec<(f64, f64)> = risk.exceeded.iter().map(|e| (e.error.value, e.probability)).collect();
    let mut chart = Chart::new("Probability to exceed", Axis::linear(&heading(risk)), Axis::log("probability")).with(
        "simulated",
        Ink::Blue,
        Mark::Line,
        points.clone(),
    );
    chart.add("", Ink::Blue, Mark::Dots(4), points);
    let limit = risk.event.limit;
    if let Some(Estimate { value, ci95: [low, high] }) = risk.probability {
        chart.add("limit", Ink::Red, Mark::Dots(4), vec![(limit, value)]);
        chart.add("", Ink::Red, Mark::Whiskers(vec![high]), vec![(limit, low)]);
    }
    chart
}
