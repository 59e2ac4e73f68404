//! From a selection to the verdict: what is named, what the motion could not tell, how well it
//! fits.

use nalgebra::Vector3;

use super::account::{Account, NamedEffect, Rest, Untold};
use super::beyond;
use super::candidate::{AXIS_SWAP, LOWPASS, TIME_OFFSET, Term, untold};
use super::clipping::Limit;
use super::course::Case;
use super::detail::{Detail, Series};
use super::effects;
use super::fit::Fit;
use super::fitted::Fitted;
use super::judgement::{HeldOut, Standing};
use super::log::Log;
use super::mounted;
use super::parameters::Point;
use super::permutation::Permutation;
use super::plausible;
use super::published;
use super::remains;
use super::rows::Row;
use super::scatter;
use super::selection::{Named, Selection, with};
use super::sensor::Diagnosed;
use super::start::Start;
use super::undetermined;
use super::upright;
use super::vibration::{self, Vibration};
use crate::answer::{self, Answer, Places};
use crate::candidate::Kind;
use crate::model::{Half, InertialNoise, Noise, Reference, Trajectory};
use crate::recording::Recording;
use crate::recording::inertial::Names;
use crate::remainder::Remainder;
use crate::ruling::{self, rule};
use crate::sensor::Sense;
use crate::standing::{Gain, Note, Ranked};
use crate::verdict::{Effect, Estimate, Evidence, Fit as FitScore, Outcome, RecordingInfo, Score};

const ACCELEROMETER_FREE: &str = "scale factors and axes of the accelerometer are free by one per cent, so that what they do \
                                  to gravity counts as no error of the gyro, and are not judged; a tumble recording determines them";
/// Points of a figure.
const DRAWN: usize = 2000;

/// Holds what a search found.
pub(super) struct Found<'a> {
    /// Readings on their axes.
    pub log: &'a Log,
    /// The log, its reference and what is held in the fit.
    pub case: &'a Case<'a>,
    /// Clocks, axes and biases that the fit began with.
    pub start: &'a Start,
    /// The linearised model with every parameter of the library.
    pub fit: &'a Fit,
    /// Candidates, named and not.
    pub selection: &'a Selection,
    /// Laws that are no candidates and that the difference goes with.
    pub laws: &'a [&'static Term],
    /// The reference as the model names it.
    pub reference: &'a Reference,
    /// Latitude, °, and height, m, where they are stated.
    pub place: Option<(f64, f64)>,
}

/// The readings after intake: what they show before any fit.
pub(super) struct Examined<'a> {
    /// The IMU's file as it was read.
    pub recording: &'a Recording,
    /// Columns of gyro and accelerometer.
    pub names: Names,
    /// Holds what intake found in the files, in sentences.
    pub findings: Vec<String>,
    /// Limits of gyro and accelerometer.
    pub limits: [Vec<Limit>; 2],
    /// Vibration of gyro and accelerometer.
    pub vibration: [Option<Vibration>; 2],
    /// The noise that the datasheet promises.
    pub stated: InertialNoise,
}

const SENSORS: [Sense; 2] = [Sense::Gyro, Sense::Accelerometer];

/// Vibration of both sensors, next to what the model states.
pub(super) fn vibration(log: &Log, model: &Trajectory) -> [Option<Vibration>; 2] {
    let stated = [model.noise.gyro, model.noise.accelerometer].map(|noise| noise.map(|n| n.density));
    let rate_hz = 1.0 / log.interval_s;
    [vibration::vibration(&log.rate, rate_hz, stated[0]), vibration::vibration(&log.force, rate_hz, stated[1])]
}

