//! `proofmass.inspect/1`: a first look at a file as JSON.

use serde::Serialize;

use super::{check, next, obstacle};
use proofmass_recording::dropped::Dropped;
use proofmass_recording::finding::sentences;
use proofmass_recording::inspection::{Column, Inspection, Rows};
use proofmass_recording::unit::Quantity;

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.inspect/1";

/// The public document `proofmass.inspect/1`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    file: String,
    /// The format, in words.
    format: &'static str,
    /// Parts of the file: topics, variables, tables.
    topics: Vec<Topic>,
    /// The part that was read; null where it has to be chosen first.
    topic: Option<String>,
    /// Column or stamps that give the time; null where there are none.
    clock: Option<String>,
    /// The command that suits it; null where nothing does.
    next: Option<String>,
    /// The command that says whether it is good enough; null where it takes none as it is.
    check: Option<String>,
    /// The reason why nothing can be run yet.
    obstacle: Option<Obstacle>,
    /// Contents of its rows; these fields are absent where no part was read.
    #[serde(flatten)]
    rows: Option<Read>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Topic {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    rows: Option<u64>,
    /// True where its columns look like an IMU's.
    imu: bool,
    columns: Vec<Heading>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Heading {
    name: String,
    unit: Option<String>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Obstacle {
    cause: String,
    hint: String,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Read {
    sha256: String,
    /// Data rows in the file.
    rows: usize,
    samples: usize,
    /// Null where there is no clock.
    rate_hz: Option<f64>,
    duration_s: Option<f64>,
    /// Rows that were not used, and why.
    dropped: Vec<Dropped>,
    /// Found in the file and survived.
    findings: Vec<String>,
    columns: Vec<Values>,
    /// Stretches in which it lies still.
    still: Vec<Stretch>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Values {
    name: String,
    quantity: Role,
    /// Unit that the heading states.
    unit: Option<String>,
    min: f64,
    max: f64,
    mean: f64,
    sd: f64,
    /// Step that its values are rounded to.
    step: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
enum Role {
    Accelerometer,
    Gyro,
    Environment,
    Unknown,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Stretch {
    from_s: f64,
    to_s: f64,
}

/// Makes the document.
pub fn document(file: &str, seen: &Inspection) -> Document {
    let topics = seen.parts.iter().map(|part| Topic {
        name: part.name.clone(),
        kind: part.kind.clone(),
        rows: part.rows,
        imu: part.is_imu,
        columns: part.columns.iter().map(|c| Heading { name: c.name.clone(), unit: c.unit.clone() }).collect(),
    });
    Document {
        schema: SCHEMA,
        file: file.to_owned(),
        format: seen.format,
        topics: topics.collect(),
        topic: seen.part.clone(),
        clock: seen.clock.clone(),
        next: next(file, seen),
        check: check(file, seen),
        obstacle: obstacle(file, seen).map(|e| Obstacle { cause: e.cause.clone(), hint: e.hint.clone() }),
        rows: seen.rows.as_ref().map(read),
    }
}

fn read(rows: &Rows) -> Read {
    Read {
        sha256: rows.sha256.clone(),
        rows: rows.rows,
        samples: rows.samples,
        rate_hz: rows.rate_hz,
        duration_s: rows.rate_hz.map(|rate_hz| rows.samples as f64 / rate_hz),
        dropped: rows.dropped.clone(),
        findings: sentences(&rows.findings),
        columns: rows.columns.iter().map(values).collect(),
        still: rows.still.iter().map(|s| Stretch { from_s: s.from_s, to_s: s.to_s }).collect(),
    }
}

fn values(column: &Column) -> Values {
    let quantity = match column.quantity {
        Quantity::Accelerometer => Role::Accelerometer,
        Quantity::Gyro => Role::Gyro,
        Quantity::Unknown if column.is_environment => Role::Environment,
        Quantity::Unknown => Role::Unknown,
    };
    Values {
        name: column.name.clone(),
        quantity,
        unit: column.stated.clone(),
        min: column.lowest,
        max: column.highest,
        mean: column.mean,
        sd: column.deviation,
        step: column.step,
    }
}
