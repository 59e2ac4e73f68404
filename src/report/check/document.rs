//! The public document `proofmass.check/1`.

use serde_json::{Value, json};

use super::sentences;
use super::values::{difference, estimated, spread};
use super::words::{name, unit};
use proofmass_diagnosis::check::{Checked, Compared};
use proofmass_diagnosis::repeatability::agreement::{Agreement, Odd};
use proofmass_diagnosis::repeatability::information::Known;
use proofmass_diagnosis::repeatability::parameter::Estimate;
use proofmass_diagnosis::repeatability::run::{Run, Split};

/// The public document `proofmass.check/1`.
pub fn document(files: &[String], checked: &Checked) -> Value {
    let runs: Vec<Value> = files.iter().zip(&checked.runs).map(|(file, run)| of_run(file, run)).collect();
    let parameters = checked.runs.first().map(|r| &r.estimate);
    json!({
        "schema": "proofmass.check/1",
        "answer": sentences::answer(files, checked),
        "recordings": runs,
        "compared": checked.agreement.as_ref().map(|(compared, _)| match compared {
            Compared::Halves(_) => "halves",
            Compared::Runs => "recordings",
        }),
        "agreement": checked.agreement.as_ref().zip(parameters).map(|((_, a), e)| of_agreement(files, a, e)),
        "next": sentences::next(files, checked),
    })
}

fn of_run(file: &str, run: &Run) -> Value {
    json!({
        "file": file,
        "poses": run.motion.as_ref().and_then(|m| m.poses),
        "turned_deg": run.motion.as_ref().and_then(|m| m.turned_rad).map(|t| t.map(f64::to_degrees)),
        "parameters": of_estimate(&run.estimate),
        "halves": run.halves.as_ref().map(|halves| json!({
            "split": match halves.split {
                Split::FirstAndSecond => json!("first-and-second"),
                Split::Alternating { parts } => json!({ "alternating_parts": parts }),
                Split::Blocks { poses } => json!({ "blocks_of_poses": poses }),
            },
            "each": halves.each.each_ref().map(of_estimate),
        })),
        "undetermined": run.information.undetermined.iter().map(|direction| {
            let parts: Vec<Value> = direction.parts.iter().filter_map(|(p, weight)| {
                Some(json!({ "name": name(run.estimate.parameters.get(*p)?), "weight": weight }))
            }).collect();
            json!({ "parts": parts, "error_over_tolerance": finite(direction.over_tolerance) })
        }).collect::<Vec<_>>(),
        "statements": sentences::of_run(run),
    })
}

fn of_estimate(estimate: &Estimate) -> Value {
    let of = |p: usize| {
        let told = estimate.determines(p).then(|| estimated(estimate, p));
        json!({
            "name": name(&estimate.parameters[p]),
            "unit": unit(&estimate.parameters[p]).0,
            "determined": match estimate.known[p] {
                Known::Determined => "well",
                Known::Weakly => "weakly",
                Known::Not => "not",
            },
            "value": told.map(|t| t.value),
            "ci95": told.map(|t| t.ci95),
        })
    };
    (0..estimate.parameters.len()).map(of).collect()
}

fn of_agreement(files: &[String], agreement: &Agreement, estimate: &Estimate) -> Value {
    let lines: Vec<Value> = agreement
        .lines
        .iter()
        .map(|line| {
            let parameter = &estimate.parameters[line.parameter];
            // Of sizes that are held as logarithms a ratio is compared.
            let is_ratio = parameter.is_logarithmic();
            let difference = difference(parameter, line);
            json!({
                "name": name(parameter),
                "unit": unit(parameter).0,
                "difference": (!is_ratio).then_some(difference.value),
                "ratio": is_ratio.then_some(difference.value),
                "ci95": difference.ci95,
                "p_value": line.p_value,
                "agrees": line.agrees(),
                "spread": line.spread.map(|of| {
                    let [mean, mean_error, between, low, high] = spread(parameter, &of);
                    json!({
                        "mean": mean,
                        "mean_error": mean_error,
                        "between": between,
                        "between_ci95": [finite(low), finite(high)],
                    })
                }),
            })
        })
        .collect();
    json!({
        "parameters": lines,
        "joint": agreement.joint.map(|j| json!({
            "chi_squared": j.chi_squared,
            "degrees_of_freedom": j.freedom,
            "p_value": j.p_value,
            "agrees": j.agrees(),
        })),
        "odd": match agreement.odd {
            Some(Odd::Run(run)) => files.get(run).map(|f| json!(f)),
            Some(Odd::Undecided) | None => None,
        },
    })
}

/// A number that JSON has.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
