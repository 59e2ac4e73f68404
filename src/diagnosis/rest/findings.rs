//! What is found besides the physics, in sentences.

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted};
use super::residual::TOLERANCE;
use super::telegraph::REPLICAS;
use crate::number::short;

/// Where what is left is no noise as modelled, yet near enough to it.
pub(super) fn within_tolerance() -> String {
    format!(
        "what is left differs from noise as modelled by more than chance, but by less than the {:.0} % of its power that \
         count as a mismatch here",
        100.0 * TOLERANCE
    )
}

/// What a filter in the sensor takes away, as a finding: it is no error that drifts.
pub(super) fn band_limit(channel: &Channel, fitted: &Fitted) -> Option<String> {
    let term = fitted.terms.iter().find(|t| t.cause == Cause::BandLimit)?;
    let Addition::Law(law) = term.addition else { return None };
    let (total, rest) = (fitted.white().0, fitted.strengths.values[0]);
    let share = 1.0 - (rest + (total - rest) * law.variance(std::f64::consts::FRAC_PI_2)) / total;
    Some(format!(
        "`{}`: the noise loses {:.0} % of its power towards {} Hz, as behind a filter or averaging in the sensor; the white \
         level stated is that of lower frequencies",
        channel.name,
        100.0 * share,
        short(channel.rate_hz / 2.0)
    ))
}

/// Whether a process named from its spectrum could be hops between two levels, which have the same one.
pub(super) fn popcorn(channel: &Channel, told: Option<usize>) -> Option<String> {
    let told = told?;
    Some(format!(
        "`{}`: hops between two levels (popcorn noise) have the spectrum of `gauss-markov`; as strong and as slow as here they \
         would have shown in {told} of {REPLICAS} simulated recordings{}",
        channel.name,
        if 10 * told >= 9 * REPLICAS as usize { ", and none show" } else { ": they are not excluded" }
    ))
}
