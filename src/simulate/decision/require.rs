//! Which value of a key, or which common factor of several, meets a requirement: a sequential
//! search that spends members where they decide.
//!
//! Few members find between which two values, a factor of four apart, the statistic crosses its
//! limit, and then about where. There, the same members at two neighbouring values give the
//! crossing with its interval ([`Panel`]); each stage estimates from the width of that interval how
//! many members the wanted one takes (Stein, *Ann. Math. Stat.* 16, 243, 1945), and stops when it
//! is reached.

use super::panel::{Crossing, Panel};
use super::statistic::Limit;
use super::values::{FIRST, Place, Work};
use crate::control::Control;
use crate::error::{Error, Kind, Result};
use crate::numerics::order;
use crate::statistics::Estimate;
use crate::study::{Assignment, Study, StudyText};

/// Ratio of neighbouring values of the first search, and how many of them there are in each
/// direction.
const RATIO: f64 = 4.0;
const RUNGS: i32 = 12;
/// Length of a run over the study's own from which a value is not tried: each rung of a key that lengthens
/// it, as a still start does, costs four times as much as the one before.
const LONGEST: u64 = 256;
/// End of the second search: the ratio of two values.
const NEAR: f64 = 1.1;
/// Steps of the second search: from a factor of four to NEAR are five.
const BISECTIONS: usize = 30;
/// Half-width of a crossing's interval over its value, where none is asked for.
pub const TOLERANCE: f64 = 0.01;
/// Stages of the last search before it is given up.
const STAGES: usize = 12;
/// The estimated number of members is multiplied by this, so that the next stage is usually the
/// last.
const MARGIN: f64 = 1.15;

/// A requirement and the keys to vary.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The requirement to meet.
    pub limit: Limit,
    /// Dotted paths of the keys; several are scaled by one factor.
    pub vary: Vec<String>,
    /// Wanted half-width of the interval over the value.
    pub tolerance: f64,
    /// Most members of one value, where not the usual.
    pub most: Option<u64>,
}

/// One varied key and the value found for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// Dotted path of the key in study.toml.
    pub key: String,
    /// Value at which the requirement is just met; `None` where no value meets it.
    pub value: Option<f64>,
    /// 95 % interval of the value.
    pub ci95: [Option<f64>; 2],
}

/// Relation of the statistic to the limit over the values tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// The statistic crosses the limit.
    Crosses {
        /// Says whether values below the crossing meet the requirement, as for an error; else those
        /// above it.
        below: bool,
    },
    /// All values that were tried meet it.
    Always,
    /// No value meets the limit.
    Never,
}

/// Result of the search: the value of each key at which the requirement is just met.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Says whether and how the limit is crossed.
    pub outcome: Outcome,
    /// Values found, one per key.
    pub vary: Vec<Value>,
    /// Says whether the interval is as narrow as was asked.
    pub settled: bool,
    /// The value over the study's own, over one where it gives none.
    pub at: Option<f64>,
    /// The statistic at the value, or where no value meets the requirement, at the best one tried.
    pub statistic: Estimate,
    /// Values tried, over the study's own value (over one where it gives none), and the statistic
    /// there; values increase.
    pub tried: Vec<(f64, f64)>,
    /// Members integrated, each as often as it was.
    pub members: u64,
}

/// The keys and what they are at a factor of one.
struct Family<'a> {
    source: &'a StudyText,
    fixed: Vec<Assignment>,
    keys: Vec<(String, f64)>,
}

impl Family<'_> {
    fn study(&self, factor: f64) -> Result<Study> {
        let varied = self.keys.iter().map(|(key, one)| Assignment::number(key, one * factor));
        let set: Vec<Assignment> = self.fixed.iter().cloned().chain(varied).collect();
        self.source.with(&set)
    }
}

/// The keys with the values that they have in the study.
fn family<'a>(source: &'a StudyText, question: &Question) -> Result<Family<'a>> {
    let mut keys = Vec::new();
    for key in &question.vary {
        let one = source.number(key)?.filter(|v| *v != 0.0 && v.is_finite());
        if one.is_none() && question.vary.len() > 1 {
            return Err(Error::new(
                format!("could not vary {}", question.vary.join(" and ")),
                format!("the study gives no number other than zero for `{key}`, and several keys are scaled together"),
                format!("give it one, e.g. with --set {key}=1, or vary one key"),
            ));
        }
        keys.push((key.clone(), one.unwrap_or(1.0)));
    }
    Ok(Family { source, fixed: Vec::new(), keys })
}

