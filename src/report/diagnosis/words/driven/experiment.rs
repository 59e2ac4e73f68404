//! States what to record next after a verdict on a driven recording, or a ring-down.

use proofmass_base::number::short;
use proofmass_diagnosis::answer::Answer;
use proofmass_diagnosis::driven::intake::notes::Broken;
use proofmass_diagnosis::driven::verdict::detail::Account;
use proofmass_diagnosis::verdict::Outcome;

use super::super::listed::listed;

/// Says what would decide or confirm.
pub(crate) fn next_experiment(answer: &Answer, account: &Account) -> String {
    let (effects, input) = (&answer.effects, account.has_input);
    let source = if input { "drive" } else { "release" };
    match &account.broken {
        Some(Broken::Exchanged { input, output }) => {
            return format!(
                "Exchange the two columns in the model file (input = \"{output}\", output = \"{input}\") and diagnose again."
            );
        }
        Some(Broken::Rescaled { row, .. }) => {
            return format!("Cut the recording at row {row}, or correct the column, and diagnose again.");
        }
        None => {}
    }
    match answer.outcome {
        Outcome::Undecidable if effects.is_empty() && account.runs_away => {
            "Check the columns: the input ought to be a force, and the output where it takes a mass.".to_owned()
        }
        Outcome::Undecidable if effects.is_empty() => {
            format!(
                "Record longer, or {source} harder: the residual must rise well above the noise before its cause can be \
                 identified."
            )
        }
        Outcome::Undecidable if account.few_cycles.is_some() => {
            format!("Record for at least {} s, ten cycles of the resonance.", short(10.0 / account.resonance_hz))
        }
        Outcome::Undecidable if account.is_linear_class && account.lines_hz.is_empty() => {
            "If a sensor is what was recorded, next to what it measures, its scale is the ratio of the two, and no resonator is \
             in it. A resonator needs an input up to three times its resonance, and readings at ten times."
                .to_owned()
        }
        Outcome::Undecidable if account.is_linear_class => format!(
            "Drive with a sweep or noise from {} to {} Hz (a third of the resonance to three times it): a delay \
             shifts the phase in proportion to frequency, a low-pass also lowers the amplitude, feedthrough \
             flattens the roll-off above the resonance, and a second mode has its own peak.",
            short(account.resonance_hz / 3.0),
            short(3.0 * account.resonance_hz)
        ),
        Outcome::Undecidable => {
            let mut tied: Vec<String> =
                effects.iter().filter(|e| !e.confusable_with.is_empty()).map(|e| e.id.clone()).collect();
            tied.dedup();
            let is_tied = |id: &str| tied.iter().any(|t| t == id);
            if !input && is_tied("warm-up") && is_tied("readout-highpass") {
                return "Hold the mass aside for ten time constants before it is let go, and record that, too: while \
                        the mass is held, an AC-coupled reading fades to its offset, and any other stays."
                    .to_owned();
            }
            let names = listed(&tied);
            match input {
                true => format!(
                    "Record again at other amplitudes and a wider band (drive at a third and at three times this \
                     level, with power well above the resonance): {names} then separate, because they scale \
                     differently with amplitude and frequency."
                ),
                false => format!(
                    "Release again at a third of this amplitude and at three times it: {names} then separate, because \
                     they scale differently with amplitude."
                ),
            }
        }
        Outcome::Explained => format!(
            "Confirm on a recording at a different level ({source} at twice the amplitude): the parameters stated must stay \
             within their intervals."
        ),
        Outcome::Unexplained if input => {
            "Drive at one frequency with the amplitude stepped up and down: an effect with \
                                          memory differs between the two directions, an amplitude-dependent one bends \
                                          the response, and noise does neither."
                .to_owned()
        }
        Outcome::Unexplained => "Release several times, from several amplitudes: what depends on the amplitude bends \
                                 frequency and decay at the same amplitude each time, what depends on time at the same \
                                 second, and noise at neither."
            .to_owned(),
        Outcome::Adequate => format!(
            "{} harder or longer: smaller effects then rise above the noise. `proofmass trial --like RECORDING \
             --model MODEL.toml` plants each candidate in copies of this recording and reports from which size it \
             would have been identified.",
            if input { "Drive" } else { "Release" }
        ),
    }
}
