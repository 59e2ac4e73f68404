//! A candidate's standing in words.

use super::words::residual;
use proofmass_base::number::{short, significant};
use proofmass_diagnosis::candidate::Kind;
use proofmass_diagnosis::driven::verdict::findings::dropped;
use proofmass_diagnosis::standing::{Gain, Note, Ranked};
use proofmass_diagnosis::trace::Step;
use proofmass_diagnosis::tumble::account::{Fate, SeenFrom};

/// Says what became of a candidate, in a few words.
pub(crate) fn note(note: &Note) -> String {
    match note {
        Note::Screened => "screened out by the linear step".into(),
        Note::Alone => "alone, on the base model".into(),
        Note::AloneByLikelihood { gain, held_out_better } => format!(
            "alone: log-likelihood {}{:.1}; held-out data are predicted {}",
            if *gain < 0.0 { "−" } else { "+" },
            gain.abs(),
            if *held_out_better { "better" } else { "no better" }
        ),
        Note::LagOf(id) => format!("its lag is that of {id}"),
        Note::BesideNamed => "what it adds to the other named effects".into(),
        Note::Dropped(reason) => format!("tried and removed: {}", dropped(*reason)),
        Note::Unnamed(reason) => format!("stays in the repaired model, not named: {}", dropped(*reason)),
        Note::InPoses { judged, fate } => format!("scored by {}{}", residual(*judged), fated(fate)),
        Note::OnePose => "cannot be separated from biases and scale factors in one pose; see the findings".into(),
        Note::Indistinguishable => "cannot be separated from the common scale by any pose: both multiply |f|".into(),
    }
}

/// States what decided that a candidate has no name: the measure and threshold of the last rule that kept it
/// out.
pub(crate) fn why(ranked: &Ranked, trace: &[Step]) -> Option<String> {
    let is_out = |s: &&Step| s.term == Some(ranked.id) && s.is_out();
    let step = trace.iter().rev().filter(|_| !ranked.named).find(is_out)?;
    let measured = step.value.zip(step.threshold).map(|(value, threshold)| {
        let quantity = step.gate.quantity();
        format!(": {quantity} {}, threshold {}", short(value), short(threshold))
    });
    // A reason in words stands in the note already.
    let rule = format!("rule `{}`", step.gate.id());
    match (measured, &ranked.note) {
        (Some(measured), Note::Dropped(_)) => Some(rule + &measured),
        (None, Note::Dropped(_)) => None,
        (measured, _) => Some(format!("not added, {rule}{}", measured.unwrap_or_default())),
    }
}

fn fated(fate: &Fate) -> String {
    match fate {
        Fate::Named => ", together with the other named effects".into(),
        Fate::Withdrawn => "; it helps, but the residual stays above the noise".into(),
        Fate::Undetermined => "; not determined by these poses".into(),
        Fate::Implausible => "; fitted outside its plausible range".into(),
        Fate::Absent { beside_named, seen_from } => {
            let beside = if *beside_named { ", together with the named effects" } else { "" };
            let seen = match seen_from {
                None => String::new(),
                Some(SeenFrom::Strength { value, unit }) => {
                    format!("; above {} {unit} it would have been detected", short(*value))
                }
                Some(SeenFrom::EarthRateDegH(value)) => {
                    format!(
                        "; the Earth's rate is 15.04 °/h, and rates below {} °/h could not be detected here",
                        short(*value)
                    )
                }
            };
            format!("{beside}{seen}")
        }
    }
}

/// Explains what the column of gains means for a kind of recording.
pub(crate) fn meaning_of_gains(kind: Kind) -> &'static str {
    match kind {
        Kind::Driven => {
            "The gain is the fraction of the held-out error of free simulation above the noise that the candidate \
             removes (1 is all of it), with its 95 % interval; for a noise term, which no simulation predicts sample \
             by sample, what it adds to the log-likelihood per held-out sample."
        }
        Kind::Tumble | Kind::Trajectory | Kind::Response => {
            "The gain is the fraction of the held-out error above the noise that the candidate removes (1 is all of \
             it), with its 95 % interval."
        }
        Kind::Static => {
            "The gain is measured on held-out data: for a noise law, the fraction of the chosen model's gain in \
             log-likelihood; for a drift curve, the fraction of the mean square that it removes."
        }
    }
}

/// A gain in a table, with its interval where it has one; in-sample ones are marked.
pub(crate) fn gain(gain: Gain) -> [String; 2] {
    let interval =
        gain.ci95().map_or("–".to_owned(), |[low, high]| format!("{} to {}", fraction(low), fraction(high)));
    let value = match gain {
        Gain::HeldOut { value, .. } => fraction(value),
        Gain::LogScore { value } => format!("{} (log-likelihood)", significant(value, 3)),
        Gain::InSample { value } => format!("{} (fitted data)", fraction(value)),
    };
    [value, interval]
}

/// A share of one: three decimals at most, for its interval is wider than a fourth.
fn fraction(value: f64) -> String {
    if value.abs() < 5e-4 { "0".into() } else { format!("{value:.3}").replacen('-', "−", 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_on_fitted_data_never_looks_like_one_on_held_out_data() {
        let held_out = gain(Gain::held_out(0.5, [0.4, 0.6]));
        assert_eq!(held_out, ["0.500", "0.400 to 0.600"]);
        assert_eq!(gain(Gain::held_out(0.5, [f64::NEG_INFINITY, f64::INFINITY])), ["0.500", "–"]);
        assert_eq!(gain(Gain::LogScore { value: 0.5 }), ["0.500 (log-likelihood)", "–"]);
        assert_eq!(gain(Gain::InSample { value: 0.5 }), ["0.500 (fitted data)", "–"]);
    }
}
