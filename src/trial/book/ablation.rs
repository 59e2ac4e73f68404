//! Measures the worth of each gate of the diagnosis: every case in which it acted is asked again without it.
//!
//! A gate that did not act cannot change a verdict by being switched off, so that only the others are
//! asked. A gate is worth what the marks lose without it.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::corpus::Item;
use super::entry::Entry;
use super::run::{self, Made, Places};
use crate::ask::Files;
use crate::independent::judge::Mark;
use crate::independent::run::{self as independent, keep, kept};
use crate::scratch::Scratch;
use proofmass_base::control::Control;
use proofmass_base::error::Result;
use proofmass_diagnosis::gate::Gate;
use proofmass_diagnosis::verdict::Verdict;

/// Share of all verdicts that a gate must change to be worth its place.
pub const LEAST_CHANGED: f64 = 0.003;

/// Verdict on one case without one gate: a line of gates.jsonl.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Without {
    /// The gate that was switched off.
    pub gate: String,
    /// Line of the book without it.
    pub entry: Entry,
}

/// Worth of one gate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worth {
    /// The gate.
    pub gate: &'static str,
    /// Its rule, in a sentence.
    pub statement: &'static str,
    /// Verdicts in which it acted.
    pub acted: usize,
    /// Of these, verdicts that are another one without it.
    pub changed: usize,
    /// Of these, verdicts whose mark is better with it.
    pub better: usize,
    /// Verdicts whose mark is worse with it.
    pub worse: usize,
    /// False names and alarms that it prevents, less those that it makes.
    pub prevents: i64,
    /// Processor time of the verdicts in which it acted, with it and without it, s.
    pub cpu_s: [f64; 2],
}

impl Worth {
    /// Says that it earns its place in a book of this many verdicts: it changes enough of them, and
    /// betters more of these than it worsens.
    pub fn is_earned(&self, verdicts: usize) -> bool {
        self.changed as f64 >= LEAST_CHANGED * verdicts as f64 && self.better > self.worse
    }
}

/// Orders marks from wrong (0) to right (4).
fn rank(mark: Mark) -> i32 {
    match mark {
        Mark::Right => 4,
        Mark::HonestNamed => 3,
        Mark::Honest | Mark::BelowDetection | Mark::Undecided => 2,
        Mark::Missed | Mark::Overclaimed => 1,
        Mark::FalseName | Mark::FalseAlarm | Mark::ConfidentlyWrong | Mark::Error => 0,
    }
}

/// A recording diagnosed without one gate.
pub type Subject<'a> = dyn Fn(&Files, Gate) -> Result<Verdict> + Sync + 'a;

/// Asks for each verdict of a book once more without each gate that acted in it, save those that are
/// in the file of lines already.
///
/// # Errors
/// Nothing can be written, the sealed truth was changed, or the work was stopped.
pub fn run(
    book: &[Entry],
    items: &[Item<'_>],
    seed: u64,
    places: &Places<'_>,
    subject: &Subject<'_>,
    control: &Control,
) -> Result<Vec<Without>> {
    let mut lines: Vec<Without> = kept(places.lines)?;
    let is_there: BTreeSet<(&str, &str)> = lines.iter().map(|l| (l.gate.as_str(), l.entry.case.as_str())).collect();
    let gates = |entry: &Entry| -> Vec<Gate> {
        let is_open = |gate: &Gate| !is_there.contains(&(gate.id(), entry.case.as_str()));
        entry.gates.iter().filter_map(|id| Gate::of_id(id)).filter(is_open).collect()
    };
    let open: BTreeMap<&str, Vec<Gate>> = book.iter().map(|entry| (entry.case.as_str(), gates(entry))).collect();
    let open_of = |name: &str| open.get(name).map_or(&[][..], Vec::as_slice);
    let asked: Vec<&Item<'_>> = items.iter().filter(|item| !open_of(&item.name(seed)).is_empty()).collect();
    let (sealed, made) = run::made(&asked, seed, places.truth, control)?;
    let pairs: Vec<(&Made<'_>, Gate)> =
        made.iter().flat_map(|made| open_of(&made.name(seed)).iter().map(move |gate| (made, *gate))).collect();
    let scratch = Scratch::new(places.lines.parent())?;
    let fresh = keep(&pairs, places.lines, control, |(made, gate)| {
        let entry = made.ask(seed, &|files| subject(files, *gate), places.data, &scratch)?;
        Ok(Without { gate: gate.id().to_owned(), entry })
    })?;
    // What was judged is what was sealed.
    independent::open(places.truth, &sealed)?;
    lines.extend(fresh);
    Ok(lines)
}

/// Returns the worth of each gate, in the order of the chain.
pub fn worth(book: &[Entry], without: &[Without]) -> Vec<Worth> {
    let with: BTreeMap<&str, &Entry> = book.iter().map(|entry| (entry.case.as_str(), entry)).collect();
    let of = |gate: &Gate| {
        let lines = without.iter().filter(|line| line.gate == gate.id());
        let pairs: Vec<(&Entry, &Entry)> =
            lines.filter_map(|line| Some((*with.get(line.entry.case.as_str())?, &line.entry))).collect();
        let count = |is: &dyn Fn(&Entry, &Entry) -> bool| pairs.iter().filter(|(a, b)| is(a, b)).count();
        let is_false = |entry: &Entry| i64::from(entry.is_false());
        Worth {
            gate: gate.id(),
            statement: gate.statement(),
            acted: pairs.len(),
            changed: count(&|a, b| !a.says_as(b)),
            better: count(&|a, b| rank(a.mark) > rank(b.mark)),
            worse: count(&|a, b| rank(a.mark) < rank(b.mark)),
            prevents: pairs.iter().map(|(a, b)| is_false(b) - is_false(a)).sum(),
            cpu_s: [pairs.iter().map(|p| p.0.cpu_s).sum(), pairs.iter().map(|p| p.1.cpu_s).sum()],
        }
    };
    Gate::ALL.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_is_worth_what_the_marks_lose_without_it() {
        let entry = |case: &str, mark: &str| -> Entry {
            let held = serde_json::json!({ "before": 2.0, "after": 1.0, "floor": 1.0 });
            serde_json::from_value(serde_json::json!({
                "case": case, "family": "near", "kind": "driven", "truth": [], "verdict": "explained", "names": [],
                "ties": [], "shares": [], "parameters": [], "held": held, "cpu_s": 0.5, "gates": ["bound", "tie"],
                "mark": mark,
            }))
            .expect("an entry")
        };
        let book = [entry("1-1", "right"), entry("1-2", "false-name"), entry("1-3", "right")];
        let lines = |gate: &str, marks: [&str; 3]| {
            let line = |(case, mark): (&Entry, &str)| Without { gate: gate.into(), entry: entry(&case.case, mark) };
            book.iter().zip(marks).map(line).collect::<Vec<_>>()
        };
        let mut without = lines("bound", ["false-name", "honest", "confidently-wrong"]);
        without.extend(lines("tie", ["right", "right", "right"]));
        let table = worth(&book, &without);
        let of = |id: &str| table.iter().find(|worth| worth.gate == id).expect("a row").clone();
        let bound = of("bound");
        assert_eq!((bound.acted, bound.changed, bound.better, bound.worse, bound.prevents), (3, 3, 2, 1, 1));
        assert!(bound.is_earned(1000) && !bound.is_earned(1001));
        let tie = of("tie");
        assert_eq!((tie.acted, tie.changed, tie.better, tie.worse), (3, 1, 0, 1));
        assert!(!tie.is_earned(3) && !of("twins").is_earned(3));
    }
}
