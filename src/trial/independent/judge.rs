//! Right, honest or false: one verdict against the truth of its case, by fixed rules.
//!
//! A name is false unless the truth allows it; names that only point to the right place are right
//! where nothing is called explained. In a tie one right name is enough.

use serde::{Deserialize, Serialize};

use super::case::Case;
use super::stated;
use super::truth::{Family, SEEN, Truth};
use crate::said::{Ending, Number, Said};

/// Worth of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mark {
    /// All that is there is named and nothing else; a null is adequate; foreign physics is
    /// unexplained without a name.
    Right,
    /// Called explained by the right name, though the truth departs from its statement by more than
    /// a good test sees.
    Overclaimed,
    /// Unexplained or undecidable, with right names only.
    HonestNamed,
    /// Unexplained or undecidable, without a name.
    Honest,
    /// Adequate, and nothing is there that a good test sees.
    BelowDetection,
    /// Adequate, or explained in part, with something there that a good test sees.
    Missed,
    /// A false name, and not called explained.
    FalseName,
    /// A false name, called explained.
    ConfidentlyWrong,
    /// A null called undecidable.
    Undecided,
    /// A null with a name, or unexplained.
    FalseAlarm,
    /// The diagnosis ended with an error.
    Error,
}

impl Mark {
    /// All, in the order of the report.
    pub const ALL: [Self; 11] = [
        Self::Right,
        Self::Overclaimed,
        Self::HonestNamed,
        Self::Honest,
        Self::BelowDetection,
        Self::Missed,
        Self::FalseName,
        Self::ConfidentlyWrong,
        Self::Undecided,
        Self::FalseAlarm,
        Self::Error,
    ];

    /// Name of the mark in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Overclaimed => "explained, only near",
            Self::HonestNamed => "honest, right name",
            Self::Honest => "honest, no name",
            Self::BelowDetection => "too small to see",
            Self::Missed => "missed",
            Self::FalseName => "false name",
            Self::ConfidentlyWrong => "confidently wrong",
            Self::Undecided => "null undecided",
            Self::FalseAlarm => "false alarm",
            Self::Error => "error",
        }
    }

    /// Returns whether a name was false, however sure it was.
    pub fn is_false_name(self) -> bool {
        matches!(self, Self::FalseName | Self::ConfidentlyWrong)
    }

    /// Returns whether a null was not left alone.
    pub fn is_alarm(self) -> bool {
        matches!(self, Self::FalseAlarm | Self::Undecided)
    }
}

/// The mark of a verdict on a case.
pub fn judge(case: &Case, said: &Said) -> Mark {
    mark(case.family, &case.truth, said, || overclaims(case, said))
}

/// The mark of a verdict on a truth; near a law, `overclaims` says whether what is called explained
/// is not.
pub(crate) fn mark(family: Family, truth: &Truth, said: &Said, overclaims: impl FnOnce() -> bool) -> Mark {
    let ids = said.ids();
    if said.outcome == Ending::Error {
        return Mark::Error;
    }
    if family == Family::Null {
        return match said.outcome {
            // A finding that belongs to the recording without being a mismatch is no alarm.
            Ending::Adequate => Mark::Right,
            Ending::Explained if !ids.is_empty() && ids.iter().all(|id| truth.allows(id)) => Mark::Right,
            Ending::Undecidable => Mark::Undecided,
            _ => Mark::FalseAlarm,
        };
    }
    if said.numbers.iter().any(|n| truth.silent.contains(&n.channel)) {
        return if said.outcome == Ending::Explained { Mark::ConfidentlyWrong } else { Mark::FalseName };
    }
    let lacks = || {
        let missing = |e: &super::truth::Effect| e.evidence >= SEEN && !e.right.iter().any(|r| ids.contains(r));
        truth.effects.iter().any(missing)
    };
    match said.outcome {
        Ending::Error => Mark::Error,
        Ending::Adequate if truth.is_detectable() => Mark::Missed,
        Ending::Adequate => Mark::BelowDetection,
        Ending::Explained if !ids.iter().all(|id| truth.allows(id)) => Mark::ConfidentlyWrong,
        Ending::Explained if truth.effects.is_empty() => Mark::ConfidentlyWrong,
        Ending::Explained => match () {
            () if lacks() => Mark::Missed,
            () if family == Family::Near && overclaims() => Mark::Overclaimed,
            () => Mark::Right,
        },
        // A tie between names of which each is right is all that can be said.
        Ending::Undecidable if !ids.is_empty() && ids.iter().all(|id| truth.allows(id)) && !lacks() => Mark::Right,
        Ending::Unexplained | Ending::Undecidable
            if !said.groups.iter().all(|g| g.iter().any(|id| truth.tolerates(id))) =>
        {
            Mark::FalseName
        }
        Ending::Unexplained | Ending::Undecidable if !ids.is_empty() => Mark::HonestNamed,
        Ending::Unexplained if truth.effects.is_empty() => Mark::Right,
        Ending::Unexplained | Ending::Undecidable => Mark::Honest,
    }
}

