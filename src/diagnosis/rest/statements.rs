//! States what is stated of every channel's readings and noise besides missing physics.

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted};
use super::residual::Residual;
use super::spectrum::Law;
use super::statement::Statement;
use crate::recording::Recording;

/// Kurtosis from which noise is called heavy-tailed: that of Student's t with ten degrees of
/// freedom is 4.
const HEAVY: f64 = 4.0;

/// Of all channels, in their order.
pub(super) fn of(
    recording: &Recording,
    channels: &[Channel],
    finals: &[Fitted],
    residuals: &[Residual],
) -> Vec<Statement> {
    let mut out = Vec::new();
    for ((channel, fitted), residual) in channels.iter().zip(finals).zip(residuals) {
        out.extend(filtered(channel, fitted));
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
            out.push(Statement::Uneven { channel: channel.name.clone(), power: residual.power, creep: residual.creep });
        }
    }
    out
}

/// Returns what a filter in the sensor takes away.
fn filtered(channel: &Channel, fitted: &Fitted) -> Option<Statement> {
    let term = fitted.terms.iter().find(|t| t.cause == Cause::BandLimit)?;
    let Addition::Law(Law::Filtered(filter)) = term.addition else { return None };
    let (total, rest) = (fitted.white().0, fitted.strengths.values[0]);
    let lost = 1.0 - (rest + (total - rest) * filter.power(std::f64::consts::FRAC_PI_2)) / total;
    Some(Statement::Filtered { channel: channel.name.clone(), filter, lost, rate_hz: channel.rate_hz })
}
