//! From an answer to words, and with them to the public document.

mod driven;
mod listed;
mod response;
mod rest;
mod trajectory;
mod tumble;

use std::collections::HashSet;

use proofmass_diagnosis::answer::{Answer, Detail};
use proofmass_diagnosis::repair::Repair;
use proofmass_diagnosis::standing::Ranked;
use proofmass_diagnosis::trace::Step;
use proofmass_diagnosis::verdict::{SCHEMA, Verdict, Where};

pub(super) use driven::form;
pub(super) use response::thermal;
pub(super) use tumble::residual;

/// A diagnosis in words and numbers.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// Verdict, as in verdict.json.
    pub verdict: Verdict,
    /// Every candidate that was tried, best first, named or not.
    pub ranking: Vec<Ranked>,
    /// Lists what each rule that acted changed, in their order.
    pub trace: Vec<Step>,
    /// The sensor with and without the named physics, for a study and for the cost in metres.
    pub repair: Option<Repair>,
    /// Holds what only this kind of recording has: numbers behind its figures.
    pub detail: Detail,
}

/// Holds the sentences of an answer.
struct Said {
    /// The verdict in one or two sentences.
    sentence: String,
    /// Says where the mismatch lives.
    place: String,
    /// Says what would decide or confirm.
    next_experiment: String,
}

/// Puts an answer into words.
pub fn worded(answer: Answer) -> Diagnosis {
    let said = said(&answer);
    let detectable = answer.detail.detectable().to_vec();
    let thermal = if let Detail::Response(detail) = &answer.detail { detail.thermal } else { None };
    let (calibration, told) = match &answer.detail {
        Detail::Tumble(detail) => (detail.published.clone(), tumble::findings(&detail.account)),
        Detail::Trajectory(detail) => (detail.published.clone(), trajectory::findings(&detail.account)),
        Detail::Static(detail) => (None, rest::statements(&detail.statements, &detail.unit, detail.channels.len())),
        Detail::Driven(_) | Detail::Response(_) => (None, Vec::new()),
    };
    let Answer {
        kind,
        outcome,
        recording,
        base,
        effects,
        places,
        fit,
        residual_after,
        mut findings,
        ranking,
        trace,
        repair,
        detail,
    } = answer;
    findings.extend(told);
    // Several stages may find the same.
    let mut seen = HashSet::new();
    findings.retain(|finding| seen.insert(finding.clone()));
    let verdict = Verdict {
        schema: SCHEMA,
        kind,
        verdict: outcome,
        sentence: said.sentence,
        recording,
        base,
        effects,
        location: Where {
            summary: said.place,
            time_s: places.time_s,
            frequency_hz: places.frequency_hz,
            state: places.state,
            state_cells: places.state_cells,
            argument: places.argument,
        },
        calibration,
        fit,
        residual_after,
        thermal,
        detectable,
        next_experiment: said.next_experiment,
        findings,
        trace: None,
    };
    Diagnosis { verdict, ranking, trace, repair, detail }
}

impl Diagnosis {
    /// The same with the trace in its public document.
    pub fn with_trace(mut self) -> Self {
        self.verdict.trace = Some(self.trace.clone());
        self
    }
}

fn said(answer: &Answer) -> Said {
    match &answer.detail {
        Detail::Driven(detail) => Said {
            sentence: driven::sentence(answer, detail),
            place: driven::place(answer, &detail.account),
            next_experiment: driven::next_experiment(answer, &detail.account),
        },
        Detail::Static(detail) => {
            let place = rest::place(detail);
            Said {
                sentence: rest::sentence(answer.outcome, &answer.effects, &place, detail),
                next_experiment: rest::next_experiment(answer.outcome, detail).into(),
                place,
            }
        }
        Detail::Response(detail) => Said {
            sentence: response::sentence(answer, detail),
            place: response::place(answer, detail),
            next_experiment: response::next_experiment(answer, detail),
        },
        Detail::Trajectory(detail) => Said {
            sentence: trajectory::sentence(answer.outcome, detail),
            place: trajectory::place(detail),
            next_experiment: trajectory::next_experiment(answer.outcome, &detail.account),
        },
        Detail::Tumble(detail) => Said {
            sentence: tumble::sentence(answer.outcome, detail),
            place: tumble::place(detail),
            next_experiment: tumble::next_experiment(answer.outcome, &detail.account).into(),
        },
    }
}
