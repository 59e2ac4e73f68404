//! `proofmass.allan/1`: the result as JSON. Values are in the datasheet units that stand next to
//! them; a term that the data do not support has none (null), only the upper end of its interval.

use serde_json::{Value, json};

use super::words;
use proofmass_numerics::numerics::allan::law::{TERMS, Term};
use proofmass_recording::finding::{Finding, sentences};
use proofmass_recording::noise::{Channel, Noise};
use proofmass_recording::unit::Quantity;

/// The public document `proofmass.allan/1`.
pub fn document(file: &str, noise: &Noise) -> Value {
    json!({
        "schema": "proofmass.allan/1",
        "recording": {
            "file": file,
            "sha256": noise.source.sha256,
            "rows": noise.source.rows,
            "samples": noise.source.samples,
            "rate_hz": noise.source.rate_hz,
            "dropped": noise.source.dropped,
            "left_out": noise.source.findings.iter().filter_map(left_out).collect::<Vec<_>>(),
        },
        "answer": words::answer(noise),
        "findings": sentences(&noise.source.findings),
        "channels": noise.channels.iter().map(of_channel).collect::<Vec<_>>(),
    })
}

/// Stray readings and knocks of a column, whose rows are used for the other columns.
fn left_out(finding: &Finding) -> Option<Value> {
    match finding {
        Finding::StraysLeftOut { column, readings, named, .. } => {
            let named: Vec<Value> =
                named.iter().map(|s| json!({ "row": s.row, "value": s.value, "deviations": s.deviations })).collect();
            Some(json!({ "column": column, "kind": "stray", "readings": readings, "first": named }))
        }
        Finding::KnocksLeftOut { column, knocks, readings, first_row } => {
            let (kind, first) = ("knock", [json!({ "row": first_row })]);
            Some(json!({ "column": column, "kind": kind, "readings": readings, "knocks": knocks, "first": first }))
        }
        _ => None,
    }
}

fn of_channel(channel: &Channel) -> Value {
    let (unit, factor) = channel.unit.signal();
    let quantity = match channel.unit.quantity {
        Quantity::Accelerometer => "accelerometer",
        Quantity::Gyro => "gyro",
        Quantity::Unknown => "unknown",
    };
    let curve: Vec<Value> = channel
        .curve
        .iter()
        .map(|d| {
            json!({ "tau_s": d.tau_s, "deviation": d.value * factor, "ci95": d.ci95.map(|e| e * factor),
                    "degrees_of_freedom": d.degrees_of_freedom })
        })
        .collect();
    let stability = channel.bias_stability().map(|(value, ci95)| {
        let (unit, factor) = channel.unit.coefficient(Term::Flicker);
        json!({ "value": value * factor, "ci95": ci95.map(|e| e * factor), "unit": unit })
    });
    let fit = channel.fit.as_ref().map(|fit| {
        json!({ "good": fit.good(), "p_value": fit.p_value, "from_s": fit.from_s, "to_s": fit.to_s,
                "discrepancy": fit.discrepancy,
                "worst": { "tau_s": fit.worst.0, "recorded_over_fitted": fit.worst.1 } })
    });
    json!({
        "name": channel.name,
        "quantity": quantity,
        "unit": unit,
        "mean": channel.mean * factor,
        "terms": TERMS.map(|term| of_term(channel, term)),
        "noise_density": density(channel),
        "deviation_at_1_s": channel.at_one_second().map(|d| {
            let (unit, factor) = channel.unit.coefficient(Term::White);
            json!({ "value": d.value * factor, "ci95": d.ci95.map(|e| e * factor), "unit": unit })
        }),
        "bias_stability_by_minimum": stability,
        "fit": fit,
        "statements": std::iter::once(words::verdict(channel)).chain(words::sentences(channel)).collect::<Vec<_>>(),
        "roll_off": channel.roll_off,
        "lines": channel.lines.iter().map(|l| json!({ "frequency_hz": l.frequency_hz, "excess": l.excess })).collect::<Vec<_>>(),
        "step": channel.step.map(|s| s * factor),
        "curve": curve,
    })
}

fn of_term(channel: &Channel, term: Term) -> Value {
    let (unit, factor) = channel.unit.coefficient(term);
    let Some(fit) = &channel.fit else { return Value::Null };
    let c = fit.coefficients[term as usize];
    let value = c.supported().then_some(c.value * factor);
    json!({ "symbol": term.symbol(), "name": words::name(term), "value": value, "unit": unit,
            "ci95": c.ci95.map(|e| e * factor), "p_value": c.p_value, "supported": c.supported() })
}

fn density(channel: &Channel) -> Value {
    let (unit, factor) = channel.unit.density();
    let Some(fit) = &channel.fit else { return Value::Null };
    let c = fit.coefficients[Term::White as usize];
    let to_density = factor * 2f64.sqrt();
    let value = c.supported().then_some(c.value * to_density);
    json!({ "value": value, "unit": unit, "ci95": c.ci95.map(|e| e * to_density), "sided": "one" })
}
