//! The corpus of the book: which cases it has, how a part of them is chosen, and how it is divided.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Deserialize;

use crate::independent::case::{Case, Change, Place, rewritten};
use crate::independent::run::Order;
use crate::independent::truth::Kind;
use crate::real::Real;
use proofmass_base::document::read_toml;
use proofmass_base::error::{Error, Result};
use proofmass_base::shard::Shard;

/// Cases of the second generator, without those that are others written otherwise.
pub const CASES: usize = 1100;
/// Rows of the longest recording: few, so that the whole corpus is asked within an hour.
pub const ROWS: usize = 4000;
/// Numbers of the cases among which the ring-downs are of which copies at lower rates are asked;
/// none is asked as it is.
const RINGS: Range<usize> = 10_000..10_400;
/// Rows of the longest of these before rows are left out: a tenth is still a recording.
const RING_ROWS: usize = 20_000;

/// One case of the corpus, before it is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Item<'a> {
    /// A case of the second generator.
    Drawn(Order),
    /// A real recording.
    Recorded(&'a Real),
}

/// Returns the name of a case of the second generator: seed, number, and what it is.
pub(super) fn name(seed: u64, number: usize) -> String {
    let place = Place::of(number);
    let change = place.change.map_or(String::new(), |change| format!(", {}", change.name()));
    format!("{seed}-{number}: {}{change}", place.sub)
}

impl Item<'_> {
    /// Returns its name in the book.
    pub fn name(&self, seed: u64) -> String {
        match self {
            Self::Drawn(order) => name(seed, order.number),
            Self::Recorded(real) => real.id(),
        }
    }

    /// Returns kind, family and sub-family: of each a part of the corpus holds the same share.
    fn stratum(&self) -> (String, &'static str, &'static str) {
        match self {
            Self::Drawn(order) => {
                let place = Place::of(order.number);
                (place.kind.name().to_owned(), place.family.name(), place.sub)
            }
            Self::Recorded(real) => (kind(real), "real", ""),
        }
    }
}

/// Returns the kind of a real recording by its base model; nothing where that cannot be read, which
/// is for its verdict to say.
pub(super) fn kind(real: &Real) -> String {
    #[derive(Deserialize)]
    struct Head {
        kind: String,
    }
    read_toml(&real.model).map_or_else(|_| String::new(), |head: Head| head.kind)
}

/// Returns whether a case can be written that way, as far as its number says.
fn is_possible(order: &Order) -> bool {
    let Place { kind, change, .. } = Place::of(order.number);
    match (kind, change) {
        (_, None) => true,
        (Kind::Driven, Some(change)) => order.rows / change.every() >= Case::LEAST_ROWS,
        (Kind::Static, Some(change)) => matches!(change, Change::Units | Change::Sign),
        (Kind::Tumble | Kind::Response, Some(_)) => false,
    }
}

/// A choice from the corpus.
#[derive(Debug, Clone, Copy)]
pub struct Choice<'a> {
    /// Seed of all random draws.
    pub seed: u64,
    /// Part of the cases of each kind, family and sub-family; 1 for all.
    pub sample: f64,
    /// Beginnings of the names of the only cases wanted, up to their colon; all where there is
    /// none.
    pub only: &'a [String],
    /// One part of several, for several machines.
    pub shard: Option<Shard>,
}

