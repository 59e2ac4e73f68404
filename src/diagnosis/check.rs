//! Asks whether a recording can be trusted: what it can know at all, and whether its halves, or several
//! recordings of one sensor, say the same.

use crate::answer::Answer;
use crate::control::Control;
use crate::error::Result;
use crate::model::{Driven, Model};
use crate::recording::Recording;
use crate::recordings::Recordings;
use crate::repeatability::agreement::Agreement;
use crate::repeatability::run::{self, Run};
use crate::twice::{self, Twice};
use crate::{driven, response, rest, stated_units, trajectory, tumble};

/// The two sides of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compared {
    /// The halves of the only recording.
    Halves(run::Split),
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
}

/// Checks one recording by its halves, or several of one sensor by one another.
///
/// # Errors
/// Recordings that cannot be used, or of which one is part of another; when stopped.
pub fn check(recordings: &[Recording], model: &Model, control: &Control) -> Result<Checked> {
    Recordings { train: recordings, test: &[] }.check_distinct()?;
    recordings.iter().try_for_each(|recording| stated_units::check(recording, model))?;
    let each = |run: &dyn Fn(&Recording) -> Result<Run>| recordings.iter().map(run).collect::<Result<Vec<Run>>>();
    let twice = |diagnose: &dyn Fn(&Recording) -> Result<Answer>| {
        let all: Vec<Twice> = recordings.iter().map(|r| Twice::of(r, diagnose)).collect::<Result<_>>()?;
        Ok(twice::runs(&all))
    };
    let runs = match model {
        Model::Tumble(model) => each(&|r| tumble::known(r, model, control)),
        Model::Static(model) => each(&|r| rest::known(r, model, control)),
        Model::Trajectory(model) => each(&|r| trajectory::known(r, model, control)),
        Model::Driven(model) => {
            // A part has no samples that the model's split could name.
            let model = Driven { split: Default::default(), ..model.clone() };
            twice(&|r| driven::diagnose(r, &model, control))
        }
        Model::Response(model) => twice(&|r| response::diagnose(r, model, control)),
    };
    runs.map(compared)
}

/// Compares what the recordings found.
pub fn compared(runs: Vec<Run>) -> Checked {
    let agreement = match &runs[..] {
        [only] => {
            only.halves.as_ref().map(|halves| (Compared::Halves(halves.split), Agreement::of(&halves.each.each_ref())))
        }
        several => Some((Compared::Runs, Agreement::of(&several.iter().map(|r| &r.estimate).collect::<Vec<_>>()))),
    };
    Checked { runs, agreement }
}
