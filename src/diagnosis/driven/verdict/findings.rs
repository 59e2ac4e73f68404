//! Writes findings besides the physics, as clauses.

use crate::driven::identification::chaos::Chaos;
use crate::driven::selection::identifiability::{FEWEST_CYCLES, Identifiability};
use crate::driven::selection::known::Known;
use crate::driven::selection::noise_character::NoiseCharacter;
use crate::number::short;

use super::dropped::{Dropped, LeftOut};

/// Terms without a name for one reason, and whether they stay in the repaired model, as a clause.
pub(crate) fn nameless(reason: Dropped, stays: bool, ids: &[&str]) -> String {
    let (ids, one) = (ids.join(", "), ids.len() == 1);
    let fate = match (stays, one) {
        (true, true) => "stays in the repaired model, not named",
        (true, false) => "stay in the repaired model, not named",
        (false, true) => "was tried and removed",
        (false, false) => "were tried and removed",
    };
    format!("{ids} {fate}: {}", dropped(reason))
}

/// States why a term has no name, as a clause.
pub fn dropped(reason: Dropped) -> String {
    match reason {
        Dropped::AtBound => {
            "a parameter is at the bound of its plausible range, where the law no longer is what its name says".into()
        }
        Dropped::MayBeNothing => "the 95 % interval of its strength includes zero".into(),
        Dropped::Worsens => "the prediction of held-out samples became worse".into(),
        Dropped::FollowsInput => {
            "its frequency is that of a line of the input, of a harmonic or of a mixed frequency: the input may cause it"
                .into()
        }
        Dropped::WithinInexactness => {
            "the improvement is too small to be distinguished from the modelling error of the other terms".into()
        }
        Dropped::Twin => "it acts only together with another that it can be confused with".into(),
        Dropped::NoSecondResonance => "no second resonance: its peak does not stand apart from the first".into(),
        Dropped::SmoothCourse => {
            "not a random walk: a smooth trend fits better, so a time-dependent effect is missing or misspecified".into()
        }
        Dropped::Coloured => "autocorrelated readout noise explains this as well as process noise does".into(),
        Dropped::Dependent { by, percent, is_power } => {
            let predicts = match by {
                Known::Input => "the input predicts",
                Known::Motion => "displacement and velocity predict",
                Known::Time => "time predicts",
                Known::Environment => "the environment predicts",
            };
            let what = if is_power { "the variance of its power" } else { "this noise" };
            format!("{predicts} {percent} % of {what}: it is not noise, and an effect is missing")
        }
        Dropped::StandIn => "an approximation only: it does not bring the residual to the noise".into(),
    }
}

/// States what the input and the length of the recording leave undetermined, in sentences.
pub(crate) fn reach(reach: &Identifiability) -> Vec<String> {
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

/// States that the response is chaotic, as a clause and what follows from it.
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

/// States what was left undone, as a clause.
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

/// States the character of the noise, as clauses; none where it is plain. Times count from the
/// recording's first sample on.
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
