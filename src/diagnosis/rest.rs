//! A sensor at rest, its noise and its drift: which physics its model leaves out.
//!
//! Base: a constant and white noise, or the noise that a datasheet promises. Which environment
//! columns the channels follow is asked first, of each alone and of all (`shared_lag`). Every
//! channel is judged alone (`selection`), then by what its neighbours bear (`agreement`), its
//! courses in time against the columns (`rival_column`), and all together for drift that they share
//! (`common`), then what is left (`residual`). Not for coefficients alone: those come faster, and
//! with the classical curve, from `recording::noise`.

mod agreement;
mod besides;
mod block_means;
mod by_column;
mod candidate;
mod candidates_round;
mod cause;
mod chain;
mod channel;
mod column;
mod common;
mod conclusion;
mod corner;
mod course;
mod decimated;
mod delayed;
mod departure;
mod describe;
pub mod detail;
mod earth;
mod effects;
mod estimate;
mod findings;
mod followed;
mod held_rows;
mod hump;
mod in_time;
mod intake;
mod jump;
mod known;
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
mod searched;
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
mod stuck;
mod telegraph;
mod temperature_profile;

pub use candidate::CANDIDATES;
pub use detail::{ChannelDetail, Detail};

use super::answer::{self, Answer};
use super::model::{self, MOST_AT_REST};
use crate::control::{Control, Stopped};
use crate::error::Result;
use crate::number::short;
use crate::numerics::moments;
use crate::recording::Recording;
use crate::recording::disturbance;
use crate::recording::health::Watch;
use crate::repeatability::besides::Besides;
use crate::repeatability::run::Run;
use crate::stated_units;
use channel::{Channel, Curve};
use intake::Columns;
use searched::{Measured, Searched};

/// Diagnoses it.
///
/// # Errors
/// Fewer than 256 samples, or columns that are not there.
pub fn diagnose(recording: &Recording, model: &model::Static, control: &Control) -> Result<Answer> {
    earth::check(model)?;
    let columns = Columns::of(recording, model)?;
    let (names, live): (Vec<&String>, Vec<&[f64]>) = columns.live(model)?.into_iter().unzip();
    let mut findings = columns.sentences();
    // The reader may have averaged already.
    let averaged = recording.averaged.as_ref();
    let more = if averaged.is_some() { 1 } else { columns.rows.len().div_ceil(MOST_AT_REST) };
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
        .map(|n| Ok((n.clone(), Curve::new(reduce(columns.values(n)?)))))
        .collect::<Result<_>>()?;
    let mut frozen = Vec::new();
    let channels: Vec<Channel> = names
        .iter()
        .zip(&live)
        .map(|(name, values)| {
            let filled = columns.filled(name);
            let step = Watch::of(name, values, &filled).step();
            let mut values = values.to_vec();
            frozen.push(columns.in_file(stuck::take_out(&mut values, &filled)));
            let disturbances = disturbance::take_out(&mut values);
            let mut channel = Channel::new(name, &reduce(&values), rate_hz);
            channel.unit = stated_units::words(recording, name, model).unwrap_or(channel.unit);
            channel.disturbances = disturbances;
            channel.promised = describe::promised(&channel, model.noise.as_ref());
            let step = if averaged.is_some() { columns.step_before(name) } else { step };
            channel.step = step.map(|q| q / channel.scale);
            channel.together = together;
            channel
        })
        .collect();
    findings.extend(stuck::sentences(&names, &frozen, columns.rows.len()));
    let raw: Vec<(&str, &[f64])> = names.iter().zip(&live).map(|(name, values)| (name.as_str(), *values)).collect();
    findings.extend(held_rows::sentence(&raw, recording.rate_hz));
    let read = channels.iter().zip(&names).map(|(c, name)| (c.mean, stated_units::of(recording, name, model)));
    findings.extend(plausible::gravity(&read.collect::<Vec<_>>()));
    let stopped = |s: Stopped| s.during(format!("could not diagnose {}", recording.path.display()), "start it again");
    let measured = Measured { channels, environment, noise: model.noise.as_ref() };
    let searched = Searched::of(measured, control).and_then(|s| s.below_the_corner(control));
    let (Searched { measured, selected, common }, below) = searched.map_err(stopped)?;
    findings.extend(below);
    Ok(conclusion::conclude(conclusion::Material {
        recording,
        columns: &columns,
        model,
        channels: &measured.channels,
        selected: &selected,
        common,
        environment: &measured.environment,
        findings,
    }))
}