/// Answers.
///
/// # Errors
/// A key that the study does not have, a time outside the run; stopped.
pub fn answer(source: &StudyText, question: &Question, control: &Control) -> Result<Answer> {
    let family = family(source, question)?;
    // A misspelt key is refused here, and a value that cannot be further on ends the range.
    let study = family.study(1.0)?;
    let place = Place::of(&question.limit, &study)?;
    let (work, most) = (Work::new(control, "searching"), place.most_members(&study, question.most));
    let mut search = Search { family: &family, question, place, work, most, tried: Vec::new() };
    let mut members = FIRST;
    let found = loop {
        let found = search.bracket(members)?;
        match found {
            // So few members may be wrong about the best value.
            Found::Never(best) if 16 * members <= search.most && search.is_open(best, members)? => members *= 16,
            found => break found,
        }
    };
    let one_value = |value: f64, statistic: Estimate| Settled {
        crossing: Some(Crossing { value, ci95: [None; 2] }),
        narrow: true,
        statistic,
    };
    let (outcome, settled) = match found {
        Found::Between(low, high) => {
            let below = search.meets(low);
            (Outcome::Crosses { below }, search.settle(low.0, high.0, below)?)
        }
        Found::Always(value) => (Outcome::Always, one_value(value, search.estimate(value, members)?)),
        Found::Never(best) => {
            (Outcome::Never, Settled { crossing: None, ..one_value(best, search.estimate(best, members)?) })
        }
    };
    let scaled = |(key, one): &(String, f64)| {
        let mut ci95 = settled.crossing.map_or([None; 2], |c| c.ci95.map(|end| end.map(|factor| factor * one)));
        if *one < 0.0 {
            ci95.reverse();
        }
        Value { key: key.clone(), value: settled.crossing.map(|c| c.value * one), ci95 }
    };
    let vary = family.keys.iter().map(scaled).collect();
    let mut tried = search.tried;
    order::sort_by_key(&mut tried, |(value, _)| *value);
    let members = search.work.members();
    let at = settled.crossing.map(|c| c.value);
    Ok(Answer { outcome, vary, at, settled: settled.narrow, statistic: settled.statistic, tried, members })
}

/// Two neighbouring values of a key between which a requirement is just met.
pub(super) struct Between<'a> {
    pub source: &'a StudyText,
    /// Other keys that are set in it.
    pub fixed: Vec<Assignment>,
    pub key: &'a str,
    pub limit: &'a Limit,
    pub ends: [f64; 2],
}

/// A crossing of the limit between two neighbouring values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossed {
    /// Value at which the statistic equals the limit, in the key's unit.
    pub value: f64,
    /// 95 % interval of the crossing.
    pub ci95: [Option<f64>; 2],
    /// Says whether the values below it meet the requirement.
    pub below: bool,
}

impl Between<'_> {
    /// The crossing, to the usual tolerance; `below` says that the requirement is met at the
    /// smaller value.
    ///
    /// # Errors
    /// As [`answer`].
    pub(super) fn crossing(self, below: bool, control: &Control) -> Result<Crossed> {
        let [low, high] = self.ends;
        // The search is among positive factors.
        let sign = if high <= 0.0 { -1.0 } else { 1.0 };
        let ends = if sign < 0.0 { [-high, -low] } else { [low, high] };
        let family = Family { source: self.source, fixed: self.fixed, keys: vec![(self.key.to_owned(), sign)] };
        let vary = vec![self.key.to_owned()];
        let question = Question { limit: self.limit.clone(), vary, tolerance: TOLERANCE, most: None };
        let study = family.study(ends[1])?;
        let place = Place::of(self.limit, &study)?;
        let (work, most) = (Work::new(control, "looking for the crossing"), place.most_members(&study, None));
        let mut search = Search { family: &family, question: &question, place, work, most, tried: Vec::new() };
        let met_below = below == (sign > 0.0);
        let settled = search.settle(ends[0], ends[1], met_below)?;
        let Crossing { value, mut ci95 } =
            settled.crossing.unwrap_or(Crossing { value: 0.5 * (ends[0] + ends[1]), ci95: [None; 2] });
        ci95 = ci95.map(|end| end.map(|end| sign * end));
        if sign < 0.0 {
            ci95.reverse();
        }
        Ok(Crossed { value: sign * value, ci95, below })
    }
}

/// Result of the last search.
struct Settled {
    crossing: Option<Crossing>,
    /// Says whether its interval is as narrow as was asked.
    narrow: bool,
    statistic: Estimate,
}

/// A factor and the statistic there.
type Point = (f64, f64);

/// Result of the first search.
enum Found {
    /// Two neighbouring factors, increasing, with the limit between them.
    Between(Point, Point),
    /// Nothing but what meets it; the largest factor tried.
    Always(f64),
    /// Nothing that meets it; the factor with the smallest statistic.
    Never(f64),
}

struct Search<'a> {
    family: &'a Family<'a>,
    question: &'a Question,
    place: Place,
    work: Work<'a>,
    /// Most members of one value.
    most: u64,
    tried: Vec<Point>,
}

