//! The page of one set of recordings: what it is, the verdicts, the numbers, noise and drift at
//! rest.

use super::numbers::estimate;
use super::origin;
use crate::recording_atlas::measured::Drift;
use crate::recording_atlas::recipe::{Question, Rest};
use crate::recording_atlas::survey::{Answered, Surveyed};
use proofmass_base::number::{duration, rounded, significant};
use proofmass_diagnosis::candidate::Kind;
use proofmass_diagnosis::verdict::{Estimate, Verdict};
use proofmass_report::table::Table;

/// Returns the page of a set; `command` is what made it.
pub fn page(surveyed: &Surveyed, command: &str) -> String {
    let set = &surveyed.set;
    let mut page = format!(
        "# {}\n\n{}\n\n- Source: {}.\n- Licence of the recordings: {}.\n\n{}\n## What the verdicts say\n\n",
        set.title,
        set.about,
        set.source,
        set.licence,
        recordings(surveyed).to_markdown()
    );
    for (question, answered) in surveyed.questions() {
        page += &format!("**{}: {}.** {}\n\n", question.name, answered.said.outcome.name(), plain(answered));
    }
    let numbers = numbers(surveyed);
    if !numbers.rows.is_empty() {
        page += &format!(
            "## Numbers found\n\nValues with their 95 % interval, in the unit of the recording's columns. Where zero lies \
             within the interval, there is no estimate, only the range. Effects that fit equally well stand with “or”.\n\n{}\n",
            numbers.to_markdown()
        );
    }
    let errors = errors(surveyed);
    if !errors.rows.is_empty() {
        page += &format!("## Error on data that were not fitted\n\n{}\n", errors.to_markdown());
    }
    if surveyed.at_rest().any(|(_, measured)| !measured.axes.is_empty()) {
        page += "## Noise at rest\n\nBy `proofmass allan`: estimates with their 95 % interval; “<” is an upper limit (95 %). A \
                 star marks a curve that the five terms of IEEE 952 do not describe.\n\n";
    }
    for (rest, measured) in surveyed.at_rest() {
        page += &format!("{}, {} at rest:\n\n", rest.name, duration(measured.length_s()));
        for table in &measured.tables {
            page += &format!("{}\n", table.to_markdown());
        }
    }
    let drift = drift(surveyed);
    if !drift.rows.is_empty() {
        page += &format!(
            "## Predicted and recorded drift\n\nThe log cut into windows, each begun with a still start, next to simulated \
             sensors that have its coefficients: position of an accelerometer, tilt of a gyro, at the end of a window.\n\n{}\n",
            drift.to_markdown()
        );
    }
    page + &origin(command)
}

/// The sentence of a verdict, without signs that Markdown would take for its own.
fn plain(answered: &Answered) -> String {
    let words = answered.said.words.replace('\n', " ").replace('*', "\\*").replace('<', "&lt;");
    // Headings such as `ax_lsb` would be set in italics.
    words.replace('_', "\\_")
}

fn recordings(surveyed: &Surveyed) -> Table {
    let mut table = Table::new(&["recording", "kind", "rows", "rate", "length", "SHA-256 of what was read"]);
    for (question, answered) in surveyed.questions() {
        let Some(verdict) = &answered.verdict else {
            table.row([question.name.as_str(), "–", "–", "–", "–", "–"]);
            continue;
        };
        let info = &verdict.recording;
        // Steps of a lock-in sweep are not evenly spaced.
        let (rate, length) = match verdict.kind {
            Kind::Response => ("–".to_owned(), "–".to_owned()),
            _ => (format!("{} Hz", rounded(info.rate_hz, 6)), duration(info.rows as f64 / info.rate_hz)),
        };
        let digest = info.sha256.chars().take(12).collect::<String>() + "…";
        table.row([question.name.clone(), verdict.kind.name().to_owned(), info.rows.to_string(), rate, length, digest]);
    }
    table
}

/// Fitted numbers of base models and of named effects. The means of a log at rest are no property of
/// the sensor alone: gravity and the Earth's rate are in them.
fn numbers(surveyed: &Surveyed) -> Table {
    let mut table = Table::new(&["recording", "of", "columns", "number", "value (95 % interval)", "unit"]);
    for (question, answered) in surveyed.questions() {
        let Some(verdict) = &answered.verdict else { continue };
        let base: &[Estimate] = if verdict.kind == Kind::Static { &[] } else { &verdict.base };
        base.iter().for_each(|number| table.row(row(question, "base model", "", number)));
        for effect in &verdict.effects {
            let of = std::iter::once(&effect.id).chain(&effect.confusable_with).map(String::as_str);
            let of = of.collect::<Vec<_>>().join(" or ");
            let columns = effect.channels.join(", ");
            effect.parameters.iter().for_each(|number| table.row(row(question, &of, &columns, number)));
        }
    }
    table
}

fn row(question: &Question, of: &str, columns: &str, number: &Estimate) -> [String; 6] {
    let [of, columns, name] = [of, columns, &number.name].map(str::to_owned);
    let unit = if number.unit == "1" { String::new() } else { number.unit.clone() };
    [question.name.clone(), of, columns, name, estimate(number.value, number.ci95), unit]
}

/// Errors of free simulation; those of logs at rest are the noise itself.
fn errors(surveyed: &Surveyed) -> Table {
    let mut table =
        Table::new(&["recording", "base model", "with the named effects", "noise of what was fitted", "unit"]);
    let has_errors = |verdict: &&Verdict| verdict.kind != Kind::Static;
    for (question, answered) in surveyed.questions() {
        let Some(verdict) = answered.verdict.as_ref().filter(has_errors) else { continue };
        let fit = &verdict.fit;
        let after = fit.test.rmse_after.map_or("–".into(), |error| significant(error, 3));
        let [before, floor] = [fit.test.rmse_before, fit.noise_floor].map(|error| significant(error, 3));
        table.row([question.name.clone(), before, after, floor, fit.unit.clone()]);
    }
    table
}

fn drift(surveyed: &Surveyed) -> Table {
    let headings = ["recording", "axis", "windows", "inside the predicted 90 %", "sd recorded", "sd predicted"];
    let mut table = Table::new(&headings);
    for (rest, measured) in surveyed.at_rest() {
        measured.drift.iter().for_each(|drift| table.row(drifted(rest, drift)));
    }
    table
}

fn drifted(rest: &Rest, drift: &Drift) -> [String; 6] {
    let sd = |value: f64| format!("{} {}", significant(value, 3), drift.unit);
    [
        rest.name.clone(),
        drift.axis.clone(),
        format!("{} × {}", drift.windows, duration(drift.seconds)),
        format!("{} of {}", drift.inside, drift.windows),
        sd(drift.recorded),
        sd(drift.predicted),
    ]
}
