//! A first look at a file, in words for a terminal and as JSON, with the command to run next.

mod document;

pub use document::{Document, document};

use super::table::Table;
use proofmass_base::document::toml_string;
use proofmass_base::error::Error;
use proofmass_base::escape::word;
use proofmass_base::number::{duration, rounded, short};
use proofmass_diagnosis::proposal::{Named, Suited, is_turned, longest, proposed, suited, total_s};
use proofmass_recording::finding::sentences;
use proofmass_recording::inspection::Inspection;

/// Parts shown on a terminal.
const SHOWN: usize = 40;
/// The tables: what parts there are, what the columns hold.
pub fn tables(seen: &Inspection) -> Vec<Table> {
    let mut out = Vec::new();
    if seen.parts.iter().any(|p| !p.name.is_empty()) {
        let mut table = Table::new(&["part", "type", "rows", "columns"]);
        for part in seen.parts.iter().take(SHOWN) {
            let columns: Vec<&str> = part.columns.iter().map(|c| c.name.as_str()).collect();
            let columns = if columns.is_empty() { "not read".to_owned() } else { columns.join(" ") };
            table.row([part.name.clone(), part.kind.clone(), part.rows.map_or("–".into(), |r| r.to_string()), columns]);
        }
        out.push(table);
    }
    if let Some(rows) = &seen.rows {
        let mut table = Table::new(&["column", "unit", "lowest", "highest", "mean", "σ", "step"]);
        for column in &rows.columns {
            let numbers = [column.lowest, column.highest, column.mean, column.deviation].map(short);
            let step = column.step.map_or("–".into(), short);
            let unit = column.stated.clone().unwrap_or_else(|| "–".into());
            // The unit in brackets stands in a column of its own.
            let bare = column.name.split(['[', '(']).next().unwrap_or_default().trim();
            let name = if column.name.ends_with([']', ')']) && !bare.is_empty() { bare } else { &column.name };
            table.row([&[name.to_owned(), unit], &numbers[..], &[step]].concat());
        }
        out.push(table);
    }
    out
}

/// Lists what is to be said of the file, a sentence a line.
pub fn notes(seen: &Inspection) -> Vec<String> {
    let mut out = Vec::new();
    let part = seen.part.as_ref().map_or(String::new(), |name| format!(", `{name}`"));
    let Some(rows) = &seen.rows else {
        out.push(seen.format.to_owned());
        return out;
    };
    out.push(match rows.rate_hz {
        Some(rate_hz) => format!(
            "{}{part}: {} rows, {} samples at {} Hz, {}",
            seen.format,
            rows.rows,
            rows.samples,
            rounded(rate_hz, 6),
            duration(rows.samples as f64 / rate_hz)
        ),
        None => format!("{}{part}: {} rows, no clock", seen.format, rows.rows),
    });
    if seen.parts.len() > SHOWN {
        out.push(format!("{} further parts are not shown; --json lists all", seen.parts.len() - SHOWN));
    }
    out.extend(sentences(&rows.findings).into_iter().map(|s| format!("found: {s}")));
    if let (Some(longest), Some(rate_hz)) = (longest(&rows.still), rows.rate_hz) {
        out.push(format!(
            "still for {} of {}, in {}; the longest from {} to {} s",
            duration(total_s(&rows.still)),
            duration(rows.samples as f64 / rate_hz),
            match rows.still.len() {
                1 => "one stretch".to_owned(),
                several => format!("{several} stretches"),
            },
            rounded(longest.from_s, 4),
            rounded(longest.to_s, 4)
        ));
    } else if rows.sensors.iter().any(|places| !places.is_empty()) && rows.rate_hz.is_some() {
        out.push("never still for two seconds".to_owned());
    }
    if is_turned(rows) {
        out.push(format!("it rests with gravity in {} directions: poses of a calibration", rows.poses));
    }
    let around: Vec<&str> = rows.columns.iter().filter(|c| c.is_environment).map(|c| c.name.as_str()).collect();
    if !around.is_empty() && rows.sensors.iter().any(|places| !places.is_empty()) {
        out.push(format!("environment, not a reading of the sensor: {}", around.join(", ")));
    }
    if rows.is_pose {
        out.push("its rows are poses: the reference of a motion, not readings of a sensor".to_owned());
    }
    out
}

/// The command that suits what was seen, or the choice that must come first; none where nothing
/// suits.
pub fn next(file: &str, seen: &Inspection) -> Option<String> {
    let rows = seen.rows.as_ref()?;
    let suited = suited(rows)?;
    let subject = subject(file, seen);
    let allan = format!("proofmass allan {subject}");
    let diagnose = format!("proofmass diagnose {subject}");
    Some(match suited {
        Suited::Reference => format!(
            "proofmass diagnose IMU.csv --model model.toml, where model.toml begins with kind = \"trajectory\" and its \
             [reference] has file = {}",
            toml_string(file)
        ),
        Suited::Motion => {
            format!("{diagnose} --model model.toml, where model.toml begins with kind = \"trajectory\"")
        }
        Suited::Rest => allan,
        Suited::RestFor(rest) => {
            format!("{allan} --from-s {} --to-s {}", rounded(rest.from_s, 4), rounded(rest.to_s, 4))
        }
        Suited::Driven | Suited::Sweeps | Suited::Poses => match proposed(&subject, seen, &Named::default()) {
            Ok(model) => format!("{diagnose}, which chooses {}", in_a_line(&model)),
            Err(refused) => refused.hint,
        },
    })
}

/// The file, and its topic where it has several, as arguments.
fn subject(file: &str, seen: &Inspection) -> String {
    let several = seen.parts.iter().filter(|p| p.is_imu).count() > 1 || seen.parts.iter().all(|p| !p.is_imu);
    let topic = seen.part.as_ref().filter(|_| several).map_or(String::new(), |t| format!(" --topic {}", word(t)));
    format!("{}{topic}", word(file))
}

/// The command that says whether the recording is good enough, where `check` takes it as it is.
pub fn check(file: &str, seen: &Inspection) -> Option<String> {
    let rows = seen.rows.as_ref().filter(|rows| rows.rate_hz.is_some())?;
    let subject = subject(file, seen);
    let check = format!("proofmass check {subject}");
    let check = match suited(rows)? {
        Suited::Rest => check,
        Suited::RestFor(rest) => {
            format!("{check} --from-s {} --to-s {}", rounded(rest.from_s, 4), rounded(rest.to_s, 4))
        }
        Suited::Poses => check,
        Suited::Reference | Suited::Motion | Suited::Driven | Suited::Sweeps => return None,
    };
    // The model that it would choose.
    proposed(&subject, seen, &Named::default()).ok().map(|_| check)
}

/// A model's lines as one, without its tables' names.
pub fn in_a_line(model: &str) -> String {
    let lines = model.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    lines.filter(|line| *line != "[columns]").collect::<Vec<_>>().join(", ")
}

/// Returns why nothing can be run yet; steps of a sweep need no clock.
pub fn obstacle<'a>(file: &str, seen: &'a Inspection) -> Option<&'a Error> {
    seen.obstacle.as_ref().filter(|_| next(file, seen).is_none())
}
