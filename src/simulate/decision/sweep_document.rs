//! A sweep as the public document `proofmass.sweep/1`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::sweep::{Point, Sweep};
use super::watched::Watched;
use crate::statistics::Estimate;
use crate::statistics::Summary;
use crate::study::Study;

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.sweep/1";

/// The public document `proofmass.sweep/1`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    name: String,
    version: &'static str,
    seed: u64,
    /// Members at every point.
    members: u64,
    /// The keys and their values.
    sweep: Vec<Axis>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<String>,
    /// Meaning of each point's `statistic`.
    statistic: String,
    /// Report times, along which the lists of the points run.
    time_s: Vec<f64>,
    /// The values of the first key run fastest.
    points: Vec<Here>,
    /// Crossings of the limit along the first key, for each value of the second.
    crossings: Vec<Crossing>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Axis {
    key: String,
    values: Vec<f64>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Here {
    values: Vec<f64>,
    failed: u64,
    statistic: Estimate,
    #[serde(flatten)]
    errors: BTreeMap<&'static str, Errors>,
}

/// One error, or those of an object such as `position_error_ned_m` by their names.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum Errors {
    One(Distribution),
    Each(BTreeMap<&'static str, Distribution>),
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Distribution {
    mean: Vec<f64>,
    sd: Vec<f64>,
    p01: Vec<f64>,
    p05: Vec<f64>,
    p50: Vec<f64>,
    p95: Vec<f64>,
    p99: Vec<f64>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Crossing {
    /// Value of the second key.
    #[serde(skip_serializing_if = "Option::is_none")]
    other: Option<f64>,
    value: f64,
    ci95: [Option<f64>; 2],
    /// Which side of the value meets the limit.
    side: &'static str,
}

impl Document {
    /// The document of an answer.
    pub fn of(study: &Study, sweep: &Sweep) -> Self {
        let followed = &sweep.followed;
        Self {
            schema: SCHEMA,
            name: study.name.clone(),
            version: env!("CARGO_PKG_VERSION"),
            seed: study.seed,
            members: sweep.members,
            sweep: sweep.plan.axes.iter().map(|a| Axis { key: a.key.clone(), values: a.values() }).collect(),
            limit: sweep.plan.limit.as_ref().map(ToString::to_string),
            statistic: format!("{}({}, {})", followed.statistic.name(), followed.quantity, followed.time_s),
            time_s: sweep.time_s.clone(),
            points: sweep.points.iter().map(|point| Here::of(point, &sweep.quantities)).collect(),
            crossings: sweep
                .crossings
                .iter()
                .map(|c| Crossing {
                    other: c.other,
                    value: c.crossed.value,
                    ci95: c.crossed.ci95,
                    side: if c.crossed.below { "below" } else { "above" },
                })
                .collect(),
        }
    }
}

impl Here {
    fn of(point: &Point, quantities: &[Watched]) -> Self {
        let distribution = |q: usize| {
            let series =
                |pick: &dyn Fn(&Summary) -> f64| point.at.iter().filter_map(|at| at.get(q).map(pick)).collect();
            let percentile = |p: usize| series(&|s| s.percentiles[p]);
            Distribution {
                mean: series(&|s| s.mean),
                sd: series(&|s| s.sd),
                p01: percentile(0),
                p05: percentile(1),
                p50: percentile(2),
                p95: percentile(3),
                p99: percentile(4),
            }
        };
        let mut errors = BTreeMap::new();
        for (q, quantity) in quantities.iter().enumerate() {
            match quantity.name().split_once('.') {
                None => drop(errors.insert(quantity.name(), Errors::One(distribution(q)))),
                Some((object, name)) => {
                    let entry = errors.entry(object).or_insert_with(|| Errors::Each(BTreeMap::new()));
                    if let Errors::Each(each) = entry {
                        each.insert(name, distribution(q));
                    }
                }
            }
        }
        Self { values: point.values.clone(), failed: point.failed, statistic: point.statistic, errors }
    }
}
