//! A decay with the laws that were found in it.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use crate::driven::base::{OMEGA, ZETA};
use crate::driven::identification::step_length::coarsest;
use crate::driven::intake::data::Data;
use crate::driven::intake::input::Interpolation;
use crate::driven::intake::observed::Observed;
use crate::driven::intake::reading_noise::{ReadingNoise, Sample, reading_noise};
use crate::driven::simulated::rows::Rows;
use crate::driven::simulated::system::System;
use crate::driven::simulation::filter::{Nothing, States};
use crate::engine::fit::{Fitted, MOST_STEPS, fit};
use crate::engine::kind::Point;
use crate::engine::levels::{AT_NOISE, FAINT, FOLLOWED, TOGETHER};
use crate::engine::names::{self, Found};
use crate::engine::search::Search;
use crate::physics::scales::Scales;

use super::base_model::{self, base};
use super::hits::Ringing;
use super::input;
use super::rows::{self, CYCLES, LONGER};
use super::swings::{self, Motion};

/// Segments of a decay at least in which laws are searched before the whole of it is one: next to each other they
/// show a law that a fit of the whole does not begin near.
const FEWEST_SEGMENTS: f64 = 4.0;
/// Part of a length from which on a segment is as long.
const WHOLE: f64 = 0.9;

/// A decay that was searched.
#[derive(Clone)]
pub(crate) struct Decay {
    /// The recording, with readings as the displacement that stands for them.
    pub(crate) data: Data,
    pub(super) motion: Motion,
    pub(super) system: System,
    /// Noise of the reading, and its variance in a row that is fitted.
    pub(super) noise: ReadingNoise,
    pub(super) variance: f64,
    pub(super) found: Found,
    pub(super) numbers: Numbers,
    /// Way of the input between its samples, where another one than was prepared does better.
    pub(super) other_input: Option<Interpolation>,
}

/// The final model over segments as long as it follows the motion through: its numbers are those of
/// the whole decay, and not of its loudest part.
#[derive(Clone)]
pub(super) struct Numbers {
    /// The decay in those segments.
    pub(super) system: System,
    /// The base model with the named laws.
    pub(super) model: Arc<Fitted>,
    /// For each named law the laws that do as well in its place.
    pub(super) rivals: Vec<Vec<(usize, Arc<Fitted>)>>,
}

/// Searches a recording without an input; `None` where nothing swings in it, or no oscillator
/// follows it. `filled` were not recorded.
pub(crate) fn decay(data: &Data, filled: &[Range<usize>]) -> Option<Decay> {
    let motion = swings::motion(&data.reading, data.hull.clone(), reading_noise(&Sample::of(data))?.deviation)?;
    let data = seen(data, TAU * data.rate_hz / motion.cycle);
    let begins = base_model::free(data.rate_hz, motion.cycle);
    let first = rows::rows(&data, &motion, filled, CYCLES);
    let mut decay = searched(data, first, motion, &begins)?;
    if !decay.motion.knocks.is_empty() && decay.is_at_noise() {
        decay = decay.unbroken(filled).unwrap_or(decay);
    }
    let broken = decay.broken(filled).map(|broken| broken.carried_on(filled));
    let decay = match broken {
        Some(broken) if broken.is_simplest() => broken,
        Some(broken) => broken.better(decay.carried_on(filled)),
        None => decay.carried_on(filled),
    };
    Some(decay.in_steps_that_suffice())
}

/// The recording with readings as the displacement that stands for them at this frequency.
pub(super) fn seen(data: &Data, omega_rad_s: f64) -> Data {
    let observed = Observed { omega_rad_s, ..data.observed };
    let reading = data.reading.iter().map(|y| observed.displacement(*y)).collect();
    Data { observed, reading, ..data.clone() }
}

