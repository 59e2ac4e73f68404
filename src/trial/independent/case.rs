//! One case of the second generator: its number says its kind, family and sub-family whatever the
//! length of the trial.

use serde::{Deserialize, Serialize};

use super::draw::Draw;
use super::driven::Driven;
use super::oscillator_base::Size;
use super::still::Still;
use super::swept::Swept;
use super::truth::{Family, Kind, Truth};
use super::turned::Turned;
use super::{exact, near_miss, null, resonance, rest, tumble, unmodelled};

/// States how a case is linked to another: the same recording, written otherwise. Their verdicts
/// must agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// Every second row.
    Half,
    /// Every fifth row.
    Fifth,
    /// Every tenth row.
    Tenth,
    /// Readings a thousand times larger, input a millionth.
    Units,
    /// The sign of the reading turned.
    Sign,
    /// Columns in the other order.
    Swapped,
}

impl Change {
    /// All, in the order of the report.
    pub const ALL: [Self; 6] = [Self::Half, Self::Fifth, Self::Tenth, Self::Units, Self::Sign, Self::Swapped];

    /// One row of so many is in the copy.
    pub(crate) fn every(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Fifth => 5,
            Self::Tenth => 10,
            Self::Units | Self::Sign | Self::Swapped => 1,
        }
    }

    /// Name of the change in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Half => "every 2nd row",
            Self::Fifth => "every 5th row",
            Self::Tenth => "every 10th row",
            Self::Units => "other units",
            Self::Sign => "sign turned",
            Self::Swapped => "columns swapped",
        }
    }
}

/// Recipe of the recording, by kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// One proof mass, driven or ringing.
    Driven(Box<Driven>),
    /// A sensor at rest.
    Still(Box<Still>),
    /// An IMU hand-rotated.
    Turned(Box<Turned>),
    /// Stepped-sine sweeps of a resonator.
    Swept(Box<Swept>),
}

/// A case with its truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Number of the case: same seed and number, same case.
    pub number: usize,
    /// Kind of recording.
    pub kind: Kind,
    /// Relation of its truth to the library.
    pub family: Family,
    /// Sub-family within the family.
    pub sub: String,
    /// The change, where it is another one written otherwise.
    pub change: Option<Change>,
    /// Holds what is planted, and which names are right.
    pub truth: Truth,
    /// Recipe of the recording.
    pub body: Body,
}

/// Of each hundred cases; sums to one hundred.
const SCHEDULE: [(Kind, Family, usize); 10] = [
    (Kind::Driven, Family::Letter, 8),
    (Kind::Driven, Family::Near, 23),
    (Kind::Driven, Family::Foreign, 4),
    (Kind::Driven, Family::Null, 23),
    (Kind::Static, Family::Letter, 3),
    (Kind::Static, Family::Near, 13),
    (Kind::Static, Family::Null, 13),
    (Kind::Tumble, Family::Letter, 5),
    (Kind::Tumble, Family::Near, 4),
    (Kind::Tumble, Family::Null, 4),
];

/// Linked cases have the number of their origin and this, times one more than the place of their
/// change.
const LINKED: usize = 1_000_000;

/// First number of the cases at rest with a strong channel next to silent ones: behind all others,
/// which keep their numbers, and so their draws, as they were before these were added.
const BESIDE: usize = 100 * LINKED;
/// States how many cases there are for each of these.
const EACH_BESIDE: usize = 100;
/// First number of the cases of sweeps, which are a trial of their own.
const SWEPT: usize = 2 * BESIDE;

/// Kind, family and how many of the same came before.
fn slot(number: usize) -> (Kind, Family, usize) {
    let of = |place: usize| {
        // 37 and 100 have no common factor: each hundred holds each slot once, well mixed.
        let mut at = place * 37 % 100;
        let found = SCHEDULE.iter().position(|(.., count)| {
            let here = at < *count;
            at = at.wrapping_sub(if here { 0 } else { *count });
            here
        });
        found.unwrap_or(0)
    };
    let (place, slot) = (number % 100, of(number % 100));
    let before = (0..place).filter(|p| of(*p) == slot).count();
    let (kind, family, count) = SCHEDULE[slot];
    (kind, family, number / 100 * count + before)
}

