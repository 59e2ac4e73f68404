//! The verdict on a still sensor in words.

use super::cause::Cause;
use super::channel::{Addition, Channel, Fitted};
use super::effects::Found;
use super::residual::TOLERANCE;
use super::telegraph::REPLICAS;
use crate::diagnosis::model;
use crate::diagnosis::verdict::{self, Effect, Outcome};
use crate::number::short;

/// The verdict in a sentence; `well` says of every channel whether its own model leaves noise.
pub(super) fn sentence(
    outcome: Outcome,
    effects: &[Effect],
    location: &str,
    channels: &[Channel],
    well: &[bool],
) -> String {
    let named = verdict::named(effects);
    match outcome {
        Outcome::Adequate => {
            "A constant and white noise describe every channel: nothing is missing that this recording could show."
                .into()
        }
        Outcome::Explained => format!("The model leaves out {named}. With that, what is left is noise."),
        Outcome::Undecidable => {
            let (ties, sure): (Vec<Effect>, Vec<Effect>) =
                effects.iter().cloned().partition(|e| !e.confusable_with.is_empty());
            let tie =
                |e: &Effect| format!("{} or {} in {}", e.id, e.confusable_with.join(" or "), e.channels.join(", "));
            let ties = ties.iter().map(tie).collect::<Vec<_>>().join("; ");
            if sure.is_empty() {
                format!("The model leaves something out, and the recording cannot tell which: {ties}.")
            } else {
                format!(
                    "The model leaves out {}; and something else, of which the recording cannot tell which: {ties}.",
                    verdict::named(&sure)
                )
            }
        }
        Outcome::Unexplained => {
            let of = |is: bool| -> String {
                let names = channels.iter().zip(well).filter(|(_, w)| **w == is).map(|(c, _)| c.name.as_str());
                names.collect::<Vec<_>>().join(", ")
            };
            let left_out = if effects.is_empty() {
                "The mismatch is real and nothing in the library accounts for it".to_owned()
            } else {
                format!("The model leaves out {named}; and more that nothing in the library accounts for")
            };
            let others = match of(true) {
                fine if fine.is_empty() => String::new(),
                fine => format!(" What is left of {fine} is noise."),
            };
            if channels.len() == 1 {
                format!("{left_out}. {location}")
            } else {
                format!("{left_out} in {}. {location}{others}", of(false))
            }
        }
    }
}

/// What would decide or confirm.
pub(super) fn next_experiment(outcome: Outcome, effects: &[Found], model: &model::Static) -> String {
    let temperature = effects.iter().any(|e| e.cause == Cause::TemperatureSensitivity);
    match outcome {
        _ if temperature && model.columns.environment.is_empty() => {
            "Log the temperature beside the sensor and name its column under environment: that confirms the cause and gives \
             the slopes."
        }
        Outcome::Adequate => "A longer log: slow terms show only at averaging times that it holds several of.",
        Outcome::Explained => "A second log on another day: the same coefficients should come out.",
        Outcome::Undecidable => "A log four times as long: the candidates part at longer averaging times.",
        Outcome::Unexplained => {
            "Log again on a quiet foundation, at another sampling rate and with temperature beside it: what moves with which \
             tells vibration, aliasing and environment apart."
        }
    }
    .into()
}

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
