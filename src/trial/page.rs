//! States what a blind trial found: on the terminal, as a page, and as a short summary to be
//! committed.

pub mod book;
pub mod figures;
pub mod independent;
pub mod like;
pub mod planned;
pub mod recording_atlas;

use crate::blind::Verdicts;
use crate::campaign::Campaign;
use crate::case::{Case, Family};
use crate::interval::Proportion;
use crate::judge::{self, Covered};
use crate::outcome::{Confusion, FALLBACK_LIMIT, Limit, Outcome};
use crate::plan::Plan;
use crate::real::Found;
use crate::said::Ending;
use proofmass_base::number::{duration, significant};
use proofmass_diagnosis::candidate::Kind;
use proofmass_numerics::numerics::order;
use proofmass_report::html::Page;
use proofmass_report::table::Table;

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn with_interval(share: &Proportion) -> String {
    let [low, high] = share.ci95.map(|p| format!("{:.1}", 100.0 * p));
    format!("{} ({low}–{high} %, {} of {})", percent(share.value), share.hits, share.cases)
}

/// The headline numbers, each with its target.
pub(crate) fn headline(outcome: &Outcome) -> Table {
    let mut table = Table::new(&["figure", "found (95 % interval)", "to reach"]);
    let rows = [
        ("effects above their detection limit named correctly", with_interval(&outcome.named), "≥ 97 %"),
        ("false alarms where nothing was planted", with_interval(&outcome.false_alarm_rate), "≤ 1 %"),
        ("unknown physics called unexplained", with_interval(&outcome.flagged), "≥ 90 %"),
        ("unknown physics given a false name", percent(outcome.unknown_named), "0 %"),
        ("95 % intervals that cover the truth", with_interval(&outcome.coverage), "92–98 %"),
        ("removable error on unseen data removed (median)", percent(outcome.held_out_gain), ""),
        ("confidently wrong, of all cases", percent(outcome.confidently_wrong), ""),
    ];
    rows.into_iter().for_each(|(a, b, c)| table.row([a.to_owned(), b, c.to_owned()]));
    table.row(["diagnoses that stopped with an error".to_owned(), percent(outcome.errors), "0 %".to_owned()]);
    let [median, largest] = outcome.seconds_per_case.map(duration);
    table.row([
        "time per verdict, each on one core".to_owned(),
        format!("{median} (at most {largest})"),
        "≤ 10 s".to_owned(),
    ]);
    table
}

/// One row per way of concealment.
pub(crate) fn families(outcome: &Outcome) -> Table {
    let mut table =
        Table::new(&["how it is concealed", "cases", "right", "silent", "detected, not named", "false name"]);
    for row in &outcome.families {
        // Counts: a share of four cases has no decimals.
        let rates = [1.0, row.named_correctly, row.silent, row.unnamed, row.confidently_wrong];
        let counts = rates.map(|s| format!("{:.0}", s * row.cases as f64));
        table.row(std::iter::once(row.name.clone()).chain(counts));
    }
    table
}

/// Real recordings against what another source knows of them.
pub fn recordings(found: &[Found]) -> Table {
    let mut table = Table::new(&["recording", "known from elsewhere", "said", "numbers"]);
    for real in found {
        let groups: Vec<String> = real.said.groups.iter().map(|g| g.join(" or ")).collect();
        let known = if real.truth.is_empty() { "nothing to be named".to_owned() } else { real.truth.join(", ") };
        let said = match real.said.outcome {
            Ending::Error => format!("error: {}", real.said.words),
            outcome => format!("{}: {}", outcome.name(), groups.join(", ")),
        };
        table.row([
            real.name.clone(),
            format!("{known} ({})", real.source),
            said.trim_end_matches([':', ' ']).to_owned(),
            real.numbers.join("; "),
        ]);
    }
    table
}

/// Errors on samples that were not fitted next to the best published ones.
pub fn scores(found: &[Found]) -> Table {
    let headings = ["recording", "validated on", "unit", "base model", "with the named physics", "published", "by"];
    let mut table = Table::new(&headings);
    let number = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), |v| significant(v, 3));
    for real in found {
        for s in &real.scores {
            let cells = [number(s.before), number(s.after), number(s.published)];
            let words = [real.name.clone(), s.on.clone(), s.unit.clone()];
            table.row(words.into_iter().chain(cells).chain([s.by.clone()]));
        }
    }
    table
}

fn limit_words(limit: &Limit) -> String {
    let numbers = |v: f64| significant(v, 2);
    match limit.effect_over_noise.zip(limit.ci95) {
        Some((size, [low, high])) => format!("{} ({}–{})", numbers(size), numbers(low), numbers(high)),
        None if limit.noticed == 1.0 => format!("< {}", significant(limit.tried[0], 2)),
        None => format!("> {}", significant(limit.tried[1], 2)),
    }
}

