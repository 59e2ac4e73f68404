//! The temperature that a sensor at rest was found to follow, as a study takes it: a profile over
//! time, and how much the reading changes with each power of it.

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted, Term};
use super::followed::{Delay, Followed};
use crate::motion::temperature::{POSSIBLE_DEG_C, Temperature};
use crate::numerics::moments;
use crate::recording::Recording;

/// Points of a profile, at most.
const POINTS: usize = 60;

/// What a study takes of a named sensitivity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Warmth {
    /// Change of the reading per power of a unit of the column, file units; powers 1 to 3, zero
    /// where the reading does not follow one.
    pub(super) by_power: [f64; 3],
    /// The column as it acts; the reference is its mean, about which the model is fitted.
    pub(super) temperature: Temperature,
    /// Heading of the column.
    pub(super) column: String,
    /// Whether it acts late, and the profile is as late.
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
    /// What stands in its place, a sentence.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Unlogged => {
                "Given the temperature as [temperature], a study runs it as bias_temperature_ug_k or \
                 bias_temperature_deg_h_k."
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
    let points = profile(&curve.values, channel.rate_hz, |value| mean + unit * value);
    if !points.iter().all(|[_, deg_c]| POSSIBLE_DEG_C.contains(deg_c)) {
        return Err(Unfit::NoTemperature);
    }
    Ok(Warmth {
        by_power,
        temperature: Temperature { points, reference_deg_c: mean },
        column: column.clone(),
        is_late: *delay != Delay::None,
    })
}

/// Points at equal times from the first sample to the last, each the mean of half the way to its
/// neighbours; the ends are where a straight line through the means of their two quarters ends.
fn profile(values: &[f64], rate_hz: f64, to: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let parts = POINTS.min(values.len() / 4).max(1);
    let at = |quarters: usize| quarters * values.len() / (4 * parts);
    let mean = |from: usize, to: usize| {
        let around = &values[at(from)..at(to)];
        moments::mean(around)
    };
    let end = |outer: f64, inner: f64| outer + 0.5 * (outer - inner);
    let last = 4 * parts;
    let point = |k: usize| {
        let value = match k {
            0 => end(mean(0, 1), mean(1, 2)),
            k if k == parts => end(mean(last - 1, last), mean(last - 2, last - 1)),
            k => mean(4 * k - 2, 4 * k + 2),
        };
        [k as f64 * values.len() as f64 / parts as f64 / rate_hz, to(value)]
    };
    (0..=parts).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::profile;

    #[test]
    fn a_profile_goes_through_a_straight_line_and_ends_where_the_recording_does() {
        let points = profile(&(0..2400).map(f64::from).collect::<Vec<_>>(), 40.0, |v| 20.0 + v / 40.0);
        assert_eq!((points.len(), points[0][0], points[60][0]), (61, 0.0, 60.0));
        for [time_s, deg_c] in points {
            assert!((deg_c - (20.0 + time_s)).abs() < 0.02, "{time_s}: {deg_c}");
        }
    }
}