/// Lists the channels of a log that hold more than noise with an Allan coefficient, and what that is.
///
/// # Errors
/// As [`diagnose`].
pub fn besides(recording: &Recording, model: &model::Static, control: &Control) -> Result<Vec<Besides>> {
    let answer = diagnose(recording, model, control)?;
    Ok(if let answer::Detail::Static(detail) = &answer.detail { besides::of(detail) } else { Vec::new() })
}

/// Returns what each log at rest can know of each channel, what it finds, and the same of its halves.
///
/// # Errors
/// As [`diagnose`].
pub fn known(recordings: &[Recording], model: &model::Static, control: &Control) -> Result<Vec<Run>> {
    let columns: Vec<Columns<'_>> = recordings.iter().map(|r| Columns::of(r, model)).collect::<Result<_>>()?;
    let live: Vec<Vec<&String>> = columns
        .iter()
        .map(|of| Ok(of.live(model)?.into_iter().map(|(name, _)| name).collect()))
        .collect::<Result<_>>()?;
    // A channel that is constant in one log has its place there too, so that each is compared with itself.
    let names: Vec<&String> =
        model.columns.channels.iter().filter(|name| live.iter().any(|of| of.contains(name))).collect();
    let _stage = control.stage("fitting the noise of each log and of its halves", 0);
    let logs = recordings.iter().zip(&columns).map(|(recording, columns)| {
        let stopped = |s: Stopped| s.during(format!("could not check {}", recording.path.display()), "start it again");
        control.go_on().map_err(stopped)?;
        let rate_hz = recording.rate_hz / recording.averaged.as_ref().map_or(1, |a| a.together) as f64;
        let mut findings = columns.sentences();
        let mut channels = Vec::new();
        let (mut left_out, mut frozen) = (Vec::new(), Vec::new());
        for name in &names {
            let mut values = columns.values(name)?.to_vec();
            let filled = columns.filled(name);
            frozen.push(columns.in_file(stuck::take_out(&mut values, &filled)));
            let disturbances = disturbance::take_out(&mut values);
            match disturbances.knocks.len() + disturbances.bad.len() {
                0 => (),
                count => left_out.push(format!("{name} {count}")),
            }
            let unit = stated_units::of(recording, name, model);
            channels.push(known::Readings { name: (*name).clone(), unit, values });
        }
        if !model.columns.environment.is_empty() {
            let columns = model.columns.environment.join("`, `");
            findings
                .push(format!("what follows `{columns}` is part of these numbers: `proofmass diagnose` takes it out"));
        }
        findings.extend(stuck::sentences(&names, &frozen, columns.rows.len()));
        if !left_out.is_empty() {
            findings.push(format!("knocks and single bad readings were left out: {}", left_out.join(", ")));
        }
        let raw: Vec<(&str, &[f64])> =
            names.iter().map(|name| Ok((name.as_str(), columns.values(name)?))).collect::<Result<_>>()?;
        findings.extend(held_rows::sentence(&raw, recording.rate_hz));
        let read = channels.iter().map(|c| (moments::mean(&c.values), c.unit.clone()));
        findings.extend(plausible::gravity(&read.collect::<Vec<_>>()));
        Ok(known::check(&channels, rate_hz, findings))
    });
    logs.collect()
}
