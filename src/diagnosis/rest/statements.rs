//! What is stated of every channel's readings and noise besides missing physics.

use super::channel::Channel;
use super::residual::Residual;
use super::statement::Statement;
use crate::recording::Recording;

/// Kurtosis from which noise is called heavy-tailed: that of Student's t with ten degrees of freedom is 4.
const HEAVY: f64 = 4.0;

/// Of all channels, in their order.
pub(super) fn of(recording: &Recording, channels: &[Channel], residuals: &[Residual]) -> Vec<Statement> {
    let mut out = Vec::new();
    for (channel, residual) in channels.iter().zip(residuals) {
        let rate_hz = channel.rate_hz * channel.together as f64;
        let rows_are_places = recording.dropped.is_empty() && recording.averaged.is_none();
        out.extend(channel.disturbances.bad.iter().map(|bad| Statement::BadReading {
            channel: channel.name.clone(),
            row: rows_are_places.then_some(recording.first_sample + bad.at + 1),
            time_s: bad.at as f64 / rate_hz,
            value: bad.value,
            deviations: bad.deviations,
        }));
        if channel.disturbances.tail > 0 && residual.kurtosis > HEAVY {
            out.push(Statement::HeavyTails { channel: channel.name.clone(), kurtosis: residual.kurtosis });
        }
        if residual.uneven && !residual.disturbed {
            out.push(Statement::Uneven {
                channel: channel.name.clone(),
                power: residual.power,
                creep: residual.creep,
            });
        }
    }
    out
}
