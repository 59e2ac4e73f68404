//! Stepped-sine sweeps of a resonator, as a lock-in amplifier records them: which physics the linear
//! resonator leaves out.
//!
//! The base model is a linear oscillator with a complex gain, a background (constant and linear in
//! frequency, and both in proportion to the drive) and what a lock-in's filter holds from the step
//! before. Its laws are those of `physics`: their effect on the motion is computed from the laws' own
//! force along it (`steady_state`). A motion with two stable states follows the history of the sweep:
//! its jumps are predicted and compared. Not for time series: those are `driven`.

mod answer;
mod balance;
mod base_model;
mod beginnings;
mod cycle;
pub mod detail;
mod effects;
mod force;
mod impedance;
mod intake;
mod jumps;
mod laws;
mod location;
mod noise;
mod places;
mod pole;
mod predicted;
mod repetition;
mod space;
mod steady_state;
mod system;
mod thermal;
mod thinned;
mod units;
mod unsettled;
mod values;

pub use detail::Detail;
pub use space::CANDIDATES;

use super::answer::Answer;
use super::model;
use crate::control::Control;
use crate::engine::fit::Fitted;
use crate::engine::names::{self, Found};
use crate::engine::search::Search;
use crate::error::{Error, Result};
use crate::recording::Recording;
use intake::Sweeps;
use system::System;

/// Noise below this part of the largest reading cannot be told from what the tables of a force round
/// off.
const LEAST_NOISE: f64 = 1e-5;

/// Diagnoses a recording of sweeps.
///
/// # Errors
/// Columns that no sweep has, too few steps, no resonance in them; when stopped.
pub fn diagnose(recording: &Recording, model: &model::Response, control: &Control) -> Result<Answer> {
    model.thermal.iter().try_for_each(|stated| thermal::check(stated, &recording.path))?;
    let mut findings = recording.sentences();
    let mut sweeps = intake::sweeps(recording, model, &mut findings)?;
    let measured = noise::deviation(&sweeps);
    unsettled::mark(&mut sweeps, measured.unwrap_or_default());
    let work = control.stage("fitting the resonance", 0);
    let mirrored = Sweeps { reading: sweeps.reading.iter().map(nalgebra::Complex::conj).collect(), ..sweeps.clone() };
    let variance = |s: &Sweeps| base_model::base(s).map_or(f64::INFINITY, |(_, f)| f.variance);
    if variance(&mirrored) < variance(&sweeps) {
        sweeps = mirrored;
        findings.push("the phase rises through the resonance: Y is taken with its sign turned".into());
    }
    let none = || {
        Error::new(
            format!("could not diagnose {}", recording.path.display()),
            "no resonance could be fitted to its sweeps",
            "the steps must cover a resonance and both of its sides; check the columns under [columns]",
        )
    };
    let (system, base) = base_model::base(&sweeps).ok_or_else(none)?;
    let least = LEAST_NOISE * system.sizes.reading;
    // Without seven steps in a row the base model itself must say it.
    let measured = measured.map(|measured| noise::allowed(measured, sweeps.len()));
    let deviation = measured.unwrap_or_else(|| base.variance.sqrt()).max(least);
    control
        .go_on()
        .map_err(|s| s.during(format!("could not finish {}", recording.path.display()), "start it again"))?;
    work.rename("searching the library");
    let found = searched(&system, deviation, &base).ok_or_else(none)?;
    // What was found says where the motion jumps, and had not settled: it is judged without those steps.
    let rested = unsettled::shown(&sweeps, &system.unsettled(&found.best));
    let fewer = rested.as_ref().and_then(|rested| {
        let fewer = system.over(rested);
        let (search, base) = Search::begin(&fewer, deviation.powi(2), &base.point)?;
        let again = names::again(&search, base, &found, |fitted| fitted.point.clone(), true)?;
        drop(search);
        Some((fewer, again))
    });
    let (system, found) = match fewer {
        Some((fewer, again)) => {
            let fitted = |s: &Sweeps| s.counts.iter().filter(|c| **c).count();
            findings.push(format!(
                "{} of {} steps had not settled, by the model found, and are not fitted: near the end of a branch a \
                 motion takes ever longer to settle",
                fitted(&sweeps) - fitted(fewer.sweeps),
                sweeps.len()
            ));
            (fewer, again)
        }
        None => (system, found),
    };
    let case =
        answer::Case { recording, model, system: &system, found: &found, deviation, is_measured: measured.is_some() };
    Ok(case.conclude(findings))
}

/// Searches the library.
fn searched(system: &System<'_>, deviation: f64, base: &Fitted) -> Option<Found> {
    let (search, base) = Search::begin(system, deviation.powi(2), &base.point)?;
    Some(names::names(&search, base, None))
}
