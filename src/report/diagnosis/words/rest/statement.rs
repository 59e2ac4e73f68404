//! Statements about a still channel's readings and noise in words.

use std::f64::consts::{PI, TAU};

use proofmass_base::number::{duration, short, significant, with_uncertainty};
use proofmass_diagnosis::rest::statement::{Difference, Earth, Filter, Follows, Statement};

use crate::grouped::{Said, grouped};

/// Returns all of them in sentences; `unit` is that of the `channels`. What is alike of several
/// channels is stated once, and so are many bad readings of one.
pub(crate) fn statements(all: &[Statement], unit: &str, channels: usize) -> Vec<String> {
    let alike: Vec<Said> = all.iter().filter_map(of_noise).collect();
    let mut out = grouped(&alike, channels);
    let others: Vec<&Statement> = all.iter().filter(|one| of_noise(one).is_none()).collect();
    let mut rest = &others[..];
    while let Some(first) = rest.first() {
        let channel = |s: &Statement| match s {
            Statement::BadReading { channel, .. } => Some(channel.clone()),
            _ => None,
        };
        let bad = channel(first).map_or(0, |own| rest.iter().take_while(|s| channel(s).as_ref() == Some(&own)).count());
        let (now, later) = rest.split_at(bad.max(1));
        if bad > ONE_BY_ONE {
            out.push(bad_readings(now));
        } else {
            out.extend(now.iter().map(|s| statement(s, unit)));
        }
        rest = later;
    }
    out
}

/// Bad readings of a channel that are stated one by one, at most.
const ONE_BY_ONE: usize = 3;

/// Many bad readings of one channel.
fn bad_readings(all: &[&Statement]) -> String {
    let mut places = Vec::new();
    let (mut name, mut largest) = ("", 0.0f64);
    for one in all {
        if let Statement::BadReading { channel, row, time_s, deviations, .. } = one {
            name = channel;
            largest = largest.max(*deviations);
            places.push(row.map_or_else(|| duration(*time_s), |row| format!("row {row}")));
        }
    }
    format!(
        "`{name}`: {} readings lie up to {} standard deviations off and were left out: {}",
        all.len(),
        short(largest),
        places.join(", ")
    )
}

/// States one of them that is not of a channel's noise.
fn statement(statement: &Statement, unit: &str) -> String {
    match statement {
        Statement::BadReading { channel, row, time_s, value, deviations } => {
            let place = match row {
                Some(row) => format!("in row {row} ({})", duration(*time_s)),
                None => format!("at {}", duration(*time_s)),
            };
            format!(
                "`{channel}`: the reading {} {unit} {place} lies {} standard deviations off and was left out",
                short(*value),
                short(*deviations)
            )
        }
        Statement::Mean { channel, value, of_recording, of_bias, follows } => format!(
            "`{channel}`: mean {} {unit}; the bias drifts, which does not average out: {} {} {unit}",
            with_uncertainty(*value, *of_recording),
            taken(follows),
            with_uncertainty(*value, *of_bias)
        ),
        _ => reference(statement, unit),
    }
}

/// Place or course at which the bias is stated.
fn taken(follows: &[Follows]) -> String {
    let of = |of: &Follows| match of {
        Follows::Column { name, mean } => format!("`{name}` (mean {})", short(*mean)),
        Follows::Time => "time".to_owned(),
    };
    let mut each: Vec<String> = Vec::new();
    // A ramp and a warm-up are both a course of time.
    for one in follows.iter().map(of) {
        if !each.contains(&one) {
            each.push(one);
        }
    }
    match each.is_empty() {
        true => "at the first sample it is".to_owned(),
        false => format!("its mean over the course of {} is", each.join(" and of ")),
    }
}

