//! 64 members of an ensemble as the kernels hold them: what all share, their parameters, and their
//! state between tiles.
//!
//! Not for stepping them: that is `simulate` and the phases it calls.

use std::ops::Range;
use std::sync::Arc;

use super::flicker::Flicker;
use super::lanes::{LANES, Lane};
use super::law_lanes::Acting;
use super::low_pass::LowPass;
use super::noise::Drawer;
use super::own::Own;
use super::reading::State;
use super::sums::{BOUND_M_S2, CHUNK, Sums};
use crate::chained::Chained;
use crate::integrator::Integrator;
use crate::job::Job;
use crate::low_pass::WEIGHTS;
use crate::member::{COLUMNS, Column, WAVES, absent, column, flicker_amplitudes};
use crate::numerics::elementary::Real;
use crate::physics::coefficients;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::{Sense, SensorTerm};

/// Numbers that all members share.
#[derive(Debug, Clone)]
pub struct Shared<T> {
    /// Substeps per sample.
    pub substeps: u32,
    /// Integrator of the proof mass.
    pub integrator: Integrator,
    /// Tilt to horizontal acceleration, per unit of rate summed over samples: gravity × sample
    /// period.
    pub tilt_gain: T,
    /// Amplitudes of the flicker terms.
    pub flicker: Vec<T>,
    /// Samples of the still start.
    pub still_samples: u64,
    /// Reciprocal of the number of samples of the still start.
    pub still_share: f64,
    /// Tilt that levelling leaves per m/s² of accelerometer error.
    pub level_rad_per_m_s2: f64,
}

impl<T: Real> Shared<T> {
    /// Returns what the members of a job share.
    pub fn of(job: &Job) -> Self {
        Self {
            // `ensemble` refuses a job with more.
            substeps: job.steps_per_sample().min(u64::from(u32::MAX)) as u32,
            integrator: job.integrator,
            tilt_gain: T::of(job.gravity_m_s2 * job.clock.sample_s()),
            flicker: flicker_amplitudes(&job.clock).into_iter().map(T::of).collect(),
            still_samples: job.clock.still_samples,
            still_share: job.clock.still_share(),
            level_rad_per_m_s2: job.level_rad_per_m_s2(),
        }
    }
}

/// Error terms and forces that some of these members have.
#[derive(Debug, Clone, Copy)]
pub(super) struct Active {
    pub(super) force: bool,
    pub(super) sine: bool,
    pub(super) gain: bool,
    /// A bit for each term, so that those they do not have cost nothing.
    terms: u64,
}

const _: () = assert!(SensorTerm::COUNT <= u64::BITS as usize, "there are more terms than bits");

impl Active {
    const NONE: Self = Self { force: false, sine: false, gain: false, terms: 0 };

    /// Returns the terms that some column has.
    fn of<T: Real>(columns: &[Lane<T>; COLUMNS]) -> Self {
        // All lanes, not until the first: that is vector code.
        let differs = |c: usize, none: f64| columns[c].0.iter().fold(false, |any, v| any | (*v != T::of(none)));
        let any = |c: usize| differs(c, 0.0);
        Self {
            force: any(column::FORCE),
            sine: any(column::SINE),
            gain: differs(column::GAIN, 1.0),
            terms: SensorTerm::ALL
                .into_iter()
                .fold(0, |terms, term| terms | u64::from(differs(column::of(term), absent(term))) << term as u32),
        }
    }

    /// Returns whether some of these members have the term.
    pub(super) fn has(&self, term: SensorTerm) -> bool {
        self.terms >> term as u32 & 1 == 1
    }

    /// The terms that some of them have, in the order of the table.
    pub(super) fn terms(&self) -> impl Iterator<Item = SensorTerm> {
        let mut left = self.terms;
        std::iter::from_fn(move || {
            let term = SensorTerm::ALL.get(left.trailing_zeros() as usize)?;
            left &= left - 1;
            Some(*term)
        })
    }

    /// Returns whether some of them have a term of this sense that `wanted` picks by its law.
    pub(super) fn any(&self, sense: Sense, wanted: impl Fn(ErrorLaw) -> bool) -> bool {
        self.terms().any(|t| t.sense() == sense && wanted(t.law()))
    }
}

