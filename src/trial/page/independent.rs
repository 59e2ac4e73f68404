//! States what the trial of the second generator found: on the terminal, as a page, as a short
//! summary.

use crate::independent::judge::Mark;
use crate::independent::run::Lines;
use crate::independent::score::{Row, Score};
use crate::independent::truth::{Family, SEEN};
use crate::interval::Proportion;
use proofmass_base::number::{duration, significant};
use proofmass_report::html::Page;
use proofmass_report::table::Table;

fn words(proportion: &Proportion) -> String {
    if proportion.cases == 0 {
        return "–".into();
    }
    let [low, high] = proportion.ci95.map(|p| format!("{:.1}", 100.0 * p));
    format!("{:.1} % ({low}–{high} %, {} of {})", 100.0 * proportion.value, proportion.hits, proportion.cases)
}

/// The figures with what is to be reached.
pub(crate) fn headline(score: &Score) -> Table {
    let mut table = Table::new(&["figure", "found (exact 95 % interval)", "to reach"]);
    let rows = [
        ("confidently wrong, of all cases", words(&score.confidently_wrong), "≤ 0.5 %"),
        ("false alarms on nulls", words(&score.false_alarms), "≤ 0.5 %"),
        ("… of these undecidable", words(&score.undecided_nulls), ""),
        ("near a law: false names", words(&score.near_false_names), "≤ 1 %"),
        ("near a law: right, or honest with the right name", words(&score.near_right_or_honest), "≥ 85 %"),
    ];
    rows.into_iter().for_each(|(a, b, c)| table.row([a.to_owned(), b, c.to_owned()]));
    let [median, ninety, most] = score.seconds.map(duration);
    table.row([
        "time per verdict, each on one core: median, 90 %, 99 %".to_owned(),
        format!("{median}, {ninety}, {most}"),
        "1 s, –, 10 s".to_owned(),
    ]);
    table
}

/// Marks by kind and family, or by sub-family.
pub(crate) fn marks(rows: &[Row]) -> Table {
    let mut headings = vec!["kind", "family"];
    let subs = rows.iter().any(|r| r.sub.is_some());
    if subs {
        headings.push("what");
    }
    headings.push("cases");
    headings.extend(Mark::ALL.map(Mark::word));
    if !subs {
        headings.extend(["right or honest name", "false names", "alarms"]);
    }
    let mut table = Table::new(&headings);
    for row in rows {
        let mut cells = vec![row.kind.name().to_owned(), row.family.name().to_owned()];
        cells.extend(row.sub.clone());
        cells.push(row.cases.to_string());
        cells.extend(Mark::ALL.map(|m| match row.count(m) {
            0 => "·".to_owned(),
            n => n.to_string(),
        }));
        if !subs {
            let null = row.family == Family::Null;
            cells.push(words(&row.right_or_honest));
            cells.push(if null { "–".to_owned() } else { words(&row.false_names) });
            cells.push(if null { words(&row.alarms) } else { "–".to_owned() });
        }
        table.row(cells);
    }
    table
}

/// Coverage per candidate and parameter.
pub(crate) fn intervals(score: &Score) -> Table {
    let mut table = Table::new(&["kind", "effect", "parameter", "hold the truth", "largest miss (half-widths)"]);
    for i in &score.intervals {
        let far = if i.worst > 0.0 { significant(i.worst, 2) } else { "–".into() };
        table.row([i.kind.name().to_owned(), i.id.clone(), i.name.clone(), words(&i.cover), far]);
    }
    table
}

/// Agreement of verdicts under other ways of writing.
pub(crate) fn agreement(score: &Score) -> Table {
    let mut table = Table::new(&["the same recording", "same verdict", "cases that do not agree"]);
    for a in &score.agreement {
        let numbers: Vec<String> = a.apart.iter().take(12).map(usize::to_string).collect();
        table.row([a.change.name().to_owned(), words(&a.same), numbers.join(", ")]);
    }
    table
}