/// Per effect: from which size it is noticed, how often it is named, what it is taken for.
pub fn effects(outcome: &Outcome) -> Table {
    let headings = ["kind", "planted alone", "cases", "detected from (× noise)", "named", "other verdicts"];
    let mut table = Table::new(&headings);
    for limit in &outcome.detection_limit {
        let of = |c: &&Confusion| c.kind == limit.kind && c.planted == limit.id;
        let mut said: Vec<_> = outcome.confusion.iter().filter(of).collect();
        order::sort_by_key(&mut said, |c| -(c.cases as f64));
        let is_right = |said: &str| said == limit.id || tie_of_two_with(said, &limit.id);
        let right: usize = said.iter().filter(|c| is_right(&c.said)).map(|c| c.cases).sum();
        let others: Vec<String> =
            said.iter().filter(|c| !is_right(&c.said)).map(|c| format!("{} {}×", c.said, c.cases)).collect();
        let total: usize = said.iter().map(|c| c.cases).sum();
        table.row([
            limit.kind.name().to_owned(),
            limit.id.clone(),
            total.to_string(),
            limit_words(limit),
            format!("{right} of {total}"),
            others.join(", "),
        ]);
    }
    table
}

/// Physics foreign to the library, kind by kind.
pub(crate) fn unknown(outcome: &Outcome) -> Table {
    let headings = ["what was planted", "cases", "unexplained", "… with a part named", "false name"];
    let mut table = Table::new(&headings);
    for kind in &outcome.unknown {
        let counts = [kind.cases, kind.flagged, kind.partly_named, kind.named].map(|n| n.to_string());
        table.row(std::iter::once(kind.what.clone()).chain(counts));
    }
    table
}

/// Planted alone against said in one kind of recording, as a matrix: a row per effect, columns by
/// the rows' numbers; a tie counts in each of its columns.
pub fn matrix(outcome: &Outcome, kind: Kind) -> Table {
    let limits = outcome.detection_limit.iter().filter(|l| l.kind == kind);
    let ids: Vec<&str> = limits.map(|l| l.id.as_str()).collect();
    let numbers: Vec<String> = (1..=ids.len()).map(|n| n.to_string()).collect();
    // Said without a name.
    let outcomes = ["adequate", "unexplained", "undecidable"];
    let headings: Vec<&str> =
        ["planted"].into_iter().chain(numbers.iter().map(String::as_str)).chain(outcomes).collect();
    let mut table = Table::new(&headings);
    for (id, number) in ids.iter().zip(&numbers) {
        let said = || outcome.confusion.iter().filter(|c| c.kind == kind && c.planted == *id);
        let names = |c: &Confusion, column: &str| c.said.split([' ', '+', '|']).any(|word| word == column);
        let cell = |column: &&str| {
            let count: usize = said().filter(|c| names(c, column)).map(|c| c.cases).sum();
            if count == 0 { "·".to_owned() } else { count.to_string() }
        };
        let cells: Vec<String> = ids.iter().chain(&outcomes).map(cell).collect();
        table.row(std::iter::once(format!("{number} {id}")).chain(cells));
    }
    table
}

/// Per parameter: how many of the 95 % intervals hold the planted value.
pub(crate) fn intervals(outcome: &Outcome) -> Table {
    let mut table = Table::new(&["effect", "parameter", "intervals", "hold the truth", "worst (estimate / truth)"]);
    let mut names: Vec<(&str, &str)> = outcome.covered.iter().map(|c| (c.id.as_str(), c.name.as_str())).collect();
    names.sort_unstable();
    names.dedup();
    for (id, name) in names {
        let of: Vec<_> = outcome.covered.iter().filter(|c| c.id == id && c.name == name).collect();
        // A planted zero has no ratio; its interval still counts.
        let ratio = |c: &Covered| if c.truth == 0.0 { 1.0 } else { c.value / c.truth };
        let worst = of.iter().max_by(|a, b| (ratio(a) - 1.0).abs().total_cmp(&(ratio(b) - 1.0).abs()));
        table.row([
            id.to_owned(),
            name.to_owned(),
            of.len().to_string(),
            of.iter().filter(|c| c.covers).count().to_string(),
            worst.map_or_else(String::new, |c| significant(ratio(c), 4)),
        ]);
    }
    table
}

fn tie_of_two_with(said: &str, id: &str) -> bool {
    let parts: Vec<&str> = said.split(" | ").collect();
    parts.len() == 2 && parts.contains(&id) && !said.contains(" + ")
}

/// The result on a terminal.
pub fn terminal(outcome: &Outcome) -> String {
    format!("{}\n{}\n{}", headline(outcome), families(outcome), effects(outcome))
}

fn how(plan: &Plan, outcome: &Outcome) -> String {
    let noise = match plan.campaign {
        Campaign::Concealed => "nulls 0.2 to 2 %; at rest and when turned, sizes are over the white noise per sample",
        Campaign::Planted => "nulls 0.2 to 2 %",
    };
    format!(
        "{} cases from seed {}, {} samples each, readout noise 0.2 % of the output ({noise}). Sizes are the rms that the best \
         refit of the base model leaves, over the rms noise. A verdict is right when it names exactly what was planted, or \
         says “undecidable” and lists it with at most one other. The detection limit of an effect is the size \
         detected in nine of ten cases; without one in range, cases count as above it from {FALLBACK_LIMIT} × noise. \
         Intervals \
         are compared \
         where exactly what was planted was named.",
        outcome.cases, plan.seed, plan.samples
    )
}

