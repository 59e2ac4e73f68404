//! The temperature that a sensor at rest was found to follow, as a study takes it: a profile over
//! time, and how much the reading changes with each power of it.

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted, Term};
use super::followed::{Delay, Followed};
use crate::motion::temperature::Temperature;
use crate::numerics::moments;
use crate::recording::Recording;
use crate::warm_profile::{is_possible, profile};

/// Holds what a study takes of a named sensitivity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Warmth {
    /// Change of the reading per power of a unit of the column, file units; powers 1 to 3, zero
    /// where the reading does not follow one.
    pub(super) by_power: [f64; 3],
    /// The column as it acts; the reference is its mean, about which the model is fitted.
    pub(super) temperature: Temperature,
    /// Heading of the column.
    pub(super) column: String,
    /// States whether it acts with play, and the profile is as late.
    pub(super) is_late: bool,
}

/// Why a study cannot take it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unfit {
    /// No column shows it.
    Unlogged,
    /// Another channel has it than the one that stands for the sensor.
    Elsewhere,
    /// Several columns do.
    Several,
    /// The column holds what is no temperature in °C.
    NoTemperature,
}

impl Unfit {
    /// Returns what stands in its place, a sentence.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Unlogged => {
                "Given the temperature as [temperature], a study runs it as bias_temperature_ug_k or \
                 bias_temperature_deg_h_k; where it bends, with those that end in _k2 and _k3."
            }
            Self::Elsewhere => "It is in another channel than the one that stands for the sensor.",
            Self::Several => "A study has one temperature, and the reading follows several columns.",
            Self::NoTemperature => "The column holds values that are no temperature in °C.",
        }
    }
}

/// The temperature that a channel follows by its model.
pub(super) fn of(channel: &Channel, fitted: &Fitted, recording: &Recording) -> Result<Warmth, Unfit> {
    let follows = |(_, term): &(usize, &Term)| term.cause == Cause::TemperatureSensitivity;
    let mut terms = fitted.terms.iter().enumerate().filter(follows);
    let (index, term) = terms.next().ok_or(Unfit::Unlogged)?;
    if terms.next().is_some() {
        return Err(Unfit::Several);
    }
    let Followed { column, delay, unit, powers } = term.column.as_ref().ok_or(Unfit::Unlogged)?;
    let Addition::Curves(curves) = &term.addition else { return Err(Unfit::Unlogged) };
    // The first curve is the column itself.
    let curve = curves.first().ok_or(Unfit::Unlogged)?;
    let mut by_power = [0.0; 3];
    for (power, (amplitude, _)) in powers.iter().zip(fitted.amplitudes_of(index)) {
        by_power[(*power as usize - 1).min(2)] = amplitude * channel.scale / unit.powi(*power);
    }
    let logged = recording.columns.iter().find(|c| c.name == *column).ok_or(Unfit::Unlogged)?;
    let mean = moments::mean(&logged.values);
    let lag_s = match delay {
        Delay::Lag(lag) if logged.values.len() == curve.values.len() => lag.value / channel.rate_hz,
        _ => 0.0,
    };
    // With a lag the sensor is as warm as the column at the beginning; its mean is another one.
    let (points, reference_deg_c) = match (lag_s > 0.0, logged.values.first(), curve.values.first()) {
        (true, Some(first), Some(late)) => (profile(&logged.values, channel.rate_hz, |v| v), first - unit * late),
        _ => (profile(&curve.values, channel.rate_hz, |value| mean + unit * value), mean),
    };
    if !is_possible(&points) {
        return Err(Unfit::NoTemperature);
    }
    Ok(Warmth {
        by_power,
        temperature: Temperature::new(points, reference_deg_c).with_lag(lag_s),
        column: column.clone(),
        is_late: *delay != Delay::None && lag_s == 0.0,
    })
}
