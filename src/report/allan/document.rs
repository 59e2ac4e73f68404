//! `proofmass.allan/1`: the result as JSON. Values are in the datasheet units that stand next to
//! them; a term that the data do not support has none (null), only the upper end of its interval.

use serde::Serialize;

use super::words;
use proofmass_numerics::numerics::allan::law::{TERMS, Term};
use proofmass_recording::dropped::Dropped;
use proofmass_recording::finding::{Finding, Stray, sentences};
use proofmass_recording::noise::{self, Noise};
use proofmass_recording::unit::Quantity;

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.allan/1";

/// The public document `proofmass.allan/1`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    recording: Recording,
    /// The result in a sentence or two.
    answer: String,
    /// Found in the file and survived.
    findings: Vec<String>,
    /// The channels: gyro x y z, then accelerometer x y z.
    channels: Vec<Channel>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Recording {
    file: String,
    sha256: String,
    /// Data rows in the file.
    rows: usize,
    samples: usize,
    rate_hz: f64,
    /// Rows that were not used, and why.
    dropped: Vec<Dropped>,
    left_out: Vec<LeftOut>,
}

/// Stray readings or knocks of a column, whose rows are used for the other columns.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct LeftOut {
    column: String,
    /// "stray" or "knock".
    kind: &'static str,
    readings: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    knocks: Option<usize>,
    first: Vec<Place>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Place {
    row: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    deviations: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Channel {
    name: String,
    /// "gyro", "accelerometer" or "unknown".
    quantity: &'static str,
    /// Unit of `mean`, of `step` and of the curve.
    unit: String,
    mean: f64,
    /// Coefficients in the order Q, N, B, K, R; null where there is no fit.
    terms: [Option<Coefficient>; 5],
    noise_density: Option<Density>,
    deviation_at_1_s: Option<Estimate>,
    bias_stability_by_minimum: Option<Estimate>,
    fit: Option<Fit>,
    statements: Vec<String>,
    /// Density near half the rate over that between a tenth and a fifth of it, where it is no accident.
    roll_off: Option<f64>,
    /// Lines of the spectrum, strongest first.
    lines: Vec<Line>,
    /// Step its readings are rounded to.
    step: Option<f64>,
    /// The Allan deviation, shortest averaging time first.
    curve: Vec<Point>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Coefficient {
    symbol: &'static str,
    name: &'static str,
    /// Null where the data do not support it.
    value: Option<f64>,
    unit: String,
    ci95: [f64; 2],
    p_value: f64,
    supported: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Density {
    /// Null where the data do not support white noise.
    value: Option<f64>,
    unit: String,
    ci95: [f64; 2],
    /// Always "one": per positive frequency.
    sided: &'static str,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Estimate {
    value: f64,
    ci95: [f64; 2],
    unit: String,
}

/// States whether the fitted terms describe the curve.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Fit {
    good: bool,
    p_value: f64,
    from_s: f64,
    to_s: f64,
    discrepancy: f64,
    worst: Worst,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Worst {
    tau_s: f64,
    recorded_over_fitted: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Line {
    frequency_hz: f64,
    /// Its power over that of the spectrum about it.
    excess: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Point {
    tau_s: f64,
    deviation: f64,
    ci95: [f64; 2],
    degrees_of_freedom: f64,
}

/// The public document `proofmass.allan/1`.
pub fn document(file: &str, noise: &Noise) -> Document {
    let source = &noise.source;
    Document {
        schema: SCHEMA,
        recording: Recording {
            file: file.to_owned(),
            sha256: source.sha256.clone(),
            rows: source.rows,
            samples: source.samples,
            rate_hz: source.rate_hz,
            dropped: source.dropped.clone(),
            left_out: source.findings.iter().filter_map(left_out).collect(),
        },
        answer: words::answer(noise),
        findings: sentences(&source.findings),
        channels: noise.channels.iter().map(of_channel).collect(),
    }
}

fn left_out(finding: &Finding) -> Option<LeftOut> {
    match finding {
        Finding::StraysLeftOut { column, readings, named, .. } => {
            let place = |s: &Stray| Place { row: s.row, value: Some(s.value), deviations: Some(s.deviations) };
            let first = named.iter().map(place).collect();
            Some(LeftOut { column: column.clone(), kind: "stray", readings: *readings, knocks: None, first })
        }
        Finding::KnocksLeftOut { column, knocks, readings, first_row } => {
            let first = vec![Place { row: *first_row, value: None, deviations: None }];
            Some(LeftOut { column: column.clone(), kind: "knock", readings: *readings, knocks: Some(*knocks), first })
        }
        _ => None,
    }
}

fn of_channel(channel: &noise::Channel) -> Channel {
    let (unit, factor) = channel.unit.signal();
    let estimate = |term: Term, value: f64, ci95: [f64; 2]| {
        let (unit, factor) = channel.unit.coefficient(term);
        Estimate { value: value * factor, ci95: ci95.map(|e| e * factor), unit: unit.into() }
    };
    Channel {
        name: channel.name.clone(),
        quantity: match channel.unit.quantity {
            Quantity::Accelerometer => "accelerometer",
            Quantity::Gyro => "gyro",
            Quantity::Unknown => "unknown",
        },
        unit: unit.into(),
        mean: channel.mean * factor,
        terms: TERMS.map(|term| of_term(channel, term)),
        noise_density: density(channel),
        deviation_at_1_s: channel.at_one_second().map(|d| estimate(Term::White, d.value, d.ci95)),
        bias_stability_by_minimum: channel.bias_stability().map(|(value, ci95)| estimate(Term::Flicker, value, ci95)),
        fit: channel.fit.as_ref().map(|fit| Fit {
            good: fit.good(),
            p_value: fit.p_value,
            from_s: fit.from_s,
            to_s: fit.to_s,
            discrepancy: fit.discrepancy,
            worst: Worst { tau_s: fit.worst.0, recorded_over_fitted: fit.worst.1 },
        }),
        statements: std::iter::once(words::verdict(channel)).chain(words::sentences(channel)).collect(),
        roll_off: channel.roll_off,
        lines: channel.lines.iter().map(|l| Line { frequency_hz: l.frequency_hz, excess: l.excess }).collect(),
        step: channel.step.map(|s| s * factor),
        curve: channel
            .curve
            .iter()
            .map(|d| Point {
                tau_s: d.tau_s,
                deviation: d.value * factor,
                ci95: d.ci95.map(|e| e * factor),
                degrees_of_freedom: d.degrees_of_freedom,
            })
            .collect(),
    }
}

fn of_term(channel: &noise::Channel, term: Term) -> Option<Coefficient> {
    let (unit, factor) = channel.unit.coefficient(term);
    let c = channel.fit.as_ref()?.coefficients[term as usize];
    Some(Coefficient {
        symbol: term.symbol(),
        name: words::name(term),
        value: c.supported().then_some(c.value * factor),
        unit: unit.into(),
        ci95: c.ci95.map(|e| e * factor),
        p_value: c.p_value,
        supported: c.supported(),
    })
}

fn density(channel: &noise::Channel) -> Option<Density> {
    let (unit, factor) = channel.unit.density();
    let c = channel.fit.as_ref()?.coefficients[Term::White as usize];
    let to_density = factor * 2f64.sqrt();
    Some(Density {
        value: c.supported().then_some(c.value * to_density),
        unit: unit.into(),
        ci95: c.ci95.map(|e| e * to_density),
        sided: "one",
    })
}
