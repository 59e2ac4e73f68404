//! Two books compared: each verdict that changed, and the odds that right marks fell or false names
//! rose by chance.
//!
//! Cases are the same in both, so only those that changed count (McNemar, Psychometrika 12, 1947):
//! were better and worse alike, the number of worse ones among them would be binomial with one
//! half. The test is exact. The whole book is tested at 5 %, its families together at another 5 %
//! (Bonferroni).

use std::collections::BTreeMap;

use serde::Serialize;
use statrs::distribution::{Binomial, DiscreteCDF};

use super::entry::Entry;
use crate::independent::judge::Mark;
use crate::interval::Proportion;

/// Chance of calling the whole book worse where it is not; the same for its families together.
pub const LEVEL: f64 = 0.05;

/// Change of one mark between two books.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shift {
    /// Cases with the mark in the first book.
    pub before: usize,
    /// Cases with it in the second.
    pub after: usize,
    /// Cases that have it in the second alone.
    pub gained: usize,
    /// Cases that have it in the first alone.
    pub lost: usize,
    /// Chance of a change for the worse as large as this one where better and worse are alike.
    pub p_value: f64,
    /// Share of all cases that changed for the worse, with its exact interval.
    pub worse: Proportion,
}

/// Which way a mark is worse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Worse {
    Fewer,
    More,
}

impl Shift {
    fn of(pairs: &[(&Entry, &Entry)], has: impl Fn(&Entry) -> bool, worse: Worse) -> Self {
        let count = |of: &dyn Fn(bool, bool) -> bool| pairs.iter().filter(|(a, b)| of(has(a), has(b))).count();
        let (gained, lost) = (count(&|a, b| !a && b), count(&|a, b| a && !b));
        let bad = if worse == Worse::Fewer { lost } else { gained };
        Self {
            before: count(&|a, _| a),
            after: count(&|_, b| b),
            gained,
            lost,
            p_value: at_least(bad, gained + lost),
            worse: Proportion::of(bad, pairs.len()),
        }
    }
}

/// Chance of so many heads or more among tosses of a fair coin.
fn at_least(heads: usize, tosses: usize) -> f64 {
    let coin = Binomial::new(0.5, tosses as u64);
    match heads.checked_sub(1) {
        None => 1.0,
        Some(fewer) => coin.map_or(1.0, |coin| coin.sf(fewer as u64)),
    }
}

/// The cases of a family, or all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Family of the cases; null for the whole book.
    pub family: Option<String>,
    /// Cases that both books have.
    pub cases: usize,
    /// Verdicts that changed.
    pub changed: usize,
    /// Verdicts marked right.
    pub right: Shift,
    /// False names, and nulls with a name or unexplained.
    pub false_names: Shift,
    /// States whether it is worse beyond chance.
    pub is_worse: bool,
    /// Processor time in both books, s.
    pub cpu_s: [f64; 2],
}

/// A case on which two books differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Changed {
    /// Name of the case.
    pub case: String,
    /// Family of the case.
    pub family: String,
    /// Holds what the first book says.
    pub before: String,
    /// Holds what the second says.
    pub after: String,
}

/// Holds what changed between two books.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Against {
    /// The whole book, then its families.
    pub rows: Vec<Row>,
    /// Each case on which they differ.
    pub changed: Vec<Changed>,
    /// Cases that only the first book has, and only the second.
    pub unmatched: [usize; 2],
}

impl Row {
    fn of(family: Option<&str>, pairs: &[(&Entry, &Entry)], level: f64) -> Self {
        let right = Shift::of(pairs, |e| e.mark == Mark::Right, Worse::Fewer);
        let false_names = Shift::of(pairs, Entry::is_false, Worse::More);
        Self {
            family: family.map(str::to_owned),
            cases: pairs.len(),
            changed: pairs.iter().filter(|(a, b)| !a.says_as(b)).count(),
            is_worse: [right, false_names].iter().any(|shift| shift.p_value <= level),
            right,
            false_names,
            cpu_s: [pairs.iter().map(|p| p.0.cpu_s).sum(), pairs.iter().map(|p| p.1.cpu_s).sum()],
        }
    }
}