/// Returns whether what is called explained is not: the nearest statement leaves too much, or the
/// repaired model runs worse than the noise by four standard errors of a variance over a third of
/// the rows and by what a good test sees.
fn overclaims(case: &Case, said: &Said) -> bool {
    let worse = case.truth.floor.is_some_and(|[sigma, rows]| {
        let excess = (said.rmse[1] / sigma).powi(2) - 1.0;
        excess > SEEN / rows && excess > 4.0 * (2.0 / (rows / 3.0)).sqrt()
    });
    // What the statement leaves where the verdict gives its shape and delay, at the best
    // amplitudes; else what its straight form does.
    worse || stated::left(case, said).or(case.truth.departure).is_some_and(|d| d >= SEEN)
}

/// One interval against the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Covered {
    /// Id of the effect.
    pub id: String,
    /// Name of the parameter.
    pub name: String,
    /// Planted value.
    pub truth: f64,
    /// Estimated value.
    pub value: f64,
    /// Interval of 95 % of the estimate.
    pub ci95: [f64; 2],
    /// States whether the interval contains the true value.
    pub covers: bool,
}

/// The intervals of right names that are true to the letter; near a law, those of exponents, which
/// say what the name leaves open.
pub fn coverage(case: &Case, said: &Said) -> Vec<Covered> {
    if judge(case, said) != Mark::Right {
        return Vec::new();
    }
    let held = |n: &Number| {
        let (truth, covers) = holds(case, n)?;
        Some(Covered { id: n.id.clone(), name: n.name.clone(), truth, value: n.value, ci95: n.ci95, covers })
    };
    said.numbers.iter().filter_map(held).collect()
}

/// The true value of a number that a verdict gives, where the truth has one, and whether its
/// interval holds it.
pub(crate) fn holds(case: &Case, n: &Number) -> Option<(f64, bool)> {
    let is_judged = match case.family {
        Family::Letter => true,
        Family::Near => n.name == "n",
        Family::Foreign | Family::Null => false,
    };
    let of = |p: &&super::truth::Parameter| {
        p.id == n.id && p.name == n.name && p.channel.as_ref().is_none_or(|c| *c == n.channel)
    };
    let truth = case.truth.parameters.iter().filter(|_| is_judged).find(of)?.value;
    // Files hold ten digits: a step read off them exactly may still differ in the last.
    let air = 1e-6 * truth.abs();
    // The side of a stop is a matter of sign.
    let [low, high] = match n.name == "gap" && n.value < 0.0 {
        true => [-n.ci95[1], -n.ci95[0]],
        false => n.ci95,
    };
    Some((truth, low - air <= truth && truth <= high + air))
}

#[cfg(test)]
mod tests {
    use super::super::case::{Change, Place, rewritten};
    use super::*;
    use crate::independent::oscillator_base::Size;
    use crate::independent::truth::{Effect, Kind, effect};

    fn said(outcome: Ending, groups: &[&[&str]]) -> Said {
        let groups = groups.iter().map(|g| g.iter().map(|id| (*id).to_owned()).collect()).collect();
        Said { outcome, groups, numbers: Vec::new(), rmse: [0.0; 3], seconds: 0.0, words: String::new() }
    }

    fn marks(family: Family, truth: &Truth) -> [Mark; 6] {
        let number = (0..100).find(|n| Case::make(1, *n, Size { rows: 2000 }).is_some()).expect("one driven case");
        let case = Case { family, truth: truth.clone(), ..Case::make(1, number, Size { rows: 2000 }).expect("made") };
        [
            said(Ending::Explained, &[&["cubic-stiffness"]]),
            said(Ending::Explained, &[&["cubic-stiffness"], &["force-noise"]]),
            said(Ending::Unexplained, &[&["hysteresis"]]),
            said(Ending::Undecidable, &[&["cubic-stiffness", "end-stop"]]),
            said(Ending::Unexplained, &[]),
            said(Ending::Adequate, &[]),
        ]
        .map(|said| judge(&case, &said))
    }

