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
        Outcome::Undecidable if effects.is_empty() => {
            "Record longer, or drive harder: the residual must rise well above the noise before its cause can be \
             identified."
                .to_owned()
        }
        Outcome::Undecidable if account.few_cycles.is_some() => {
            format!("Record for at least {} s, ten cycles of the resonance.", short(10.0 / account.resonance_hz))
        }
        Outcome::Undecidable if account.is_linear_class => format!(
            "Drive with a sweep or noise from {} to {} Hz (a third of the resonance to three times it): a delay \
             shifts the phase in proportion to frequency, a low-pass also lowers the amplitude, feedthrough \
             flattens the roll-off above the resonance, and a second mode has its own peak.",
            short(account.resonance_hz / 3.0),
            short(3.0 * account.resonance_hz)
        ),
        Outcome::Undecidable => {
            let tied: Vec<&str> =
                effects.iter().filter(|e| !e.confusable_with.is_empty()).map(|e| e.id.as_str()).collect();
            format!(
                "Record again at other amplitudes and a wider band ({source} at a third and at three times this \
                 level, with power well above the resonance): {} then separate, because they scale differently with \
                 amplitude and frequency.",
                listed(&tied.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>())
            )
        }
        Outcome::Explained => format!(
            "Confirm on a recording at a different level ({source} at twice the amplitude): the parameters stated must stay \
             within their intervals."
        ),
        Outcome::Unexplained => format!(
            "{} at one frequency with the amplitude stepped up and down: an effect with memory differs between the \
             two directions, an amplitude-dependent one bends the response, and noise does neither.",
            if input { "Drive" } else { "Release" }
        ),
        Outcome::Adequate => format!(
            "{} harder or longer: smaller effects then rise above the noise. `proofmass trial --like RECORDING \
             --model MODEL.toml` plants each candidate in copies of this recording and reports from which size it \
             would have been identified.",
            if input { "Drive" } else { "Release" }
        ),
    }
}
