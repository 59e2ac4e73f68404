//! What is found besides the physics, as clauses.

use crate::driven::identification::chaos::Chaos;
use crate::driven::selection::identifiability::{FEWEST_CYCLES, Reach};
use crate::driven::selection::known::Known;
use crate::driven::selection::noise_character::NoiseCharacter;
use crate::number::short;

use super::dropped::{Dropped, LeftOut};

/// Why a term has no name, as a clause.
pub fn dropped(reason: Dropped) -> String {
    match reason {
        Dropped::AtBound => {
            "one of its parameters is at the bound of its plausible range, where it no longer is what its name says"
                .into()
        }
        Dropped::MayBeNothing => "the 95 % interval of its strength includes zero".into(),
        Dropped::Worsens => "made the prediction of held-out samples worse".into(),
        Dropped::FollowsInput => {
            "its frequency is that of a line of the input, of a harmonic or of a mixed frequency: the input may cause it"
                .into()
        }
        Dropped::FollowsRounding => "follows only the rounding of the readings; kept in the model, not named".into(),
        Dropped::SmallerThanTheRest => "smaller than the unexplained residual; kept in the model, not named".into(),
        Dropped::WithinInexactness => {
            "too small, compared with what the other terms explain, to be distinguished from their modelling error; \
             kept in the model, not named"
                .into()
        }
        Dropped::Twin => "only together with another that it can be confused with".into(),
        Dropped::Series(series) => format!("only in a series: {}", series.words()),
        Dropped::PushesAlong => {
            "no friction: fitted, it pushes along the velocity instead of opposing it; kept in the model, not named"
                .into()
        }
        Dropped::NoSecondResonance => "no second resonance: its peak does not stand apart from the first".into(),
        Dropped::SmoothCourse => {
            "not a walk: a smooth course of time describes it better, so a law of time is missing or not exact".into()
        }
        Dropped::Coloured => {
            "no noise inside the sensor: readout noise whose neighbours are correlated describes it as well".into()
        }
        Dropped::Dependent { by, percent, is_power } => {
            let by = match by {
                Known::Input => "the input",
                Known::Motion => "displacement and velocity",
                Known::Time => "time",
                Known::Environment => "the environment",
            };
            let what = if is_power { "of the variance of its power" } else { "of what it takes up" };
            format!("not independent: {percent} % {what} follows from {by}, so a law is missing")
        }
        Dropped::StandIn => "an approximation only: it does not bring the residual to the noise".into(),
    }
}

/// What the input and the length of the recording leave undetermined, in sentences.
pub(crate) fn reach(reach: &Reach) -> Vec<String> {
    let mut out = Vec::new();
    if reach.tells_nothing_linear_apart() {
        let lines: Vec<String> = reach.lines_hz.iter().map(|f| short(*f)).collect();
        out.push(format!(
            "the input has {} that {} the reading, at {} Hz: in steady state no linear effect (a delay, a low-pass, \
             feedthrough, another mode, another ω₀, ζ or gain) can be distinguished by {}",
            if lines.len() == 1 { "one spectral line".to_owned() } else { format!("{} spectral lines", lines.len()) },
            if lines.len() == 1 { "moves" } else { "move" },
            lines.join(" and "),
            if lines.len() == 1 { "it" } else { "them" }
        ));
    }
    if let Some(cycles) = reach.few_cycles {
        out.push(format!(
            "the recording holds {} cycles of the resonance, and ω₀ and ζ need about {FEWEST_CYCLES}: any further \
             effect is not determined",
            short(cycles)
        ));
    }
    out
}

/// That the response is chaotic, as a clause and what follows from it.
pub(crate) fn chaos(chaos: &Chaos) -> [String; 2] {
    let wells = chaos.wells.map_or(String::new(), |[a, b]| {
        format!(
            "; the mass has two wells, at readings of {} and {}, and the model is written about the stiffer one",
            short(a),
            short(b)
        )
    });
    [
        format!(
            "the response is chaotic (largest Lyapunov exponent {} 1/s): a simulation can follow it for about {} s",
            short(chaos.exponent_per_s),
            short(chaos.horizon_s)
        ),
        format!(
            ": models are compared in windows of {} s, each started from its best-fitting state, and all errors are \
             of such windows; candidates with internal states and noise terms were not tried{wells}",
            short(chaos.window_s)
        ),
    ]
}

/// What was left undone, as a clause.
pub(crate) fn left_out(what: LeftOut) -> &'static str {
    match what {
        LeftOut::Profiles => {
            "intervals of non-smooth laws are from the quadratic approximation: their profiles were not finished"
        }
        LeftOut::WeighingAgain => {
            "terms were not compared again after one that made the prediction worse was \
                                   removed"
        }
    }
}

/// What kind of noise it is, as clauses; none where it is plain. Times count from the recording's
/// first sample on.
pub fn noise(noise: &NoiseCharacter, rate_hz: f64) -> Vec<String> {
    let tails = noise.tails.map(|beyond| {
        format!(
            "the noise is heavy-tailed: {} % of the readings lie more than 3.5 standard deviations away, against \
             0.047 % for normal noise",
            short(100.0 * beyond)
        )
    });
    let growth = noise.growth.map(|ratio| {
        let word = if ratio > 1.0 { "grows" } else { "fades" };
        format!(
            "the noise {word} with time: in the last quarter it is {} times as strong as in the first",
            short(ratio)
        )
    });
    let with_amplitude = noise.with_amplitude.map(|ratio| {
        format!(
            "the noise depends on amplitude: in the quarter of the samples with the largest motion it is {} times as strong as in \
             that with the smallest",
            short(ratio)
        )
    });
    let stretch = noise.stretch.map(|s| {
        format!(
            "the noise is {} times as strong from {} to {} s as elsewhere",
            short(s.ratio),
            short(s.from as f64 / rate_hz),
            short(s.to as f64 / rate_hz)
        )
    });
    let memory = noise.memory.map(|memory| {
        format!(
            "the noise is coloured: the errors of neighbouring readings have a correlation of {}; once that is taken \
             out, less than 1 % of the residual can be predicted",
            short(memory.neighbour)
        )
    });
    [tails, growth, with_amplitude, stretch, memory].into_iter().flatten().collect()
}