/// 64 members between tiles: parameters and state.
#[derive(Debug, Clone)]
pub struct Members<T> {
    pub(super) draw: Drawer,
    /// Source of their random numbers, if these are not those of their index.
    pub(super) own: Option<Own>,
    pub(super) active: Active,
    pub(super) columns: [Lane<T>; COLUMNS],
    pub(super) turns: [Lane<u32>; 2],
    pub(super) waves: [Lane<u32>; WAVES],
    /// Laws that some of these members follow next to the linear one, where the integrator takes
    /// them one by one.
    pub(super) laws: Vec<Acting<T>>,
    /// The low-pass behind the proof masses, if some of these members have one.
    pub(super) low_pass: Option<Box<LowPass<T>>>,
    pub(super) e: Lane<T>,
    pub(super) q: Lane<T>,
    pub(super) reading: State<T>,
    pub(super) sums: Sums<T>,
    /// Mean errors of accelerometer and gyro that a still start takes off.
    pub(super) mean: Lane<T>,
    pub(super) gyro_mean: Lane<T>,
    /// The tilt that a run begins with: the drawn one, or what a still start leaves.
    pub(super) start_tilt: Lane<f64>,
    /// Errors of the last reading.
    pub(super) acceleration: Lane<T>,
}

/// Errors of 64 members at a sample, in the order of `QUANTITIES`, and who failed.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Position (m), velocity (m/s), acceleration (m/s²) and tilt (rad) error.
    pub values: [[f64; LANES]; 4],
    /// Members that left the range of their model.
    pub failed: [bool; LANES],
}

impl<T: Real> Members<T> {
    /// 64 members at rest: the first `of` these, which begin at a multiple of 64, each with the
    /// numbers that `column` gives for it. Lanes beyond the last member repeat it. In a place of
    /// their own and filled there: ten kilobytes and more, whose copies from hand to hand cost a
    /// fifth of starting a run.
    ///
    /// # Errors
    /// The first of `column`.
    pub fn new<E>(
        seed: u64,
        of: Range<u64>,
        flicker_terms: usize,
        mut column: impl FnMut(u64) -> Result<Column, E>,
    ) -> Result<Box<Self>, E> {
        let mut members = Box::new(Self::none(Drawer::new(seed, of.start)));
        let mut laws = [Lane::splat(T::of(0.0)); coefficients::MOST];
        let mut low_pass = [Lane::splat(T::of(0.0)); WEIGHTS];
        let count = of.end.saturating_sub(of.start).min(LANES as u64) as usize;
        for (l, member) in of.take(count).enumerate() {
            // By reference: a column is close to a kilobyte.
            let made = column(member);
            let Ok(member) = &made else {
                // What `map` would make of a column is never asked: this is the error.
                return made.map(|_| members);
            };
            let end = if l + 1 == count { LANES } else { l + 1 };
            for l in l..end {
                (0..COLUMNS).for_each(|c| members.columns[c][l] = T::of(member.values[c]));
                (0..2).for_each(|i| members.turns[i][l] = member.turns[i]);
                (0..WAVES).for_each(|i| members.waves[i][l] = member.waves[i]);
                (0..coefficients::MOST).for_each(|c| laws[c][l] = T::of(member.laws[c]));
                (0..WEIGHTS).for_each(|c| low_pass[c][l] = T::of(member.low_pass[c]));
            }
        }
        members.low_pass = LowPass::of(low_pass);
        members.laws = Acting::of(&laws);
        members.active = Active::of(&members.columns);
        for term in SensorTerm::ALL {
            if members.active.has(term) && matches!(term.law(), ErrorLaw::Flicker(_)) {
                members.reading.flickers[term.rank()] = Flicker::new(flicker_terms);
            }
        }
        Ok(members)
    }

    fn none(draw: Drawer) -> Self {
        let zero = Lane::splat(T::of(0.0));
        Self {
            draw,
            own: None,
            active: Active::NONE,
            columns: [zero; COLUMNS],
            turns: [Lane::splat(0); 2],
            waves: [Lane::splat(0); WAVES],
            laws: Vec::new(),
            low_pass: None,
            e: zero,
            q: zero,
            reading: State::new(),
            sums: Sums::new(),
            mean: zero,
            gyro_mean: zero,
            start_tilt: Lane::splat(0.0),
            acceleration: zero,
        }
    }

    /// Lets them have their random numbers from a chain, if there is one, before they begin.
    pub fn chain(&mut self, chained: Option<&Arc<dyn Chained>>) {
        let first = self.draw.first_member;
        self.own = chained.map(|chained| Own { chained: chained.clone(), first, block: None });
    }

