//! States what a verdict said, as far as a trial judges it.

use serde::{Deserialize, Serialize};

use proofmass_diagnosis::verdict::{Effect, Outcome, Verdict};

/// A fitted number with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Effect it belongs to.
    pub id: String,
    /// Column it belongs to, where there are several.
    pub channel: String,
    /// Symbol of the parameter.
    pub name: String,
    /// Estimated value.
    pub value: f64,
    /// 95 % interval, lower and upper end.
    pub ci95: [f64; 2],
}

/// Verdict or error that a diagnosis ended with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ending {
    /// Adequate: nothing is missing.
    Adequate,
    /// Named effects account for the mismatch.
    Explained,
    /// The mismatch is real, and nothing in the library accounts for it.
    Unexplained,
    /// Candidates are indistinguishable, or the recording is too weak.
    Undecidable,
    /// No verdict: it stopped with an error.
    Error,
}

impl Ending {
    /// Verdict as in verdict.json, or "error".
    pub fn name(self) -> &'static str {
        match self {
            Self::Adequate => Outcome::Adequate.name(),
            Self::Explained => Outcome::Explained.name(),
            Self::Unexplained => Outcome::Unexplained.name(),
            Self::Undecidable => Outcome::Undecidable.name(),
            Self::Error => "error",
        }
    }
}

impl From<Outcome> for Ending {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Adequate => Self::Adequate,
            Outcome::Explained => Self::Explained,
            Outcome::Unexplained => Self::Unexplained,
            Outcome::Undecidable => Self::Undecidable,
        }
    }
}

/// The parts of a verdict that a trial judges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Said {
    /// Verdict, or an error.
    pub outcome: Ending,
    /// Named effects; those of a tie stand in one group.
    pub groups: Vec<Vec<String>>,
    /// Fitted numbers of the named effects.
    pub numbers: Vec<Number>,
    /// rmse of the base and of the repaired model on data not fitted, and the noise floor.
    pub rmse: [f64; 3],
    /// Processor time that the diagnosis took, s.
    pub seconds: f64,
    /// The verdict's sentence, or the error.
    pub words: String,
}

impl Said {
    /// From the public document.
    pub fn from_verdict(verdict: &Verdict, seconds: f64) -> Self {
        let groups = grouped(verdict.verdict, &verdict.effects);
        let numbers = verdict
            .effects
            .iter()
            .flat_map(|effect| {
                effect.parameters.iter().map(|p| Number {
                    id: effect.id.clone(),
                    channel: effect.channels.first().cloned().unwrap_or_default(),
                    name: p.name.clone(),
                    value: p.value,
                    ci95: p.ci95,
                })
            })
            .collect();
        let test = verdict.fit.test;
        Self {
            outcome: verdict.verdict.into(),
            groups,
            numbers,
            rmse: [test.rmse_before, test.rmse_after.unwrap_or(test.rmse_before), verdict.fit.noise_floor],
            seconds,
            words: verdict.sentence.clone(),
        }
    }

    /// When the diagnosis stopped with an error.
    pub fn from_error(error: &proofmass_base::error::Error, seconds: f64) -> Self {
        Self {
            outcome: Ending::Error,
            groups: Vec::new(),
            numbers: Vec::new(),
            rmse: [0.0; 3],
            seconds,
            words: error.to_string(),
        }
    }

    /// All ids, sorted.
    pub fn ids(&self) -> Vec<String> {
        let mut ids: Vec<String> = self.groups.iter().flatten().cloned().collect();
        ids.sort();
        ids.dedup();
        ids
    }
}