/// Returns what is stated of a channel's noise, which others may have alike; `None` for all else.
fn of_noise(statement: &Statement) -> Option<Said> {
    let (channel, sentence) = match statement {
        Statement::HeavyTails { channel, kurtosis } => (
            channel,
            format!(
                "its noise has heavier tails than normal noise (kurtosis {}, normal 3); no test used here relies on \
                 normal noise",
                short(*kurtosis)
            ),
        ),
        Statement::Filtered { channel, filter, lost, rate_hz } => (
            channel,
            format!(
                "the noise loses {:.0} % of its power towards {} Hz, as with {} in the sensor; the white level stated is \
                 that at lower frequencies",
                100.0 * lost,
                short(rate_hz / 2.0),
                shape(*filter, *rate_hz)
            ),
        ),
        Statement::Uneven { channel, power, creep } => {
            let [low, high] = power.map(short);
            let how = match creep {
                Some(creep) => format!(
                    "from end to end its power {} by {} of its mean",
                    if *creep > 0.0 { "grows" } else { "falls" },
                    short(creep.abs())
                ),
                None => format!("its power is {low} to {high} times its mean"),
            };
            (channel, format!("the noise is uneven, {how}; stated levels are means over the recording"))
        }
        Statement::BadReading { .. } | Statement::Mean { .. } | Statement::Reference { .. } => return None,
    };
    // A power that is a range already does not become one of ranges.
    let ranges = !matches!(statement, Statement::Uneven { .. });
    Some(Said { of: format!("`{channel}`"), sentence, ranges })
}

/// The length of the three means next to what the Earth shows.
fn reference(of: &Statement, unit: &str) -> String {
    let Statement::Reference { earth, length, ci95, expected, latitude_deg, height_m, difference } = of else {
        return String::new();
    };
    let off = length - expected;
    let more = if off > 0.0 { "more" } else { "less" };
    let [size, ppm] = [off.abs(), 1e6 * (off / expected).abs()].map(short);
    let [low, high] = ci95.map(|v| significant(v, 6));
    let [length, expected] = [*length, *expected];
    let found = format!("the vector of the three means has length {} {unit} ({low} to {high})", significant(length, 6));
    let latitude = short(*latitude_deg);
    let place = match height_m {
        Some(height_m) => format!("{latitude}° and {} m", short(*height_m)),
        None => format!("{latitude}° and 0 m, assumed because height_m is not given,"),
    };
    match earth {
        Earth::Gravity => {
            let what = format!("`local-gravity`: {found}, gravity at {place} is {} {unit}", significant(expected, 6));
            match difference {
                Difference::None => {
                    format!("{what}: they agree; a scale error and a bias that cancel along gravity would not show")
                }
                Difference::Anomaly => {
                    format!(
                        "{what}: {size} {unit} {more}, which within its interval is as little as gravity commonly \
                        deviates from the ellipsoid's"
                    )
                }
                Difference::Latitude(other) => format!(
                    "{what}: {size} {unit} {more}; a scale error of {ppm} ppm, biases of at least {size} {unit} and \
                    gravity at {}° look alike in one pose, so none is named",
                    short(*other)
                ),
                Difference::Sensor => format!(
                    "{what}: {size} {unit} {more}, and no latitude at this height has such gravity: it is a scale \
                    error of {ppm} ppm or biases of at least {size} {unit}, which look alike in one pose"
                ),
            }
        }
        Earth::Rate => {
            let what = format!("`earth-rate`: {found}, the Earth turns at {} {unit}", significant(expected, 6));
            let reach = short(length + expected);
            match difference {
                Difference::Sensor => format!(
                    "{what}: {size} {unit} {more}, so biases of {size} to {reach} {unit} together, or a scale error, \
                    are in the means"
                ),
                _ => format!("{what}: they agree; biases of up to {reach} {unit} together could hide in one pose"),
            }
        }
    }
}

/// A filter by its usual name.
fn shape(filter: Filter, rate_hz: f64) -> String {
    match filter {
        Filter::Smoothing(1) => "a two-sample averaging filter".into(),
        Filter::Smoothing(2) => "a two-sample averaging filter, applied twice".into(),
        Filter::Smoothing(times) => format!("a two-sample averaging filter, applied {times} times"),
        Filter::MovingAverage { readings, times: 1 } => {
            format!("a moving-average filter of {readings} readings")
        }
        Filter::MovingAverage { readings, .. } => {
            format!("a moving-average filter of {readings} readings, applied twice")
        }
        Filter::OnePole(memory) => format!("a one-pole filter at {} Hz", short(rate_hz / (TAU * memory))),
        Filter::PoleTwice(memory) => {
            format!("a one-pole filter at {} Hz, applied twice", short(rate_hz / (TAU * memory)))
        }
        Filter::TwoPoles { cut, quality } => {
            format!("a two-pole filter at {} Hz (quality factor {})", short(rate_hz * cut.atan() / PI), short(quality))
        }
    }
}
