//! A verdict's numbers against each other, before it is written: what contradicts itself is not
//! said.
//!
//! One row a rule, the same for every kind. A verdict that claims more than its own numbers bear
//! falls to `unexplained`; a number that has no meaning is left out. Not for the evidence behind a
//! verdict (`ruling`).

use super::answer::Answer;
use super::verdict::{Outcome, Score};

/// A rule that an answer breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contradiction {
    /// `adequate`, and the base model's error is several times the noise measured apart from it.
    AdequateAboveNoise,
    /// `explained`, and what is left is not noise while the error on held-out data has grown.
    ExplainedAndWorse,
    /// `explained`, and nothing is named.
    ExplainedWithoutName,
    /// An interval that does not hold its own value.
    IntervalMissesValue,
    /// A model with named effects is scored, and nothing is named.
    RepairedWithoutName,
    /// A score that is no number.
    NotANumber,
}

impl Contradiction {
    /// Returns it as a finding; `None` where only a meaningless number was left out.
    pub fn words(self) -> Option<&'static str> {
        match self {
            Self::AdequateAboveNoise => Some(
                "the base model's error is several times the independently measured noise: the verdict is not \
                      `adequate`",
            ),
            Self::ExplainedAndWorse => Some(
                "with the named effects the held-out error grows and the residual is not noise: the verdict is not \
                 `explained`",
            ),
            Self::ExplainedWithoutName => Some("no effect is named: the verdict is not `explained`"),
            Self::IntervalMissesValue => Some(
                "an interval does not contain its own estimate: the fit is unreliable, so the verdict is not \
                 `explained`",
            ),
            Self::RepairedWithoutName => None,
            Self::NotANumber => Some("an error on held-out data is not finite and was left out"),
        }
    }
}

/// Root-mean-square error over the noise from which on it is several times the noise.
const SEVERAL: f64 = 3.0;
/// Growth of the held-out error that noise terms, which weigh the samples differently, may cause.
const BY_NOISE_TERMS: f64 = 1.01;

/// Holds what breaks a rule.
type Test = fn(&Answer) -> bool;
/// Holds what is done about it.
type Remedy = fn(&mut Answer);

const RULES: &[(Contradiction, Test, Remedy)] = &[
    (Contradiction::NotANumber, has_no_number, without_what_is_no_number),
    (Contradiction::RepairedWithoutName, is_repaired_without_name, without_repair),
    (Contradiction::AdequateAboveNoise, is_adequate_above_noise, unexplained),
    (Contradiction::ExplainedWithoutName, |a| a.outcome == Outcome::Explained && a.effects.is_empty(), unexplained),
    (Contradiction::ExplainedAndWorse, is_explained_and_worse, unexplained),
    (Contradiction::IntervalMissesValue, |a| a.outcome == Outcome::Explained && misses(a), unexplained),
];

/// Brings an answer into accord with its own numbers; what was wrong, in the order of the rules.
pub(crate) fn settle(answer: &mut Answer) -> Vec<Contradiction> {
    let mut broken = Vec::new();
    for (contradiction, test, remedy) in RULES {
        if test(answer) {
            remedy(answer);
            broken.push(*contradiction);
        }
    }
    answer.findings.extend(broken.iter().filter_map(|c| c.words()).map(str::to_owned));
    broken
}

fn unexplained(answer: &mut Answer) {
    answer.outcome = Outcome::Unexplained;
}

fn scores(answer: &mut Answer) -> [&mut Score; 2] {
    [&mut answer.fit.train, &mut answer.fit.test]
}

fn has_no_number(answer: &Answer) -> bool {
    let bad = |s: &Score| {
        s.rmse_after.is_some_and(|v| !v.is_finite()) || s.ratio_ci95.is_some_and(|r| !r.iter().all(|v| v.is_finite()))
    };
    bad(&answer.fit.train) || bad(&answer.fit.test)
}

fn without_what_is_no_number(answer: &mut Answer) {
    for score in scores(answer) {
        score.rmse_after = score.rmse_after.filter(|v| v.is_finite());
        score.ratio_ci95 = score.ratio_ci95.filter(|r| r.iter().all(|v| v.is_finite()));
    }
}

fn is_repaired_without_name(answer: &Answer) -> bool {
    let repaired = |s: &Score| s.rmse_after.is_some() || s.ratio_ci95.is_some();
    answer.effects.is_empty() && (repaired(&answer.fit.train) || repaired(&answer.fit.test))
}

fn without_repair(answer: &mut Answer) {
    for score in scores(answer) {
        (score.rmse_after, score.ratio_ci95, score.share) = (None, None, None);
    }
    answer.fit.test_ranges.iter_mut().for_each(|r| r.rmse_after = None);
    answer.fit.recordings.iter_mut().for_each(|r| r.rmse_after = None);
}

fn is_adequate_above_noise(answer: &Answer) -> bool {
    let noise = answer.fit.noise.as_ref().map_or(f64::INFINITY, |n| n.value);
    answer.outcome == Outcome::Adequate && answer.fit.test.rmse_before > SEVERAL * noise
}

