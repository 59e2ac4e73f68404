//! The public document `proofmass.check/1`.

use serde::Serialize;

use super::sentences;
use super::values::{difference, estimated, spread};
use super::words::{name, unit};
use proofmass_diagnosis::check::{Checked, Compared};
use proofmass_diagnosis::repeatability::agreement::{self, Odd};
use proofmass_diagnosis::repeatability::besides::{self, What};
use proofmass_diagnosis::repeatability::information::Known;
use proofmass_diagnosis::repeatability::parameter::Estimate;
use proofmass_diagnosis::repeatability::run;

/// Value of `schema` in the document.
const SCHEMA: &str = "proofmass.check/1";

/// The public document `proofmass.check/1`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    /// The result in a sentence or two.
    answer: String,
    recordings: Vec<Run>,
    /// "halves" of one recording or "recordings"; null where one is too short to be divided.
    compared: Option<&'static str>,
    agreement: Option<Agreement>,
    /// Suggestions for the next recording.
    next: Vec<String>,
}

/// One recording: the parameters that it can know, and their values.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Run {
    file: String,
    poses: Option<usize>,
    /// Turned through, about x, y and z.
    turned_deg: Option<[f64; 3]>,
    parameters: Vec<Parameter>,
    halves: Option<Halves>,
    /// Directions among the parameters that the recording does not determine.
    undetermined: Vec<Direction>,
    /// Channels that hold something besides noise that has a coefficient: `noise` parameters of theirs are not of
    /// noise alone. Of poses, sensors whose linear model leaves more than noise.
    besides: Vec<Besides>,
    statements: Vec<String>,
}

