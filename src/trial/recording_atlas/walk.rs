//! Judges of every axis at rest whether a random walk of its bias is in it, by two witnesses: the
//! fit of its Allan deviation, and what the diagnosis names.
//!
//! A coefficient whose interval begins at zero is a limit. A limit says something only where a walk
//! as strong as those that other logs show would have been above it.

use std::collections::BTreeSet;

use serde::Serialize;

use super::measured::{Axis, Coefficient, Quantity};
use super::recipe::Temperature;
use super::survey::Surveyed;
use proofmass_diagnosis::candidate::Kind;
use proofmass_diagnosis::verdict::Effect;

const WALK: &str = "random-walk";
const FOLLOWS_TEMPERATURE: &str = "temperature-sensitivity";

/// Answer of one axis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// The fit supports a walk, and the diagnosis names it and nothing in its place.
    Shown,
    /// One of the two witnesses, or both with a doubt.
    Perhaps(Doubt),
    /// The limit lies below the walks that other logs show.
    NoneSeen,
    /// A walk as strong as those that other logs show would not have been seen.
    CannotTell,
    /// The mean is nearer to zero than the bias is stable: something took the bias off before it was
    /// logged, and would have taken a walk with it.
    BiasRemoved,
}

/// Reason why a walk is not sure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// The diagnosis cannot tell it from these.
    Tie(Vec<String>),
    /// The curve rises as a walk makes it, and the diagnosis names none.
    CurveAlone,
    /// The diagnosis names it, and the fit of the curve does without.
    DiagnosisAlone,
    /// An axis of the same sensor follows temperature, which wanders too.
    Temperature,
}

/// Evidence for and against a walk in one axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Page of its set.
    pub page: String,
    /// Name of the recording.
    pub recording: String,
    /// Heading of the column.
    pub axis: String,
    /// Quantity that it measures.
    pub quantity: Quantity,
    /// Length of the log, s.
    pub length_s: f64,
    /// Record of the temperature.
    pub temperature: Temperature,
    /// Longest averaging time of the fit, s.
    pub longest_s: f64,
    /// K by the fit of the Allan deviation.
    pub walk: Coefficient,
    /// K and the ends of its 95 % interval where the diagnosis names a walk, in the unit of `walk`.
    pub named: Option<[f64; 3]>,
    /// B by the fit.
    pub flicker: Coefficient,
    /// R by the fit.
    pub ramp: Coefficient,
    /// Other effects that the diagnosis names in the axis, ties included.
    pub others: Vec<String>,
    /// The answer.
    pub answer: Answer,
}

/// Judges every axis of the logs at rest.
pub fn lines(found: &[Surveyed]) -> Vec<Line> {
    let mut lines = Vec::new();
    for surveyed in found {
        for (rest, measured) in surveyed.at_rest() {
            let verdicts = surveyed.questions().filter(|(question, _)| rest.is_judged_by(question));
            let verdicts = verdicts.filter_map(|(_, answered)| answered.verdict.as_ref());
            let effects = verdicts.filter(|verdict| verdict.kind == Kind::Static).flat_map(|verdict| &verdict.effects);
            let log = Log { axes: &measured.axes, effects: effects.collect() };
            lines.extend(measured.axes.iter().map(|axis| {
                let Named { walk, others, answer } = log.judged(axis);
                Line {
                    page: surveyed.set.id.clone(),
                    recording: rest.name.clone(),
                    axis: axis.name.clone(),
                    quantity: axis.quantity,
                    length_s: measured.length_s(),
                    temperature: rest.temperature,
                    longest_s: axis.longest_s,
                    walk: axis.walk.clone(),
                    named: walk,
                    flicker: axis.flicker.clone(),
                    ramp: axis.ramp.clone(),
                    others,
                    answer,
                }
            }));
        }
    }
    [Quantity::Gyro, Quantity::Accelerometer].into_iter().for_each(|quantity| weigh(&mut lines, quantity));
    lines
}

/// A log at rest with all that is named in it.
struct Log<'a> {
    axes: &'a [Axis],
    effects: Vec<&'a Effect>,
}

/// Effects named in an axis, and what they make of its curve.
struct Named {
    /// K and the ends of its interval, in the unit of the axis' walk.
    walk: Option<[f64; 3]>,
    /// Other effects.
    others: Vec<String>,
    answer: Answer,
}

