//! Distances of the values of each parameter from their mean, in units of how well they are known.

use super::table::columns;
use super::words::name;
use crate::figure::{Axis, Chart, Ink, Mark};
use proofmass_diagnosis::check::{Checked, Compared};

pub(super) const CAPTION: &str = "Each value less the mean of those compared, over its standard error, with its 95 % \
     interval. Where two differ by more than chance makes them differ in one of twenty cases, the table says so.";

/// Standard errors from a value to the end of its 95 % interval.
const TO_THE_END: f64 = 1.96;
/// Recordings that are told apart by colour.
const SHOWN: usize = 6;
/// Distance of two recordings within a row.
const APART: f64 = 0.14;
/// Standard errors beyond which a value is drawn at the edge.
const EDGE: f64 = 12.0;

/// A row for each parameter that is compared.
pub(super) fn differences(files: &[String], checked: &Checked) -> Option<Chart> {
    let (compared, agreement) = checked.agreement.as_ref()?;
    let estimate = &checked.runs.first()?.estimate;
    let rows = agreement.lines.len();
    if rows == 0 {
        return None;
    }
    let place = |row: usize| (rows - row) as f64;
    let names = agreement.lines.iter().enumerate();
    let names = names.map(|(row, line)| (place(row), name(&estimate.parameters[line.parameter]))).collect();
    let mut chart = Chart::new(
        "How far the values lie apart",
        Axis::linear("value less mean / standard errors"),
        Axis::linear("parameter").named(names).within(0.4, rows as f64 + 0.6),
    );
    let (headings, _) = columns(files, checked);
    // Of one recording the whole stands first, and is not compared.
    let headings = &headings[usize::from(matches!(compared, Compared::Halves(_)))..];
    let clip = |x: f64| x.clamp(-EDGE, EDGE);
    for (run, heading) in headings.iter().enumerate().take(SHOWN) {
        let mut dots = Vec::new();
        for (row, line) in agreement.lines.iter().enumerate() {
            let Some((value, error)) = line.runs.get(run).copied() else { continue };
            let weight = line.runs.iter().map(|r| r.1.powi(-2)).sum::<f64>();
            let mean = line.runs.iter().map(|r| r.0 * r.1.powi(-2)).sum::<f64>() / weight;
            let x = (value - mean) / error;
            let y = place(row) + APART * (0.5 * (headings.len().min(SHOWN) - 1) as f64 - run as f64);
            dots.push((clip(x), y));
            let interval = [x - TO_THE_END, x + TO_THE_END].map(|end| (clip(end), y));
            chart.add("", Ink::nth(run), Mark::Line, interval.to_vec());
        }
        chart.add(heading, Ink::nth(run), Mark::Dots(3), dots);
    }
    chart.size = (720, 120 + 24 * rows.max(4) as u32);
    Some(chart)
}
