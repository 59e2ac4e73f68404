//! The answer of `require` as the public document `proofmass.require/1`.

use serde::Serialize;

use super::parts::Judged;
use super::require::{Answer, Outcome, Value};
use super::statistic::Limit;
use crate::statistics::Estimate;
use crate::study::Study;

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.require/1";

/// The public document `proofmass.require/1`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    name: String,
    version: &'static str,
    seed: u64,
    limit: String,
    /// Says whether a value, or a part, meets the requirement.
    meets: bool,
    vary: Vec<Varied>,
    /// Which side of the value meets the requirement: "below", "above" or "all"; absent where none
    /// does.
    #[serde(skip_serializing_if = "Option::is_none")]
    side: Option<&'static str>,
    /// The statistic at the value, or at the best one tried.
    #[serde(skip_serializing_if = "Option::is_none")]
    statistic: Option<Estimate>,
    /// Says whether the interval is as narrow as was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    settled: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parts: Option<Vec<Part>>,
    /// Members integrated, each as often as it was.
    members: u64,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Varied {
    key: String,
    value: Option<f64>,
    ci95: Option<[Option<f64>; 2]>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Part {
    name: String,
    price: Option<f64>,
    meets: bool,
    /// Says whether the interval of the statistic lies on one side of the limit.
    sure: bool,
    #[serde(flatten)]
    statistic: Estimate,
    /// Errors of the study that the part does not state, and that are not simulated with it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unstated: Vec<&'static str>,
}

/// Results for keys, for parts, or for both.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Found {
    /// Result of `--vary`; `None` where only parts were ranked.
    pub answer: Option<Answer>,
    /// Parts in order of rank, and the members simulated for them.
    pub parts: Option<(Vec<Judged>, u64)>,
}

impl Document {
    /// The document of what was found.
    pub fn of(study: &Study, limit: &Limit, found: &Found) -> Self {
        let answer = found.answer.as_ref();
        let parts = found.parts.as_ref();
        let part = |p: &Judged| Part {
            name: p.name.clone(),
            price: p.price,
            meets: p.meets,
            sure: p.sure,
            statistic: p.statistic,
            unstated: p.unstated.clone(),
        };
        let side = answer.and_then(|a| match a.outcome {
            Outcome::Crosses { below: true } => Some("below"),
            Outcome::Crosses { below: false } => Some("above"),
            Outcome::Always => Some("all"),
            Outcome::Never => None,
        });
        Self {
            schema: SCHEMA,
            name: study.name.clone(),
            version: env!("CARGO_PKG_VERSION"),
            seed: study.seed,
            limit: limit.to_string(),
            meets: side.is_some() || parts.is_some_and(|(parts, _)| parts.iter().any(|p| p.meets)),
            vary: answer.map_or(Vec::new(), |a| a.vary.iter().map(Varied::of).collect()),
            side,
            statistic: answer.map(|a| a.statistic),
            settled: answer.map(|a| a.settled),
            parts: parts.map(|(parts, _)| parts.iter().map(part).collect()),
            members: answer.map_or(0, |a| a.members) + parts.map_or(0, |(_, members)| *members),
        }
    }
}

impl Varied {
    fn of(value: &Value) -> Self {
        let ci95 = Some(value.ci95).filter(|ci95| ci95.iter().any(Option::is_some));
        Self { key: value.key.clone(), value: value.value, ci95 }
    }
}
