//! Asks whether a recording can be trusted: what it can know at all, and whether its halves, or several
//! recordings of one sensor, say the same.

use std::path::Path;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::numerics::moments::mean_sd;
use crate::recording::Recording;
use crate::recordings::Recordings;
use crate::repeatability::agreement::Agreement;
use crate::repeatability::run::{Run, Split};
use crate::repeatability::study;
use crate::{rest, stated_units, trajectory, tumble};

/// The two sides of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compared {
    /// The halves of the only recording.
    Halves(Split),
    /// The recordings.
    Runs,
}

/// Recordings of one sensor, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// One entry for each recording, in the order given.
    pub runs: Vec<Run>,
    /// The sides, and what came of it; `None` of a recording that is too short to be
    /// divided.
    pub agreement: Option<(Compared, Agreement)>,
    /// Environment columns that differ between the recordings.
    pub surroundings: Vec<Surroundings>,
}

/// An environment column that differs between recordings by more than it varies in each.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    /// Its heading.
    pub column: String,
    /// The lowest and the highest of its means in each recording.
    pub means: [f64; 2],
}

impl Surroundings {
    /// Those of a model that differ between recordings.
    fn of(recordings: &[Recording], model: &Model) -> Vec<Self> {
        let one = |column: &String| {
            let values = recordings.iter().map(|recording| recording.column(column).map(mean_sd));
            let (means, within): (Vec<f64>, Vec<f64>) = values.collect::<Option<Vec<_>>>()?.into_iter().unzip();
            let means = [f64::min, f64::max].map(|end| means.iter().copied().reduce(end).unwrap_or_default());
            let differs = means[1] - means[0] > within.into_iter().fold(0.0, f64::max);
            differs.then(|| Self { column: column.clone(), means })
        };
        model.environment().iter().filter_map(one).collect()
    }
}

impl Checked {
    /// The sensor of a study, with its spread from run to run; `None` where nothing was compared that a study has a
    /// key for.
    pub fn sensor_toml(&self, rate_hz: f64) -> Option<String> {
        let (_, agreement) = self.agreement.as_ref()?;
        study::sensor_toml(agreement, &self.runs.first()?.estimate, rate_hz)
    }
}

/// Checks one recording by its halves, or several of one sensor by one another.
///
/// # Errors
/// A kind that is not checked yet; recordings that cannot be used, of which one is part of another, or which would share a file that
/// belongs to one of them; when stopped.
pub fn check(recordings: &[Recording], model: &Model, control: &Control) -> Result<Checked> {
    Recordings { train: recordings, test: &[] }.check_distinct()?;
    recordings.iter().try_for_each(|recording| stated_units::check(recording, model))?;
    if let ([_, second, ..], Some(file)) = (recordings, of_one_recording(model)) {
        return Err(Error::new(
            format!("could not check {} with this model", second.path.display()),
            format!("the model names {}, which belongs to one recording, and several are given", file.display()),
            "check each by itself, with a model that names its own file, and compare the values that `--json` prints",
        ));
    }
    let each = |run: &dyn Fn(&Recording) -> Result<Run>| recordings.iter().map(run).collect::<Result<_>>();
    let runs = match model {
        Model::Tumble(model) => each(&|recording| tumble::known(recording, model, control)),
        Model::Static(model) => rest::known(recordings, model, control),
        Model::Trajectory(model) => each(&|recording| trajectory::known(recording, model, control)),
        Model::Driven(_) => each(&|recording| Err(not_yet(recording, "driven"))),
        Model::Response(_) => each(&|recording| Err(not_yet(recording, "response"))),
    };
    Ok(Checked { surroundings: Surroundings::of(recordings, model), ..compared(runs?) })
}

/// Adds to each log at rest what a diagnosis finds in it besides noise. Other kinds stay as they are.
///
/// # Errors
/// As [`rest::diagnose`].
pub fn with_besides(
    mut checked: Checked,
    recordings: &[Recording],
    model: &Model,
    control: &Control,
) -> Result<Checked> {
    if let Model::Static(model) = model {
        for (run, recording) in checked.runs.iter_mut().zip(recordings) {
            run.besides = rest::besides(recording, model, control)?;
        }
    }
    Ok(checked)
}

/// A file next to the recording that the model names: poses, or a reference.
fn of_one_recording(model: &Model) -> Option<&Path> {
    match model {
        Model::Tumble(model) => model.poses.as_deref(),
        Model::Trajectory(model) => model.reference.as_ref().map(|reference| reference.file.as_path()),
        Model::Driven(_) | Model::Static(_) | Model::Response(_) => None,
    }
}

/// Compares what the recordings found.
pub fn compared(runs: Vec<Run>) -> Checked {
    let agreement = match &runs[..] {
        [only] => {
            only.halves.as_ref().map(|halves| (Compared::Halves(halves.split), Agreement::of(&halves.each.each_ref())))
        }
        several => Some((Compared::Runs, Agreement::of(&several.iter().map(|r| &r.estimate).collect::<Vec<_>>()))),
    };
    Checked { runs, agreement, surroundings: Vec::new() }
}

fn not_yet(recording: &Recording, kind: &str) -> Error {
    Error::new(
        format!("could not check {}", recording.path.display()),
        format!("its model has kind = \"{kind}\", and only kinds static, tumble and trajectory are checked"),
        "proofmass diagnose states each parameter with its 95 % interval: run it on each recording and compare",
    )
}