/// States where a case stands among the others; known by its number, before it is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Kind of recording.
    pub kind: Kind,
    /// Relation of its truth to the library.
    pub family: Family,
    /// Sub-family within the family.
    pub sub: &'static str,
    /// The change, where it is another case written otherwise.
    pub change: Option<Change>,
}

impl Place {
    /// Returns the place of a case.
    pub fn of(number: usize) -> Self {
        if number >= SWEPT {
            let (family, nth) = resonance::turn(number - SWEPT);
            return Self { kind: Kind::Response, family, sub: resonance::sub(family, nth), change: None };
        }
        if number >= BESIDE {
            return Self { kind: Kind::Static, family: Family::Near, sub: rest::BESIDE_SILENT, change: None };
        }
        let (kind, family, nth) = slot(number % LINKED);
        let sub = match (kind, family) {
            (Kind::Driven, Family::Letter) => exact::sub(nth),
            (Kind::Driven, Family::Near) => near_miss::sub(nth),
            (Kind::Driven, Family::Foreign) => unmodelled::sub(nth),
            (Kind::Driven, Family::Null) => null::sub(nth),
            (Kind::Static, _) => rest::sub(family, nth),
            (Kind::Tumble, _) => tumble::sub(family, nth),
            (Kind::Response, _) => resonance::sub(family, nth),
        };
        let how = number / LINKED;
        Self { kind, family, sub, change: how.checked_sub(1).and_then(|how| Change::ALL.get(how)).copied() }
    }
}

/// Returns the number of a case written otherwise.
pub(crate) fn rewritten(origin: usize, change: Change) -> usize {
    let how = Change::ALL.iter().position(|c| *c == change).unwrap_or(0) + 1;
    how * LINKED + origin
}

impl Case {
    /// Fewest rows of a copy at a lower rate.
    pub(crate) const LEAST_ROWS: usize = 1500;

    /// Makes a case by its number. None where it cannot be written that way: too few rows, say.
    pub fn make(seed: u64, number: usize, size: Size) -> Option<Self> {
        if number >= SWEPT {
            let (family, nth) = resonance::turn(number - SWEPT);
            let mut draw = Draw::new(seed, number as u64, 1);
            let (sub, swept, truth) = resonance::draw(family, nth, &mut draw);
            let (kind, body) = (Kind::Response, Body::Swept(Box::new(swept)));
            return Some(Self { number, kind, family, sub, change: None, truth, body });
        }
        if number >= BESIDE {
            let (sub, still, truth) = rest::draw_beside_silent(&mut Draw::new(seed, number as u64, 1), size);
            let (kind, family) = (Kind::Static, Family::Near);
            let body = Body::Still(Box::new(still));
            return Some(Self { number, kind, family, sub, change: None, truth, body });
        }
        let (origin, how) = (number % LINKED, number / LINKED);
        let (kind, family, nth) = slot(origin);
        let mut draw = Draw::new(seed, origin as u64, 1);
        let (sub, body, truth) = match (kind, family) {
            (Kind::Driven, Family::Letter) => boxed(exact::draw(nth, &mut draw, size)),
            (Kind::Driven, Family::Near) => boxed(near_miss::draw(nth, &mut draw, size)),
            (Kind::Driven, Family::Foreign) => boxed(unmodelled::draw(nth, &mut draw, size)),
            (Kind::Driven, Family::Null) => boxed(null::draw(nth, &mut draw, size)),
            (Kind::Static, _) => {
                let (sub, still, truth) = rest::draw(family, nth, &mut draw, size);
                (sub, Body::Still(Box::new(still)), truth)
            }
            (Kind::Tumble, _) => {
                let (sub, turned, truth) = tumble::draw(family, nth, &mut draw, size);
                (sub, Body::Turned(Box::new(turned)), truth)
            }
            (Kind::Response, _) => return None,
        };
        let mut case = Self { number, kind, family, sub, change: None, truth, body };
        if how > 0 {
            case.rewrite(*Change::ALL.get(how - 1)?)?;
        }
        Some(case)
    }

