//! Statements about a still channel's readings and noise in words.

use std::f64::consts::{PI, TAU};

use crate::diagnosis::rest::statement::{Filter, Statement};
use crate::number::{duration, short};

/// One of them in a sentence; `unit` is that of the channels.
pub fn statement(statement: &Statement, unit: &str) -> String {
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
        Statement::HeavyTails { channel, kurtosis } => format!(
            "`{channel}`: its noise has heavier tails than normal noise (kurtosis {}, normal 3); no test here rests on them",
            short(*kurtosis)
        ),
        Statement::Filtered { channel, filter, lost, rate_hz } => format!(
            "`{channel}`: the noise loses {:.0} % of its power towards {} Hz, as behind {} in the sensor; the white level \
             stated is that of lower frequencies",
            100.0 * lost,
            short(rate_hz / 2.0),
            shape(*filter, *rate_hz)
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
            format!("`{channel}`: the noise is uneven, {how}; stated levels are means over the recording")
        }
    }
}

/// A filter by its usual name.
fn shape(filter: Filter, rate_hz: f64) -> String {
    match filter {
        Filter::Smoothing(1) => "a filter that averages two neighbours".into(),
        Filter::Smoothing(times) => format!("a filter that averages two neighbours {times} times over"),
        Filter::MovingAverage { readings, times: 1 } => {
            format!("a filter that is a moving average of {readings} readings")
        }
        Filter::MovingAverage { readings, .. } => {
            format!("a filter that is a moving average of {readings} readings, twice over")
        }
        Filter::OnePole(memory) => format!("a filter of one pole at {} Hz", short(rate_hz / (TAU * memory))),
        Filter::TwoPoles { cut, quality } => format!(
            "a filter of two poles at {} Hz (quality factor {})",
            short(rate_hz * cut.atan() / PI),
            short(quality)
        ),
    }
}
