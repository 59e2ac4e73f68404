//! When simulation and recording differ: locate the mismatch, name the physics, model it, show the
//! fit improve.
//!
//! Chain: detection → isolation → selection → ruling. One sub-folder per kind of recording: it
//! reads its recording, tries its candidates and weighs the residual (`remainder`); from that
//! evidence `ruling` draws the verdict, the same for all kinds. The vocabulary of a selection
//! stands in `standing`. Each kind returns the same [`answer::Answer`]: numbers and typed reasons.
//! Not for words or drawing: `report` turns an `Answer` into the public document and a page.
//!
//! A sensor at rest whose readings walk at random is more than a constant and white noise:
//!
//! ```
//! use proofmass_base::control::Control;
//! use proofmass_diagnosis::{diagnose, model, verdict::Outcome};
//! use proofmass_recording::{Column, Recording};
//! use proofmass_numerics::rng::{Philox, Stream};
//! use rand_distr::{Distribution, StandardNormal};
//!
//! let mut random = Philox::new(1, 0, Stream::Host);
//! let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
//! let mut walk = 0.0;
//! let mut reading = || {
//!     walk += 0.1 * normal();
//!     walk + normal()
//! };
//! let values = (0..8192).map(|_| reading()).collect();
//! let columns = vec![Column { name: "ax".into(), values }];
//! let recording = Recording { rows: 8192, rate_hz: 100.0, columns, ..Recording::default() };
//! let model = model::parse("model.toml", "kind = \"static\"\nrate_hz = 100.0\n[columns]\nchannels = [\"ax\"]\n")?;
//! let answer = diagnose(&recording, &model, &Control::silent())?;
//! assert_eq!(answer.outcome, Outcome::Explained);
//! assert_eq!(answer.effects[0].id, "random-walk");
//! # Ok::<(), proofmass_base::error::Error>(())
//! ```

#![warn(unreachable_pub)]

pub mod answer;
pub mod by_axis;
pub use proofmass_physics::candidate;
pub mod check;
pub mod consequence;
pub mod consistency;
pub mod detection;
pub mod driven;
mod engine;
pub mod gate;
pub mod model;
pub mod plan;
pub mod proposal;
pub mod recordings;
pub mod rectification;
pub mod remainder;
pub mod repair;
pub mod repaired;
pub mod repeatability;
pub mod response;
pub mod rest;
pub mod ruling;
pub mod standing;
mod stated_units;
pub mod trace;
pub mod trajectory;
pub mod tumble;
pub mod verdict;
mod warm_profile;

// The crates below, under the names by which files here call them.
use proofmass_base::{control, document, error, escape, number, parallel, units};
use proofmass_numerics::{numerics, rng};
use proofmass_physics as physics;
use proofmass_recording as recording;
use proofmass_scenario::{motion, navigation, sensor};
use proofmass_study as study;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::recording::Recording;

use answer::Answer;
use candidate::Candidate;
use model::Model;
use recordings::Recordings;

/// Diagnoses a recording by the kind its model states.
///
/// # Errors
/// When the recording cannot be judged at all (columns missing, too few samples), or when stopped;
/// what can be survived is in `Answer::findings` instead.
pub fn diagnose(recording: &Recording, model: &Model, control: &Control) -> Result<Answer> {
    diagnose_all(Recordings::one(recording), model, control)
}

/// Diagnoses several recordings of one sensor together.
///
/// # Errors
/// As [`diagnose`], and where several recordings are of a kind that is judged one by one, or one is
/// part of another.
pub fn diagnose_all(recordings: Recordings<'_>, model: &Model, control: &Control) -> Result<Answer> {
    let only = || {
        recordings.only().ok_or_else(|| {
            let count = recordings.all().count();
            let cause = format!("{count} recordings are given, and the model's kind takes one");
            let hint = "several recordings, and --test, are for kind = \"driven\": diagnose these one by one";
            Error::new("could not diagnose them together", cause, hint)
        })
    };
    recordings.check_distinct()?;
    recordings.all().try_for_each(|recording| stated_units::check(recording, model))?;
    // What the work says of itself where none of its parts does.
    let _work = control.stage("diagnosing", 0);
    let mut answer = match model {
        Model::Driven(model) => driven::diagnose_all(recordings, model, control)?,
        Model::Static(model) => {
            let recording = only()?;
            rest::diagnose(recording, &stated_units::settled(recording, model), control)?
        }
        Model::Tumble(model) => tumble::diagnose(only()?, model, control)?,
        Model::Trajectory(model) => trajectory::diagnose(only()?, model, control)?,
        Model::Response(model) => response::diagnose(only()?, model, control)?,
    };
    consistency::settle(&mut answer);
    Ok(answer)
}

/// Every candidate of every kind, in the order of each kind's list.
pub fn library() -> impl Iterator<Item = &'static Candidate> {
    let timed =
        driven::CANDIDATES.iter().chain(rest::CANDIDATES).chain(tumble::CANDIDATES).chain(trajectory::CANDIDATES);
    timed.chain(response::CANDIDATES.iter())
}