impl<'a> Log<'a> {
    /// Effects named in a column.
    fn of(&self, column: &str) -> impl Iterator<Item = &'a Effect> {
        self.effects.iter().copied().filter(move |effect| effect.channels.iter().any(|c| c == column))
    }

    /// Returns whether an axis of the same sensor follows temperature.
    fn follows_temperature(&self, quantity: Quantity) -> bool {
        let mut same = self.axes.iter().filter(|axis| axis.quantity == quantity);
        same.any(|axis| self.of(&axis.name).any(|effect| effect.id == FOLLOWS_TEMPERATURE))
    }

    fn judged(&self, axis: &Axis) -> Named {
        let walk = self.of(&axis.name).find(|effect| effect.id == WALK);
        let is_tied = |effect: &&Effect| effect.id == WALK || effect.confusable_with.iter().any(|id| id == WALK);
        let rivals = others(self.of(&axis.name).filter(is_tied));
        let answer = match (axis.walk.value, walk) {
            _ if !rivals.is_empty() => Answer::Perhaps(Doubt::Tie(rivals)),
            (Some(_), _) | (_, Some(_)) if self.follows_temperature(axis.quantity) => {
                Answer::Perhaps(Doubt::Temperature)
            }
            (Some(_), Some(_)) => Answer::Shown,
            (None, Some(_)) => Answer::Perhaps(Doubt::DiagnosisAlone),
            (Some(_), None) => Answer::Perhaps(Doubt::CurveAlone),
            (None, None) if bias_removed(axis) => Answer::BiasRemoved,
            (None, None) => Answer::NoneSeen,
        };
        let k = walk.and_then(|effect| effect.parameters.iter().find(|p| p.name == "K"));
        let k = k.map(|k| [k.value, k.ci95[0], k.ci95[1]].map(|v| v * axis.walk_per_file_unit));
        Named { walk: k, others: others(self.of(&axis.name)), answer }
    }
}

/// Ids of effects and of what fits as well, but for the walk; sorted, each once.
fn others<'a>(effects: impl Iterator<Item = &'a Effect>) -> Vec<String> {
    let ids = effects.flat_map(|effect| effect.confusable_with.iter().chain([&effect.id]));
    let ids: BTreeSet<&String> = ids.filter(|id| *id != WALK).collect();
    ids.into_iter().cloned().collect()
}

/// Returns whether the mean of a gyro lies nearer to zero than its bias is stable. Gyros come with
/// biases hundreds of times that; a specific force near zero is only a level axis.
fn bias_removed(axis: &Axis) -> bool {
    axis.quantity == Quantity::Gyro && axis.lowest.is_some_and(|lowest| axis.mean.abs() < lowest)
}

/// Marks limits above the strongest walk that a log shows, or perhaps shows: such a walk would not
/// have been seen. Where no log shows any, no limit can be judged.
fn weigh(lines: &mut [Line], quantity: Quantity) {
    let strongest = strongest(lines, quantity).and_then(|line| line.walk.value);
    let limits = lines.iter_mut().filter(|l| l.quantity == quantity && l.answer == Answer::NoneSeen);
    for line in limits {
        if strongest.is_none_or(|k| line.walk.ci95[1] > k) {
            line.answer = Answer::CannotTell;
        }
    }
}

