//! The page of a diagnosis: the verdict in plain words first, then where, how sure and at what
//! cost, then the proof.
//!
//! The kinds give their figures as [`Exhibit`]s; this file decides the order of the page, the same
//! for all kinds.

mod calibration;
mod cost;
mod driven;
mod exhibit;
mod fit;
mod form;
mod numbers;
mod profile;
mod response;
mod rest;
mod standing;
mod trajectory;
mod tumble;
mod words;

pub use cost::costs;
pub use exhibit::{Exhibit, Part};
pub use words::{Diagnosis, worded};

use std::collections::HashSet;

use proofmass_diagnosis::answer::Detail;
use proofmass_diagnosis::candidate::Kind;
use proofmass_diagnosis::driven::intake::notes::Broken;
use proofmass_diagnosis::repair::Cost;
use proofmass_diagnosis::standing::{Note, Ranked};
use proofmass_diagnosis::trace::Step;
use proofmass_diagnosis::verdict::{Detectable, Effect, Outcome, Verdict, named};

use super::figure::Figure;
use super::html::Page;
use super::table::Table;
use fit::{base_table, base_words, fit_table, sure};
use numbers::{estimate, formula};
use proofmass_base::number::{duration, rounded, significant};

/// The figures of any kind of diagnosis, no two of one file name.
pub fn exhibits(detail: &Detail) -> Vec<Exhibit> {
    let mut all = match detail {
        Detail::Driven(detail) => driven::exhibits(detail),
        Detail::Static(detail) => rest::exhibits(detail),
        Detail::Tumble(detail) => tumble::exhibits(detail),
        Detail::Trajectory(detail) => trajectory::exhibits(detail),
        Detail::Response(detail) => response::exhibits(detail),
    };
    // Headings that differ in what no file name holds (`a/b`, `a b`), or in case alone, would share
    // a file.
    let mut taken = HashSet::new();
    for exhibit in &mut all {
        let names = std::iter::once(exhibit.name.clone()).chain((2..).map(|n| format!("{}-{n}", exhibit.name)));
        if let Some(free) = names.into_iter().find(|name| !taken.contains(&name.to_lowercase())) {
            taken.insert(free.to_lowercase());
            exhibit.figure = exhibit.figure.clone().named(&free);
            exhibit.name = free;
        }
    }
    all
}

/// Writes the answer for a terminal.
pub fn terminal(diagnosis: &Diagnosis, costs: &[Cost]) -> String {
    let verdict = &diagnosis.verdict;
    let mut out = format!("{}: {}\n\n", verdict.verdict.name(), verdict.sentence);
    out += &answers(diagnosis, costs).iter().map(|(k, v)| format!("{:<18}{v}\n", format!("{k}:"))).collect::<String>();
    if !verdict.effects.is_empty() {
        out += &format!("\n{}", effects_table(&verdict.effects));
    }
    if let Some(found) = &verdict.calibration {
        out += &format!("\n{}:\n{}", calibration::meaning(found, verdict.kind), calibration::text(found, verdict.kind));
    }
    if !verdict.findings.is_empty() {
        out += "\nfound in the file:\n";
        out += &verdict.findings.iter().map(|f| format!("- {f}\n")).collect::<String>();
    }
    out
}

