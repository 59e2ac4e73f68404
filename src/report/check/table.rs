//! Each parameter of each run, and whether they agree.

use super::words::{name, unit, unit_of_difference};
use crate::table::Table;
use proofmass_base::number::{short, with_uncertainty};
use proofmass_diagnosis::check::{Checked, Compared};
use proofmass_diagnosis::repeatability::agreement::Line;
use proofmass_diagnosis::repeatability::parameter::Estimate;

/// Runs that a terminal has room for; of more the means and spreads are shown.
const SHOWN: usize = 4;

/// The table.
pub(super) fn of(files: &[String], checked: &Checked) -> Table {
    let (headings, shown) = columns(files, checked);
    let several = checked.runs.len() > 1;
    let mut all: Vec<String> = ["parameter, 95 %", "unit"].map(str::to_owned).to_vec();
    all.extend(headings);
    all.extend(["difference", ""].map(str::to_owned));
    if several {
        all.push("from run to run".to_owned());
    }
    let mut table = Table::new(&all.iter().map(String::as_str).collect::<Vec<_>>());
    let Some(first) = checked.runs.first() else { return table };
    for (p, parameter) in first.estimate.parameters.iter().enumerate() {
        let (in_unit, factor) = unit(parameter);
        let cell = |e: &&Estimate| match e.determines(p) {
            true => with_uncertainty(e.value[p] * factor, e.half_width(p) * factor),
            false => "not determined".to_owned(),
        };
        let mut row = vec![name(parameter), in_unit.to_owned()];
        row.extend(shown.iter().map(cell));
        let line = checked.agreement.as_ref().and_then(|(_, a)| a.lines.iter().find(|l| l.parameter == p));
        row.extend(compared(line, |line| unit_of_difference(parameter, middle(line))));
        if several {
            row.push(line.and_then(|l| l.spread).map_or("–".to_owned(), |spread| {
                let [low, high] = spread.between_ci95.map(|end| short(end * factor));
                format!("{} ({low} to {high})", short(spread.between * factor))
            }));
        }
        table.row(row);
    }
    table
}

fn middle(line: &Line) -> f64 {
    line.runs.iter().map(|r| r.0).sum::<f64>() / line.runs.len().max(1) as f64
}

fn compared(line: Option<&Line>, unit: impl Fn(&Line) -> (&'static str, f64)) -> [String; 2] {
    let Some(line) = line else { return ["–".to_owned(), "not compared".to_owned()] };
    let (in_unit, factor) = unit(line);
    let difference = with_uncertainty(line.difference * factor, line.half_width * factor);
    let difference = if in_unit == "%" { format!("{difference} %") } else { difference };
    [difference, if line.agrees() { "agrees" } else { "DIFFERS" }.to_owned()]
}

/// Columns side by side: a recording and its halves, or the recordings.
fn columns<'a>(files: &[String], checked: &'a Checked) -> (Vec<String>, Vec<&'a Estimate>) {
    match (&checked.agreement, &checked.runs[..]) {
        (Some((Compared::Halves(_), _)), [only]) => {
            let halves = only.halves.iter().flat_map(|h| h.each.iter());
            let headings = ["all of it", "one half", "other half"].map(str::to_owned).to_vec();
            (headings, std::iter::once(&only.estimate).chain(halves).collect())
        }
        (_, runs) => {
            let shown = runs.iter().take(SHOWN).map(|r| &r.estimate).collect();
            (files.iter().take(SHOWN).map(|f| short_name(f)).collect(), shown)
        }
    }
}

/// The name of a file without its folders.
pub(super) fn short_name(file: &str) -> String {
    file.rsplit('/').next().unwrap_or(file).to_owned()
}