impl Search<'_> {
    /// Errors of the first members at a factor; those that failed are NaN.
    fn values(&mut self, factor: f64, members: u64) -> Result<Vec<f64>> {
        self.work.values(&self.family.study(factor)?, self.place, 0..members)
    }

    /// The statistic at a factor with its interval, without members that failed.
    fn estimate(&mut self, factor: f64, members: u64) -> Result<Estimate> {
        let mut values = self.values(factor, members)?;
        values.retain(|v| v.is_finite());
        Ok(self.question.limit.statistic.estimate(&values))
    }

    /// The statistic at a factor; where all members failed, it is infinite.
    fn look(&mut self, factor: f64, members: u64) -> Result<Point> {
        let mut values = self.values(factor, members)?;
        values.retain(|v| v.is_finite());
        let statistic = self.question.limit.statistic.shifted(&mut values, 0.0);
        let point = (factor, if statistic.is_nan() { f64::INFINITY } else { statistic });
        self.tried.push(point);
        Ok(point)
    }

    fn meets(&self, point: Point) -> bool {
        point.1 < self.question.limit.below
    }

    /// Returns whether a factor that seems to miss the limit may still meet it, judged by
    /// `members`.
    fn is_open(&mut self, factor: f64, members: u64) -> Result<bool> {
        Ok(self.estimate(factor, members)?.ci95[0] < self.question.limit.below)
    }

    /// Returns whether a run takes far longer at a factor than the study's own.
    fn is_too_long(&self, factor: f64) -> bool {
        let samples = |factor: f64| {
            let study = self.family.study(factor).ok()?;
            Some(self.place.samples + study.alignment.still_samples())
        };
        samples(factor).zip(samples(1.0)).is_some_and(|(long, own)| long > LONGEST * own)
    }

    /// The first search: rungs of a ladder, away from the study's own value, until the limit lies
    /// between two.
    fn bracket(&mut self, members: u64) -> Result<Found> {
        let start = self.look(1.0, members)?;
        let met = self.meets(start);
        let mut ends = vec![start];
        // More of an error is worse: what meets the limit is followed upward first, what misses it
        // downward.
        for up in [met, !met] {
            let mut before = start;
            for rung in 1..=RUNGS {
                let factor = RATIO.powi(if up { rung } else { -rung });
                if self.is_too_long(factor) {
                    break;
                }
                let point = match self.look(factor, members) {
                    Ok(point) => point,
                    Err(error) if error.kind == Kind::Interrupted => return Err(error),
                    // No sensor has that, or the study's other numbers do not go with it: the range
                    // ends here.
                    Err(_) => break,
                };
                if self.meets(point) != met {
                    return Ok(if up { Found::Between(before, point) } else { Found::Between(point, before) });
                }
                before = point;
            }
            ends.push(before);
        }
        let best = ends.iter().copied().reduce(|a, b| if b.1 < a.1 { b } else { a }).map_or(1.0, |end| end.0);
        Ok(if met { Found::Always(ends.iter().fold(1.0, |most, end| most.max(end.0))) } else { Found::Never(best) })
    }

    /// The second search, by bisection, and the third: the crossing with its interval, between two
    /// increasing factors of which the smaller, or else the larger one, meets the limit. The larger
    /// one is positive.
    fn settle(&mut self, mut low: f64, mut high: f64, met_below: bool) -> Result<Settled> {
        let mut steps = 0;
        while (low <= 0.0 || high / low >= NEAR) && steps < BISECTIONS {
            // A ratio where there is one; zero and less are left by halves.
            let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
            let point = self.look(middle, FIRST)?;
            if self.meets(point) == met_below {
                low = middle
            } else {
                high = middle
            }
            steps += 1;
        }
        let (low, high) = (low.max(0.5 * high), high);
        let Question { limit, tolerance, .. } = self.question;
        let (mut centre, mut spread, mut members) = ((low * high).sqrt(), NEAR - 1.0, 4 * FIRST);
        let unknown = Estimate { value: f64::NAN, ci95: [f64::NAN; 2] };
        let mut best =
            Settled { crossing: Some(Crossing { value: centre, ci95: [None; 2] }), narrow: false, statistic: unknown };
        for _ in 0..STAGES {
            let at = [centre / (1.0 + spread), centre * (1.0 + spread)];
            let panel = Panel::new(at, &self.values(at[0], members)?, &self.values(at[1], members)?);
            let Some(crossing) = panel.crossing(limit.statistic, limit.below) else {
                // It lies further away than the first members said.
                (spread, members) = ((3.0 * spread).min(1.0), (4 * members).min(self.most));
                continue;
            };
            let half = match crossing.ci95 {
                [Some(low), Some(high)] => 0.5 * (high - low) / crossing.value,
                _ => f64::INFINITY,
            };
            // Far outside the pair, the straight line between its values is not trusted.
            let inside = (crossing.value / centre).ln().abs() <= (1.0 + 2.0 * spread).ln();
            let narrow = half <= *tolerance && inside;
            let statistic = panel.estimate(limit.statistic, crossing.value);
            best = Settled { crossing: Some(crossing), narrow, statistic };
            if narrow || (members == self.most && inside) {
                break;
            }
            centre = crossing.value;
            if half.is_finite() {
                let wanted = (half / tolerance).powi(2) * MARGIN;
                members = (members as f64 * wanted.clamp(1.0, 64.0)) as u64;
                spread = half.clamp(0.01, 1.0);
            } else {
                members *= 16;
                spread = (3.0 * spread).min(1.0);
            }
            members = members.next_multiple_of(256).min(self.most);
        }
        Ok(best)
    }
}
