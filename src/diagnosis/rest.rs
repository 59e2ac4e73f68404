//! A sensor at rest, its noise and its drift: which physics its model leaves out.
//!
//! Base: a constant and white noise, or the noise that a datasheet promises. Which environment
//! columns the channels follow is asked first, of each alone and of all (`shared_lag`). Every
//! channel is judged alone (`selection`), then by what its neighbours bear (`agreement`), its
//! courses in time against the columns (`rival_column`), and all together for drift that they share
//! (`common`), then what is left (`residual`). Not for coefficients alone: those come faster, and
//! with the classical curve, from `recording::noise`.

mod agreement;
mod block_means;
mod candidate;
mod candidates_round;
mod cause;
mod chain;
mod channel;
mod column;
mod common;
mod conclusion;
mod course;
mod decimated;
mod departure;
mod describe;
pub mod detail;
mod disturbance;
mod earth;
mod effects;
mod estimate;
mod findings;
mod followed;
mod hump;
mod in_time;
mod jump;
mod laws;
mod level;
mod location;
mod mean;
mod near_law;
mod plausible;
mod products;
mod profile;
mod quantisation;
mod residual;
mod rival_column;
mod score;
mod search;
mod selection;
mod sensor;
mod shape;
mod shared_exponent;
mod shared_lag;
mod shift_null;
mod slow;
mod spectrum;
mod standing;
pub mod statement;
mod statements;
mod telegraph;
mod temperature_profile;

pub use candidate::CANDIDATES;
pub use detail::{ChannelDetail, Detail};

use std::collections::HashMap;
use std::ops::Range;

use super::answer::Answer;
use super::model::{self, MOST_AT_REST};
use crate::control::{Control, Stopped};
use crate::error::{Error, Result};
use crate::number::short;
use crate::parallel;
use crate::recording::Recording;
use crate::recording::finding::Finding;
use crate::recording::health::Watch;
use channel::{Channel, Curve};
use selection::Surroundings;
use shape::Following;

/// Fewer samples cannot tell one law from another.
const FEWEST: usize = 256;

/// Diagnoses it.
///
/// # Errors
/// Fewer than 256 samples, or columns that are not there.
pub fn diagnose(recording: &Recording, model: &model::Static, control: &Control) -> Result<Answer> {
    earth::check(model)?;
    let rows = rows(recording, model)?;
    // A linear search for each of many thousand channels would take minutes.
    let places: HashMap<&str, usize> =
        recording.columns.iter().enumerate().map(|(i, c)| (c.name.as_str(), i)).collect();
    let column = |name: &String| {
        places.get(name.as_str()).and_then(|i| recording.columns[*i].values.get(rows.clone())).ok_or_else(|| {
            Error::new("could not diagnose the recording", format!("column `{name}` was not read"), "check [columns]")
        })
    };
    let mut findings = recording.sentences();
    let (names, live): (Vec<&String>, Vec<&[f64]>) = {
        let all: Vec<(&String, &[f64])> =
            model.columns.channels.iter().map(|n| Ok((n, column(n)?))).collect::<Result<_>>()?;
        all.into_iter().filter(|(_, v)| v.windows(2).any(|w| w[0] != w[1])).unzip()
    };
    if live.is_empty() {
        let rounded = recording.findings.iter().any(|f| matches!(f, Finding::BeyondDouble { .. }));
        return Err(Error::new(
            "could not diagnose the recording",
            if rounded { "every channel is constant in double precision" } else { "every channel is constant" },
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
    // The reader may have averaged already.
    let averaged = recording.averaged.as_ref();
    let more = if averaged.is_some() { 1 } else { rows.len().div_ceil(MOST_AT_REST) };
    let together = averaged.map_or(more, |a| a.together);
    let rate_hz = recording.rate_hz / together as f64;
    if together > 1 {
        findings.push(format!(
            "{together} neighbouring samples were averaged: nothing faster than {} Hz is tested, and a faster \
             disturbance aliases into the band",
            short(rate_hz / 2.0)
        ));
    }
    let reduce = |values: &[f64]| -> Vec<f64> {
        values.chunks_exact(more).map(|c| c.iter().sum::<f64>() / more as f64).collect()
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
            let step = Watch::of(name, values).step();
            let mut values = values.to_vec();
            let disturbances = disturbance::take_out(&mut values);
            let mut channel = Channel::new(name, &reduce(&values), rate_hz);
            channel.disturbances = disturbances;
            channel.promised = describe::promised(&channel, model.noise.as_ref());
            let step = match averaged {
                Some(averaged) => places.get(name.as_str()).and_then(|i| averaged.steps.get(*i).copied().flatten()),
                None => step,
            };
            channel.step = step.map(|q| q / channel.scale);
            channel.together = together;
            channel
        })
        .collect();
    let means: Vec<f64> = channels.iter().map(|c| c.mean).collect();
    findings.extend(plausible::gravity(&means, &model.unit));
    let stopped = |s: Stopped| s.during(format!("could not diagnose {}", recording.path.display()), "start it again");
    let work = control.stage("searching the laws of each channel", channels.len() as u64);
    let followed = shared_lag::find(&channels, &environment, control).map_err(stopped)?;
    let select = |(channel, following): (&Channel, &Vec<Following>)| {
        let surroundings = Surroundings { columns: &environment, following };
        let selected = selection::select(channel, &surroundings, channels.len(), control);
        work.step();
        selected
    };
    let asked: Vec<_> = channels.iter().zip(&followed).collect();
    let selected: Result<Vec<_>, Stopped> = parallel::map(&asked, |of| select(*of)).into_iter().collect();
    let mut selected = selected.map_err(stopped)?;
    work.rename("comparing the channels");
    agreement::agree(&channels, &mut selected, &environment, control).map_err(stopped)?;
    rival_column::tie(&channels, &mut selected, &environment, control).map_err(stopped)?;
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

/// Values from the first to the last sample that the model's split names; all where it names none.
///
/// # Errors
/// Ranges outside the recording, or samples that are to be fitted and to judge.
fn rows(recording: &Recording, model: &model::Static) -> Result<Range<usize>> {
    let total = recording.first_sample + recording.samples();
    model.split.check(total).map_err(|(cause, hint)| {
        Error::new(format!("could not use [split] for {}", recording.path.display()), cause, hint)
    })?;
    let values = recording.columns.first().map_or(0, |c| c.values.len());
    Ok(match model.split.hull() {
        // The reader has cut it out where it averaged, or where the recording begins with it.
        Some(hull) if recording.averaged.is_none() => {
            let from = hull.start.saturating_sub(recording.first_sample);
            from..(hull.end - recording.first_sample.min(hull.end)).min(values)
        }
        _ => 0..values,
    })
}