    /// Case numbers of a trial: `cases` different ones, and for every fifth of them two copies
    /// (decimated, in other units or of the other sign); behind them one in a hundred with a strong
    /// channel next to silent ones.
    pub fn numbers(cases: usize) -> Vec<usize> {
        let linked = (0..cases).filter(|n| n % 5 == 2).flat_map(|n| {
            let first = n / 5 % Change::ALL.len();
            [first, (first + 3) % Change::ALL.len()].map(|how| (how + 1) * LINKED + n)
        });
        (0..cases).chain(linked).chain((0..cases / EACH_BESIDE).map(|n| BESIDE + n)).collect()
    }

    /// Case numbers of a trial of one kind. Sweeps are in no other trial: there are `cases` of them; of the
    /// other kinds it is those that a trial of `cases` holds.
    pub fn numbers_of(kind: Kind, cases: usize) -> Vec<usize> {
        match kind {
            Kind::Response => (SWEPT..SWEPT + cases).collect(),
            _ => Self::numbers(cases).into_iter().filter(|n| Place::of(*n).kind == kind).collect(),
        }
    }

    /// The number of the case it is linked to, itself where it is none.
    pub fn origin(&self) -> usize {
        if self.number < BESIDE { self.number % LINKED } else { self.number }
    }

    fn rewrite(&mut self, change: Change) -> Option<()> {
        let driven = match &mut self.body {
            Body::Driven(driven) => driven,
            Body::Still(still) => {
                rewrite_still(still, change)?;
                self.truth.parameters = Vec::new();
                self.change = Some(change);
                return Some(());
            }
            Body::Turned(_) | Body::Swept(_) => return None,
        };
        let (o, columns) = (&driven.oscillator, &mut driven.columns);
        match change {
            Change::Half | Change::Fifth | Change::Tenth => {
                let every = change.every();
                let rate_hz = o.rate_hz / every as f64;
                // A held input is not known from every k-th value; a fast one is not known from few
                // rows.
                let fast = o.input.highest_hz().max(o.omega / std::f64::consts::TAU);
                if o.held || o.rows / every < Self::LEAST_ROWS || rate_hz < 4.0 * fast {
                    return None;
                }
                columns.every = every;
                self.truth.evidence /= every as f64;
                self.truth.effects.iter_mut().for_each(|e| e.evidence /= every as f64);
                self.truth.floor = self.truth.floor.map(|[sigma, rows]| [sigma, rows / every as f64]);
            }
            Change::Units => {
                columns.output_scale *= 1e3;
                columns.offset *= 1e3;
                columns.step *= 1e3;
                columns.input_scale *= 1e-6;
                self.truth.floor = self.truth.floor.map(|[sigma, rows]| [1e3 * sigma, rows]);
            }
            Change::Sign => {
                columns.output_scale *= -1.0;
                columns.offset *= -1.0;
            }
            Change::Swapped => columns.swapped = !columns.swapped,
        }
        self.truth.parameters = if self.truth.parameters.is_empty() { Vec::new() } else { driven.parameters() };
        self.change = Some(change);
        Some(())
    }

    /// recording.csv and model.toml: what the diagnosis may see, and nothing else.
    pub fn texts(&self) -> [String; 2] {
        match &self.body {
            Body::Driven(driven) => driven.texts(),
            Body::Still(still) => still.texts(),
            Body::Turned(turned) => turned.texts(),
            Body::Swept(swept) => swept.texts(),
        }
    }
}

/// A recording at rest in other units or with its sign turned; every k-th row would be another
/// noise.
fn rewrite_still(still: &mut Still, change: Change) -> Option<()> {
    let factor = match change {
        Change::Units => 1e3,
        Change::Sign => -1.0,
        _ => return None,
    };
    still.mean.iter_mut().for_each(|m| *m *= factor);
    still.sigma.iter_mut().for_each(|s| *s *= factor);
    still.step *= factor.abs();
    // The data sheet promises a size.
    still.promised = still.promised.map(|p| p * factor.signum());
    Some(())
}