/// The report page of `diagnose`; `study` is the repaired sensor as TOML.
pub fn page(diagnosis: &Diagnosis, costs: &[Cost], exhibits: &[Exhibit], study: Option<&str>) -> Page {
    let verdict = &diagnosis.verdict;
    let file = std::path::Path::new(&verdict.recording.file);
    let name = file.file_name().map_or(verdict.recording.file.clone(), |n| n.to_string_lossy().into_owned());
    let mut page = Page::new(&format!("{}: {name}", headline(diagnosis)), &verdict.sentence);
    let mut first = Table::new(&["", ""]);
    answers(diagnosis, costs).into_iter().for_each(|(question, answer)| first.row([question.to_owned(), answer]));
    page.table(&first);
    figures(&mut page, exhibits, Part::Opening);

    page.section("What was left out");
    match verdict.effects.is_empty() {
        true => page.paragraph(nothing_named(diagnosis)),
        false => {
            statements(&verdict.effects).iter().for_each(|s| page.paragraph(s));
            page.table(&effects_table(&verdict.effects));
        }
    }
    if let Some(found) = &verdict.calibration {
        page.section("The calibration, ready to paste");
        page.paragraph(&format!(
            "{}. The same numbers stand in verdict.json.",
            calibration::meaning(found, verdict.kind)
        ));
        page.preformatted(&calibration::text(found, verdict.kind));
    }
    page.section("Candidates");
    let (passed_over, tried): (Vec<&Ranked>, Vec<&Ranked>) =
        diagnosis.ranking.iter().partition(|r| r.note == Note::Screened);
    if diagnosis.ranking.is_empty() {
        page.paragraph("None was tried.");
    }
    if !tried.is_empty() {
        page.paragraph(&format!(
            "Every candidate that was tried, best first. {} p is corrected for the number of candidates tried.",
            standing::meaning_of_gains(verdict.kind)
        ));
        page.table(&ranking_table(&tried, &diagnosis.trace));
    }
    if !passed_over.is_empty() {
        let ids: Vec<&str> = passed_over.iter().map(|r| r.id).collect();
        page.paragraph(&format!("Not fitted in full, screened out by the linear step: {}.", ids.join(", ")));
    }
    if !verdict.detectable.is_empty() {
        page.section("Detection limits of this recording");
        page.paragraph(&detectable_words(diagnosis));
        page.table(&detectable_table(&verdict.detectable));
    }
    page.section(if verdict.effects.is_empty() { "How well it fits" } else { "Before and after" });
    page.table(&fit_table(verdict));
    if !verdict.base.is_empty() {
        page.paragraph(if verdict.effects.is_empty() {
            "The base model's numbers:"
        } else {
            "The base model's numbers, fitted together with the named effects:"
        });
        page.table(&base_table(verdict));
    }
    figures(&mut page, exhibits, Part::Improvement);
    page.section("Where it shows");
    page.paragraph(&verdict.location.summary);
    figures(&mut page, exhibits, Part::Isolation);
    if exhibits.iter().any(|e| e.part == Part::Identification) {
        page.section("Confidence in the parameters");
        figures(&mut page, exhibits, Part::Identification);
    }
    if !costs.is_empty() {
        page.section("What it costs");
        if let Some(repair) = &diagnosis.repair {
            page.paragraph(&repair.relation);
        }
        page.table(&cost::table(costs));
    }
    page.section("What to do next");
    page.callout(&verdict.next_experiment);
    if let Some(study) = study {
        page.paragraph("The repaired sensor as a study, also in repaired.toml next to this page: run it with `proofmass study repaired.toml`. Constants that a calibration subtracts are left out of it; where there are any, uncorrected.toml has them.");
        page.preformatted(study);
    }
    if !verdict.findings.is_empty() {
        page.section("Found in the file");
        page.list(&verdict.findings);
    }
    page.section("Provenance");
    let recording = &verdict.recording;
    let mut table = Table::new(&["", ""]);
    table.row(["recording", &recording.file]);
    table.row(["SHA-256", &recording.sha256]);
    table.row(["samples", &recording.samples.to_string()]);
    table.row(["rate", &format!("{} Hz", rounded(recording.rate_hz, 6))]);
    table.row(["proofmass", env!("CARGO_PKG_VERSION")]);
    page.table(&table);
    page
}

/// Why the columns of a driven recording do not belong together, if they do not.
fn broken(diagnosis: &Diagnosis) -> Option<&Broken> {
    match &diagnosis.detail {
        Detail::Driven(detail) => detail.account.broken.as_ref(),
        _ => None,
    }
}

fn headline(diagnosis: &Diagnosis) -> &'static str {
    let verdict = &diagnosis.verdict;
    match broken(diagnosis) {
        Some(Broken::Exchanged { .. }) => return "The columns look swapped",
        Some(Broken::Rescaled { .. }) => return "A column changes its size",
        None => {}
    }
    match verdict.verdict {
        Outcome::Unexplained if !verdict.effects.is_empty() => "Not all missing physics could be identified",
        Outcome::Adequate => "Nothing is missing",
        Outcome::Explained => "Missing physics identified",
        Outcome::Unexplained => "Unknown physics is missing",
        Outcome::Undecidable => "This recording cannot decide",
    }
}

fn nothing_named(diagnosis: &Diagnosis) -> &'static str {
    if broken(diagnosis).is_some() {
        return "Nothing was tried, because input and output do not belong together as they stand.";
    }
    match diagnosis.verdict.verdict {
        Outcome::Adequate => "Nothing that this recording could show.",
        Outcome::Explained | Outcome::Unexplained => {
            "No candidate in the library explains the mismatch, so none is named."
        }
        Outcome::Undecidable => "None is named, because this recording cannot tell the candidates apart.",
    }
}

