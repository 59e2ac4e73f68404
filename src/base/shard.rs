//! A run divided among machines: which share is whose, the state file that a shard leaves, and the
//! files of a run gathered and found to be all of it.
//!
//! A run is a line of parts (the ensembles of a study, the maps of an atlas, the cases of a trial),
//! each of this many units (members, rows, cases). A shard takes a stretch of the line, so a short
//! part goes to few shards. Not for starting anything on another machine: batch systems do that.

pub mod file;
pub mod gather;

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// One shard of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// Number of the shard, from 1.
    pub number: u64,
    /// Number of all shards.
    pub of: u64,
}

/// Most shards of a run.
pub const MOST: u64 = 1_000_000;

impl Shard {
    /// The file that it writes.
    pub fn file_name(self) -> String {
        format!("shard-{}-of-{}.state", self.number, self.of)
    }

    /// The pieces of the run that this shard computes.
    pub fn pieces(self, parts: &[Part]) -> Vec<Piece> {
        let total: u128 = parts.iter().map(Part::weight).sum();
        let place = |number: u64| total * u128::from(number) / u128::from(self.of.max(1));
        let (from, to) = (place(self.number - 1), place(self.number));
        let mut begin = 0;
        let mut pieces = Vec::new();
        for (number, part) in parts.iter().enumerate() {
            // A grain belongs to the shard in whose stretch it begins.
            let grain = |place: u128| {
                let grains = place.saturating_sub(begin).div_ceil(u128::from(part.effort.max(1)));
                u64::try_from(grains * u128::from(part.grain)).unwrap_or(u64::MAX).min(part.units)
            };
            let units = grain(from)..grain(to);
            if units.start < units.end {
                pieces.push(Piece { part: number, units });
            }
            begin += part.weight();
        }
        pieces
    }
}

/// Divides anew what is left of a run: stretches of its parts that nobody has done yet, which begin
/// with a grain.
pub fn rest(shard: Shard, parts: &[Part], gaps: &[(usize, Range<u64>)]) -> Vec<Piece> {
    let of = |(part, units): &(usize, Range<u64>)| Part { units: units.end - units.start, ..parts[*part] };
    let line: Vec<Part> = gaps.iter().map(of).collect();
    let whole = |Piece { part, units }: Piece| {
        let (part, gap) = &gaps[part];
        Piece { part: *part, units: gap.start + units.start..gap.start + units.end }
    };
    shard.pieces(&line).into_iter().map(whole).collect()
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} of {}", self.number, self.of)
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let need = || format!("need K/N with K from 1 to N and N at most {MOST}, e.g. 3/16");
        let (number, of) = text.split_once('/').ok_or_else(need)?;
        let [number, of] = [number, of].map(|n| n.trim().parse().ok());
        let shard = number.zip(of).map(|(number, of)| Self { number, of }).ok_or_else(need)?;
        if (1..=shard.of).contains(&shard.number) && shard.of <= MOST { Ok(shard) } else { Err(need()) }
    }
}

/// A part of a run as it is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Number of units in the part.
    pub units: u64,
    /// Units that stay together.
    pub grain: u64,
    /// Cost of this many, in any measure that all parts share.
    pub effort: u64,
}

impl Part {
    fn weight(&self) -> u128 {
        u128::from(self.units.div_ceil(self.grain.max(1))) * u128::from(self.effort.max(1))
    }
}

/// Units of a part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Piece {
    /// Index of the part, from 0.
    pub part: usize,
    /// Units of that part.
    pub units: Range<u64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_take_every_unit_once_and_grains_stay_whole() {
        let parts = [
            Part { units: 10_000, grain: 256, effort: 7 },
            Part { units: 100, grain: 256, effort: 3 },
            Part { units: 4096, grain: 256, effort: 1 },
        ];
        for of in [1, 2, 3, 7, 16, 100] {
            let mut at = [0; 3];
            for number in 1..=of {
                for Piece { part, units } in (Shard { number, of }).pieces(&parts) {
                    assert_eq!(units.start, at[part], "{number}/{of}");
                    let whole = units.end.is_multiple_of(256) || units.end == parts[part].units;
                    assert!(units.start < units.end && whole, "{number}/{of} {units:?}");
                    at[part] = units.end;
                }
            }
            assert_eq!(at, parts.map(|p| p.units), "{of}");
        }
    }

    #[test]
    fn a_short_part_goes_to_few_shards() {
        let parts = [Part { units: 1 << 20, grain: 256, effort: 1 }, Part { units: 4096, grain: 256, effort: 1 }];
        let touched = (1..=16).filter(|n| (Shard { number: *n, of: 16 }).pieces(&parts).iter().any(|p| p.part == 1));
        assert_eq!(touched.count(), 1);
    }

    #[test]
    fn what_is_left_is_divided_anew_without_a_gap() {
        let parts = [Part { units: 10_000, grain: 256, effort: 7 }, Part { units: 4096, grain: 256, effort: 1 }];
        let gaps = [(0, 512..2048), (0, 9984..10_000), (1, 256..4096)];
        let mut left = Vec::new();
        for number in 1..=3 {
            left.extend(rest(Shard { number, of: 3 }, &parts, &gaps));
        }
        let covers = |(part, gap): &(usize, Range<u64>)| {
            let mine = left.iter().filter(|p| p.part == *part && gap.contains(&p.units.start));
            mine.fold(gap.start, |at, p| if p.units.start == at { p.units.end } else { u64::MAX }) == gap.end
        };
        assert!(gaps.iter().all(covers), "{left:?}");
        assert_eq!(left.iter().map(|p| p.units.end - p.units.start).sum::<u64>(), 1536 + 16 + 3840);
    }

    #[test]
    fn a_shard_is_a_number_of_numbers() {
        assert_eq!("3/16".parse(), Ok(Shard { number: 3, of: 16 }));
        for wrong in ["0/4", "5/4", "3", "3/", "a/4", "1/0", "-1/4", "1/1000001"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
