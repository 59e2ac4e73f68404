//! Recordings of an experiment with noise, one for each rival, diagnosed: how often the answer is right.

use crate::control::{Control, Stopped};
use crate::driven;
use crate::model;
use crate::parallel;
use crate::recording::{Column, Recording};
use crate::rng::{Philox, Stream};
use crate::verdict::Outcome;

use super::experiment::Experiment;
use super::question::Question;
use super::simulated::{Truth, readings};

/// Outcomes of diagnoses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Confirmed {
    /// Those that named the truth and nothing else.
    pub right: usize,
    /// Those that named something else.
    pub wrong: usize,
    /// All of them.
    pub of: usize,
}

/// Records the experiment so often under each truth, and diagnoses it.
///
/// # Errors
/// Stopped.
pub fn confirm(
    question: &Question,
    experiment: &Experiment,
    times: usize,
    control: &Control,
) -> Result<Confirmed, Stopped> {
    let truths: Vec<Truth<'_>> = question
        .rivals
        .iter()
        .map(Some)
        .chain([None])
        .map(|own| Truth { sensor: question.sensor_with(own), common: &question.common, own })
        .collect();
    let progress = control.stage("recordings diagnosed", (times * truths.len()) as u64);
    let quiet = control.without_stages();
    let answers = parallel::map_indices(times * truths.len(), |i| {
        let truth = &truths[i % truths.len()];
        let said = readings(truth, experiment).and_then(|y| named(question, experiment, y, i as u64, &quiet));
        progress.step();
        let mut expected: Vec<&str> = truth.common.iter().chain(truth.own).map(|k| k.term.id()).collect();
        expected.sort_unstable();
        said.map(|said| (said == expected, !said.is_empty() && said != expected))
    });
    control.go_on()?;
    let count = |of: fn(&(bool, bool)) -> bool| answers.iter().flatten().filter(|a| of(a)).count();
    Ok(Confirmed { right: count(|a| a.0), wrong: count(|a| a.1), of: answers.len() })
}

/// The ids that a diagnosis names and ties with nothing; none where it leaves the question open.
fn named(
    question: &Question,
    experiment: &Experiment,
    mut reading: Vec<f64>,
    seed: u64,
    control: &Control,
) -> Option<Vec<String>> {
    let mut rng = Philox::new(seed, 1, Stream::Host);
    reading.iter_mut().for_each(|y| *y += question.sensor.noise * rng.normal());
    let columns = [("input", experiment.input()), ("reading", reading)];
    let columns: Vec<Column> = columns.map(|(name, values)| Column { name: name.into(), values }).to_vec();
    let rows = experiment.samples();
    let recording = Recording { rows, rate_hz: experiment.rate_hz, columns, ..Recording::default() };
    let model = model::Driven {
        topic: None,
        rate_hz: Some(experiment.rate_hz),
        force_rate: false,
        rows: model::Ranges::default(),
        unit: None,
        output_is: model::Output::Displacement,
        columns: model::DrivenColumns {
            time: None,
            input: Some("input".into()),
            output: "reading".into(),
            environment: Vec::new(),
        },
        start: model::Start::default(),
        split: model::Split::default(),
        without: Vec::new(),
    };
    let answer = driven::diagnose(&recording, &model, control).ok()?;
    let is_open = answer.outcome == Outcome::Undecidable || answer.outcome == Outcome::Unexplained;
    if is_open {
        return None;
    }
    let mut ids: Vec<String> = answer.effects.iter().map(|e| e.id.clone()).collect();
    ids.sort_unstable();
    Some(ids)
}
