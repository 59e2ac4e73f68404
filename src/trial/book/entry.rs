//! One line of the book: what is known of a case, what the verdict said, what it cost, and its
//! worth.

use serde::{Deserialize, Serialize};

use super::corpus;
use crate::independent::case::Case;
use crate::independent::judge::{self, Mark};
use crate::independent::truth::Truth;
use crate::real::Real;
use crate::said::{Ending, Said};
use proofmass_diagnosis::verdict::Verdict;

/// Share of the excess error of held-out free simulation that one name removes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Removed {
    /// Id of the effect.
    pub id: String,
    /// Column that it shows in.
    pub channel: String,
    /// The share; 1 is all of it.
    pub value: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
}

/// A fitted number next to the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Id of the effect.
    pub id: String,
    /// Column that it belongs to.
    pub channel: String,
    /// Symbol of the parameter.
    pub name: String,
    /// Estimated value.
    pub value: f64,
    /// 95 % interval of the estimate.
    pub ci95: [f64; 2],
    /// True value; null where none is known.
    pub truth: Option<f64>,
    /// States whether the interval holds the truth.
    pub holds: Option<bool>,
}

/// Root-mean-square errors on held-out samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Held {
    /// Of the base model.
    pub before: f64,
    /// With the named effects.
    pub after: f64,
    /// Of the noise.
    pub floor: f64,
}

/// One line of book.jsonl.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Name of the case: seed, number and sub-family, or the name of a real recording.
    pub case: String,
    /// Relation of its truth to the library, or "real".
    pub family: String,
    /// Kind of recording.
    pub kind: String,
    /// For each effect that is there the names of which any one is right.
    pub truth: Vec<Vec<String>>,
    /// Holds what the verdict is.
    pub verdict: Ending,
    /// Effects named alone.
    pub names: Vec<String>,
    /// Effects between which nothing is decided.
    pub ties: Vec<Vec<String>>,
    /// Holds what each name removes of the held-out error.
    pub shares: Vec<Removed>,
    /// Fitted numbers of the named effects.
    pub parameters: Vec<Parameter>,
    /// Held-out errors before and after, and the noise.
    pub held: Held,
    /// Processor time of the verdict, s.
    pub cpu_s: f64,
    /// Gates of the diagnosis that changed something.
    pub gates: Vec<String>,
    /// Worth of the verdict.
    pub mark: Mark,
}

/// A verdict, and the numbers that it left out of what is judged.
pub(super) type Told = (Said, Option<Verdict>);

/// Holds what is known of a case before its verdict.
struct Known<'a> {
    case: String,
    family: String,
    kind: String,
    truth: &'a Truth,
}

impl Entry {
    /// Returns the line of a case of the second generator.
    pub(super) fn drawn(seed: u64, case: &Case, told: Told) -> Self {
        let (family, kind) = (case.family.name().to_owned(), case.kind.name().to_owned());
        let known = Known { case: corpus::name(seed, case.number), family, kind, truth: &case.truth };
        let mark = judge::judge(case, &told.0);
        let mut entry = Self::of(known, told, mark);
        for parameter in &mut entry.parameters {
            let held = judge::holds(case, &parameter.number());
            (parameter.truth, parameter.holds) = (held.map(|h| h.0), held.map(|h| h.1));
        }
        entry
    }

    /// Returns the line of a real recording, judged by what other sources know of it.
    pub(super) fn recorded(real: &Real, told: Told) -> Self {
        let (family, truth) = real.judged();
        let mark = judge::mark(family, &truth, &told.0, || false);
        let known = Known { case: real.id(), family: "real".into(), kind: corpus::kind(real), truth: &truth };
        let mut entry = Self::of(known, told, mark);
        for parameter in &mut entry.parameters {
            let of = |k: &&crate::real::Known| {
                k.id == parameter.id
                    && k.name == parameter.name
                    && k.channel.as_ref().is_none_or(|c| *c == parameter.channel)
            };
            parameter.truth = real.numbers.iter().find(of).map(|known| known.value);
            let [low, high] = parameter.ci95;
            parameter.holds = parameter.truth.map(|truth| (low..=high).contains(&truth));
        }
        entry
    }

    fn of(known: Known<'_>, (said, verdict): Told, mark: Mark) -> Self {
        let (names, ties): (Vec<_>, Vec<_>) = said.groups.into_iter().partition(|group| group.len() == 1);
        let mut names: Vec<String> = names.into_iter().flatten().collect();
        names.sort();
        let effects = verdict.iter().flat_map(|verdict| &verdict.effects);
        let removed = effects.filter_map(|effect| {
            let share = effect.share?;
            let channel = effect.channels.first().cloned().unwrap_or_default();
            Some(Removed { id: effect.id.clone(), channel, value: share.value, ci95: share.ci95 })
        });
        let [before, after, floor] = said.rmse;
        Self {
            case: known.case,
            family: known.family,
            kind: known.kind,
            truth: known.truth.effects.iter().map(|effect| effect.right.clone()).collect(),
            verdict: said.outcome,
            names,
            ties,
            shares: removed.collect(),
            parameters: said.numbers.into_iter().map(Parameter::of).collect(),
            held: Held { before, after, floor },
            cpu_s: said.seconds,
            gates: verdict.map_or_else(Vec::new, |verdict| gates(&verdict)),
            mark,
        }
    }

    /// Returns whether another line says the same of its case, whatever it cost.
    pub(super) fn says_as(&self, other: &Self) -> bool {
        let told = |e: &Self| (e.verdict, e.names.clone(), e.ties.clone(), e.mark);
        told(self) == told(other)
    }

    /// Says that it is a false name or a false alarm.
    pub(super) fn is_false(&self) -> bool {
        self.mark.is_false_name() || self.mark == Mark::FalseAlarm
    }

    /// Returns what it says in one line: "explained cubic-stiffness (right)".
    pub(crate) fn words(&self) -> String {
        let ties = self.ties.iter().map(|tie| tie.join(" | "));
        let names: Vec<String> = self.names.iter().cloned().chain(ties).collect();
        let space = if names.is_empty() { "" } else { " " };
        format!("{}{space}{} ({})", self.verdict.name(), names.join(" + "), self.mark.word())
    }
}

/// Ids of the gates that acted, each once, in the order in which they last did.
fn gates(verdict: &Verdict) -> Vec<String> {
    let mut ids: Vec<String> = Vec::new();
    for step in verdict.trace.iter().flatten() {
        let id = step.gate.id();
        ids.retain(|other| other != id);
        ids.push(id.to_owned());
    }
    ids
}

impl Parameter {
    fn of(n: crate::said::Number) -> Self {
        let crate::said::Number { id, channel, name, value, ci95 } = n;
        Self { id, channel, name, value, ci95, truth: None, holds: None }
    }

    fn number(&self) -> crate::said::Number {
        let Self { id, channel, name, value, ci95, .. } = self.clone();
        crate::said::Number { id, channel, name, value, ci95 }
    }
}
