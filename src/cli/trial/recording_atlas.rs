//! `proofmass trial --atlas`: pages on real recordings, one a set, with what the other commands say
//! of them.

use std::path::{Path, PathBuf};

use crate::allan::{Asked, Scales};
use crate::output::{remark, say, sayln};
use proofmass_base::control::Control;
use proofmass_base::document::to_json;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::units::DEGREE;
use proofmass_numerics::numerics::allan::law::Term;
use proofmass_recording::Request as Reading;
use proofmass_recording::noise::{Channel, Noise};
use proofmass_recording::unit;
use proofmass_report::allan as report;
use proofmass_simulate::drift::compare::Outcome;
use proofmass_simulate::drift::{self, windows};
use proofmass_simulate::ensemble::{Backends, Choice, Keeper, Options};
use proofmass_trial::ask::Subject;
use proofmass_trial::page::recording_atlas as page;
use proofmass_trial::real;
use proofmass_trial::recording_atlas::measured::{Axis, Coefficient, Drift, Measured, Quantity};
use proofmass_trial::recording_atlas::recipe::{self, OTHER_PAGES, Recipe, Rest};
use proofmass_trial::recording_atlas::survey::{Instruments, Surveyed, survey};
use proofmass_trial::recording_atlas::walk::{self, Line};

/// Request to an atlas.
#[derive(Debug, Clone)]
pub(super) struct Request {
    /// List of the sets.
    pub recipe: PathBuf,
    /// Folder of the pages.
    pub out: PathBuf,
    /// Replace what is not ours.
    pub force: bool,
}

/// Makes the pages and says what is on them.
///
/// # Errors
/// A recipe that cannot be used, recordings that are not there, a folder that cannot be written, or
/// Ctrl-C.
pub(super) fn run(request: &Request, subject: &Subject<'_>, control: &Control, json: bool) -> Result<()> {
    let recipe = recipe::read(&request.recipe)?;
    let data = real::folder().ok_or_else(|| {
        let cause = "there is no folder of recordings: neither PROOFMASS_DATA nor ../shared/data is one";
        Error::new("could not make the atlas", cause, "set PROOFMASS_DATA to the folder that has them")
    })?;
    let mut folder = keep(request, &recipe)?;
    let rest = |path: &Path, rest: &Rest| measured(path, rest, control);
    let found = survey(recipe, &Instruments { diagnose: subject, rest: &rest, data: &data, control })?;
    let lines = walk::lines(&found);
    // As a reader of the pages would type it there: no path of this machine.
    let command = format!("proofmass trial --atlas {} --out .", file_name(&request.recipe));
    for surveyed in &found {
        folder.write(&file(&surveyed.set.id), page::set::page(surveyed, &command).as_bytes())?;
    }
    let others = [page::index::page(&found, &command), page::random_walk::page(&lines, &command)];
    for (name, text) in OTHER_PAGES.iter().zip(others) {
        folder.write(&file(name), text.as_bytes())?;
    }
    folder.finish()?;
    if json {
        return sayln!("{}", to_json(&document(&found, &lines))?);
    }
    for surveyed in &found {
        for (question, answered) in surveyed.questions() {
            say(format_args!("{}, {}: {}\n", surveyed.set.id, question.name, answered.said.outcome.name()))?;
        }
    }
    remark!("wrote {} pages in {}", found.len() + OTHER_PAGES.len(), request.out.display());
    Ok(())
}

