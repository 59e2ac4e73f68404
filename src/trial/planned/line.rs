//! The outcome of one sensor: laws tied at first, the plan, the verdict on its experiment, and its worth.

use serde::{Deserialize, Serialize};

use super::pair::Left;
use crate::said::{Ending, Said};
use proofmass_diagnosis::plan::experiment::{self as proposed, Shape};

/// An experiment, as far as a table shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Kind of input.
    pub kind: String,
    /// Number of samples.
    pub samples: usize,
}

impl Experiment {
    /// From a proposal.
    pub(super) fn of(experiment: &proposed::Experiment) -> Self {
        let kind = match experiment.shape {
            Shape::Sine { .. } => "sine",
            Shape::Levels { .. } => "sines of rising level",
            Shape::Frequencies { .. } => "sines of rising frequency",
            Shape::Chirp { .. } => "chirp",
            Shape::Multisine { .. } => "multisine",
            Shape::Steps { .. } => "steps",
        };
        Self { kind: kind.into(), samples: experiment.samples() }
    }
}

/// Worth of a verdict on an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Worth {
    /// It names the law and nothing else; where no rival is the law, it names none of them.
    Right,
    /// It leaves the question open.
    Open,
    /// It is sure of a law that is not there.
    Wrong,
}

/// A verdict on an experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Decided {
    /// The verdict.
    pub said: Ending,
    /// Names in it.
    pub names: Vec<String>,
    /// Worth of it.
    pub worth: Worth,
}

impl Decided {
    /// Judges what was said of a sensor with this law, when these rivals were in question.
    pub(super) fn of(said: &Said, law: &str, rivals: &[String]) -> Self {
        let names = said.ids();
        let is_sure = said.outcome == Ending::Explained;
        let is_among = rivals.iter().any(|id| id == law);
        let is_law = names.len() == 1 && names[0] == law;
        // Where neither is true, it is decided that neither is.
        let rejects = !is_among && said.outcome != Ending::Error && !names.iter().any(|id| rivals.contains(id));
        let worth = match () {
            () if is_sure && is_law || rejects && (!is_sure || names.iter().all(|id| id == law)) => Worth::Right,
            () if is_sure && names.iter().any(|id| id != law) => Worth::Wrong,
            () => Worth::Open,
        };
        Self { said: said.outcome, names, worth }
    }
}

/// A plan, recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// Laws that the plan tells apart.
    pub rivals: Vec<String>,
    /// The experiment that it proposes.
    pub experiment: Experiment,
    /// Probability of a right decision that it states.
    pub promised: f64,
    /// Says whether that is what was wished.
    pub reached: bool,
    /// The verdict on the experiment.
    pub decided: Decided,
    /// Samples of the broadband multisine that the plan holds to be as good, where there is one.
    pub broadband: Option<usize>,
    /// The verdict on a broadband multisine of twice the experiment's length.
    pub twice_broadband: Decided,
}

/// The last step that a sensor reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The first recording left no laws tied.
    #[expect(missing_docs, reason = "the line of the variant says what its fields are")]
    NotOpen { said: Ending, names: Vec<String> },
    /// No plan was made.
    #[expect(missing_docs, reason = "the line of the variant says what its fields are")]
    NotPlanned { words: String },
    /// The experiment was recorded and diagnosed.
    Planned(Box<Planned>),
}

/// One line of verdicts.jsonl.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Number of the sensor.
    pub number: usize,
    /// Law that it follows.
    pub law: String,
    /// Reason for which the first recording may leave it open.
    pub left: Left,
    /// Laws tied after the first recording.
    pub rivals: Vec<String>,
    /// The last step that it reached.
    pub stage: Stage,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decision_is_right_where_it_names_the_law_or_none_of_two_that_are_not_there() {
        let said = |outcome, names: &[&str]| Said {
            outcome,
            groups: names.iter().map(|n| vec![(*n).to_owned()]).collect(),
            numbers: Vec::new(),
            rmse: [0.0; 3],
            seconds: 0.0,
            words: String::new(),
        };
        let rivals = ["a", "b"].map(str::to_owned);
        let worth = |outcome, names: &[&str], law| Decided::of(&said(outcome, names), law, &rivals).worth;
        assert_eq!(worth(Ending::Explained, &["a"], "a"), Worth::Right);
        assert_eq!(worth(Ending::Explained, &["b"], "a"), Worth::Wrong);
        assert_eq!(worth(Ending::Explained, &["a", "c"], "a"), Worth::Wrong);
        assert_eq!(worth(Ending::Unexplained, &["a"], "a"), Worth::Open);
        assert_eq!(worth(Ending::Explained, &["c"], "c"), Worth::Right);
        assert_eq!(worth(Ending::Unexplained, &[], "c"), Worth::Right);
        assert_eq!(worth(Ending::Undecidable, &["a", "b"], "c"), Worth::Open);
        assert_eq!(worth(Ending::Explained, &["d"], "c"), Worth::Wrong);
    }
}
