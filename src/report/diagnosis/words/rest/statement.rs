//! Statements about a still channel's readings and noise in words.

use crate::diagnosis::rest::statement::Statement;
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