impl Choice<'_> {
    /// Returns the chosen cases in the order of the book.
    ///
    /// # Errors
    /// A case that was asked for by name is not in the corpus.
    pub fn items<'r>(&self, recorded: &'r [Real]) -> Result<Vec<Item<'r>>> {
        let own = Case::numbers(CASES).into_iter().map(|number| Order { number, rows: ROWS });
        let rings = RINGS.filter(|n| Place::of(*n).sub.starts_with("ring-down")).flat_map(|origin| {
            [Change::Fifth, Change::Tenth].map(|c| Order { number: rewritten(origin, c), rows: RING_ROWS })
        });
        let drawn = own.chain(rings).filter(is_possible).map(Item::Drawn);
        let all: Vec<Item<'_>> = drawn.chain(recorded.iter().map(Item::Recorded)).collect();
        let chosen = if self.only.is_empty() { sampled(all, self.sample) } else { self.named(all)? };
        let mine = |place: usize| self.shard.is_none_or(|s| place as u64 % s.of == s.number - 1);
        Ok(chosen.into_iter().enumerate().filter(|(place, _)| mine(*place)).map(|(_, item)| item).collect())
    }

    fn named<'r>(&self, all: Vec<Item<'r>>) -> Result<Vec<Item<'r>>> {
        let head = |name: &str| name.split(':').next().unwrap_or_default().trim().to_owned();
        let wanted: Vec<String> = self.only.iter().map(|name| head(name)).collect();
        let found: Vec<(String, Item<'_>)> = all
            .into_iter()
            .map(|item| (head(&item.name(self.seed)), item))
            .filter(|(n, _)| wanted.contains(n))
            .collect();
        match wanted.iter().find(|name| found.iter().all(|(n, _)| n != *name)) {
            None => Ok(found.into_iter().map(|(_, item)| item).collect()),
            Some(name) => Err(Error::new(
                format!("could not choose the case {name:?}"),
                format!("the book of seed {} has none of that name", self.seed),
                "give names as they stand under `case` in book.jsonl, up to the colon: 1-17, or emps",
            )),
        }
    }
}

/// The same part of each stratum, at least one case of each; a larger part holds every smaller one.
fn sampled(all: Vec<Item<'_>>, part: f64) -> Vec<Item<'_>> {
    let mut strata: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (place, item) in all.iter().enumerate() {
        strata.entry(item.stratum()).or_default().push(place);
    }
    let mut kept = vec![false; all.len()];
    for places in strata.values_mut() {
        let wanted = ((part * places.len() as f64).round() as usize).max(1);
        // Fibonacci hashing: near places come far apart, always in the same order.
        places.sort_by_key(|place| (*place as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        places.iter().take(wanted).for_each(|place| kept[*place] = true);
    }
    all.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(item, _)| item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn choice(sample: f64) -> Choice<'static> {
        Choice { seed: 1, sample, only: &[], shard: None }
    }

    fn names(choice: &Choice<'_>) -> Vec<String> {
        choice.items(&[]).expect("chosen").iter().map(|item| item.name(choice.seed)).collect()
    }

    #[test]
    fn the_corpus_has_every_sub_family_and_a_sample_of_it_as_well() {
        let strata =
            |c: &Choice<'_>| -> BTreeSet<_> { c.items(&[]).expect("chosen").iter().map(Item::stratum).collect() };
        let (all, tenth) = (names(&choice(1.0)), names(&choice(0.1)));
        assert!(all.len() > 1250 && tenth.len() < all.len() / 6, "{} {}", all.len(), tenth.len());
        assert_eq!(strata(&choice(1.0)), strata(&choice(0.1)));
        let third: BTreeSet<String> = names(&choice(0.3)).into_iter().collect();
        assert!(tenth.iter().all(|name| third.contains(name)), "a smaller sample is part of a larger one");
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len(), "two cases of one name");
    }

    #[test]
    fn shards_are_the_whole_without_overlap_and_only_what_is_named_is_chosen() {
        let mut parts: Vec<String> =
            (1..=3).flat_map(|number| names(&Choice { shard: Some(Shard { number, of: 3 }), ..choice(0.1) })).collect();
        let mut whole = names(&choice(0.1));
        parts.sort();
        whole.sort();
        assert_eq!(parts, whole);
        let only = ["1-17".to_owned(), "1-3: whatever".to_owned()];
        let found = names(&Choice { only: &only, ..choice(1.0) });
        assert!(found.len() == 2 && found[0].starts_with("1-3:") && found[1].starts_with("1-17:"), "{found:?}");
        assert!(Choice { only: &["2-17".to_owned()], ..choice(1.0) }.items(&[]).is_err(), "of another seed");
    }
}
