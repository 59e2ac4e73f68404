//! Reports aiding on page and terminal: the errors at the end of each outage, and how they get
//! there.

use super::doubt::doubt;
use crate::figure::{Axis, Chart, Ink, Mark};
use crate::html::Page;
use crate::table::Table;
use proofmass_base::number::{significant, worth};
use proofmass_simulate::backend::flight::Quantity;
use proofmass_simulate::strapdown::answer::Answer;
use proofmass_simulate::strapdown::outages::Outage;
use proofmass_study::Study;
use proofmass_study::file::AidingMethod;

/// Outages that are drawn.
const DRAWN: usize = 6;

/// The section about aiding; nothing where there is none.
pub(crate) fn section(page: &mut Page, study: &Study, answer: &Answer) {
    if answer.flight.fixes.is_empty() {
        return;
    }
    page.section("What aids it");
    page.paragraph(&model(study, answer));
    if answer.outages.is_empty() {
        return;
    }
    page.figure(
        &growth(answer).draw(),
        "Horizontal distance from the truth that 95 of 100 navigators stay within, from the start of each outage.",
    );
    page.table(&table(answer));
}

/// States what measures, and how the navigator uses it.
pub(crate) fn model(study: &Study, answer: &Answer) -> String {
    let fixes = answer.flight.fixes.len();
    let aiding = study.in_motion.as_ref().and_then(|motion| motion.aiding.as_ref());
    let method = match aiding.map_or(AidingMethod::Filter, |aiding| aiding.method) {
        AidingMethod::Filter => {
            "A loosely coupled Kalman filter of fifteen errors (attitude, velocity, position, biases), told the study's own \
             numbers, corrects every navigator with the same gains."
        }
        AidingMethod::Reset => {
            "Velocity and position are set to what is measured; attitude and biases are left as they are."
        }
    };
    format!("{fixes} measurements aid the run. {method}")
}

/// The outage at whose end the horizontal error is largest.
pub(crate) fn worst(answer: &Answer) -> Option<(&Outage, usize)> {
    let end = |outage: &Outage| outage.places.last().copied();
    let size = |k: usize| answer.ensemble.summary(k, Quantity::Horizontal).percentiles[3];
    let all = answer.outages.iter().filter_map(|outage| end(outage).map(|k| (outage, k)));
    all.max_by(|a, b| size(a.1).total_cmp(&size(b.1)))
}

/// Errors at the start and the end of each outage.
pub(crate) fn table(answer: &Answer) -> Table {
    let mut table = Table::new(&[
        "GNSS outage / s",
        "CEP95 at its start / m",
        "north sd / m",
        "east sd / m",
        "down sd / m",
        "CEP50 / m",
        "CEP95 / m",
        "SEP95 / m",
        "horizontal by linear model / m",
    ]);
    for outage in &answer.outages {
        let (Some(first), Some(last)) = (outage.places.first(), outage.places.last()) else { continue };
        let at = |place: usize, quantity| answer.ensemble.summary(place, quantity);
        let percentile = |place: usize, quantity, rank: usize| {
            let summary = at(place, quantity);
            worth(summary.percentiles[rank], 2.0 * doubt(summary))
        };
        let begin = if outage.from_s > 0.0 { percentile(*first, Quantity::Horizontal, 3) } else { "start".to_owned() };
        let mut row = vec![format!("{} to {}", outage.from_s, outage.until_s), begin];
        row.extend((0..3).map(|axis| at(*last, Quantity::Position(axis))).map(|s| worth(s.sd, doubt(s))));
        row.push(percentile(*last, Quantity::Horizontal, 2));
        row.push(percentile(*last, Quantity::Horizontal, 3));
        row.push(percentile(*last, Quantity::Spherical, 3));
        let square =
            |axis: usize| answer.covariance.variance(*last, axis) + answer.covariance.mean(*last, axis).powi(2);
        row.push(significant((square(0) + square(1)).sqrt(), 3));
        table.row(row);
    }
    table
}

/// Horizontal error over the time since each outage began.
fn growth(answer: &Answer) -> Chart {
    let (time, distance) = (Axis::linear("time since the outage began / s"), Axis::linear("horizontal, 95 % / m"));
    let mut chart = Chart::new("While GNSS is out", time, distance);
    for (n, outage) in answer.outages.iter().take(DRAWN).enumerate() {
        let point = |k: &usize| {
            let percentile = answer.ensemble.summary(*k, Quantity::Horizontal).percentiles[3];
            (answer.ensemble.time_s[*k] - outage.from_s, percentile)
        };
        let name = format!("{} to {} s", outage.from_s, outage.until_s);
        chart.add(&name, Ink::nth(n), Mark::Line, outage.places.iter().map(point).collect());
    }
    chart
}
