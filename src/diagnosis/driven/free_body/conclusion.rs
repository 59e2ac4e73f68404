//! Concludes on a body without a spring: named laws in both units, the errors of force and of
//! restarted windows.

use std::ops::Range;

use crate::answer::{self, Answer, Places};
use crate::candidate::Kind;
use crate::detection::{Predictability, structure};
use crate::driven::intake::data::Data;
use crate::driven::intake::notes::Notes;
use crate::driven::intake::several::Piece;
use crate::driven::selection::held_out::{Comparison, HeldOut, compare, ratio_interval};
use crate::driven::verdict::asked::Asked;
use crate::driven::verdict::detail::{Account, Detail, Shown};
use crate::driven::verdict::effects::{Channels, unit, unit_of};
use crate::driven::verdict::residual_tests::WHITE;
use crate::number::short;
use crate::numerics::moments::{mean_sd, rms};
use crate::physics::coulomb_friction::Sides;
use crate::remainder::{Remainder, Size, Test};
use crate::ruling::{self, rule};
use crate::standing::{Gain, Note, Ranked};
use crate::verdict::{Effect, Estimate, Evidence, Fit, RecordingInfo, RecordingScore, Score};

use super::motion::{MotionAndForce, Part};
use super::noise;
use super::regression::Regression;
use super::selection::{Law, Selection, last, search};
use super::windows;

/// A residual of this fraction of the variance, when it can be predicted, shows that something is
/// missing.
const FAINT: f64 = 0.05;
/// Every twelfth sample is examined for structure: at that spacing the low-pass of the force leaves
/// white noise of the force white.
const EVERY: usize = 12;
/// Own past that is looked at, in those samples.
const LAGS: usize = 12;
/// Samples of the figure that shows both models.
const SHOWN: usize = 1000;

/// Both models, fitted for the last time.
struct Models<'a> {
    data: &'a Data,
    motion: &'a MotionAndForce,
    base: Regression,
    model: Regression,
    selection: Selection,
}

/// The answer; `None` where the force cannot be fitted at all.
pub fn answer(asked: &Asked<'_>, data: &Data, mut notes: Notes) -> Option<Answer> {
    let motion = MotionAndForce::of(data, asked.pieces)?;
    let selection = if notes.broken.is_some() { None } else { Some(search(data, &motion)?) };
    let selection = selection.unwrap_or(Selection { chosen: Vec::new(), alone: Vec::new() });
    let fitted: Vec<Range<usize>> =
        if data.own_test { data.train.iter().chain(&data.validation).cloned().collect() } else { data.train.clone() };
    let base = last(&motion, &[], &fitted)?;
    let model = last(&motion, &selection.chosen, &fitted)?;
    let models = Models { data, motion: &motion, base, model, selection };
    let said = "no spring was detected: fewer than five cycles of any resonance fit into the recording, so the body \
                is treated as free (ω₀ = 0), its laws are identified from the force that its motion requires, and \
                simulations restart every second from the measured state";
    notes.findings.push(said.to_owned());
    Some(models.answer(asked, &fitted, notes))
}

