//! The functions of the module: what the command does, with what Python holds in place of files.

use std::ffi::OsString;
use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use toml::Table;

use super::answer::Answer;
use super::arrays::{Given, Recorded};
use super::value::{self, Document};
use super::work::{detached, raised};
use proofmass_base::columns::Values;
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_cli as cli;
use proofmass_cli::allan::{Asked, Scales};
use proofmass_diagnosis::model::{self, Model};
use proofmass_diagnosis::plan::experiment::Experiment;
use proofmass_diagnosis::plan::limits::Limits;
use proofmass_diagnosis::plan::{Wish, asked};
use proofmass_diagnosis::recordings::Recordings;
use proofmass_diagnosis::{self as diagnosis, repaired};
use proofmass_recording::{self as recording, Recording, Request};
use proofmass_report as report;
use proofmass_simulate::decision::further::Further;
use proofmass_simulate::drift;
use proofmass_simulate::drift::document;
use proofmass_simulate::ensemble::{self, Backends, Choice, Keeper, Options};
use proofmass_simulate::strapdown;
use proofmass_study::{self as studies, Overrides, Preset, Study};

/// The command, from its words to its exit code. A defect that panics ends it as it ends the
/// binary, with 101.
#[pyfunction]
pub(super) fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| std::panic::catch_unwind(|| cli::main(words)).unwrap_or(101))
}

/// Holds what changes a study.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Changes<'py> {
    members: Option<u64>,
    seed: Option<u64>,
    preset: Option<String>,
    set: Option<Bound<'py, PyDict>>,
}

impl Changes<'_> {
    fn overrides(&self) -> Result<Overrides> {
        let fail = |cause: String, hint: String| Error::new("could not change the study", cause, hint);
        let preset = self.preset.as_deref().map(|name| {
            let known = Preset::ALL.map(Preset::name);
            Preset::ALL
                .into_iter()
                .find(|p| p.name() == name)
                .ok_or_else(|| fail(format!("`{name}` is not a grade"), format!("there are {}", known.join(", "))))
        });
        let mut set = Vec::new();
        for (key, value) in self.set.iter().flatten() {
            let key = key.to_string();
            let text = format!("{key}={}", value::one(&value, &key)?);
            set.push(text.parse().map_err(|cause| fail(cause, "keys are dotted paths: gyro.bias_deg_h".into()))?);
        }
        Ok(Overrides { members: self.members, seed: self.seed, preset: preset.transpose()?, set })
    }
}

/// A study as it was given, free of Python.
enum Source {
    Default,
    Path(PathBuf),
    Table(Table),
}

/// Returns what is to be read, with its changes.
fn source(given: Option<Document<'_>>, changes: &Changes<'_>) -> Result<(Source, Overrides)> {
    let source = match given {
        None => Source::Default,
        Some(Document::Path(path)) => Source::Path(path),
        Some(Document::Table(dictionary)) => Source::Table(value::table(&dictionary, "")?),
    };
    Ok((source, changes.overrides()?))
}

fn read_study((source, overrides): (Source, Overrides), control: &Control) -> Result<Study> {
    let study = match source {
        Source::Default => studies::read_default(&overrides, control),
        Source::Path(path) => studies::read(&path, &overrides, control),
        Source::Table(table) => studies::of_table("the study", table, &overrides, control),
    }?;
    match study.sweep {
        None => Ok(study),
        Some(_) => Err(Error::new(
            format!("could not run {} as one study", study.name),
            "it has a [sweep], which is many studies",
            "leave [sweep] out and give each value with `set`, or run `proofmass study`",
        )),
    }
}

fn choice(backend: &str) -> Result<Choice> {
    let all = [("auto", Choice::Auto), ("gpu", Choice::Gpu), ("cpu", Choice::Cpu)];
    let found = all.iter().find(|(name, _)| *name == backend).map(|(_, choice)| *choice);
    let cause = format!("`{backend}` is not a backend");
    found.ok_or_else(|| Error::new("could not choose a backend", cause, "choose auto, gpu or cpu"))
}

/// `proofmass.study`: a study from a file or a dictionary.
#[pyfunction]
pub(super) fn study(
    py: Python<'_>,
    given: Option<Document<'_>>,
    changes: Changes<'_>,
    backend: &str,
) -> PyResult<Answer> {
    let prepared = source(given, &changes).and_then(|source| Ok((source, choice(backend)?)));
    let (source, backend) = prepared.map_err(|error| raised(py, error))?;
    detached(py, move |control| {
        let study = read_study(source, control)?;
        if let Some(motion) = &study.in_motion {
            let answer = strapdown::answer::answer(&study, motion, backend, control)?;
            let findings = report::strapdown::findings(&answer);
            let json = to_json(&strapdown::document::Document::of(&study, &answer, findings))?;
            let draw = move || report::strapdown::page(&study, &answer, None, Further::NONE).finish();
            return Ok(Answer { json, toml: None, draw: Box::new(draw) });
        }
        let options = Options { backend, control: control.clone(), ..Options::default() };
        let mut backends = Backends::default();
        let run = |job: &_, _: &str| backends.run(job, &options, &mut Keeper::none());
        let drift = drift::answer(&study, control, run)?;
        let json = to_json(&document::Document::of(&study, &drift))?;
        Ok(Answer {
            json,
            toml: None,
            draw: Box::new(move || report::study::page(&study, &drift, Further::NONE).finish()),
        })
    })
}

