//! Each parameter of each run, and whether they agree.

use super::values::{difference_in_words, estimated, spread_in_words};
use super::words::{name, unit};
use crate::table::Table;
use proofmass_diagnosis::check::{Checked, Compared};
use proofmass_diagnosis::repeatability::agreement::Line;
use proofmass_diagnosis::repeatability::parameter::{AtRest, Estimate, Parameter};
use proofmass_diagnosis::repeatability::run::Run;

/// Runs that a terminal has room for; how many more there are stands with the last.
const SHOWN: usize = 4;

/// The table.
pub(super) fn of(files: &[String], checked: &Checked) -> Table {
    let (headings, shown) = columns(files, checked);
    let several = checked.runs.len() > 1;
    let mut all: Vec<String> = ["parameter, 95 %", "unit"].map(str::to_owned).to_vec();
    all.extend(headings);
    let difference = if checked.runs.len() > 2 { "clearest difference" } else { "difference" };
    all.extend([difference, ""].map(str::to_owned));
    if several {
        all.push("from run to run".to_owned());
    }
    let mut table = Table::new(&all.iter().map(String::as_str).collect::<Vec<_>>());
    let Some(first) = checked.runs.first() else { return table };
    for (p, parameter) in first.estimate.parameters.iter().enumerate() {
        // What nothing determines is said above the table.
        if shown.iter().all(|e| !e.determines(p)) {
            continue;
        }
        let cell = |e: &&Estimate| match e.determines(p) {
            true => estimated(e, p).words(),
            false => "not determined".to_owned(),
        };
        let mark = if checked.runs.iter().any(|run| is_mixed(run, parameter)) { " *" } else { "" };
        let mut row = vec![format!("{}{mark}", name(parameter)), unit(parameter).0.to_owned()];
        row.extend(shown.iter().map(cell));
        let line = checked.agreement.as_ref().and_then(|(_, a)| a.lines.iter().find(|l| l.parameter == p));
        row.extend(match line {
            Some(line) => {
                let agrees = if line.agrees() { "agrees" } else { "DIFFERS" };
                [without_unit(parameter, line), agrees.to_owned()]
            }
            None => ["–".to_owned(), "not compared".to_owned()],
        });
        if several {
            let of = line.and_then(|l| l.spread);
            row.push(of.map_or("–".to_owned(), |of| spread_in_words(parameter, &of)));
        }
        table.row(row);
    }
    table
}

/// Returns whether a coefficient of noise is one of a channel that holds something else.
fn is_mixed(run: &Run, parameter: &Parameter) -> bool {
    let Parameter::AtRest(AtRest { channel, term: Some(_), .. }) = parameter else { return false };
    run.besides.iter().any(|besides| besides.channel == *channel)
}

/// The difference without its unit, which has a column.
fn without_unit(parameter: &Parameter, line: &Line) -> String {
    let words = difference_in_words(parameter, line).replace("a factor of ", "× ");
    words.strip_suffix(unit(parameter).0).map_or(words.clone(), |bare| bare.trim_end().to_owned())
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
            let mut headings: Vec<String> = files.iter().take(SHOWN).map(|f| short_name(f)).collect();
            let more = files.len().saturating_sub(SHOWN);
            headings.last_mut().filter(|_| more > 0).into_iter().for_each(|last| *last += &format!(" (+ {more} more)"));
            (headings, shown)
        }
    }
}

/// The name of a file without its folders.
pub(super) fn short_name(file: &str) -> String {
    file.rsplit('/').next().unwrap_or(file).to_owned()
}