fn is_explained_and_worse(answer: &Answer) -> bool {
    let room = if answer.fit.log_score.is_some() { BY_NOISE_TERMS } else { 1.0 };
    let test = &answer.fit.test;
    let grows = test.rmse_after.is_some_and(|after| after > room * test.rmse_before);
    answer.outcome == Outcome::Explained && !answer.residual_after.white && grows
}

fn misses(answer: &Answer) -> bool {
    let numbers = answer.effects.iter().flat_map(|e| &e.parameters);
    let air = |v: f64| 1e-9 * v.abs();
    numbers.into_iter().any(|p| !(p.ci95[0] - air(p.value) <= p.value && p.value <= p.ci95[1] + air(p.value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::{Detail, Places};
    use crate::candidate::Kind;
    use crate::driven;
    use crate::recording::Recording;
    use crate::verdict::{Effect, Estimate, Evidence, Fit, Noise, RecordingInfo, Whiteness};

    /// An answer that contradicts nothing, named or not.
    fn sound(outcome: Outcome, named: bool) -> Answer {
        let after = named.then_some(1.0);
        let score =
            Score { rmse_before: if named { 5.0 } else { 1.0 }, rmse_after: after, ratio_ci95: None, share: None };
        let beta = Estimate { name: "beta".into(), value: 2.0, unit: "1".into(), ci95: [1.0, 3.0] };
        let effect = Effect {
            id: "cubic-stiffness".into(),
            statement: String::new(),
            equation: String::new(),
            parameters: vec![beta],
            channels: Vec::new(),
            evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
            share: None,
            base: Vec::new(),
            confusable_with: Vec::new(),
            form: None,
        };
        Answer {
            kind: Kind::Driven,
            outcome,
            recording: RecordingInfo::of(&Recording::default()),
            base: Vec::new(),
            effects: if named { vec![effect] } else { Vec::new() },
            places: Places::default(),
            fit: Fit {
                unit: "V".into(),
                noise_floor: 1.0,
                noise: Some(Noise { value: 1.0, unit: "V".into(), how: String::new() }),
                train: score,
                test: score,
                test_ranges: Vec::new(),
                recordings: Vec::new(),
                log_score: None,
                with_unnamed: None,
                one_step_rmse: None,
            },
            residual_after: Whiteness { white: true, p_value: 0.5 },
            findings: Vec::new(),
            ranking: Vec::new(),
            trace: Vec::new(),
            repair: None,
            detail: Detail::Driven(Box::<driven::Detail>::default()),
        }
    }

    fn settled(mut answer: Answer) -> (Vec<Contradiction>, Outcome) {
        let broken = settle(&mut answer);
        assert_eq!(settle(&mut answer.clone()), [], "what was settled stays settled");
        (broken, answer.outcome)
    }

    #[test]
    fn sound_answers_are_left_alone() {
        for answer in
            [sound(Outcome::Adequate, false), sound(Outcome::Explained, true), sound(Outcome::Undecidable, true)]
        {
            let outcome = answer.outcome;
            assert_eq!(settled(answer), (vec![], outcome));
        }
    }

    #[test]
    fn each_contradiction_is_found_and_settled() {
        let mut above = sound(Outcome::Adequate, false);
        above.fit.test.rmse_before = 3.1;
        assert_eq!(settled(above), (vec![Contradiction::AdequateAboveNoise], Outcome::Unexplained));
        let mut worse = sound(Outcome::Explained, true);
        worse.residual_after.white = false;
        worse.fit.test.rmse_after = Some(5.1);
        assert_eq!(settled(worse), (vec![Contradiction::ExplainedAndWorse], Outcome::Unexplained));
        let mut missed = sound(Outcome::Explained, true);
        missed.effects[0].parameters[0].ci95 = [2.5, 3.0];
        assert_eq!(settled(missed), (vec![Contradiction::IntervalMissesValue], Outcome::Unexplained));
        let mut unbounded = sound(Outcome::Explained, true);
        unbounded.effects[0].parameters[0].ci95 = [f64::NAN, 3.0];
        assert_eq!(settled(unbounded).0, [Contradiction::IntervalMissesValue]);
        let mut nameless = sound(Outcome::Unexplained, false);
        nameless.fit.test.rmse_after = Some(7.0);
        nameless.fit.test.ratio_ci95 = Some([0.9, 1.1]);
        settle(&mut nameless);
        assert_eq!((nameless.fit.test.rmse_after, nameless.fit.test.ratio_ci95), (None, None));
        assert!(nameless.fit.test.rmse_before > 0.0 && nameless.findings.is_empty());
        let mut infinite = sound(Outcome::Explained, true);
        infinite.fit.test.rmse_after = Some(f64::INFINITY);
        settle(&mut infinite);
        assert_eq!(infinite.fit.test.rmse_after, None);
    }
}