    /// Replaces every number that a tile changes by what `with` makes of it, always in the same
    /// order: to read them all, or to set them all to those of a run that was stopped.
    pub fn exchange(&mut self, with: &mut dyn FnMut(f64) -> f64) {
        // No `..`: a new field must decide here whether tiles change it.
        let Self {
            draw: _,
            own: _,
            active: _,
            columns: _,
            turns: _,
            waves: _,
            laws,
            low_pass,
            e,
            q,
            reading,
            sums,
            mean,
            gyro_mean,
            start_tilt,
            acceleration,
        } = self;
        let Sums { velocity, position, rate, velocity_total, position_total, rate_total, failed } = sums;
        let lanes = [e, q, mean, gyro_mean, acceleration, velocity, position, rate];
        let shown = low_pass.as_mut().map(|low_pass| &mut low_pass.p);
        let numbers = lanes.into_iter().chain(shown).chain(reading.lanes()).flat_map(|lane| &mut lane.0);
        let own = laws.iter_mut().flat_map(Acting::own);
        numbers.chain(own).for_each(|v| *v = T::of(with(v.f64())));
        let totals = [start_tilt, velocity_total, position_total, rate_total].into_iter().flat_map(|lane| &mut lane.0);
        totals.for_each(|v| *v = with(*v));
        failed.iter_mut().for_each(|f| *f = with(f64::from(u8::from(*f))) != 0.0);
    }

    /// Places every proof mass: error of the reading (m/s²) and rate of the reading times one
    /// substep.
    pub fn place(&mut self, error_m_s2: f64, rate_step_m_s2: f64) {
        self.e = Lane::splat(T::of(error_m_s2));
        self.q = Lane::splat(T::of(rate_step_m_s2));
    }

    /// Error of the reading and its rate times one substep, of one lane.
    pub fn placed(&self, lane: usize) -> (f64, f64) {
        (self.e[lane].f64(), self.q[lane].f64())
    }

    /// The tilt that a run begins with: the drawn one, less what a still start has found.
    pub fn tilt(&mut self, level_rad_per_m_s2: f64) {
        let initial = &self.columns[column::of(SensorTerm::InitialTilt)];
        for l in 0..LANES {
            self.start_tilt[l] = level_rad_per_m_s2 * (initial[l].f64() - self.mean[l].f64());
        }
    }

    /// Ends the still start: the mean errors so far are what is taken off from here on, and the
    /// integrals begin. Levelling by an accelerometer that errs by its mean leaves a tilt whose
    /// share of gravity hides that mean.
    pub(super) fn level(&mut self, shared: &Shared<T>) {
        let sums = &self.sums;
        for l in 0..LANES {
            self.mean[l] = T::of(shared.still_share * (sums.velocity_total[l] + sums.velocity[l].f64()));
            self.gyro_mean[l] = T::of(shared.still_share * (sums.rate_total[l] + sums.rate[l].f64()));
        }
        self.sums = Sums { failed: sums.failed, ..Sums::new() };
        // Of an initial tilt, levelling takes away what the mean has of it.
        self.tilt(shared.level_rad_per_m_s2);
    }

    /// Mean errors of accelerometer (m/s²) and gyro (rad/s) of one member over a still start that
    /// has just ended.
    pub(super) fn standing_mean(&self, shared: &Shared<T>, lane: usize) -> (f64, f64) {
        let sums = &self.sums;
        let mean = |total: &Lane<f64>, part: &Lane<T>| shared.still_share * (total[lane] + part[lane].f64());
        (mean(&sums.velocity_total, &sums.velocity), mean(&sums.rate_total, &sums.rate))
    }

    /// Returns whether a member's reading has left the range of its model.
    pub(super) fn has_failed(&self, lane: usize) -> bool {
        self.sums.failed[lane] || self.e[lane].beyond(BOUND_M_S2)
    }

    /// The errors after `samples` samples of `sample_s` seconds.
    pub fn snapshot(&self, samples: u64, sample_s: f64) -> Snapshot {
        let sums = &self.sums;
        let mut s = Snapshot { values: [[0.0; LANES]; 4], failed: sums.failed };
        let since = (samples % CHUNK) as f64;
        for l in 0..LANES {
            let position = sums.position_total[l] + (since * sums.velocity_total[l] + sums.position[l].f64());
            s.values[0][l] = sample_s * sample_s * position;
            s.values[1][l] = sample_s * (sums.velocity_total[l] + sums.velocity[l].f64());
            s.values[2][l] = self.acceleration[l].f64();
            s.values[3][l] = sample_s * (sums.rate_total[l] + sums.rate[l].f64()) + self.start_tilt[l];
            s.failed[l] |= self.acceleration[l].beyond(BOUND_M_S2) || s.values.iter().any(|v| !v[l].is_finite());
        }
        s
    }
}