/// Fits the base model from the places where it may begin, and searches the laws added to it, on the way of the
/// input between its samples that does best with few of them.
pub(super) fn searched(data: Data, rows: Rows, motion: Motion, begins: &[[f64; 3]]) -> Option<Decay> {
    let noise = reading_noise(&Sample::of(&data))?;
    let (system, base) = begun_at(rows, &motion, begins)?;
    let variance = variance(&noise, &system);
    let (search, base) = Search::begin(&system, variance, &base.point)?;
    let early = if data.input.is_some() { search.early(&base) } else { base.clone() };
    let is_asked = data.input.is_some() && !search.is_at_noise(&early);
    let other_input = is_asked.then(|| input::other_input(&system, variance, &[&early])).flatten();
    let (data, system, found) = match other_input {
        None => {
            let found = names::names(&search, base, None);
            drop(search);
            (data, system, found)
        }
        Some(how) => {
            drop(search);
            let (system, base) = begun_at(input::rows(&system.rows, how), &motion, begins)?;
            let (search, base) = Search::begin(&system, variance, &base.point)?;
            let found = names::names(&search, base, None);
            drop(search);
            (input::gone(&data, how), system, found)
        }
    };
    let numbers = numbers(&system, &found, variance);
    Some(Decay { data, motion, system, noise, variance, found, numbers, other_input })
}

fn begun_at(rows: Rows, motion: &Motion, begins: &[[f64; 3]]) -> Option<(System, Fitted)> {
    (!rows.layout.segments.is_empty()).then(|| base(rows, motion.cycle, begins)).flatten()
}

/// Variance of a row. What rounding adds is not smoothed away below a thousandth of the motion.
fn variance(noise: &ReadingNoise, system: &System) -> f64 {
    (noise.deviation * system.rows.noise_gain).max(1e-6 * system.scales.output).powi(2)
}

/// Joins segments as long as the model follows the motion through the longer ones.
fn numbers(system: &System, found: &Found, noise: f64) -> Numbers {
    let mut numbers = Numbers {
        system: system.clone(),
        model: found.model.clone(),
        rivals: found.named.iter().map(|n| n.rivals.clone()).collect(),
    };
    let most = FOLLOWED * found.model.variance.max(noise);
    while let Some(joined) = joined(&numbers.system) {
        let again = |fitted: &Fitted| {
            let point = begun(&numbers.system, &joined, &fitted.point);
            fit(&joined, &fitted.set, &point, MOST_STEPS).map(Arc::new)
        };
        let Some(model) = again(&numbers.model).filter(|m| m.variance <= most) else { break };
        let all = numbers.rivals.iter().map(|r| r.iter().map(|(law, f)| Some((*law, again(f)?))).collect());
        let Some(rivals) = all.collect() else { break };
        numbers = Numbers { system: joined, model, rivals };
    }
    numbers
}

/// The same recording in segments twice as long; `None` where it is one.
fn joined(system: &System) -> Option<System> {
    Some(System { rows: system.rows.joined()?, ..system.clone() })
}

/// A point over longer segments that begin where some of the shorter ones do.
pub(super) fn begun(shorter: &System, longer: &System, point: &Point) -> Point {
    let before = &shorter.rows.layout.segments;
    let first = |s: &Range<usize>| before.iter().position(|own| own.start == s.start);
    let starts = longer.rows.layout.segments.iter().filter_map(first).map(|s| point.starts[s].clone()).collect();
    Point { starts, ..point.clone() }
}

impl Decay {
    /// Returns whether laws, or a free form of what the rest depends on, account for what the base model leaves.
    pub(crate) fn is_accounted_for(&self) -> bool {
        let gains = self.found.together.into_iter().chain(self.found.rest.iter().map(|rest| rest.gain));
        gains.map(|gain| gain.share).any(|share| share >= TOGETHER)
    }

    /// Returns whether the model leaves the noise alone.
    fn is_at_noise(&self) -> bool {
        self.found.model.variance < (1.0 + AT_NOISE) * self.variance
    }

    /// Returns whether it needs no law: nothing is simpler.
    fn is_simplest(&self) -> bool {
        self.is_at_noise() && self.found.named.is_empty()
    }