impl Against {
    /// Compares two books, case by case.
    pub fn of(before: &[Entry], after: &[Entry]) -> Self {
        let first: BTreeMap<&str, &Entry> = before.iter().map(|entry| (entry.case.as_str(), entry)).collect();
        let pairs: Vec<(&Entry, &Entry)> =
            after.iter().filter_map(|entry| Some((*first.get(entry.case.as_str())?, entry))).collect();
        let mut families: BTreeMap<&str, Vec<(&Entry, &Entry)>> = BTreeMap::new();
        pairs.iter().for_each(|pair| families.entry(&pair.1.family).or_default().push(*pair));
        // Two figures are tested in each.
        let (whole, each) = (LEVEL / 2.0, LEVEL / (2 * families.len().max(1)) as f64);
        let rows = std::iter::once(Row::of(None, &pairs, whole))
            .chain(families.iter().map(|(family, pairs)| Row::of(Some(family), pairs, each)));
        let changed = |(a, b): &(&Entry, &Entry)| {
            let (case, family) = (b.case.clone(), b.family.clone());
            (!a.says_as(b)).then(|| Changed { case, family, before: a.words(), after: b.words() })
        };
        Self {
            rows: rows.collect(),
            changed: pairs.iter().filter_map(changed).collect(),
            unmatched: [before.len() - pairs.len(), after.len() - pairs.len()],
        }
    }

    /// Returns whether right marks fell or false names rose beyond chance.
    pub fn is_worse(&self) -> bool {
        self.rows.iter().any(|row| row.is_worse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::book::entry::Held;
    use crate::said::Ending;

    fn book(right: usize, wrong: usize) -> Vec<Entry> {
        let marks = std::iter::repeat_n(Mark::Right, right).chain(std::iter::repeat_n(Mark::ConfidentlyWrong, wrong));
        let entry = |(n, mark): (usize, Mark)| Entry {
            case: format!("1-{n}: spring"),
            family: "near".into(),
            kind: "driven".into(),
            truth: Vec::new(),
            verdict: Ending::Explained,
            names: Vec::new(),
            ties: Vec::new(),
            shares: Vec::new(),
            parameters: Vec::new(),
            held: Held { before: 2.0, after: 1.0, floor: 1.0 },
            cpu_s: 0.5,
            gates: Vec::new(),
            mark,
        };
        marks.enumerate().map(entry).collect()
    }

    // Of a fair coin: 5 of 5 heads 1/32, 6 of 6 1/64, 4 or more of 5 are 6/32.
    #[test]
    fn odds_are_those_of_a_coin() {
        for (heads, tosses, chance) in [(0, 0, 1.0), (5, 5, 1.0 / 32.0), (6, 6, 1.0 / 64.0), (4, 5, 6.0 / 32.0)] {
            assert!((at_least(heads, tosses) - chance).abs() < 1e-12, "{heads} of {tosses}");
        }
    }

    #[test]
    fn a_worse_book_is_called_worse_and_the_same_one_is_not() {
        let (good, same) = (book(100, 0), Against::of(&book(100, 0), &book(100, 0)));
        assert!(!same.is_worse() && same.changed.is_empty() && same.rows[0].right.p_value == 1.0);
        // Six of six lost are 1/64 < 2.5 %; five of five 1/32 are not.
        assert!(Against::of(&good, &book(94, 6)).is_worse());
        assert!(!Against::of(&good, &book(95, 5)).is_worse());
        let better = Against::of(&book(94, 6), &good);
        assert!(!better.is_worse() && better.changed.len() == 6, "an improvement is none");
        assert_eq!(Against::of(&good, &book(10, 0)).unmatched, [90, 0]);
    }
}
