//! Measured speed as a table and a page.

use super::figure::{Axis, Chart, Ink, Mark};
use super::html::Page;
use super::number::significant;
use super::table::Table;
use crate::backend::cpu::processor_name;
use crate::benchmark::{Row, work};

/// All measurements.
pub fn table(rows: &[Row]) -> Table {
    let mut table = Table::new(&["work", "where", "precision", "members", "million per s", "of", "share of peak"]);
    for r in rows {
        table.row([
            r.work.clone(),
            r.place.clone(),
            r.precision.clone(),
            r.members.to_string(),
            significant(r.per_second / 1e6, 4),
            r.unit.clone(),
            r.share_of_peak.map_or_else(String::new, |s| format!("{} %", significant(100.0 * s, 3))),
        ]);
    }
    table
}

/// The page: what was measured and on what.
pub fn page(rows: &[Row]) -> String {
    let mut page = Page::new(
        "How fast proofmass is here",
        "Member-steps per second, the fastest of repeated runs in one process. Compare rows with each other, not with rows of \
         another day.",
    );
    page.section("Measurements");
    page.paragraph(&format!(
        "Processor: {}, {} threads. A member-step is one integration step of one sensor. The share of peak counts the \
         floating-point instructions of a step (fused multiply-adds, additions and multiplications alike) against the \
         multiply-adds per second measured in the same run; additions may run beside them, so it is no strict bound.",
        processor_name(),
        std::thread::available_parallelism().map_or(1, usize::from)
    ));
    page.table(&table(rows));
    page.section("Small and large ensembles");
    let mut chart =
        Chart::new("Speed by size of the ensemble", Axis::log("members"), Axis::log("million member-steps per s"));
    let inks = [Ink::Blue, Ink::Orange];
    let mut places: Vec<&str> = rows.iter().map(|r| r.place.as_str()).collect();
    places.dedup();
    for (place, ink) in places.into_iter().zip(inks) {
        let sized = rows.iter().filter(|r| r.work == work::SIZED && r.place == place);
        let points: Vec<(f64, f64)> = sized.map(|r| (r.members as f64, r.per_second / 1e6)).collect();
        chart.add(place, ink, Mark::Line, points.clone());
        chart.add("", ink, Mark::Dots(3), points);
    }
    page.figure(
        &chart.draw(),
        "The full path (Runge-Kutta 4, force noise, two integrations) from one sensor to a million, drawing of members and \
         sums included.",
    );
    page.finish()
}