fn boxed((sub, driven, truth): exact::Made) -> (String, Body, Truth) {
    (sub, Body::Driven(Box::new(driven)), truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_hundred_holds_the_schedule_and_a_number_means_the_same_in_any_trial() {
        assert_eq!(SCHEDULE.iter().map(|s| s.2).sum::<usize>(), 100);
        for (kind, family, count) in SCHEDULE {
            let of = |n: &usize| slot(*n).0 == kind && slot(*n).1 == family;
            assert_eq!((0..100).filter(of).count(), count);
            let nths: Vec<usize> = (0..300).filter(of).map(|n| slot(n).2).collect();
            assert_eq!(nths, (0..3 * count).collect::<Vec<_>>());
        }
        assert!(Case::numbers(100).iter().all(|n| Case::numbers(2000).contains(n)));
    }

    #[test]
    fn a_strong_channel_beside_silent_ones_comes_behind_all_other_cases() {
        let numbers = Case::numbers(400);
        assert_eq!(numbers.iter().filter(|n| **n >= BESIDE).count(), 4);
        assert_eq!(numbers.len() - 4, numbers.iter().position(|n| *n >= BESIDE).expect("listed"));
        let case = Case::make(3, BESIDE, Size { rows: 4000 }).expect("made");
        assert_eq!(case.sub, Place::of(BESIDE).sub);
        let Body::Still(still) = &case.body else { panic!("at rest") };
        let acts = |c: usize| still.effect(0, c).iter().any(|v| *v != 0.0);
        let silent: Vec<&String> = (0..3).filter(|c| !acts(*c)).map(|c| &still.headings[c]).collect();
        assert!(silent.len() == 2 && silent.iter().copied().eq(&case.truth.silent), "{:?}", case.truth.silent);
        assert!(case.truth.is_detectable() && case.origin() == BESIDE);
        assert_ne!(case.texts(), Case::make(3, BESIDE + 1, Size { rows: 4000 }).expect("made").texts());
    }

    #[test]
    fn the_same_recording_written_otherwise_is_the_same_recording() {
        let size = Size { rows: 4000 };
        let numbers = |text: &str| -> Vec<Vec<f64>> {
            text.lines().skip(1).map(|l| l.split(',').map(|v| v.parse().expect("a number")).collect()).collect()
        };
        let pair = |change: Change, number: usize| -> Option<[Vec<Vec<f64>>; 2]> {
            let other = Case::make(3, rewritten(number, change), size)?;
            assert_eq!(Place::of(other.number).change, Some(change));
            let origin = Case::make(3, other.origin(), size)?;
            Some([&origin, &other].map(|c| numbers(&c.texts()[0])))
        };
        let nulls = || (0..60).filter(|n| slot(*n).0 == Kind::Driven && slot(*n).1 == Family::Null);
        let thinned: Vec<_> = nulls().filter_map(|n| pair(Change::Half, n)).collect();
        assert!(!thinned.is_empty());
        for [first, other] in thinned {
            assert!(other.iter().eq(first.iter().step_by(2)));
            assert!(!other.iter().eq(first.iter().skip(1).step_by(2)), "shifted rows are seen: control");
        }
        let swapped: Vec<_> = nulls().filter_map(|n| pair(Change::Swapped, n)).filter(|p| p[0][0].len() == 2).collect();
        assert!(!swapped.is_empty());
        for [first, other] in swapped {
            assert!(other.iter().zip(&first).all(|(a, b)| (a[0], a[1]) == (b[1], b[0])));
        }
    }

    #[test]
    fn every_slot_makes_cases_with_files_that_repeat() {
        let size = Size { rows: 1000 };
        for number in 0..25 {
            let case = Case::make(5, number, size).expect("made");
            assert!(case.texts() == Case::make(5, number, size).expect("made").texts());
            let place = Place::of(number);
            assert_eq!((place.kind, place.family, place.sub), (case.kind, case.family, case.sub.as_str()));
            assert_eq!(case.family == Family::Null, case.truth.effects.is_empty() && case.family != Family::Foreign);
            let text = serde_json::to_string(&case).expect("written");
            assert_eq!(serde_json::from_str::<Case>(&text).expect("read"), case);
        }
    }
}