fn file(id: &str) -> String {
    format!("{id}.md")
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn keep(request: &Request, recipe: &Recipe) -> Result<Folder> {
    let ids = recipe.set.iter().map(|set| set.id.as_str());
    let models = recipe.set.iter().flat_map(|set| &set.diagnosis).map(|question| question.model.clone());
    let request_to_write = output::Request {
        command: "trial --atlas",
        inputs: vec![request.recipe.clone()],
        reads: models.collect(),
        writes: ids.chain(OTHER_PAGES).map(file).collect(),
        force: request.force,
        ..output::Request::default()
    };
    Folder::open(&request.out, request_to_write)
}

/// The public document `proofmass.atlas/1`.
fn document(found: &[Surveyed], lines: &[Line]) -> serde_json::Value {
    let set = |surveyed: &Surveyed| {
        let verdicts: Vec<_> = surveyed
            .questions()
            .map(|(question, answered)| serde_json::json!({ "recording": question.name, "said": answered.said }))
            .collect();
        let rests: Vec<_> = surveyed
            .at_rest()
            .map(|(rest, measured)| serde_json::json!({ "recording": rest.name, "measured": measured }))
            .collect();
        let set = &surveyed.set;
        serde_json::json!({ "id": set.id, "source": set.source, "licence": set.licence, "verdicts": verdicts, "rest": rests })
    };
    let sets: Vec<_> = found.iter().map(set).collect();
    serde_json::json!({ "schema": "proofmass.atlas/1", "sets": sets, "random_walk": lines })
}

/// Noise of a log at rest by the way of `proofmass allan`, drift by that of `proofmass study`.
fn measured(path: &Path, rest: &Rest, control: &Control) -> Result<Measured> {
    let scales = Scales {
        accelerometer: rest.accelerometer.clone(),
        accelerometer_scale: rest.accelerometer_scale.clone(),
        gyro: rest.gyro.clone(),
        gyro_scale: rest.gyro_scale.clone(),
    };
    let reading = Reading { rate_hz: rest.rate_hz, control: control.without_stages(), ..Reading::default() };
    let noise = Asked::new(reading, &scales)?.analyse(path)?;
    Ok(Measured {
        samples: noise.source.samples,
        rate_hz: noise.source.rate_hz,
        sha256: noise.source.sha256.clone(),
        tables: report::tables(&noise).into(),
        axes: noise.channels.iter().filter_map(axis).collect(),
        drift: if rest.drift { drifted(path, &noise, control)? } else { Vec::new() },
    })
}

/// The noise of a column that has a unit and a fit.
fn axis(channel: &Channel) -> Option<Axis> {
    let quantity = match channel.unit.quantity {
        unit::Quantity::Gyro => Quantity::Gyro,
        unit::Quantity::Accelerometer => Quantity::Accelerometer,
        unit::Quantity::Unknown => return None,
    };
    let fit = channel.fit.as_ref()?;
    let of = |term: Term| {
        let (unit, factor) = channel.unit.coefficient(term);
        let c = fit.coefficients[term as usize];
        let value = c.supported().then_some(c.value * factor);
        Coefficient { value, ci95: c.ci95.map(|end| end * factor), unit }
    };
    let (_, level) = channel.unit.coefficient(Term::Flicker);
    Some(Axis {
        name: channel.name.clone(),
        quantity,
        mean: channel.mean * level,
        lowest: channel.minimum.map(|deviation| deviation.value * level),
        longest_s: fit.to_s,
        flicker: of(Term::Flicker),
        walk: of(Term::Walk),
        ramp: of(Term::Ramp),
        walk_per_file_unit: channel.unit.coefficient(Term::Walk).1,
    })
}

/// Drift in windows next to that of simulated sensors, on the CPU: the same on every machine.
fn drifted(path: &Path, noise: &Noise, control: &Control) -> Result<Vec<Drift>> {
    let Some(text) = report::study(path, noise) else { return Ok(Vec::new()) };
    let study = proofmass_study::parse("study.toml", &text, Path::new("."))?;
    let options = Options { backend: Choice::Cpu, control: control.without_stages(), ..Options::default() };
    let (mut backends, mut keeper) = (Backends::default(), Keeper::none());
    let answer = drift::answer(&study, &options.control, |job, _| backends.run(job, &options, &mut keeper))?;
    let Outcome::Compared(comparison) = answer.compared else { return Ok(Vec::new()) };
    let of_axis = |axis: &windows::Drifted| {
        let is_gyro = |c: &&Channel| c.name == axis.column && c.unit.quantity == unit::Quantity::Gyro;
        let (unit, size) = match noise.channels.iter().find(is_gyro) {
            None => ("m", 1.0),
            Some(_) => ("°", DEGREE),
        };
        let of = |w: &windows::Windows| Drift {
            axis: axis.column.clone(),
            seconds: w.seconds,
            windows: w.recorded.len(),
            inside: w.inside(false)[1],
            recorded: w.sd_recorded(false) / size,
            predicted: w.sd_predicted / size,
            unit,
        };
        axis.windows.iter().map(of).collect::<Vec<_>>()
    };
    Ok(comparison.windows.iter().flat_map(of_axis).collect())
}
