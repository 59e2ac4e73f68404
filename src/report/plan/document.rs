//! The public document `proofmass.plan/1`.

use serde_json::{Value, json};

use super::sentences;
use super::words::{key, kind, rivals};
use proofmass_diagnosis::plan::confirm::Confirmed;
use proofmass_diagnosis::plan::experiment::Shape;
use proofmass_diagnosis::plan::question::Purpose;
use proofmass_diagnosis::plan::search::{Planned, Proposal};

/// The public document `proofmass.plan/1`; `files` are the names of the experiments' files, in order.
pub fn document(planned: &Planned, wish: f64, confirmed: &[Confirmed], files: &[&str]) -> Value {
    let with_more = |(i, p): (usize, &Proposal)| {
        let mut value = proposal(planned, p);
        value["file"] = json!(files.get(i));
        value["confirmed"] = json!(confirmed.get(i).map(|c| json!({ "right": c.right, "wrong": c.wrong, "of": c.of })));
        value
    };
    json!({
        "schema": "proofmass.plan/1",
        "answer": sentences::answer(planned, wish),
        "purpose": match planned.question.purpose {
            Purpose::Decide => "decide",
            Purpose::Show(_) => "show",
            Purpose::Narrow(_) => "narrow",
        },
        "rivals": planned.question.rivals.iter().map(|k| {
            let named = k.term.candidate().parameters.iter().zip(&k.values);
            json!({
                "id": k.term.id(),
                "parameters": named.map(|(p, v)| json!({ "name": p.name, "value": v })).collect::<Vec<_>>(),
            })
        }).collect::<Vec<_>>(),
        "wanted": wish,
        "reached": planned.reached,
        "experiments": planned.best.iter().enumerate().map(with_more).collect::<Vec<_>>(),
        "broadband": planned.broadband.as_ref().map(|p| proposal(planned, p)),
        "binding": planned.binding.map(|b| json!({
            "limit": key(b.limit),
            "times": b.factor,
            "doubled": b.doubled.map(|(limit, p)| json!({ "limit": key(limit), "probability": p })),
        })),
        "interval": match &planned.question.purpose {
            Purpose::Narrow(i) => json!({
                "parameter": i.parameter, "unit": i.unit, "half_width": i.half_width, "halves_as_before_s": 3.0 * i.seconds,
            }),
            Purpose::Decide | Purpose::Show(_) => Value::Null,
        },
    })
}

fn proposal(planned: &Planned, p: &Proposal) -> Value {
    let e = &p.experiment;
    let frequencies = match e.shape {
        Shape::Sine { hz } => json!([hz, hz]),
        Shape::Levels { from_hz, to_hz }
        | Shape::Frequencies { from_hz, to_hz }
        | Shape::Chirp { from_hz, to_hz }
        | Shape::Multisine { from_hz, to_hz } => {
            json!([from_hz, to_hz])
        }
        Shape::Steps { .. } => Value::Null,
    };
    let names = rivals(planned).into_iter().chain(["none"]);
    json!({
        "kind": kind(&e.shape),
        "seconds": e.seconds,
        "samples": e.samples(),
        "rate_hz": e.rate_hz,
        "level_m_s2": e.level,
        "frequency_hz": frequencies,
        "decides": p.probability,
        "between": names.zip(&p.each).map(|(id, p)| json!({ "id": id, "decides": p })).collect::<Vec<_>>(),
        "half_width": p.half_width,
    })
}