    /// The same where the mass is hit in the middle of its motion; `None` where it is not, or no oscillator follows
    /// what lies between.
    fn broken(&self, filled: &[Range<usize>]) -> Option<Self> {
        let values = self.system.shared_values(&[], &self.found.base.point);
        let begins = [1.0, self.system.own(OMEGA, &values), self.system.own(ZETA, &values)];
        let [_, omega_rad_s, zeta] = begins;
        let ringing = Ringing {
            reading: &self.data.reading,
            filled,
            cycle: TAU * self.data.rate_hz / omega_rad_s,
            decay: zeta * omega_rad_s / self.data.rate_hz,
            noise: self.noise.deviation,
        };
        let hits: Vec<usize> = self.motion.stretches.iter().flat_map(|s| ringing.hits(s)).collect();
        let motion = self.motion.broken(&hits);
        if motion == self.motion {
            return None;
        }
        let rows = rows::rows(&self.data, &motion, filled, CYCLES);
        searched(self.data.clone(), rows, motion, &[begins])
    }

    /// Searched to the end: in longer segments, at every sample, as a whole.
    fn carried_on(self, filled: &[Range<usize>]) -> Self {
        let mut decay = self.lengthened(false, filled);
        if let Some(rows) = rows::finer(&decay.data, &decay.system.rows, &decay.motion, filled) {
            decay = decay.at(rows, decay.system.scales.fineness).unwrap_or(decay);
        }
        decay.lengthened(true, filled)
    }

    /// Of a decay with hits and the same without the better one: where without them it is followed as a whole, they
    /// must spare a law.
    fn better(self, whole: Self) -> Self {
        let longest = whole.motion.stretches.iter().map(Range::len).max().unwrap_or(0) as f64 / whole.motion.cycle;
        let is_followed = whole.is_at_noise() && whole.segment_cycles() >= WHOLE * longest;
        let is_spared = self.found.named.len() < whole.found.named.len();
        if self.is_at_noise() && (!is_followed || is_spared) { self } else { whole }
    }

    /// The same in longer and longer segments, where shorter ones show only noise, or nothing that has a name and
    /// little that is no noise: as long as [`FEWEST_SEGMENTS`] are left, or up to the `whole`.
    fn lengthened(self, whole: bool, filled: &[Range<usize>]) -> Self {
        let mut decay = self;
        let longest = decay.motion.stretches.iter().map(Range::len).max().unwrap_or(0) as f64 / decay.motion.cycle;
        let most = if whole { longest } else { longest / FEWEST_SEGMENTS };
        let mut cycles = decay.segment_cycles();
        while decay.may_show_more() && (LONGER * cycles <= most || (whole && cycles < WHOLE * most)) {
            cycles = (LONGER * cycles).min(most);
            let Some(longer) = decay.longer(cycles, filled).filter(|longer| !decay.is_lost_in(longer)) else { break };
            if decay.is_at_noise() || !longer.found.named.is_empty() {
                decay = longer;
            }
        }
        decay
    }