/// A channel that holds something besides noise, or a sensor that is not linear.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Besides {
    channel: String,
    /// Effects by id; empty where nothing that is known here describes it.
    effects: Vec<String>,
    /// Jumps of its bias, s from the first sample.
    jumps_s: Vec<f64>,
    /// Of a sensor in poses: what its linear model leaves over its noise, root mean square.
    left_over_noise: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parameter {
    name: String,
    unit: String,
    /// "well", "weakly" or "not".
    determined: &'static str,
    /// Null where it is not determined.
    value: Option<f64>,
    ci95: Option<[f64; 2]>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Halves {
    split: Split,
    each: [Vec<Parameter>; 2],
}

/// Division of a recording.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Split {
    /// The first half and the second.
    #[serde(rename = "first-and-second")]
    FirstAndSecond,
    /// This many parts, dealt to the two halves in turn.
    #[serde(rename = "alternating_parts")]
    Alternating(usize),
    /// Blocks with this many poses each, dealt to the two halves in turn.
    #[serde(rename = "blocks_of_poses")]
    Blocks(usize),
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Direction {
    parts: Vec<Part>,
    /// Null where it is not determined at all.
    error_over_tolerance: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Part {
    name: String,
    weight: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Agreement {
    parameters: Vec<Line>,
    /// All of them together.
    joint: Option<Joint>,
    /// The recording without which the others agree.
    odd: Option<String>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Line {
    name: String,
    unit: String,
    difference: Option<f64>,
    /// Of sizes that are held as logarithms, in place of the difference.
    ratio: Option<f64>,
    ci95: [f64; 2],
    p_value: f64,
    agrees: bool,
    spread: Option<Spread>,
}

/// From run to run.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Spread {
    mean: f64,
    mean_error: f64,
    between: f64,
    between_ci95: [Option<f64>; 2],
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Joint {
    chi_squared: f64,
    degrees_of_freedom: f64,
    p_value: f64,
    /// Of one as unlikely as the least likely parameter among as many.
    least_p_value: f64,
    agrees: bool,
}

/// The public document `proofmass.check/1`.
pub fn document(files: &[String], checked: &Checked) -> Document {
    let parameters = checked.runs.first().map(|r| &r.estimate);
    Document {
        schema: SCHEMA,
        answer: sentences::answer(files, checked),
        recordings: files.iter().zip(&checked.runs).map(|(file, run)| of_run(file, run)).collect(),
        compared: checked.agreement.as_ref().map(|(compared, _)| match compared {
            Compared::Halves(_) => "halves",
            Compared::Runs => "recordings",
        }),
        agreement: checked.agreement.as_ref().zip(parameters).map(|((_, a), e)| of_agreement(files, a, e)),
        next: sentences::next(files, checked),
    }
}

fn of_run(file: &str, run: &run::Run) -> Run {
    let part =
        |(p, weight): &(usize, f64)| Some(Part { name: name(run.estimate.parameters.get(*p)?), weight: *weight });
    Run {
        file: file.to_owned(),
        poses: run.motion.as_ref().and_then(|m| m.poses),
        turned_deg: run.motion.as_ref().and_then(|m| m.turned_rad).map(|t| t.map(f64::to_degrees)),
        parameters: of_estimate(&run.estimate),
        halves: run.halves.as_ref().map(|halves| Halves {
            split: match halves.split {
                run::Split::FirstAndSecond => Split::FirstAndSecond,
                run::Split::Alternating { parts } => Split::Alternating(parts),
                run::Split::Blocks { poses } => Split::Blocks(poses),
            },
            each: halves.each.each_ref().map(of_estimate),
        }),
        undetermined: run
            .information
            .undetermined
            .iter()
            .map(|direction| Direction {
                parts: direction.parts.iter().filter_map(part).collect(),
                error_over_tolerance: finite(direction.over_tolerance),
            })
            .collect(),
        besides: run.besides.iter().map(of_besides).collect(),
        statements: sentences::of_run(run),
    }
}

fn of_besides(besides: &besides::Besides) -> Besides {
    let mut said =
        Besides { channel: besides.channel.clone(), effects: Vec::new(), jumps_s: Vec::new(), left_over_noise: None };
    match &besides.what {
        What::Named(ids) => said.effects.clone_from(ids),
        What::Jumps(at_s) => said.jumps_s.clone_from(at_s),
        What::Beyond(times) => said.left_over_noise = Some(*times),
        What::Unnamed => {}
    }
    said
}

fn of_estimate(estimate: &Estimate) -> Vec<Parameter> {
    let of = |p: usize| {
        let told = estimate.determines(p).then(|| estimated(estimate, p));
        Parameter {
            name: name(&estimate.parameters[p]),
            unit: unit(&estimate.parameters[p]).0.into(),
            determined: match estimate.known[p] {
                Known::Determined => "well",
                Known::Weakly => "weakly",
                Known::Not => "not",
            },
            value: told.map(|t| t.value),
            ci95: told.map(|t| t.ci95),
        }
    };
    (0..estimate.parameters.len()).map(of).collect()
}

fn of_agreement(files: &[String], agreement: &agreement::Agreement, estimate: &Estimate) -> Agreement {
    let line = |line: &agreement::Line| {
        let parameter = &estimate.parameters[line.parameter];
        let is_ratio = parameter.is_logarithmic();
        let difference = difference(parameter, line);
        Line {
            name: name(parameter),
            unit: unit(parameter).0.into(),
            difference: (!is_ratio).then_some(difference.value),
            ratio: is_ratio.then_some(difference.value),
            ci95: difference.ci95,
            p_value: line.p_value,
            agrees: line.agrees(),
            spread: line.spread.map(|of| {
                let [mean, mean_error, between, low, high] = spread(parameter, &of);
                Spread { mean, mean_error, between, between_ci95: [finite(low), finite(high)] }
            }),
        }
    };
    Agreement {
        parameters: agreement.lines.iter().map(line).collect(),
        joint: agreement.joint.map(|j| Joint {
            chi_squared: j.chi_squared,
            degrees_of_freedom: j.freedom,
            p_value: j.p_value,
            least_p_value: j.least_p_value,
            agrees: j.agrees(),
        }),
        odd: match agreement.odd {
            Some(Odd::Run(run)) => files.get(run).cloned(),
            Some(Odd::Undecided) | None => None,
        },
    }
}

/// A number that JSON has.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