impl Examined<'_> {
    /// The verdict without a reference: limits and vibration alone.
    pub(super) fn without_reference(self, log: &Log) -> Answer {
        let none = Evidence { held_out_gain: 0.0, p_value: 1.0 };
        let effects = self.of_readings([0.0; 2], [Permutation::NONE; 2], none);
        let account = self.account(&effects, None, [0.0; 2]);
        let outcome = rule(&ruling::Evidence { named: effects.len(), has_power: false, ..ruling::Evidence::default() });
        let fit = FitScore {
            unit: "times the noise".into(),
            noise_floor: 1.0,
            noise: None,
            train: Score { rmse_before: 1.0, rmse_after: None, ratio_ci95: None, share: None },
            test: Score { rmse_before: 1.0, rmse_after: None, ratio_ci95: None, share: None },
            test_ranges: Vec::new(),
            recordings: Vec::new(),
            log_score: None,
            with_unnamed: None,
            one_step_rmse: None,
        };
        let detail = self.detail(log, None, account);
        self.answer(outcome, effects, fit, Remainder::of([]), Vec::new(), detail)
    }

    /// The verdict next to a reference.
    pub(super) fn conclude(mut self, found: &Found<'_>) -> Answer {
        let (fit, selection, halves) = (found.fit, found.selection, found.case.motion.halves);
        if !halves.attitude {
            self.findings.push(ACCELEROMETER_FREE.into());
        }
        let small = selection.base.clone();
        let active = selection.active();
        let fitted = |active: &[usize]| Fitted::of(&fit.linear, active, found.log.interval_s);
        let chosen = fitted(&active);
        let laws = found.laws;
        // What goes with a law that has no name goes into no other number, nor into noise of the reference.
        let lawful = with(&active, laws.iter().copied());
        let told = fitted(&lawful);
        let wide = fitted(&selection.shown(&published::usual(&lawful, selection)));
        let seated = fitted(&selection.shown(&published::seated(&lawful, halves)));
        let before = fit.linear.solve(&small, |_| true).point;
        let held = HeldOut::of(&fit.linear, &small, &active);
        let first = halves.lacks().map_or(Half::Attitude, other);
        let clipped = fit.residuals_at(first, &chosen.point).map_or(0.0, |all| remains::lies_in_clipped(&all));
        let swap = [found.start.gyro, found.start.accelerometer];
        let exchanged =
            Evidence { held_out_gain: found.start.explained.max(0.0), p_value: found.start.chance_exchanged };
        let mut effects = effects::of_fit(selection, &seated, |term| self.channels(term));
        let tied = effects.iter().filter(|e| !e.confusable_with.is_empty()).count();
        mounted::named(&mut effects, &told, found.start, &self.names);
        effects.splice(0..0, self.of_readings([clipped; 2], swap, exchanged));
        self.findings.extend(laws.iter().map(|law| beyond::words(law, &seated)));
        self.findings.extend(selection.named.iter().filter_map(undetermined::elements));
        self.findings.extend(upright::tilted(&seated, found.case.gravity_m_s2));
        let (remainder, rest) = remains::remainder(fit, &chosen.point, &held, !laws.is_empty());
        let own = scatter::random_walks(found.log, self.stated);
        let residuals = |half: Half| {
            // Without attitudes only what points down is differenced as often as noise is judged
            // by.
            let only = |v: Vector3<f64>| if halves.attitude { v } else { Vector3::repeat(v.z) };
            let at = fit.residuals_at(half, &seated.point)?.into_iter().map(|(v, holds)| (only(v), holds));
            Some((at.collect::<Vec<_>>(), fit.of(half)?.0.width_s))
        };
        let attitude = residuals(Half::Attitude).and_then(|(l, width_s)| scatter::excess(&l, width_s, own[0]));
        let position = residuals(Half::Position).and_then(|(l, width_s)| scatter::position(&l, width_s, own[1]));
        let erring = effects::reference(attitude, position, halves);
        let errs = erring.is_some();
        effects.extend(erring);
        let ruled = |base_determined: bool, named: usize| {
            rule(&ruling::Evidence {
                base_determined,
                named,
                tied,
                remainder: remainder.size,
                held_out_ratio: held.ratio()[0],
                ..ruling::Evidence::default()
            })
        };
        let is_unexplained = ruled(true, effects.len()) == Outcome::Unexplained;
        let absurd = plausible::absurd(&chosen.point, attitude, selection, is_unexplained);
        let failed = !absurd.is_empty();
        if failed {
            effects = self.of_readings([clipped; 2], swap, exchanged);
        }
        let outcome = ruled(!failed, effects.len());
        let mut account = self.account(&effects, Some(selection), held.rms());
        account.absurd = absurd;
        account.rest = rest;
        account.untold = halves.lacks().map(|half| Untold { half, terms: untold(halves) });
        let mut detail = self.detail(found.log, Some((found, &before, &chosen.point)), account);
        detail.published = published::calibration(&wide, swap).filter(|_| !failed);
        let diagnosed = Diagnosed {
            case: found.case,
            start: found.start,
            selection,
            chosen: &told,
            seated: &seated,
            reference: found.reference,
            place: found.place,
            limits: &self.limits,
            density: self.densities(found.log),
            errs,
        };
        detail.repaired = (!failed).then(|| diagnosed.repaired());
        // Noise and limits are named next to a model that they do not change.
        let changed = !effects.is_empty() && active != small && !failed;
        let scores = scores(found, [&before, &chosen.point], &held, changed);
        let widths = &fit.linear.widths;
        let base = if failed { Vec::new() } else { published::base(&seated, &wide, found.case.turned, widths) };
        let mut answer = self.answer(outcome, effects, scores, remainder, base, detail);
        answer.ranking = if failed { Vec::new() } else { ranking(&answer.effects, selection) };
        answer
    }

    /// One-sided noise densities of both sensors in motion: with vibration, as stated, or the floor
    /// of the readings.
    fn densities(&self, log: &Log) -> [f64; 2] {
        let rate_hz = 1.0 / log.interval_s;
        let of = |sensor: usize, stated: Option<Noise>, readings: &[Vector3<f64>]| match &self.vibration[sensor] {
            Some(vibration) => vibration.density,
            None => stated.map_or_else(|| scatter::floor(readings, rate_hz).sqrt(), |noise| noise.density),
        };
        [of(0, self.stated.gyro, &log.rate), of(1, self.stated.accelerometer, &log.force)]
    }

    /// Effects that the readings show by themselves.
    fn of_readings(&self, clipped: [f64; 2], swap: [Permutation; 2], exchanged: Evidence) -> Vec<Effect> {
        let mut all = Vec::new();
        for (k, sensor) in SENSORS.into_iter().enumerate() {
            all.extend(effects::swapped(swap[k], sensor, &self.names[k], exchanged));
            all.extend(effects::saturation(&self.limits[k], sensor, &self.names[k], clipped[k]));
        }
        for (k, sensor) in SENSORS.into_iter().enumerate() {
            all.extend(self.vibration[k].iter().map(|v| effects::vibration(v, sensor, &self.names[k])));
        }
        all
    }

    fn channels(&self, term: &Term) -> Vec<String> {
        let of = |sensor: Sense| self.names[usize::from(sensor == Sense::Accelerometer)].to_vec();
        match term.sensor {
            Some(sensor) => of(sensor),
            None => of(Sense::Gyro).into_iter().chain(of(Sense::Accelerometer)).collect(),
        }
    }

    fn account(&self, effects: &[Effect], selection: Option<&Selection>, held_out: [f64; 2]) -> Account {
        let phrase = |effect: &Effect| {
            let within = |k: &usize| effect.channels.iter().all(|c| self.names[*k].contains(c));
            let alone = (0..SENSORS.len()).find(within);
            let of = alone.map_or(effect.id.clone(), |k| format!("{} of the {}", effect.id, SENSORS[k].name()));
            if effect.id == AXIS_SWAP.id { format!("{of} ({})", effect.equation) } else { of }
        };
        let named = effects
            .iter()
            .map(|e| NamedEffect { id: e.id.clone(), phrase: phrase(e), rivals: e.confusable_with.clone() })
            .collect();
        let hidden = selection.map_or(Vec::new(), |s| s.others.iter().filter_map(undetermined::hidden).collect());
        let is_fitted = selection.is_some_and(|s| !s.named.is_empty());
        let louder = SENSORS.iter().zip(&self.vibration).filter_map(|(sensor, found)| {
            let found = found.as_ref()?;
            Some((*sensor, found.density / found.stated?))
        });
        Account {
            named,
            is_fitted,
            louder: louder.collect(),
            hidden,
            untold: None,
            absurd: Vec::new(),
            rest: Rest::Large,
            with_reference: selection.is_some(),
            held_out,
        }
    }

    fn detail(&self, log: &Log, found: Option<(&Found<'_>, &Point, &Point)>, account: Account) -> Detail {
        let rate_hz = 1.0 / log.interval_s;
        let root = |readings: &[Vector3<f64>]| -> Vec<(f64, f64)> {
            vibration::spectrum(readings, rate_hz).0.into_iter().map(|(hz, v)| (hz, v.sqrt())).collect()
        };
        let series = |half: Half| -> Series {
            let Some((found, before, after)) = found else { return Series::default() };
            let Some((residuals, _)) = found.fit.of(half) else { return Series::default() };
            let has_attitude = found.case.motion.halves.attitude;
            let of = |point: &Point| {
                let at = found.fit.residuals_at(half, point).unwrap_or_default();
                let down = |(v, holds): (Vector3<f64>, bool)| (Vector3::new(0.0, 0.0, v.z), holds);
                let at = if has_attitude { at } else { at.into_iter().map(down).collect() };
                lengths(&residuals.rows, &at)
            };
            Series { before: of(before), after: of(after) }
        };
        let drift = found.map_or(Vec::new(), |(found, ..)| {
            let times = &found.case.motion.time_s;
            let every = times.len().div_ceil(DRAWN).max(1);
            times.iter().zip(&found.fit.error).step_by(every).map(|(t, e)| (*t, e.norm())).collect()
        });
        Detail {
            attitude: series(Half::Attitude),
            position: series(Half::Position),
            drift,
            spectra: [root(&log.rate), root(&log.force)],
            stated: [self.stated.gyro, self.stated.accelerometer].map(|noise| noise.map(|n| n.density)),
            published: None,
            repaired: None,
            account,
        }
    }

    fn answer(
        self,
        outcome: Outcome,
        effects: Vec<Effect>,
        fit: FitScore,
        remainder: Remainder,
        base: Vec<Estimate>,
        detail: Detail,
    ) -> Answer {
        Answer {
            kind: Kind::Trajectory,
            outcome,
            recording: RecordingInfo::of(self.recording),
            base,
            effects,
            places: Places::default(),
            fit,
            residual_after: remainder.whiteness(),
            findings: self.findings,
            ranking: Vec::new(),
            trace: Vec::new(),
            repair: None,
            detail: answer::Detail::Trajectory(Box::new(detail)),
        }
    }
}