    /// Returns whether on other rows, too, these laws leave no more than the noise, and some of them are not named
    /// only because no fit without them came to rest.
    fn is_lost_in(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|decay| &decay.found.model.set);
        let are_fewer = others.len() < own.len() && others.iter().all(|law| own.contains(law));
        are_fewer && !other.is_at_noise() && other.found.best.variance < (1.0 + AT_NOISE) * other.variance
    }

    /// Cycles of its longest segment.
    fn segment_cycles(&self) -> f64 {
        let rows = &self.system.rows;
        let longest = rows.layout.segments.iter().map(Range::len).max().unwrap_or(0);
        longest as f64 * rows.step as f64 / self.motion.cycle
    }

    /// Returns whether longer segments may show what these do not.
    fn may_show_more(&self) -> bool {
        let excess = self.found.model.variance / self.variance - 1.0;
        self.is_at_noise() || (self.found.named.is_empty() && excess < FAINT)
    }

    /// Searches the same decay in segments of about `cycles` cycles each. A small shift in frequency, hidden in
    /// a short segment, builds up a phase error in a long one, which also tells similar laws apart. `None` if
    /// too few segments are left, or if no oscillator follows them.
    fn longer(&self, cycles: f64, filled: &[Range<usize>]) -> Option<Self> {
        let coarse = rows::rows(&self.data, &self.motion, filled, cycles);
        let is_finer = coarse.step > self.system.rows.step;
        let finer = is_finer.then(|| rows::finer(&self.data, &coarse, &self.motion, filled)).flatten();
        let rows = finer.unwrap_or(coarse);
        if rows.layout.segments.is_empty() {
            return None;
        }
        if self.found.named.is_empty() {
            let values = self.system.shared_values(&[], &self.found.base.point);
            let begins = [[1.0, self.system.own(OMEGA, &values), self.system.own(ZETA, &values)]];
            return searched(self.data.clone(), rows, self.motion.clone(), &begins);
        }
        let scales = Scales { interval_s: rows.data.interval_s(), ..self.system.scales.clone() };
        let system = System { rows, scales, ..self.system.clone() };
        let starts = base_model::starts(&system);
        self.again(system, |fitted| {
            // The states of laws that have one come after displacement and velocity.
            let states = fitted.point.starts.first().map_or(0, Vec::len);
            let begun = |start: &Vec<f64>| start.iter().copied().chain(std::iter::repeat(0.0)).take(states).collect();
            Point { starts: starts.iter().map(begun).collect(), ..fitted.point.clone() }
        })
    }

    /// The same laws in one motion that nothing excites again; `None` where they leave more than the noise then.
    fn unbroken(&self, filled: &[Range<usize>]) -> Option<Self> {
        let whole = Self { motion: self.motion.unbroken(), ..self.clone() };
        whole.longer(CYCLES, filled).filter(Self::is_at_noise)
    }

    /// The laws that were found, judged and measured on more rows, which no parabola bends, or with shorter
    /// steps; `None` where no fit comes to rest there.
    fn at(&self, rows: Rows, fineness: f64) -> Option<Self> {
        let scales = Scales { interval_s: rows.data.interval_s(), fineness, ..self.system.scales.clone() };
        self.again(System { rows, scales, ..self.system.clone() }, |fitted| fitted.point.clone())
    }

    /// The laws that were found, judged on other rows, where their fits begin at these points.
    fn again(&self, system: System, begin: impl Fn(&Fitted) -> Point) -> Option<Self> {
        // Shorter steps show no further law, other rows may.
        let grows = system.scales.fineness == self.system.scales.fineness;
        let variance = variance(&self.noise, &system);
        let (search, base) = Search::begin(&system, variance, &begin(&self.found.base))?;
        let found = names::again(&search, base, &self.found, begin, grows)?;
        drop(search);
        let numbers = numbers(&system, &found, variance);
        Some(Self { system, variance, found, numbers, data: self.data.clone(), motion: self.motion.clone(), ..*self })
    }

    /// The same in steps so short that shorter ones change no number.
    pub(super) fn in_steps_that_suffice(self) -> Self {
        let fineness = self.fineness();
        let is_finer = fineness > self.system.scales.fineness;
        is_finer.then(|| self.at(self.system.rows.clone(), fineness)).flatten().unwrap_or(self)
    }

    /// Fineness at which shorter steps change no number: the mass may pass a corner within a step.
    fn fineness(&self) -> f64 {
        let (system, model) = (&self.numbers.system, &self.numbers.model);
        let (structure, point) = (system.structure(&model.set), system.parameters(&model.set, &model.point));
        let scales = |fineness: f64| Scales { fineness, ..system.scales.clone() };
        let steps = |fineness: f64| System { scales: scales(fineness), ..system.clone() }.steps(&structure, &point);
        let errors = |fineness: f64| {
            let system = System { scales: scales(fineness), ..system.clone() };
            system.traced(&model.set, &model.point, &mut Nothing)
        };
        coarsest(&structure.terms, steps, errors, &model.model.shared, model.variance)
    }

    /// States that a model passes through, row by row.
    pub(super) fn passed(&self, model: &Fitted) -> States {
        let mut states = States::default();
        self.system.traced(&model.set, &model.point, &mut states);
        states
    }
}