    #[test]
    fn each_verdict_has_its_mark_in_each_family() {
        use Mark::*;
        let mut cubic = effect(&["cubic-stiffness"]);
        cubic.evidence = 500.0;
        let seen = Truth { effects: vec![cubic.clone()], evidence: 500.0, ..Truth::default() };
        assert_eq!(marks(Family::Near, &seen), [Right, ConfidentlyWrong, FalseName, HonestNamed, Honest, Missed]);
        let faint = Truth { evidence: 5.0, ..seen.clone() };
        assert_eq!(marks(Family::Letter, &faint)[5], BelowDetection);
        let more = Truth { effects: vec![cubic, Effect { evidence: 900.0, ..effect(&["warm-up"]) }], ..seen };
        assert_eq!(marks(Family::Letter, &more)[0], Missed);
        let foreign = Truth { evidence: 500.0, tolerable: vec!["hysteresis".into()], ..Truth::default() };
        assert_eq!(
            marks(Family::Foreign, &foreign),
            [ConfidentlyWrong, ConfidentlyWrong, HonestNamed, FalseName, Right, Missed]
        );
        let null = marks(Family::Null, &Truth::default());
        assert_eq!(null, [FalseAlarm, FalseAlarm, FalseAlarm, Undecided, FalseAlarm, Right]);
    }

    // Control: a tie with a name that is not right, and one that leaves out another effect that a good test sees.
    #[test]
    fn a_tie_between_names_of_which_each_is_right_is_right() {
        let seen = |right: &[&str]| Effect { evidence: 500.0, ..effect(right) };
        let of = |effects: Vec<Effect>, tie: &[&str]| {
            let truth = Truth { effects, evidence: 500.0, ..Truth::default() };
            let made = Case::make(1, 0, Size { rows: 2000 }).expect("made");
            judge(&Case { family: Family::Letter, truth, ..made }, &said(Ending::Undecidable, &[tie]))
        };
        let either = seen(&["quadratic-damping", "squeeze-film-damping"]);
        let tie = ["quadratic-damping", "squeeze-film-damping"];
        assert_eq!(of(vec![either.clone()], &tie), Mark::Right);
        assert_eq!(of(vec![either.clone()], &["quadratic-damping", "hysteresis"]), Mark::HonestNamed);
        assert_eq!(of(vec![either, seen(&["cubic-stiffness"])], &tie), Mark::HonestNamed);
    }

    #[test]
    fn a_right_name_in_a_column_where_nothing_acts_is_false() {
        let effects = vec![Effect { evidence: 500.0, ..effect(&["cubic-stiffness"]) }];
        let truth = Truth { effects, evidence: 500.0, silent: vec!["y".into()], ..Truth::default() };
        let family = Family::Letter;
        let case = Case { family, truth, ..Case::make(1, 0, Size { rows: 2000 }).expect("made") };
        let mark = |outcome, channel: &str| {
            let id = "cubic-stiffness".to_owned();
            let number = Number { id, channel: channel.into(), name: "slope".into(), value: 1.0, ci95: [0.9, 1.1] };
            judge(&case, &Said { numbers: vec![number], ..said(outcome, &[&["cubic-stiffness"]]) })
        };
        let marks = [Ending::Explained, Ending::Unexplained].map(|outcome| [mark(outcome, "x"), mark(outcome, "y")]);
        assert_eq!(marks, [[Mark::Right, Mark::ConfidentlyWrong], [Mark::HonestNamed, Mark::FalseName]]);
    }

    // A verdict whose error is the noise is as good in other units, and over every second row.
    #[test]
    fn the_noise_that_a_repaired_model_has_to_reach_is_in_the_units_and_rows_of_the_copy() {
        let size = Size { rows: 4000 };
        let near = |n: &usize| (Place::of(*n).kind, Place::of(*n).family) == (Kind::Driven, Family::Near);
        let floors = |change: Change| {
            let pair = |n: usize| Some((Case::make(7, n, size)?, Case::make(7, rewritten(n, change), size)?));
            let known = |(own, copy): (Case, Case)| Some((own.truth.floor?, copy.truth.floor?));
            (0..100).filter(near).filter_map(pair).filter_map(known).take(3).collect::<Vec<_>>()
        };
        let (units, half) = (floors(Change::Units), floors(Change::Half));
        assert!(units.len() == 3 && half.len() == 3, "{} {}", units.len(), half.len());
        assert!(units.iter().all(|(own, copy)| copy[0] == 1e3 * own[0] && copy[1] == own[1]));
        assert!(half.iter().all(|(own, copy)| copy[0] == own[0] && copy[1] == 0.5 * own[1]));
    }
}