/// `proofmass.allan`: noise coefficients of a recording at rest.
#[pyfunction]
pub(super) fn allan(py: Python<'_>, given: Given<'_>, request: Read, scales: Units) -> PyResult<Answer> {
    let Recorded { path, memory } = given.recorded().map_err(|error| raised(py, error))?;
    detached(py, move |control| {
        let request = Request { memory, control: control.clone(), ..request.into() };
        let noise = Asked::new(request, &scales.into())?.analyse(&path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let json = to_json(&report::allan::document(&name, &noise))?;
        let draw = move || report::allan::page(&name, &noise, &report::allan::fragments(&name, &noise)).finish();
        Ok(Answer { json, toml: None, draw: Box::new(draw) })
    })
}

/// Which part of a recording is read, and by which clock.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Read {
    topic: Option<String>,
    columns: Vec<String>,
    rate_hz: Option<f64>,
    force_rate: bool,
    time: Option<String>,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

impl From<Read> for Request {
    fn from(read: Read) -> Self {
        let Read { topic, columns, rate_hz, force_rate, time, from_s, to_s } = read;
        Self { topic, columns, rate_hz, force_rate, time, from_s, to_s, ..Self::default() }
    }
}

/// Columns of the sensors and their units.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Units {
    accelerometer: Vec<String>,
    accelerometer_scale: Option<String>,
    gyro: Vec<String>,
    gyro_scale: Option<String>,
}

impl From<Units> for Scales {
    fn from(units: Units) -> Self {
        let Units { accelerometer, accelerometer_scale, gyro, gyro_scale } = units;
        Self { accelerometer, accelerometer_scale, gyro, gyro_scale }
    }
}

/// `proofmass.diagnose`: a recording and its model.
#[pyfunction]
pub(super) fn diagnose(
    py: Python<'_>,
    train: Vec<Given<'_>>,
    test: Vec<Given<'_>>,
    model: Document<'_>,
    part: Part,
) -> PyResult<Answer> {
    let recorded = |all: Vec<Given<'_>>| all.into_iter().map(Given::recorded).collect::<Result<Vec<Recorded>>>();
    let prepared = || Ok((recorded(train)?, recorded(test)?, read_model(model, part.topic.as_deref())?));
    let (train, test, model) = prepared().map_err(|error| raised(py, error))?;
    let seconds = model::Seconds { from_s: part.from_s, to_s: part.to_s };
    detached(py, move |control| {
        let read = |all: Vec<Recorded>| {
            all.into_iter().map(|one| read(one, &model, seconds, control)).collect::<Result<Vec<_>>>()
        };
        judge(&read(train)?, &read(test)?, &model, part.trace, control)
    })
}

/// `proofmass.check`: one recording by its halves, or several of one sensor.
#[pyfunction]
pub(super) fn check(py: Python<'_>, given: Vec<Given<'_>>, model: Document<'_>, part: Part) -> PyResult<Answer> {
    let prepared = || {
        let all = given.into_iter().map(Given::recorded).collect::<Result<Vec<Recorded>>>()?;
        Ok((all, read_model(model, part.topic.as_deref())?))
    };
    let (all, model) = prepared().map_err(|error: Error| raised(py, error))?;
    let seconds = model::Seconds { from_s: part.from_s, to_s: part.to_s };
    detached(py, move |control| {
        let read = |one| read(one, &model, seconds, control);
        let recordings: Vec<Recording> = all.into_iter().map(read).collect::<Result<_>>()?;
        let checked = diagnosis::check::check(&recordings, &model, control)?;
        let files: Vec<String> = recordings.iter().map(|r| r.path.display().to_string()).collect();
        let json = to_json(&report::check::document(&files, &checked))?;
        let toml = recordings.first().and_then(|first| checked.sensor_toml(first.rate_hz));
        Ok(Answer { json, toml, draw: Box::new(move || report::check::page(&files, &recordings, &checked).finish()) })
    })
}

/// A question that an experiment shall answer, and what it shall reach.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Wanted<'py> {
    /// A verdict as JSON, where it is not a file.
    verdict: Option<String>,
    /// A model, or the path of a verdict or a model.
    given: Option<Document<'py>>,
    show: Option<String>,
    probability: f64,
    confirm: usize,
}