/// Returns the axis with the strongest walk of those that show one, else of those that perhaps do.
pub fn strongest(lines: &[Line], quantity: Quantity) -> Option<&Line> {
    let of = |sure: bool| {
        let supported = lines.iter().filter(move |l| l.quantity == quantity && l.walk.value.is_some());
        let wanted = supported.filter(move |l| (l.answer == Answer::Shown) == sure);
        wanted.max_by(|a, b| a.walk.value.unwrap_or(0.0).total_cmp(&b.walk.value.unwrap_or(0.0)))
    };
    of(true).or_else(|| of(false))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proofmass_diagnosis::verdict::{Estimate, Evidence};

    fn coefficient(value: Option<f64>, ci95: [f64; 2]) -> Coefficient {
        Coefficient { value, ci95, unit: "°/h/√h" }
    }

    fn axis(name: &str, mean: f64, walk: Coefficient) -> Axis {
        let none = coefficient(None, [0.0, 1.0]);
        Axis {
            name: name.into(),
            quantity: Quantity::Gyro,
            mean,
            lowest: Some(10.0),
            longest_s: 100.0,
            flicker: none.clone(),
            walk,
            ramp: none,
            walk_per_file_unit: 2.0,
        }
    }

    fn effect(id: &str, channel: &str, rivals: &[&str]) -> Effect {
        Effect {
            id: id.into(),
            statement: String::new(),
            equation: String::new(),
            parameters: vec![Estimate { name: "K".into(), value: 50.0, unit: "1".into(), ci95: [40.0, 60.0] }],
            channels: vec![channel.into()],
            form: None,
            evidence: Evidence { held_out_gain: 1.0, p_value: 0.0 },
            share: None,
            confusable_with: rivals.iter().map(|id| (*id).to_owned()).collect(),
            base: Vec::new(),
        }
    }

    #[test]
    fn both_witnesses_are_needed_and_a_rival_or_temperature_makes_a_doubt() {
        let rises = || axis("x", 900.0, coefficient(Some(100.0), [80.0, 120.0]));
        let flat = |mean: f64| axis("x", mean, coefficient(None, [0.0, 50.0]));
        let judged = |axis: &Axis, effects: &[Effect]| {
            let all = [axis.clone(), self::axis("y", 900.0, coefficient(None, [0.0, 50.0]))];
            Log { axes: &all, effects: effects.iter().collect() }.judged(axis)
        };
        let walk = || effect("random-walk", "x", &[]);
        let shown = judged(&rises(), &[walk(), effect("flicker-noise", "x", &[])]);
        assert_eq!((shown.answer, shown.walk), (Answer::Shown, Some([100.0, 80.0, 120.0])));
        assert_eq!(shown.others, ["flicker-noise"]);
        let tie = judged(&rises(), &[effect("flicker-noise", "x", &["random-walk"])]);
        assert_eq!(tie.answer, Answer::Perhaps(Doubt::Tie(vec!["flicker-noise".into()])));
        let warm = [walk(), effect("temperature-sensitivity", "y", &[])];
        assert_eq!(judged(&rises(), &warm).answer, Answer::Perhaps(Doubt::Temperature));
        // Controls: one witness alone, the walk of another axis, none, and a mean below 10 °/h.
        assert_eq!(judged(&rises(), &[effect("random-walk", "y", &[])]).answer, Answer::Perhaps(Doubt::CurveAlone));
        assert_eq!(judged(&flat(900.0), &[walk()]).answer, Answer::Perhaps(Doubt::DiagnosisAlone));
        assert_eq!(judged(&flat(900.0), &[]).answer, Answer::NoneSeen);
        assert_eq!(judged(&flat(-9.0), &[]).answer, Answer::BiasRemoved);
    }

    #[test]
    fn a_limit_says_something_only_below_the_strongest_walk_that_is_shown() {
        let line = |walk: Coefficient, answer: Answer| Line {
            page: String::new(),
            recording: String::new(),
            axis: String::new(),
            quantity: Quantity::Gyro,
            length_s: 1.0,
            temperature: Temperature::NotLogged,
            longest_s: 1.0,
            walk,
            named: None,
            flicker: coefficient(None, [0.0, 1.0]),
            ramp: coefficient(None, [0.0, 1.0]),
            others: Vec::new(),
            answer,
        };
        let limit = |k: f64| line(coefficient(None, [0.0, k]), Answer::NoneSeen);
        let answers = |mut lines: Vec<Line>| {
            weigh(&mut lines, Quantity::Gyro);
            lines.into_iter().map(|line| line.answer).collect::<Vec<_>>()
        };
        let shown = line(coefficient(Some(100.0), [80.0, 120.0]), Answer::Shown);
        let perhaps = line(coefficient(Some(300.0), [200.0, 400.0]), Answer::Perhaps(Doubt::CurveAlone));
        assert_eq!(
            answers(vec![shown.clone(), perhaps.clone(), limit(90.0), limit(110.0)])[2..],
            [Answer::NoneSeen, Answer::CannotTell]
        );
        assert_eq!(answers(vec![perhaps, limit(110.0)])[1], Answer::NoneSeen);
        assert_eq!(answers(vec![limit(90.0)]), [Answer::CannotTell]);
    }
}
