//! Names of experiments, limits and rivals.

use proofmass_base::number::short;
use proofmass_diagnosis::plan::experiment::{Experiment, Shape};
use proofmass_diagnosis::plan::limits::Limit;
use proofmass_diagnosis::plan::search::Planned;

/// "a sine of 5 Hz at 2 m/s²".
pub(super) fn experiment(e: &Experiment) -> String {
    let at = format!("{} m/s²", short(e.level));
    let hz = |hz: f64| short(hz);
    let said = match e.shape {
        Shape::Sine { hz: f } => format!("a sine of {} Hz and {at}", hz(f)),
        Shape::Levels { from_hz, to_hz } => {
            format!("a ladder of eight sines from {} to {} Hz that rises to {at}", hz(from_hz), hz(to_hz))
        }
        Shape::Frequencies { from_hz, to_hz } => {
            format!("a ladder of eight sines from {} to {} Hz at {at}", hz(from_hz), hz(to_hz))
        }
        Shape::Chirp { from_hz, to_hz } => format!("a chirp from {} to {} Hz at {at}", hz(from_hz), hz(to_hz)),
        Shape::Multisine { from_hz, to_hz } => {
            format!("a multisine from {} to {} Hz with a peak of {at}", hz(from_hz), hz(to_hz))
        }
        Shape::Steps { every_s } => format!("steps between −{at} and +{at}, each {} s long", short(every_s)),
    };
    format!("{said}, for {} s ({} samples at {} Hz)", short(e.seconds), e.samples(), short(e.rate_hz))
}

/// Id of the kind in the document.
pub(super) fn kind(shape: &Shape) -> &'static str {
    match shape {
        Shape::Sine { .. } => "sine",
        Shape::Levels { .. } => "sine-ladder-of-levels",
        Shape::Frequencies { .. } => "sine-ladder-of-frequencies",
        Shape::Chirp { .. } => "chirp",
        Shape::Multisine { .. } => "multisine",
        Shape::Steps { .. } => "steps",
    }
}

/// "largest input".
pub(super) fn limit(limit: Limit) -> &'static str {
    match limit {
        Limit::Input => "largest input",
        Limit::Length => "longest recording",
        Limit::Rate => "sampling rate",
    }
}

/// Key of a limit in limits.toml.
pub(super) fn key(limit: Limit) -> &'static str {
    match limit {
        Limit::Input => "largest_input_m_s2",
        Limit::Length => "longest_s",
        Limit::Rate => "rate_hz",
    }
}

/// Ids of the rivals.
pub(super) fn rivals(planned: &Planned) -> Vec<&'static str> {
    planned.question.rivals.iter().map(|k| k.term.id()).collect()
}

/// "97 %", never certain: what rounds to 100 % is more than 99.9 %.
pub(super) fn percent(p: f64) -> String {
    if p > 0.999 {
        "more than 99.9 %".into()
    } else if p < 0.001 {
        "less than 0.1 %".into()
    } else {
        format!("{} %", short(100.0 * p))
    }
}