/// Names in groups: a tie is one group, as the words have it, also where something else remains
/// unexplained. What is explained has no ties.
fn grouped(outcome: Outcome, effects: &[Effect]) -> Vec<Vec<String>> {
    /// Effects of the same columns that are indistinguishable from each other.
    struct Tie<'e> {
        channels: &'e [String],
        effects: Vec<&'e Effect>,
    }
    let name_each_other =
        |a: &Effect, b: &Effect| a.confusable_with.contains(&b.id) && b.confusable_with.contains(&a.id);
    let mut ties: Vec<Tie<'_>> = Vec::new();
    for effect in effects {
        // A name that is sure in one column is no part of a tie in another, and a rival that two
        // effects share ties neither with the other.
        let (touching, apart): (Vec<_>, Vec<_>) = ties.into_iter().partition(|tie| {
            outcome != Outcome::Explained
                && tie.channels == effect.channels
                && tie.effects.iter().any(|e| e.id == effect.id || name_each_other(e, effect))
        });
        ties = apart;
        let effects = touching.into_iter().flat_map(|tie| tie.effects).chain([effect]).collect();
        ties.push(Tie { channels: &effect.channels, effects });
    }
    let groups = ties.into_iter().map(|tie| {
        let rivals = |e: &Effect| if outcome == Outcome::Explained { Vec::new() } else { e.confusable_with.clone() };
        let mut group: Vec<String> =
            tie.effects.iter().flat_map(|e| [vec![e.id.clone()], rivals(e)].concat()).collect();
        group.sort();
        group.dedup();
        group
    });
    let mut said: Vec<Vec<String>> = Vec::new();
    for group in groups {
        // The same said of several columns is said once.
        if !said.contains(&group) {
            said.push(group);
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use proofmass_diagnosis::verdict::Evidence;

    #[test]
    fn a_tie_is_one_group_also_where_something_else_is_left_and_a_sure_name_is_no_part_of_it() {
        let effect = |id: &str, channel: &str, rival: Option<&str>| Effect {
            id: id.into(),
            statement: String::new(),
            equation: String::new(),
            parameters: Vec::new(),
            channels: vec![channel.into()],
            form: None,
            evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
            share: None,
            base: Vec::new(),
            confusable_with: rival.into_iter().map(str::to_owned).collect(),
        };
        let tied = effect("gauss-markov", "x", Some("random-walk"));
        let of = |outcome, effects: &[&Effect]| {
            grouped(outcome, &effects.iter().map(|e| (*e).clone()).collect::<Vec<Effect>>())
        };
        for outcome in [Outcome::Unexplained, Outcome::Undecidable] {
            assert_eq!(of(outcome, &[&tied]), [["gauss-markov", "random-walk"]]);
            // Another column's sure name, and the same tie in another column.
            let (sure, again) = (effect("gauss-markov", "y", None), effect("random-walk", "y", Some("gauss-markov")));
            assert_eq!(of(outcome, &[&tied, &sure]), [vec!["gauss-markov", "random-walk"], vec!["gauss-markov"]]);
            assert_eq!(of(outcome, &[&tied, &again]), [["gauss-markov", "random-walk"]]);
            let (back, other) =
                (effect("random-walk", "x", Some("gauss-markov")), effect("ramp", "x", Some("random-walk")));
            assert_eq!(of(outcome, &[&tied, &back]), [["gauss-markov", "random-walk"]]);
            // The same rival of two effects ties neither with the other.
            assert_eq!(of(outcome, &[&tied, &other]), [["gauss-markov", "random-walk"], ["ramp", "random-walk"]]);
        }
        assert_eq!(of(Outcome::Explained, &[&tied]), [["gauss-markov"]], "nothing tied is explained");
    }

    #[test]
    fn an_ending_is_written_as_its_name_and_read_back() {
        let all = [Outcome::Adequate, Outcome::Explained, Outcome::Unexplained, Outcome::Undecidable];
        for ending in all.map(Ending::from).into_iter().chain([Ending::Error]) {
            let text = serde_json::to_string(&ending).expect("a word");
            assert_eq!(text, format!("\"{}\"", ending.name()));
            assert_eq!(serde_json::from_str::<Ending>(&text).expect("the same word"), ending);
        }
        assert!(serde_json::from_str::<Ending>("\"explaned\"").is_err());
    }
}
