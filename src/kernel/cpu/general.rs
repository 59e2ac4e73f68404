//! Runge–Kutta of order 4 for proof masses with any laws of `physics`; twin of
//! `runge_kutta_4_general` in `shaders/shared/oscillator.wgsl`.
//!
//! The stages are those of `oscillator::RungeKutta4`, taken by 64 members together, so that a law
//! that none of them follows costs nothing: each law that acts is one loop over the lanes of a
//! stage. States of a law's own go through the stages with the mass (`law_lanes`).

use super::lanes::{Kernel, LANES, Lane};
use super::law_lanes::{Acting, Stage};
use super::low_pass::Moved;
use super::oscillator::{ProofMasses, read, sines};
use crate::force::Force;
use crate::member::column;
use crate::numerics::elementary::{Real, fma};
use crate::physics::state::{Base, Instants};

/// [`ProofMasses`] under these laws.
pub(super) struct General<'a, T> {
    pub laws: &'a mut [Acting<T>],
    /// Number of the first substep.
    pub first: u64,
    /// Temperature of the sensor above its reference in each sample, K; empty where it is not.
    pub warmer: &'a [T],
    /// The members and their force.
    pub motion: ProofMasses<'a, T>,
}

impl<T: Real> Kernel for General<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let (laws, m) = (self.laws, self.motion);
        let zero = Lane::splat(T::of(0.0));
        let base = Base { gain: m.k[0].0, stiffness: m.k[0].0, damping: m.k[1].0 };
        let staged = laws.iter().any(Acting::has_states);
        let mut mass = Mass { laws, staged, base: &base, e: m.e.0, q: m.q.0 };
        let mut low_pass = m.low_pass;
        let mut half = m.sine.map_or(0, |(_, half)| half);
        let mut substep = self.first;
        let samples = m.error.iter_mut().zip(m.felt).zip(m.force.chunks_exact(m.substeps)).enumerate();
        for (i, ((error, felt), steps)) in samples {
            let mut push = *m.push.map_or(&zero, |p| &p[i]);
            for l in 0..LANES {
                push[l] = m.k[column::FORCE][l] * push[l];
            }
            // Slow next to the mass: that of the sample's middle holds for all of it.
            let warmer_k = self.warmer.get(i).map_or(0.0, |warmer| warmer.f64());
            for f in steps {
                let sine = m.sine.map_or([zero; 3], |(turns, _)| sines::<T, FMA>(m.k, turns, half));
                let force = felt_by_each::<T, FMA>(&m.k[column::GAIN], f, &sine);
                let from = low_pass.as_ref().map(|_| mass.seen::<FMA>(&force[0]));
                // A run begins at rest, and with it what the low-pass holds.
                if let (0, Some(low_pass), Some([e0, _])) = (substep, &mut low_pass, &from) {
                    low_pass.p = *e0;
                }
                mass.step::<FMA>(&force, &push.0, &During { warmer_k, begin: T::of(substep as f64) });
                if let (Some(low_pass), Some([e0, q0])) = (&mut low_pass, &from) {
                    let [e, q] = &mass.seen::<FMA>(&force[2]);
                    low_pass.step::<FMA>(&Moved { from: [e0, q0], to: [e, q], growth: &force[4], push: &push });
                }
                *felt = force[2];
                (half, substep) = (half + 2, substep + 1);
            }
            let shown = low_pass.as_ref().map_or_else(|| mass.seen::<FMA>(felt)[0], |low_pass| low_pass.p);
            read::<T, FMA>(m.k, &shown, felt, m.scaled, error);
        }
        (m.e.0, m.q.0) = (mass.e, mass.q);
    }
}

/// The force that each member feels at the beginning, the middle and the end of a substep, and by
/// how much it has grown at the latter two.
#[inline(always)]
fn felt_by_each<T: Real, const FMA: bool>(gain: &Lane<T>, f: &Force<T>, sine: &[Lane<T>; 3]) -> [Lane<T>; 5] {
    let mut out = [Lane::splat(T::of(0.0)); 5];
    for l in 0..LANES {
        let [begin, middle, end] = [sine[0][l], sine[1][l], sine[2][l]];
        let shared = [f.begin, f.middle, f.end, f.to_middle, f.to_end];
        let own = [begin, middle, end, middle - begin, end - begin];
        for i in 0..5 {
            out[i][l] = fma::<T, FMA>(gain[l], shared[i], own[i]);
        }
    }
    out
}

