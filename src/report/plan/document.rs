//! The public document `proofmass.plan/1`.

use serde::Serialize;

use super::sentences;
use super::words::{key, kind, rivals};
use proofmass_diagnosis::plan::confirm;
use proofmass_diagnosis::plan::experiment::Shape;
use proofmass_diagnosis::plan::question::{self, Purpose};
use proofmass_diagnosis::plan::search::{Planned, Proposal};

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.plan/1";

/// The public document `proofmass.plan/1`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    /// The result in a sentence or two.
    answer: String,
    /// "decide" between rivals, "show" a law or "narrow" an interval.
    purpose: &'static str,
    rivals: Vec<Rival>,
    /// Probability that was asked for.
    wanted: f64,
    /// Says whether the first experiment reaches it.
    reached: bool,
    /// The best, and the next best.
    experiments: Vec<Listed>,
    /// A broadband multisine within the same limits.
    broadband: Option<Experiment>,
    /// The limit that is in the way; null where none is.
    binding: Option<Binding>,
    interval: Option<Interval>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Rival {
    /// Id in the library of candidates.
    id: &'static str,
    parameters: Vec<Parameter>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parameter {
    name: &'static str,
    value: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Listed {
    #[serde(flatten)]
    experiment: Experiment,
    /// File with the input to play; null where none was written.
    file: Option<String>,
    confirmed: Option<Confirmed>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Experiment {
    kind: &'static str,
    seconds: f64,
    samples: usize,
    rate_hz: f64,
    /// Largest input.
    level_m_s2: f64,
    /// From, to; null of steps.
    frequency_hz: Option<[f64; 2]>,
    /// Probability of a right decision.
    decides: f64,
    /// The same under each truth, "none" last.
    between: Vec<Truth>,
    /// Half the interval of the law that is narrowed.
    half_width: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Truth {
    id: String,
    decides: f64,
}

/// Recordings of an experiment that were simulated with noise and diagnosed.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Confirmed {
    right: usize,
    wrong: usize,
    of: usize,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Binding {
    /// Key of limits.toml.
    limit: &'static str,
    /// Times that it would have to grow; null where that is not enough.
    times: Option<f64>,
    doubled: Vec<Doubled>,
}

/// The best probability with one limit doubled.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Doubled {
    limit: &'static str,
    probability: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Interval {
    parameter: String,
    unit: String,
    half_width: f64,
    /// Length of a recording like the first that halves it.
    halves_as_before_s: f64,
}

/// The public document `proofmass.plan/1`; `files` are the names of the experiments' files, in order.
pub fn document(planned: &Planned, wish: f64, confirmed: &[confirm::Confirmed], files: &[&str]) -> Document {
    let listed = |(i, p): (usize, &Proposal)| Listed {
        experiment: experiment(planned, p),
        file: files.get(i).map(|file| (*file).to_owned()),
        confirmed: confirmed.get(i).map(|c| Confirmed { right: c.right, wrong: c.wrong, of: c.of }),
    };
    Document {
        schema: SCHEMA,
        answer: sentences::answer(planned, wish),
        purpose: match planned.question.purpose {
            Purpose::Decide => "decide",
            Purpose::Show(_) => "show",
            Purpose::Narrow(_) => "narrow",
        },
        rivals: planned.question.rivals.iter().map(rival).collect(),
        wanted: wish,
        reached: planned.reached,
        experiments: planned.best.iter().enumerate().map(listed).collect(),
        broadband: planned.broadband.as_ref().map(|p| experiment(planned, p)),
        binding: planned.binding.map(|b| Binding {
            limit: key(b.limit),
            times: b.factor,
            doubled: b.doubled.map(|(limit, probability)| Doubled { limit: key(limit), probability }).into(),
        }),
        interval: match &planned.question.purpose {
            Purpose::Narrow(i) => Some(Interval {
                parameter: i.parameter.to_string(),
                unit: i.unit.to_string(),
                half_width: i.half_width,
                halves_as_before_s: 3.0 * i.seconds,
            }),
            Purpose::Decide | Purpose::Show(_) => None,
        },
    }
}

fn rival(known: &question::Known) -> Rival {
    let named = known.term.candidate().parameters.iter().zip(&known.values);
    Rival {
        id: known.term.id(),
        parameters: named.map(|(p, value)| Parameter { name: p.name, value: *value }).collect(),
    }
}

fn experiment(planned: &Planned, p: &Proposal) -> Experiment {
    let e = &p.experiment;
    let names = rivals(planned).into_iter().chain(["none"]);
    Experiment {
        kind: kind(&e.shape),
        seconds: e.seconds,
        samples: e.samples(),
        rate_hz: e.rate_hz,
        level_m_s2: e.level,
        frequency_hz: match e.shape {
            Shape::Sine { hz } => Some([hz, hz]),
            Shape::Levels { from_hz, to_hz }
            | Shape::Frequencies { from_hz, to_hz }
            | Shape::Chirp { from_hz, to_hz }
            | Shape::Multisine { from_hz, to_hz } => Some([from_hz, to_hz]),
            Shape::Steps { .. } => None,
        },
        decides: p.probability,
        between: names.zip(&p.each).map(|(id, p)| Truth { id: id.to_owned(), decides: *p }).collect(),
        half_width: p.half_width,
    }
}
