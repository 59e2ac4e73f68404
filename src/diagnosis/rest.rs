//! A sensor at rest, its noise and its drift: which physics its model leaves out.
//!
//! Base: a constant and white noise, or the noise that a datasheet promises. Every channel is judged alone (`selection`),
//! then by what its neighbours bear (`agreement`) and all together for drift that they share (`common`), then what is left
//! (`residual`). Not for coefficients alone: those come faster, and with the classical curve, from `recording::noise`.

mod agreement;
mod candidate;
mod cause;
mod chain;
mod channel;
mod common;
mod conclusion;
mod describe;
pub mod detail;
mod effects;
mod estimate;
mod findings;
mod jump;
mod laws;
mod location;
mod plausible;
mod residual;
mod round;
mod rounding;
mod search;
mod selection;
mod sensor;
mod spectrum;
mod standing;
mod telegraph;

pub use candidate::CANDIDATES;
pub use detail::{ChannelDetail, Detail};

use super::answer::Answer;
use super::model;
use crate::control::{Control, Stopped};
use crate::error::{Error, Result};
use crate::number::short;
use crate::parallel;
use crate::recording::Recording;
use crate::recording::health::Watch;
use channel::{Channel, Curve};

/// Longer recordings are averaged over neighbouring samples to at most this many.
const LONGEST: usize = 1 << 19;
/// Fewer samples cannot tell one law from another.
const FEWEST: usize = 256;

/// Diagnoses it.
///
/// # Errors
/// Fewer than 256 samples, or columns that are not there.
pub fn diagnose(recording: &Recording, model: &model::Static, control: &Control) -> Result<Answer> {
    let rows = rows(recording, model);
    let column = |name: &String| {
        recording.column(name).map(|values| &values[rows.clone()]).ok_or_else(|| {
            Error::new("could not diagnose the recording", format!("column `{name}` was not read"), "check [columns]")
        })
    };
    let mut findings = recording.findings.clone();
    let (names, live): (Vec<&String>, Vec<&[f64]>) = {
        let all: Vec<(&String, &[f64])> =
            model.columns.channels.iter().map(|n| Ok((n, column(n)?))).collect::<Result<_>>()?;
        all.into_iter().filter(|(_, v)| v.windows(2).any(|w| w[0] != w[1])).unzip()
    };
    if live.is_empty() {
        return Err(Error::new(
            "could not diagnose the recording",
            "every channel is constant",
            "a sensor at rest still has noise: is it connected, and is the resolution high enough?",
        ));
    }
    if rows.len() < FEWEST {
        return Err(Error::new(
            "could not diagnose the recording",
            format!("{} samples", rows.len()),
            format!("need at least {FEWEST}; thousands are better"),
        ));
    }
    let together = rows.len().div_ceil(LONGEST);
    let rate_hz = recording.rate_hz / together as f64;
    if together > 1 {
        findings.push(format!(
            "{together} neighbouring samples were averaged: nothing faster than {} Hz is judged, and a disturbance faster \
             than that folds into what is",
            short(rate_hz / 2.0)
        ));
    }
    let reduce = |values: &[f64]| -> Vec<f64> {
        values.chunks_exact(together).map(|c| c.iter().sum::<f64>() / together as f64).collect()
    };
    let environment: Vec<(String, Curve)> = model
        .columns
        .environment
        .iter()
        .map(|n| Ok((n.clone(), Curve::new(reduce(column(n)?)))))
        .collect::<Result<_>>()?;
    let channels: Vec<Channel> = names
        .iter()
        .zip(&live)
        .map(|(name, values)| {
            let mut channel = Channel::new(name, &reduce(values), rate_hz);
            channel.promised = describe::promised(&channel, model.noise.as_ref());
            channel.step = Watch::of(name, values).step().map(|q| q / channel.scale);
            channel.together = together;
            channel
        })
        .collect();
    let means: Vec<f64> = live.iter().map(|v| v.iter().sum::<f64>() / v.len() as f64).collect();
    findings.extend(plausible::gravity(&means, &model.unit));
    let stopped = |s: Stopped| s.during(format!("could not diagnose {}", recording.path.display()), "start it again");
    let select = |c: &Channel| selection::select(c, &environment, channels.len(), control);
    let selected: Result<Vec<_>, Stopped> = parallel::map(&channels, select).into_iter().collect();
    let mut selected = selected.map_err(stopped)?;
    agreement::agree(&channels, &mut selected, &environment, control).map_err(stopped)?;
    let common = if environment.is_empty() { common::find(&channels, &selected) } else { None };
    Ok(conclusion::conclude(conclusion::Material {
        recording,
        model,
        channels: &channels,
        selected: &selected,
        common,
        findings,
    }))
}

/// Rows from the first to the last that the model's split names; all where it names none.
fn rows(recording: &Recording, model: &model::Static) -> std::ops::Range<usize> {
    let ranges = || model.split.train.iter().chain(&model.split.test);
    let end = recording.samples();
    match (ranges().map(|r| r[0]).min(), ranges().map(|r| r[1]).max()) {
        (Some(from), Some(to)) if from < to.min(end) => from..to.min(end),
        _ => 0..end,
    }
}