/// 64 members in a step.
struct Mass<'a, T> {
    laws: &'a mut [Acting<T>],
    /// Says whether any law has internal states. Tested once per tile: testing each law at every
    /// stage made runs without such laws 7 % slower.
    staged: bool,
    base: &'a Base<T, LANES>,
    e: [T; LANES],
    q: [T; LANES],
}

/// When a substep is.
struct During<T> {
    /// When it begins, in substeps.
    begin: T,
    /// Temperature of the sensor above its reference meanwhile, K.
    warmer_k: f64,
}

impl<T: Real> Mass<'_, T> {
    /// One substep; `push` is the noise of the force, times W.
    #[inline(always)]
    fn step<const FMA: bool>(&mut self, force: &[Lane<T>; 5], push: &[T; LANES], during: &During<T>) {
        let (time, environment) = (during.begin, &[during.warmer_k]);
        let [begin, middle, end, to_middle, to_end] = force;
        let (half, one, sixth) = (T::of(0.5), T::of(1.0), T::of(1.0 / 6.0));
        let zero = [T::of(0.0); LANES];
        let step = one;
        let mut at = Instants { time, step, input: begin.0, x: zero, v: self.q, base: self.base, environment };
        let mut e = self.e;
        let mut d = [zero; 4];
        for stage in 0..4 {
            let mut growth = &zero;
            if stage > 0 {
                let (grown, input) = if stage == 3 { (to_end, end) } else { (to_middle, middle) };
                (at.time, at.input) = (time + if stage == 3 { one } else { half }, input.0);
                growth = &grown.0;
                let before = d[stage - 1];
                for l in 0..LANES {
                    // The displacement moves with the rate of the stage before, the rate from the
                    // step's own beginning.
                    let start = self.e[l] - grown[l];
                    let (rate, from) = (at.v[l], self.q[l]);
                    (e[l], at.v[l]) = if stage == 3 {
                        (start + rate, from + before[l])
                    } else {
                        (fma::<T, FMA>(half, rate, start), fma::<T, FMA>(half, before[l], from))
                    };
                }
            }
            let mut sum = zero;
            for l in 0..LANES {
                at.x[l] = e[l] + at.input[l];
                let linear = fma::<T, FMA>(-self.base.stiffness[l], e[l], push[l]);
                sum[l] = fma::<T, FMA>(-self.base.damping[l], at.v[l], linear);
            }
            if self.staged {
                self.laws.iter_mut().for_each(|law| law.begin::<FMA>(&Stage { number: stage, at: &at, growth }));
            }
            for law in &mut *self.laws {
                law.act::<FMA>(&at, &mut sum);
            }
            if self.staged {
                self.laws.iter_mut().for_each(|law| law.end::<FMA>(stage));
            }
            d[stage] = sum;
        }
        if self.staged {
            self.laws.iter_mut().for_each(|law| law.finish::<FMA>(&to_end.0));
        }
        for l in 0..LANES {
            let twice = d[1][l] + d[2][l];
            let once = d[0][l] + twice;
            let (start, from) = (self.e[l] - to_end[l], self.q[l]);
            self.e[l] = fma::<T, FMA>(sixth, once, start + from);
            self.q[l] = fma::<T, FMA>(sixth, once + twice + d[3][l], from);
        }
    }

    /// Error and rate of what is read at this force: of the mass, and of modes that are read with
    /// it.
    #[inline(always)]
    fn seen<const FMA: bool>(&self, force: &Lane<T>) -> [Lane<T>; 2] {
        let mut seen = [Lane(self.e), Lane(self.q)];
        if self.staged {
            self.laws.iter().for_each(|law| law.add_to_reading::<FMA>(&force.0, &mut seen));
        }
        seen
    }
}
