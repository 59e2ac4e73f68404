//! A law that some of 64 members follow, and its internal states at each stage of a step; twin of
//! what `source::staged` writes for the GPU.
//!
//! The first state is stored as its difference from equilibrium under the present force, as the
//! mass stores its error. A run therefore begins at rest, and a constant force cancels, except for
//! rounding where a law subtracts one displacement from another.

use super::lanes::{LANES, Lane};
use crate::numerics::elementary::{Real, fma};
use crate::physics::coefficients::{StudyLaw, laws};
use crate::physics::law::Role;
use crate::physics::library::Term;
use crate::physics::state::Instants;

/// A law, its parameters with the substep as unit of time and the reading as displacement, and its
/// states.
#[derive(Debug, Clone)]
pub(super) struct Acting<T> {
    term: Term,
    /// Its parameters, and zeros in the places of unknown beginnings.
    p: Vec<[T; LANES]>,
    /// First state at rest under a unit of force.
    rest: [T; LANES],
    /// Its states, the first less what it would be at rest.
    own: Vec<[T; LANES]>,
    /// Within a step: the states at a stage, their rates there, and the weighted sum of rates.
    here: Vec<[T; LANES]>,
    rates: Vec<[T; LANES]>,
    sums: Vec<[T; LANES]>,
}

/// A stage of a step.
pub(super) struct Stage<'a, T> {
    /// Its number, from 0 on.
    pub number: usize,
    /// The mass there.
    pub at: &'a Instants<'a, T, LANES>,
    /// By how much the force has grown since the step began.
    pub growth: &'a [T; LANES],
}

impl<T: Real> Acting<T> {
    /// The laws that some of these members follow, by their columns.
    pub(super) fn of(columns: &[Lane<T>]) -> Vec<Self> {
        let acts = |lane: &Lane<T>| lane.0.iter().any(|v| *v != T::of(0.0));
        let found = laws().iter().filter(|law| columns.get(law.first).is_some_and(acts));
        found.map(|law| Self::one(law, &columns[law.places()])).collect()
    }

    fn one(law: &StudyLaw, columns: &[Lane<T>]) -> Self {
        let zeros = |count: usize| vec![[T::of(0.0); LANES]; count];
        let mut p: Vec<[T; LANES]> = columns.iter().map(|lane| lane.0).collect();
        let of_lane = |l: usize| -> Vec<f64> { p.iter().map(|row| row[l].f64()).collect() };
        let rest = std::array::from_fn(|l| T::of(law.at_rest(&of_lane(l))));
        p.resize(law.term.values().max(p.len()), [T::of(0.0); LANES]);
        let states = law.term.states();
        let [own, here, rates, sums] = [(); 4].map(|()| zeros(states));
        Self { term: law.term, p, rest, own, here, rates, sums }
    }

    /// Numbers that a step changes.
    pub(super) fn own(&mut self) -> impl Iterator<Item = &mut T> {
        self.own.iter_mut().flatten()
    }

    /// Returns whether it has internal states.
    pub(super) fn has_states(&self) -> bool {
        !self.own.is_empty()
    }

    /// Adds its force at a stage to the acceleration of the masses.
    #[inline(always)]
    pub(super) fn act<const FMA: bool>(&mut self, at: &Instants<'_, T, LANES>, sum: &mut [T; LANES]) {
        self.term.force::<T, LANES, FMA>(at, &self.p, &self.here, &mut self.rates, sum);
    }

    /// Adds the rates of its states at a stage to their sums: 1, 2, 2, 1 sixths.
    #[inline(always)]
    pub(super) fn end<const FMA: bool>(&mut self, stage: usize) {
        let weight = T::of([1.0, 2.0, 2.0, 1.0][stage]);
        for (sums, rates) in self.sums.iter_mut().zip(&self.rates) {
            for l in 0..LANES {
                let before = if stage == 0 { T::of(0.0) } else { sums[l] };
                sums[l] = fma::<T, FMA>(weight, rates[l], before);
            }
        }
    }

    /// Its states at a stage, by the rates of the one before.
    #[inline(always)]
    pub(super) fn begin<const FMA: bool>(&mut self, stage: &Stage<'_, T>) {
        let share = T::of([0.0, 0.5, 0.5, 1.0][stage.number]);
        for (s, own) in self.own.iter().enumerate() {
            let (here, rates) = (&mut self.here[s], &self.rates[s]);
            *here = *own;
            if s == 0 {
                for l in 0..LANES {
                    here[l] = fma::<T, FMA>(-self.rest[l], stage.growth[l], here[l]);
                }
            }
            if stage.number > 0 {
                for l in 0..LANES {
                    here[l] = fma::<T, FMA>(share, rates[l], here[l]);
                }
            }
            if s == 0 {
                for l in 0..LANES {
                    here[l] = fma::<T, FMA>(self.rest[l], stage.at.input[l], here[l]);
                }
            }
        }
    }

    /// Takes its states to the end of the step, over which the force has grown by so much.
    #[inline(always)]
    pub(super) fn finish<const FMA: bool>(&mut self, growth: &[T; LANES]) {
        let sixth = T::of(1.0 / 6.0);
        for (s, own) in self.own.iter_mut().enumerate() {
            if s == 0 {
                for l in 0..LANES {
                    own[l] = fma::<T, FMA>(-self.rest[l], growth[l], own[l]);
                }
            }
            for l in 0..LANES {
                own[l] = fma::<T, FMA>(sixth, self.sums[s][l], own[l]);
            }
        }
    }

    /// Adds displacement and rate of a mode that is read together with the mass.
    #[inline(always)]
    pub(super) fn add_to_reading<const FMA: bool>(&self, force: &[T; LANES], seen: &mut [Lane<T>; 2]) {
        if self.term.role() != Role::Mode {
            return;
        }
        let [e, q] = seen;
        for l in 0..LANES {
            e[l] = e[l] + fma::<T, FMA>(self.rest[l], force[l], self.own[0][l]);
            q[l] = q[l] + self.own[1][l];
        }
    }
}