fn counts(rows: &[Row]) -> Table {
    let shown = [Mark::Right, Mark::Overclaimed, Mark::HonestNamed, Mark::Honest, Mark::BelowDetection, Mark::Missed];
    let mut table = Table::new(&[
        "kind",
        "family",
        "cases",
        "right",
        "only near",
        "right name",
        "no name",
        "unseen",
        "missed",
        "false (sure)",
        "alarm (undecided)",
        "error",
    ]);
    for row in rows {
        let mut cells = vec![row.kind.name().to_owned(), row.family.name().to_owned(), row.cases.to_string()];
        cells.extend(shown.map(|m| row.count(m).to_string()));
        let sure = row.count(Mark::ConfidentlyWrong);
        cells.push(format!("{} ({sure})", row.count(Mark::FalseName) + sure));
        let undecided = row.count(Mark::Undecided);
        cells.push(format!("{} ({undecided})", row.count(Mark::FalseAlarm) + undecided));
        cells.push(row.count(Mark::Error).to_string());
        table.row(cells);
    }
    table
}

/// The result on a terminal.
pub fn terminal(score: &Score) -> String {
    let mut text = format!(
        "{}\n{}\nonly near: explained by a law that the truth departs from; right name, no name: unexplained or undecidable;\n\
         unseen: adequate, too small for a good test; sure: called explained\n",
        headline(score),
        counts(&score.families)
    );
    if !score.agreement.is_empty() {
        text += &format!("\n{}", agreement(score));
    }
    if !score.intervals.is_empty() {
        text += &format!("\n{}", intervals(score));
    }
    text
}

fn how(score: &Score) -> String {
    format!(
        "{} cases from seed {}, made by a second generator whose physics lies mostly outside the library; rewritten \
        copies of the same recordings are counted separately. An effect counts as visible when it adds {SEEN} to \
        twice the log-likelihood over the best base model: a weaker one cannot be expected to pass a test on a third \
        of the data. A name is false when it is neither that of the planted physics nor that of the nearest library \
        law.",
        score.cases, score.seed
    )
}

/// The whole report as a page.
pub fn page(score: &Score, lines: &Lines) -> String {
    let lede = format!(
        "Second trial of the diagnosis: confidently wrong {}; false alarms on nulls {}; near a law, right or honest \
        with the \
         right name {}.",
        words(&score.confidently_wrong),
        words(&score.false_alarms),
        words(&score.near_right_or_honest)
    );
    let mut page = Page::new("Proof of the diagnosis, second generator", &lede);
    page.paragraph(&how(score));
    page.callout(&format!(
        "SHA-256 of the sealed truth, printed before the first verdict: {}. truth.json next to this page has it.",
        score.truth_sha256
    ));
    page.table(&headline(score));
    page.section("By kind and family");
    page.table(&marks(&score.families));
    page.section("By what is there");
    page.table(&marks(&score.subs));
    // Sweeps are not written otherwise.
    if !score.agreement.is_empty() {
        page.section("Invariance: the same recording rewritten");
        page.table(&agreement(score));
    }
    page.section("Interval coverage");
    page.table(&intervals(score));
    page.section("Every case");
    page.paragraph("Reproduce one with: proofmass trial --independent --seed S --case NUMBER --out DIR.");
    let mut table = Table::new(&["case", "kind", "family", "what", "truth (× noise)", "said", "mark", "s"]);
    for line in lines.values() {
        let sizes: Vec<String> = line.over_noise.iter().map(|s| significant(*s, 2)).collect();
        let groups: Vec<String> = line.said.groups.iter().map(|g| g.join(" | ")).collect();
        table.row([
            line.number.to_string(),
            line.kind.clone(),
            line.family.clone(),
            line.sub.clone(),
            format!("{} ({})", line.truth, sizes.join(", ")),
            format!("{} {}", line.said.outcome.name(), groups.join(" + ")),
            line.mark.word().to_owned(),
            significant(line.said.seconds, 2),
        ]);
    }
    page.table(&table);
    page.finish()
}

/// The short summary that is committed.
pub fn summary(score: &Score, command: &str) -> String {
    format!(
        "# Proof of the diagnosis, second generator\n\nGenerated by `{command}`.\n\n{}\n\nSHA-256 of the sealed truth: `{}`\n\n\
         {}\n## By kind and family\n\n{}\n## By what is there\n\n{}\n## The same recording rewritten\n\n{}\n\
         ## Intervals\n\n{}",
        how(score),
        score.truth_sha256,
        headline(score).to_markdown(),
        marks(&score.families).to_markdown(),
        marks(&score.subs).to_markdown(),
        agreement(score).to_markdown(),
        intervals(score).to_markdown(),
    )
}