fn lengths(rows: &[Row], at: &[(Vector3<f64>, bool)]) -> Vec<(f64, f64)> {
    let every = rows.len().div_ceil(DRAWN).max(1);
    let drawn = rows.iter().zip(at).filter(|(_, (_, holds))| *holds).step_by(every);
    drawn.map(|(row, (value, _))| (row.time_s, value.norm())).collect()
}

/// The other half of a pose.
fn other(half: Half) -> Half {
    match half {
        Half::Attitude => Half::Position,
        Half::Position => Half::Attitude,
    }
}

fn scores(found: &Found<'_>, [before, after]: [&Point; 2], held: &HeldOut, named: bool) -> FitScore {
    let linear = &found.fit.linear;
    let rms = |point: &Point| {
        let mut all = (0.0, 0);
        for sensor in 0..linear.sensors.len() {
            for block in 0..super::blocks::BLOCKS {
                let (square, n) = linear.squares(sensor, block, point);
                all = (all.0 + square, all.1 + n);
            }
        }
        (all.0 / f64::from(all.1.max(1) as u32)).sqrt()
    };
    let some = |value: f64| named.then_some(value);
    let [held_before, held_after] = held.rms();
    FitScore {
        unit: "times the noise".into(),
        noise_floor: 1.0,
        noise: None,
        train: Score { rmse_before: rms(before), rmse_after: some(rms(after)), ratio_ci95: None, share: None },
        test: Score {
            rmse_before: held_before,
            rmse_after: some(held_after),
            ratio_ci95: named.then(|| held.ratio()),
            share: None,
        },
        test_ranges: Vec::new(),
        recordings: Vec::new(),
        log_score: None,
        with_unnamed: None,
        one_step_rmse: None,
    }
}

fn ranking(effects: &[Effect], selection: &Selection) -> Vec<Ranked> {
    let row = |s: &Standing, named: bool, note: Note| Ranked {
        id: s.term.id(),
        channels: s.term.sensor.map(|sensor| sensor.name().to_owned()).into_iter().collect(),
        gain: Gain::held_out(s.gain, s.ci95),
        p_value: s.p_value,
        named,
        note,
    };
    let beside = || if effects.is_empty() { Note::Alone } else { Note::BesideNamed };
    let named = selection.named.iter().map(|Named { standing, .. }| {
        let is_effect = effects.iter().any(|e| e.id == standing.term.id());
        row(standing, is_effect, if is_effect { beside() } else { Note::LagOf(LOWPASS.id) })
    });
    // A clock that cancels the lag of a low-pass is named although the search had no use for its
    // term.
    let beside_lowpass = |s: &Standing| s.term.id() == TIME_OFFSET.id && effects.iter().any(|e| e.id == TIME_OFFSET.id);
    named.chain(selection.others.iter().map(|s| row(s, beside_lowpass(s), beside()))).collect()
}