/// The questions of the first screen.
fn answers(diagnosis: &Diagnosis, costs: &[Cost]) -> Vec<(&'static str, String)> {
    let verdict = &diagnosis.verdict;
    let what = match verdict.effects.as_slice() {
        [] => nothing_named(diagnosis).to_owned(),
        effects => statements(effects).join(" "),
    };
    let mut out = vec![("recording", recorded(verdict)), ("left out", what)];
    // The sentence above may hold it already.
    if !verdict.sentence.contains(verdict.location.summary.trim_end_matches('.')) {
        out.push(("where it shows", verdict.location.summary.clone()));
    }
    out.push(("how sure", sure(verdict)));
    if !verdict.base.is_empty() {
        out.push(("base model", base_words(verdict)));
    }
    if let Some(noise) = &verdict.thermal {
        out.push(("thermal noise", words::thermal(noise, &verdict.fit.unit)));
    }
    if let Some(words) = cost::sentence(costs, diagnosis) {
        out.push(("what it costs", words));
    }
    out.push(("next experiment", verdict.next_experiment.clone()));
    out
}

/// A sentence for each effect: its name, its channels and what was left out.
fn statements(effects: &[Effect]) -> Vec<String> {
    let first = |n: &usize| effects[..*n].iter().all(|e| e.id != effects[*n].id);
    let of = |n: usize| {
        let all: Vec<Effect> = effects.iter().filter(|e| e.id == effects[n].id).cloned().collect();
        let form = words::form(&effects[n]).map_or(String::new(), |form| format!(" In this recording {form}."));
        format!("{}: {}{form}", named(&all), effects[n].statement)
    };
    (0..effects.len()).filter(first).map(of).collect()
}

fn recorded(verdict: &Verdict) -> String {
    let (samples, rate_hz) = (verdict.recording.samples, verdict.recording.rate_hz);
    if verdict.kind == Kind::Response {
        return format!("{samples} steps");
    }
    format!("{samples} samples at {} Hz: {}", rounded(rate_hz, 6), duration(samples as f64 / rate_hz))
}

fn effects_table(effects: &[Effect]) -> Table {
    let mut table = Table::new(&["effect", "channels", "parameter", "value ± 95 %", "unit", "held-out gain"]);
    for effect in effects {
        for (n, p) in effect.parameters.iter().enumerate() {
            let once = |text: String| if n == 0 { text } else { String::new() };
            table.row([
                once(effect.id.clone()),
                once(effect.channels.join(", ")),
                p.name.clone(),
                estimate(p),
                formula(&p.unit),
                once(significant(effect.evidence.held_out_gain, 3)),
            ]);
        }
    }
    table
}

fn ranking_table(ranking: &[&Ranked], trace: &[Step]) -> Table {
    let mut table = Table::new(&["candidate", "channels", "held-out gain", "95 %", "p", "named", "note"]);
    for r in ranking {
        let [gain, interval] = standing::gain(r.gain);
        table.row([
            r.id.to_owned(),
            r.channels.join(", "),
            gain,
            interval,
            if r.p_value < 1e-6 { "<10⁻⁶".into() } else { significant(r.p_value, 2) },
            if r.named { "yes" } else { "no" }.to_owned(),
            match standing::why(r, trace) {
                Some(why) => format!("{}; {why}", standing::note(&r.note)),
                None => standing::note(&r.note),
            },
        ]);
    }
    table
}

fn detectable_words(diagnosis: &Diagnosis) -> String {
    let Detail::Driven(detail) = &diagnosis.detail else { return String::new() };
    let mut words = format!(
        "No effect was identified. An effect would have been identified in nine cases of ten if it leaves {} × the \
         noise after the base model is refitted. For each candidate the table states how strong it must be for \
         that, how it changes the reading, and how much of it a refit of resonance, damping and gain hides. \
         Linearised around the base model; `proofmass trial --like` checks it by planting each candidate.",
        significant(detail.least_over_noise, 2)
    );
    if !detail.indistinguishable.is_empty() {
        let pairs: Vec<String> = detail.indistinguishable.iter().map(|[a, b]| format!("{a} and {b}")).collect();
        words += &format!(" Indistinguishable in this recording if one of them were present: {}.", pairs.join("; "));
    }
    words
}

fn detectable_table(all: &[Detectable]) -> Table {
    let mut table = Table::new(&[
        "candidate",
        "strength",
        "would be named from",
        "unit",
        "change of the reading, × noise",
        "of it hidden, %",
    ]);
    for d in all {
        let or_never = |value: Option<f64>| value.map_or("–".to_owned(), |v| significant(v, 2));
        table.row([
            d.id.clone(),
            d.parameter.clone(),
            or_never(d.strength),
            formula(&d.unit),
            or_never(d.effect_over_noise),
            format!("{:.0}", 100.0 * d.hidden_share),
        ]);
    }
    table
}

fn figures(page: &mut Page, exhibits: &[Exhibit], part: Part) {
    let chosen: Vec<(&Figure, &str)> =
        exhibits.iter().filter(|e| e.part == part).map(|e| (&e.figure, e.caption.as_str())).collect();
    match chosen.as_slice() {
        [] => {}
        [(figure, caption)] => page.figure(figure, caption),
        several => page.figure_row(several),
    }
}