impl Models<'_> {
    fn answer(&self, asked: &Asked<'_>, fitted: &[Range<usize>], notes: Notes) -> Answer {
        let Asked { recording, pieces, columns, .. } = *asked;
        let output_unit = asked.unit.map_or_else(|| unit_of(recording, &columns.output, "output unit"), str::to_owned);
        let input_unit = columns.input.as_deref().map_or_else(String::new, |i| unit_of(recording, i, "input unit"));
        // No law of a free body follows one.
        let environment_units = Vec::new();
        let channels = Channels {
            output: columns.output.clone(),
            output_unit: output_unit.clone(),
            input_unit,
            environment_units,
        };
        let [before, after] = [&self.base, &self.model].map(|m| windows::errors(self.data, pieces, self.motion, m));
        let [held_before, held_after] = [&self.base, &self.model].map(|m| m.held_out(self.motion, &self.data.test));
        let left = self.predictable(fitted);
        let test = Test { p_value: left.p_value, size: Size::of(left.r_squared, WHITE, FAINT) };
        let remainder = Remainder::of([test]);
        let named = !self.selection.chosen.is_empty();
        let window_ratio = ratio(&before, &after, &self.data.test);
        let base_follows = self.follows(&before);
        let outcome = rule(&ruling::Evidence {
            base_follows,
            named: self.selection.chosen.len(),
            remainder: remainder.size,
            removed: 1.0 - held_after.free() / held_before.free().max(1e-300),
            held_out_ratio: ratio_interval(&held_before, &held_after)[0].max(window_ratio),
            ..ruling::Evidence::default()
        });
        let fit = self.fit(pieces, fitted, [&before, &after], [&held_before, &held_after], &output_unit);
        let hull = self.data.hull.clone();
        let cut = |values: &[f64]| values[hull.clone()].to_vec();
        let place = format!(
            "the force that the motion requires differs from the input by {} % of it",
            short(100.0 * self.base.force_error(self.motion, &hull))
        );
        let ranking = self.ranking(fitted, &channels);
        let detail = Detail {
            output: columns.output.clone(),
            unit: output_unit,
            rate_hz: self.data.rate_hz,
            shown: self.shown(&before, &after),
            state: cut(&self.motion.x),
            before: cut(&before),
            after: cut(&after),
            innovations: cut(&after),
            from: hull.start,
            named,
            candidates: ranking.iter().map(|r| (r.id.to_owned(), r.gain, r.named)).collect(),
            account: Account {
                place,
                doubts: notes.doubts,
                broken: notes.broken,
                has_input: true,
                predictable: left.r_squared,
                is_structured: left.r_squared >= WHITE,
                runs_away: !base_follows,
                detectable_r_squared: left.detectable_r_squared,
                ..Account::default()
            },
            ..Detail::default()
        };
        Answer {
            kind: Kind::Driven,
            outcome,
            recording: RecordingInfo::of(recording),
            base: Vec::new(),
            effects: self.selection.chosen.iter().map(|law| self.effect(*law, fitted, &channels)).collect(),
            places: Places::default(),
            fit,
            residual_after: remainder.whiteness(),
            findings: notes.findings,
            ranking,
            trace: Vec::new(),
            repair: None,
            detail: answer::Detail::Driven(Box::new(detail)),
        }
    }

    /// Returns whether restarted simulations, whose errors these are, stray less than the reading itself moves.
    fn follows(&self, errors: &[f64]) -> bool {
        let tested =
            |values: &[f64]| self.data.test.iter().flat_map(|r| &values[r.clone()]).copied().collect::<Vec<_>>();
        rms(tested(errors)) < mean_sd(&tested(&self.motion.x)).1
    }

    /// Returns the fraction of the variance of the force's residual that its past, the motion and
    /// the square of the input predict beyond what noise of the reading does, with the probability of as much by
    /// chance.
    fn predictable(&self, fitted: &[Range<usize>]) -> Predictability {
        let rows: Vec<usize> = self.motion.counted(fitted).into_iter().flatten().step_by(EVERY).collect();
        let residual: Vec<f64> = rows.iter().map(|k| self.model.residual(self.motion, *k)).collect();
        let of = |f: &dyn Fn(usize) -> f64| rows.iter().map(|k| f(*k)).collect::<Vec<f64>>();
        let (x, v) = (&self.motion.x, &self.motion.v);
        // Not force and acceleration: with the velocity they make up the residual itself.
        let regressors = [
            of(&|k| v[k]),
            of(&|k| v[k].signum()),
            of(&|k| v[k].abs()),
            of(&|k| v[k].abs() * v[k]),
            of(&|k| v[k].powi(3)),
            of(&|k| x[k]),
            of(&|k| x[k] * x[k]),
            of(&|k| self.motion.part(Part::SquaredInput)[k]),
        ];
        let found = structure(&residual, LAGS, &regressors);
        let beyond = found.r_squared - noise::predictable(self.data, self.motion, &self.model, (EVERY, LAGS));
        match beyond > 0.0 {
            true => Predictability { r_squared: beyond, ..found },
            false => Predictability { r_squared: 0.0, p_value: 1.0, ..found },
        }
    }

    /// One named law with its parameters, those that are forces also in the unit of the input.
    fn effect(&self, law: Law, fitted: &[Range<usize>], channels: &Channels) -> Effect {
        let words = law.candidate();
        let model = &self.model;
        let estimate = |name: &str, (value, ci95): (f64, [f64; 2]), pattern: &str| Estimate {
            name: name.to_owned(),
            value,
            unit: unit(pattern, channels),
            ci95,
        };
        let acceleration = |name: &str, part, pattern| estimate(name, model.as_acceleration(part), pattern);
        let input = |name: &str, part| estimate(name, model.in_input(part), "u");
        let mut parameters = match law {
            Law::Friction(_) => vec![
                acceleration("f_c", Part::Direction, "y/s^2"),
                input("f_c/g", Part::Direction),
                acceleration("f_0", Part::Constant, "y/s^2"),
                input("f_0/g", Part::Constant),
            ],
            Law::Drag => vec![acceleration("c2", Part::SquaredVelocity, "1/y")],
            Law::Drive => vec![estimate("kappa", model.in_input(Part::SquaredInput), "1/u")],
        };
        let (mut statement, mut equation) = (words.statement, words.equation);
        if law == Law::Friction(Sides::Apart) {
            parameters.push(acceleration("c_d", Part::Speed, "1/s"));
            statement = "Dry friction opposes motion, and friction differs in both directions.";
        }
        if let Law::Friction(sides) = law {
            equation = match sides {
                Sides::Alike => "x″ + cx′ + f_c sgn x′ + f_0 = g·u",
                Sides::Apart => "x″ + cx′ + f_c sgn x′ + c_d|x′| + f_0 = g·u",
            };
        }
        let comparison = self.without(law, fitted);
        Effect {
            id: words.id.to_owned(),
            statement: statement.to_owned(),
            equation: equation.to_owned(),
            parameters,
            channels: vec![channels.output.clone()],
            evidence: Evidence { held_out_gain: comparison.gain, p_value: comparison.p_value },
            form: None,
            share: None,
            base: Vec::new(),
            confusable_with: Vec::new(),
        }
    }

    /// The model against the one without a law, on what judges.
    fn without(&self, law: Law, fitted: &[Range<usize>]) -> Comparison {
        let others: Vec<Law> = self.selection.chosen.iter().copied().filter(|l| *l != law).collect();
        let judged = |m: &Regression| m.held_out(self.motion, &self.data.test);
        let reduced = last(self.motion, &others, fitted).map_or_else(HeldOut::default, |m| judged(&m));
        compare(&reduced, &judged(&self.model))
    }

    /// Every law that was tried: a named one by what it adds to the others, as its effect states.
    fn ranking(&self, fitted: &[Range<usize>], channels: &Channels) -> Vec<Ranked> {
        let of = |t: &super::selection::Trial| {
            let id = t.law.candidate().id;
            let named = self.selection.chosen.iter().find(|law| law.candidate().id == id);
            let comparison = named.map_or(t.comparison, |law| self.without(*law, fitted));
            Ranked {
                id,
                channels: vec![channels.output.clone()],
                gain: Gain::held_out(comparison.gain, comparison.ci95),
                p_value: comparison.p_value,
                named: named.is_some(),
                note: if named.is_some() { Note::BesideNamed } else { Note::Alone },
            }
        };
        self.selection.alone.iter().map(of).collect()
    }

    fn fit(
        &self,
        pieces: &[Piece],
        fitted: &[Range<usize>],
        [before, after]: [&[f64]; 2],
        [held_before, held_after]: [&HeldOut; 2],
        unit: &str,
    ) -> Fit {
        let named = !self.selection.chosen.is_empty();
        let over = |errors: &[f64], ranges: &[Range<usize>]| rms(ranges.iter().cloned().flatten().map(|k| errors[k]));
        let score = |ranges: &[Range<usize>], ratio_ci95| Score {
            rmse_before: over(before, ranges),
            rmse_after: named.then(|| over(after, ranges)),
            ratio_ci95,
            share: None,
        };
        let recording = |piece: &Piece| {
            let range = std::slice::from_ref(&piece.range);
            let force = |model: &Regression| model.force_error(self.motion, &piece.range);
            RecordingScore {
                file: piece.file.clone(),
                role: piece.role,
                samples: piece.range.len(),
                rmse_before: over(before, range),
                rmse_after: named.then(|| over(after, range)),
                force_error_before: Some(force(&self.base)),
                force_error_after: named.then(|| force(&self.model)),
            }
        };
        Fit {
            unit: unit.to_owned(),
            noise_floor: noise::of_reading(self.data, self.motion),
            train: score(fitted, None),
            test: score(&self.data.test, named.then(|| ratio_interval(held_before, held_after))),
            test_ranges: Vec::new(),
            recordings: pieces.iter().map(recording).collect(),
            log_score: None,
            with_unnamed: None,
            one_step_rmse: None,
            noise: None,
        }
    }

    /// Reading and both models where the base errs most among what judges.
    fn shown(&self, before: &[f64], after: &[f64]) -> Shown {
        let starts = self.data.test.iter().flat_map(|r| r.clone().step_by(SHOWN).map(|a| a..(a + SHOWN).min(r.end)));
        let power = |r: &Range<usize>| before[r.clone()].iter().map(|e| e * e).sum::<f64>();
        let Some(range) = starts.max_by(|a, b| power(a).total_cmp(&power(b))) else { return Shown::default() };
        let less = |errors: &[f64]| range.clone().map(|k| self.data.reading[k] - errors[k]).collect();
        Shown {
            from: range.start,
            held_out: vec![range.clone()],
            reading: self.data.reading[range.clone()].to_vec(),
            base: less(before),
            repaired: less(after),
        }
    }
}

/// Root-mean-square error of restarted windows with the laws over that without, on what judges.
fn ratio(before: &[f64], after: &[f64], ranges: &[Range<usize>]) -> f64 {
    let over = |errors: &[f64]| rms(ranges.iter().cloned().flatten().map(|k| errors[k]));
    over(after) / over(before).max(1e-300)
}