/// Inputs to play, an array of time and one of input for each.
type Inputs<'py> = Vec<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)>;

/// `proofmass.plan`: the next experiment.
#[pyfunction]
pub(super) fn plan<'py>(py: Python<'py>, wanted: Wanted<'_>, limits: Document<'_>) -> PyResult<(Answer, Inputs<'py>)> {
    let Wanted { verdict, given, show, probability, confirm } = wanted;
    let prepared = || {
        let limits = match limits {
            Document::Path(path) => Limits::read(&path)?,
            Document::Table(table) => Limits::of_table("the limits", value::table(&table, "")?)?,
        };
        let show = show.as_deref();
        let question = match (verdict, given) {
            (Some(text), _) => asked::of_verdict("the diagnosis", &text, show)?,
            (None, Some(Document::Path(path))) => asked::read(&path, show, &limits)?,
            (None, Some(Document::Table(table))) => {
                let model = model::of_table("the model", value::table(&table, "")?)?;
                asked::of_model("the model", model, show, &limits)?
            }
            (None, None) => {
                let hint = "give a diagnosis, a model, or the path of verdict.json or model.toml";
                return Err(Error::new("could not plan an experiment", "there is no question", hint));
            }
        };
        Ok((question, limits))
    };
    let (question, limits) = prepared().map_err(|error: Error| raised(py, error))?;
    let wish = Wish { probability, confirm };
    let (answer, experiments) = detached(py, move |control| {
        let (planned, confirmed) = diagnosis::plan::plan(&question, &limits, wish, control)?;
        let json = to_json(&report::plan::document(&planned, wish.probability, &confirmed, &[]))?;
        let experiments: Vec<_> = planned.proposals().map(|p| p.experiment).collect();
        let played = ["inputs[0]", "inputs[1]"];
        let draw = move || report::plan::page(&planned, wish.probability, &confirmed, &played).finish();
        Ok((Answer { json, toml: None, draw: Box::new(draw) }, experiments))
    })?;
    let arrays = |e: &Experiment| {
        let time: Vec<f64> = (0..e.samples()).map(|k| k as f64 / e.rate_hz).collect();
        (PyArray1::from_vec(py, time), PyArray1::from_vec(py, e.input()))
    };
    Ok((answer, experiments.iter().map(arrays).collect()))
}

/// Which part of each recording is used.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct Part {
    topic: Option<String>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    trace: bool,
}

fn read_model(given: Document<'_>, topic: Option<&str>) -> Result<Model> {
    let model = match given {
        Document::Path(path) => model::read(&path)?,
        Document::Table(dictionary) => model::of_table("the model", value::table(&dictionary, "")?)?,
    };
    Ok(match topic {
        Some(topic) => model.of_topic(topic),
        None => model,
    })
}

fn read(recorded: Recorded, model: &Model, seconds: model::Seconds, control: &Control) -> Result<Recording> {
    let Recorded { path, memory } = recorded;
    recording::read(&path, &Request { memory, control: control.clone(), ..model::requested(&path, model, seconds)? })
}

fn judge(train: &[Recording], test: &[Recording], model: &Model, trace: bool, control: &Control) -> Result<Answer> {
    let found = diagnosis::diagnose_all(Recordings { train, test }, model, control)?;
    let found = report::diagnosis::worded(found);
    let costs = report::diagnosis::costs(&found, control)?;
    let found = if trace { found.with_trace() } else { found };
    let json = to_json(&found.verdict)?;
    let repaired_study = repaired::document(found.repair.as_ref(), &found.detail, &found.verdict);
    let study = repaired_study.clone();
    let draw = move || {
        let exhibits = report::diagnosis::exhibits(&found.detail);
        report::diagnosis::page(&found, &costs, &exhibits, study.as_deref()).finish()
    };
    Ok(Answer { json, toml: repaired_study, draw: Box::new(draw) })
}

/// `proofmass study --samples`: names and values of columns, the clock first.
#[pyfunction]
pub(super) fn simulate<'py>(
    py: Python<'py>,
    given: Option<Document<'py>>,
    changes: Changes<'py>,
    members: u64,
) -> PyResult<Bound<'py, PyList>> {
    let source = source(given, &changes).map_err(|error| raised(py, error))?;
    let columns = detached(py, move |control| {
        let study = read_study(source, control)?;
        study.along_one_axis()?;
        let job = study.job(study.integrator()?.integrator, vec![study.clock.samples]);
        ensemble::samples(&job, members, control)
    })?;
    let numbers = columns.all().iter().filter_map(|column| match &column.values {
        Values::Numbers(values) => Some((&column.name, PyArray1::from_slice(py, values))),
        Values::Words(_) => None,
    });
    PyList::new(py, numbers.collect::<Vec<_>>())
}
