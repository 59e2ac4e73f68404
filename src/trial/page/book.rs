//! A verdict book on the terminal: marks by kind and family, processor time, and what changed since
//! another book.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::book::ablation::{LEAST_CHANGED, Worth};
use crate::book::against::{Against, LEVEL, Row, Shift};
use crate::book::entry::Entry;
use crate::independent::judge::Mark;
use proofmass_base::number::{duration, significant};
use proofmass_report::table::Table;

/// Processor time of the verdicts of a book, s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Of all of them.
    pub total_s: f64,
    /// Of the one in the middle.
    pub median_s: f64,
    /// Of the one that nine of ten do not exceed.
    pub p90_s: f64,
    /// Of the one that 99 of 100 do not exceed.
    pub p99_s: f64,
    /// Of the longest.
    pub longest_s: f64,
}

impl Cost {
    /// Returns what the verdicts cost; zeros where there are none.
    pub fn of<'a>(book: impl Iterator<Item = &'a Entry>) -> Self {
        let mut times: Vec<f64> = book.map(|entry| entry.cpu_s).collect();
        times.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let place = (part * times.len() as f64).ceil() as usize;
            times.get(place.saturating_sub(1)).copied().unwrap_or(0.0)
        };
        Self { total_s: times.iter().sum(), median_s: at(0.5), p90_s: at(0.9), p99_s: at(0.99), longest_s: at(1.0) }
    }
}

/// Returns the marks of a book and what it cost.
pub fn terminal(book: &[Entry]) -> String {
    let mut groups: BTreeMap<(&str, &str), Vec<&Entry>> = BTreeMap::new();
    for entry in book {
        groups.entry((&entry.kind, &entry.family)).or_default().push(entry);
    }
    let marks: Vec<Mark> = Mark::ALL.into_iter().filter(|mark| book.iter().any(|e| e.mark == *mark)).collect();
    let mut headings = vec!["kind", "family", "cases"];
    headings.extend(marks.iter().map(|mark| mark.word()));
    headings.extend(["median", "99 %", "in all"]);
    let mut table = Table::new(&headings);
    let mut row = |kind: &str, family: &str, of: &[&Entry]| {
        let count = |mark: &Mark| match of.iter().filter(|e| e.mark == *mark).count() {
            0 => "·".to_owned(),
            n => n.to_string(),
        };
        let cost = Cost::of(of.iter().copied());
        let cells = [kind.to_owned(), family.to_owned(), of.len().to_string()].into_iter();
        let times = [cost.median_s, cost.p99_s, cost.total_s].map(duration);
        table.row(cells.chain(marks.iter().map(count)).chain(times));
    };
    groups.iter().for_each(|((kind, family), of)| row(kind, family, of));
    row("all", "", &book.iter().collect::<Vec<_>>());
    let cost = Cost::of(book.iter());
    let longest = book.iter().max_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s)).map_or("", |entry| &entry.case);
    let [total, median, ninety, most, last] =
        [cost.total_s, cost.median_s, cost.p90_s, cost.p99_s, cost.longest_s].map(duration);
    format!(
        "{table}\nprocessor time of the verdicts: {total} in all; median {median}, 90 % {ninety}, 99 % {most}, longest \
         {last} ({longest})\n"
    )
}

fn shift(shift: &Shift) -> [String; 3] {
    let [low, high] = shift.worse.ci95.map(|p| significant(100.0 * p, 2));
    [
        format!("{} → {} (+{} −{})", shift.before, shift.after, shift.gained, shift.lost),
        format!("{} % ({low}–{high} %)", significant(100.0 * shift.worse.value, 2)),
        significant(shift.p_value, 2),
    ]
}

/// Returns what changed between two books, a line for each case.
pub fn against(found: &Against) -> String {
    if found.rows.first().is_none_or(|row| row.cases == 0) {
        return "the two books have no case in common\n".into();
    }
    let mut table = Table::new(&[
        "family",
        "cases",
        "changed",
        "right",
        "lost, exact 95 %",
        "p",
        "false names and alarms",
        "worse, exact 95 %",
        "p",
        "processor time",
        "",
    ]);
    for row in &found.rows {
        let Row { right, false_names, cpu_s, .. } = row;
        let counts = [row.cases, row.changed].map(|n| n.to_string());
        let family = row.family.clone().unwrap_or_else(|| "all".into());
        let time = format!("{} → {}", duration(cpu_s[0]), duration(cpu_s[1]));
        let called = if row.is_worse { "WORSE" } else { "" }.to_owned();
        let cells = std::iter::once(family).chain(counts).chain(shift(right)).chain(shift(false_names));
        table.row(cells.chain([time, called]));
    }
    let mut text = format!("{table}\n");
    for c in &found.changed {
        text += &format!("{} [{}]: {} → {}\n", c.case, c.family, c.before, c.after);
    }
    let [first, second] = found.unmatched;
    if first + second > 0 {
        text += &format!("not compared: {first} cases of the first book alone, {second} of the second alone\n");
    }
    if found.changed.is_empty() {
        text += "nothing changed: every verdict, name, tie and mark is the same\n";
    }
    let level = significant(100.0 * LEVEL, 2);
    text + &format!(
        "p: chance of a change for the worse as large as this, where better and worse are alike; the whole book is \
         tested at {level} % for both figures together, its families together at another {level} %\n"
    )
}

/// Returns the table of what each gate is worth, as Markdown, with how it was measured.
pub fn gates(worths: &[Worth], verdicts: usize) -> String {
    let mut text = format!(
        "# What each rule of a driven diagnosis is worth\n\nOf {verdicts} verdicts of the book, each in which a rule \
         acted was asked for again without it. *Better* and *worse*: verdicts whose mark is so because of the rule. \
         A rule earns its place where it changes at least {} % of the verdicts, and more for the better than for the \
         worse.\n\n| rule | what it says | acted | changed | better | worse | false names prevented | time with → without \
         it | earned |\n|:--|:--|--:|--:|--:|--:|--:|--:|:--|\n",
        significant(100.0 * LEAST_CHANGED, 2)
    );
    for worth in worths {
        let Worth { gate, statement, acted, changed, better, worse, prevents, cpu_s } = worth;
        let [with, without] = cpu_s.map(duration);
        let earned = if worth.is_earned(verdicts) { "yes" } else { "no" };
        text += &format!(
            "| `{gate}` | {statement} | {acted} | {changed} | {better} | {worse} | {prevents} | {with} → {without} | \
             {earned} |\n"
        );
    }
    text
}