/// The whole report as a page.
pub fn page(plan: &Plan, outcome: &Outcome, cases: &[Case], verdicts: &Verdicts, real: &[Found]) -> Page {
    let lede = format!(
        "Blind trial of the diagnosis: {} of the effects above their detection limit were named correctly; false alarms on \
         {} recordings with nothing planted: {}; unknown physics flagged: {}.",
        percent(outcome.named_correctly),
        outcome.false_alarm_rate.cases,
        outcome.false_alarm_rate.hits,
        percent(outcome.unknown_flagged)
    );
    let mut page = Page::new("Proof of the diagnosis", &lede);
    page.paragraph(&how(plan, outcome));
    page.callout(&format!(
        "SHA-256 of the sealed truth, printed before the first verdict: {}. truth.json next to this page has it.",
        outcome.truth_sha256
    ));
    page.table(&headline(outcome));
    page.section("How effects were concealed");
    page.table(&families(outcome));
    if !real.is_empty() {
        page.section("Real recordings");
        page.table(&recordings(real));
        if real.iter().any(|r| !r.scores.is_empty()) {
            page.paragraph(
                "Errors of free simulation on the official test data of public benchmarks, none of which was fitted, \
                beside the best published (collected in Champneys, Beintema, Tóth, Schoukens & Rogers, arXiv \
                2405.10779, unless said otherwise).",
            );
            page.table(&scores(real));
        }
    }
    page.section("Power against size");
    let (power, limits) = (figures::power(outcome), figures::limits(outcome));
    page.figure_row(&[
        (
            &power,
            "Fraction detected and fraction named against the visible size, all effects planted alone. Bars: exact \
             95 %; bands: all curves within 95 %.",
        ),
        (
            &limits,
            "Size at which a mismatch is detected in nine of ten recordings, per effect, with its 95 % interval; \
            those that \
        reach beyond \
          100 are cut there.",
        ),
    ]);
    page.section("Confusion matrix");
    page.table(&effects(outcome));
    page.paragraph(
        "As matrices: rows planted alone, columns named, by the number of the row; a tie counts in both columns.",
    );
    for kind in [Kind::Driven, Kind::Static, Kind::Tumble] {
        let matrix = matrix(outcome, kind);
        if !matrix.rows.is_empty() {
            page.subsection(kind.name());
            page.table(&matrix);
        }
    }
    page.section("What no candidate describes");
    page.table(&unknown(outcome));
    page.section("Interval coverage");
    page.table(&intervals(outcome));
    page.section("Every case");
    page.paragraph("Reproduce one with: proofmass trial --seed S --cases N --case NUMBER --out DIR.");
    let mut table = Table::new(&["case", "family", "planted (× noise)", "said", "mark"]);
    for case in cases {
        let Some(said) = verdicts.get(&case.number) else { continue };
        let sizes: Vec<String> =
            case.sizes_over_noise().iter().map(|(id, s)| format!("{id} {}", significant(*s, 2))).collect();
        let groups: Vec<String> = said.groups.iter().map(|g| g.join(" | ")).collect();
        let words = format!("{} {}", said.outcome.name(), groups.join(" + "));
        let mark = judge::judge(case, said).word().to_owned();
        let cells = [case.family.name().to_owned(), sizes.join(" + "), words, mark];
        table.row(std::iter::once(case.number.to_string()).chain(cells));
    }
    page.table(&table);
    page
}

/// The short summary that is committed.
pub fn summary(plan: &Plan, outcome: &Outcome, command: &str, real: &[Found]) -> String {
    let blind: Vec<String> = Family::ALL
        .iter()
        .filter_map(|f| outcome.families.iter().find(|r| r.name == f.name() && r.confidently_wrong > 0.0))
        .map(|r| format!("{} ({})", r.name, percent(r.confidently_wrong)))
        .collect();
    let misses = if blind.is_empty() { "none".to_owned() } else { blind.join(", ") };
    format!(
        "# Proof of the diagnosis\n\nGenerated by `{command}`.\n\n{}\n\nSHA-256 of the sealed truth: `{}`\n\n{}\n\
         ## How effects were concealed\n\n{}\nFamilies with confident false names: {misses}.\n\n\
         {}## Effects\n\n{}\n## What no candidate describes\n\n{}\n## Intervals\n\n{}\n![power](power.svg)\n\n![limits](limits.svg)\n",
        how(plan, outcome),
        outcome.truth_sha256,
        headline(outcome).to_markdown(),
        families(outcome).to_markdown(),
        if real.is_empty() {
            String::new()
        } else {
            format!("## Real recordings\n\n{}\n{}\n", recordings(real).to_markdown(), scores(real).to_markdown())
        },
        effects(outcome).to_markdown(),
        unknown(outcome).to_markdown(),
        intervals(outcome).to_markdown(),
    )
}
