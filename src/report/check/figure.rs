//! Distances of the values of each parameter from their mean, in units of how well they are known.

use super::table::short_name;
use super::words::name;
use crate::figure::{Axis, Chart, Ink, Mark};
use proofmass_diagnosis::check::{Checked, Compared};
use proofmass_diagnosis::repeatability::agreement::Odd;
use proofmass_diagnosis::repeatability::parameter::Estimate;

pub(super) const CAPTION: &str = "Each value less the weighted mean of those compared, over half the width of its own \
     95 % interval, which reaches one to each side. What lies beyond six is drawn at six. Which differences are more \
     than chance is said in the table.";

/// Recordings that are told apart by colour; of more, only the odd one is.
const COLOURED: usize = 6;
/// Part of a row over which the recordings are spread.
const SPREAD: f64 = 0.5;
/// Half-widths beyond which a value is drawn at the edge.
const EDGE: f64 = 6.0;

/// A recording, or a half of one.
struct Side<'a> {
    name: String,
    ink: Ink,
    estimate: &'a Estimate,
}

/// A row for each parameter that is compared.
pub(super) fn differences(files: &[String], checked: &Checked) -> Option<Chart> {
    let (_, agreement) = checked.agreement.as_ref()?;
    let rows = agreement.lines.len();
    let sides = sides(files, checked);
    let first = sides.first().filter(|_| rows > 0)?.estimate;
    let place = |row: usize| (rows - row) as f64;
    let names = agreement.lines.iter().enumerate();
    let names = names.map(|(row, line)| (place(row), name(&first.parameters[line.parameter]))).collect();
    let mut chart = Chart::new(
        "How far the values lie apart",
        Axis::linear("value less mean / half of its 95 % interval"),
        Axis::linear("parameter").named(names).within(0.4, rows as f64 + 0.6),
    );
    let clip = |x: f64| x.clamp(-EDGE, EDGE);
    for (n, side) in sides.iter().enumerate() {
        let mut dots = Vec::new();
        for (row, line) in agreement.lines.iter().enumerate() {
            let p = line.parameter;
            let weight = |s: &Side<'_>| s.estimate.half_width(p).powi(-2);
            let sum: f64 = sides.iter().map(weight).sum();
            let mean = sides.iter().map(|s| weight(s) * s.estimate.value[p]).sum::<f64>() / sum;
            let x = (side.estimate.value[p] - mean) / side.estimate.half_width(p);
            let y = place(row) + SPREAD * (0.5 - (n as f64 + 0.5) / sides.len() as f64);
            dots.push((clip(x), y));
            let interval = [x - 1.0, x + 1.0].map(|end| (clip(end), y));
            chart.add("", side.ink, Mark::Line, interval.to_vec());
        }
        chart.add(&side.name, side.ink, Mark::Dots(3), dots);
    }
    chart.size = (720, 120 + 24 * rows.max(4) as u32);
    Some(chart)
}

fn sides<'a>(files: &[String], checked: &'a Checked) -> Vec<Side<'a>> {
    let Some((compared, agreement)) = &checked.agreement else { return Vec::new() };
    if let (Compared::Halves(_), [only]) = (compared, &checked.runs[..]) {
        let halves = only.halves.iter().flat_map(|halves| &halves.each).zip(["one half", "other half"]).enumerate();
        let side = |(n, (estimate, name)): (usize, (&'a Estimate, &str))| Side {
            name: name.to_owned(),
            ink: Ink::nth(n),
            estimate,
        };
        return halves.map(side).collect();
    }
    let is_few = files.len() <= COLOURED;
    let side = |(n, (file, estimate)): (usize, (&String, &'a Estimate))| match agreement.odd == Some(Odd::Run(n)) {
        _ if is_few => Side { name: short_name(file), ink: Ink::nth(n), estimate },
        true => Side { name: short_name(file), ink: Ink::Red, estimate },
        false => Side { name: String::new(), ink: Ink::Soft, estimate },
    };
    files.iter().zip(checked.runs.iter().map(|run| &run.estimate)).enumerate().map(side).collect()
}
