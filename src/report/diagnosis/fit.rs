//! Says how well it fits, in words and as tables: errors before and after, the noise next to them,
//! the base model's own numbers.

use crate::table::Table;
use proofmass_base::number::significant;
use proofmass_diagnosis::verdict::{Estimate, Role, Verdict};

use super::numbers::{chance, estimate, formula};

/// States what held-out data say; noise that no simulation predicts shows in the likelihood alone.
pub(crate) fn sure(verdict: &Verdict) -> String {
    let (test, unit) = (&verdict.fit.test, &verdict.fit.unit);
    let (before, floor) = (significant(test.rmse_before, 3), noise(verdict));
    let Some(after) = test.rmse_after.filter(|_| !verdict.effects.is_empty()).map(|v| significant(v, 3)) else {
        return format!("held-out error of the base model {before} {unit} ({floor})");
    };
    let gain = match verdict.fit.log_score {
        Some(score) if before == after => format!(
            "log-likelihood per held-out sample {} → {} (noise cannot be predicted sample by sample, so the error \
             stays at {after} {unit})",
            significant(score.before, 4),
            significant(score.after, 4)
        ),
        _ => format!("held-out error {before} → {after} {unit} ({floor})"),
    };
    let worst = verdict.effects.iter().map(|e| e.evidence.p_value).fold(f64::NAN, f64::max);
    if worst.is_finite() { format!("{gain}; chance of a false name {}", chance(worst)) } else { gain }
}

/// The noise as measured apart from the fit; by the fit where it was not.
fn noise(verdict: &Verdict) -> String {
    match &verdict.fit.noise {
        Some(noise) => format!("noise {}, measured from {}", significant(noise.value, 3), noise.how),
        None => format!("noise alone {}", significant(verdict.fit.noise_floor, 3)),
    }
}

/// Numbers of the base model in a line, at most; the table has them all.
const IN_A_LINE: usize = 12;

/// The base model's numbers in a line.
pub(crate) fn base_words(verdict: &Verdict) -> String {
    let one = |e: &Estimate| {
        let symbol = if e.name == "omega0" {
            "ω₀"
        } else if e.name == "zeta" {
            "ζ"
        } else {
            &e.name
        };
        let unit = if e.unit == "1" { String::new() } else { format!(" {}", formula(&e.unit)) };
        let hz = if e.name == "omega0" {
            format!(" ({} Hz)", significant(e.value / std::f64::consts::TAU, 4))
        } else {
            String::new()
        };
        format!("{symbol} = {}{unit}{hz}", estimate(e))
    };
    let words = verdict.base.iter().take(IN_A_LINE).map(one).collect::<Vec<String>>().join(", ");
    match verdict.base.len().saturating_sub(IN_A_LINE) {
        0 => words,
        more => format!("{words} and {more} more in verdict.json"),
    }
}

/// The same as a table.
pub(crate) fn base_table(verdict: &Verdict) -> Table {
    let mut table = Table::new(&["parameter", "value ± 95 %", "unit"]);
    for e in &verdict.base {
        table.row([e.name.clone(), estimate(e), formula(&e.unit)]);
    }
    table
}

/// Errors of the base model, and where something is named, with it.
pub(crate) fn fit_table(verdict: &Verdict) -> Table {
    let fit = &verdict.fit;
    let title = format!("root-mean-square error, {}", fit.unit);
    let noise = fit.noise.as_ref().map_or(fit.noise_floor, |n| n.value);
    let alone = match &fit.noise {
        Some(noise) => format!("noise alone, from {}", noise.how),
        None => "noise alone".to_owned(),
    };
    if verdict.effects.is_empty() {
        let mut table = Table::new(&[&title, "base model"]);
        for (name, score) in [("fitted data", &fit.train), ("held-out data", &fit.test)] {
            table.row([name.to_owned(), significant(score.rmse_before, 3)]);
        }
        for r in &fit.test_ranges {
            table.row([format!("held-out samples {} to {}", r.from, r.to), significant(r.rmse_before, 3)]);
        }
        table.row([alone, significant(noise, 3)]);
        return table;
    }
    let after = |value: Option<f64>| value.map_or("–".to_owned(), |v| significant(v, 3));
    let mut table = Table::new(&[&title, "base model", "with the named physics"]);
    for (name, score) in [("fitted data", &fit.train), ("held-out data", &fit.test)] {
        table.row([name.to_owned(), significant(score.rmse_before, 3), after(score.rmse_after)]);
    }
    for r in &fit.test_ranges {
        let name = format!("held-out samples {} to {}", r.from, r.to);
        table.row([name, significant(r.rmse_before, 3), after(r.rmse_after)]);
    }
    if let Some(repaired) = &fit.with_unnamed {
        let with = format!("with corrections that are not named ({})", repaired.terms.join(", "));
        let parts = [("fitted data", repaired.train_rmse), ("held-out data", repaired.test_rmse)];
        for (name, rmse) in parts {
            table.row([format!("{name}, {with}"), String::new(), significant(rmse, 3)]);
        }
        for (r, rmse) in fit.test_ranges.iter().zip(&repaired.test_ranges_rmse) {
            let name = format!("held-out samples {} to {}, with these", r.from, r.to);
            table.row([name, String::new(), significant(*rmse, 3)]);
        }
    }
    let several = fit.recordings.len() > 1 || fit.recordings.iter().any(|r| r.force_error_before.is_some());
    for r in fit.recordings.iter().filter(|_| several) {
        let path = std::path::Path::new(&r.file).file_name();
        let file = path.map_or(r.file.clone(), |f| f.to_string_lossy().into_owned());
        let role = if r.role == Role::Test { "validation only" } else { "fitted" };
        table.row([format!("{file}, {role}"), significant(r.rmse_before, 3), after(r.rmse_after)]);
        if let Some(before) = r.force_error_before {
            let name = format!("{file}, {role}: error of the force over the force");
            table.row([name, significant(before, 3), after(r.force_error_after)]);
        }
    }
    if let Some([before, after]) = fit.one_step_rmse {
        table.row(["held-out data, one step ahead".to_owned(), significant(before, 3), significant(after, 3)]);
    }
    if let Some(score) = fit.log_score {
        table.row([
            "log-likelihood per held-out sample".to_owned(),
            significant(score.before, 4),
            significant(score.after, 4),
        ]);
    }
    table.row([alone, significant(noise, 3), String::new()]);
    table
}
