//! An oscillator, and a law of the library that acts on it: its force along a motion, or in proportion to it.

use nalgebra::Complex;

use crate::physics::free_form::Freed;
use crate::physics::library::Term;
use crate::physics::state::{Base, Instants, MOST_STAGED, MOST_VALUES};

type Phasor = Complex<f64>;

/// Oscillator without its laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Oscillator {
    /// ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Γ = 2ζω₀, 1/s.
    pub damping_per_s: f64,
}

/// A law at its parameters.
#[derive(Debug, Clone)]
pub(super) struct Law {
    /// The law.
    pub term: Term,
    /// Its parameters, then zeros for unknown beginnings.
    pub values: Vec<f64>,
}

/// Holds what a law adds to the acceleration of N masses, and the rates of its states.
pub(super) struct Answer<const N: usize> {
    /// On each mass.
    pub force: [f64; N],
    rates: [[f64; N]; MOST_STAGED],
}

impl Law {
    /// Its force on N masses at these displacements and velocities.
    pub(super) fn at<const N: usize>(
        &self,
        mass: &Oscillator,
        [x, v]: [[f64; N]; 2],
        time_s: f64,
        own: [f64; 2],
    ) -> Answer<N> {
        let base = Base { gain: [1.0; N], stiffness: [mass.omega_rad_s.powi(2); N], damping: [mass.damping_per_s; N] };
        let at = Instants { time: time_s, step: 0.0, input: [0.0; N], x, v, base: &base, environment: &[] };
        let mut p = [[0.0; N]; MOST_VALUES];
        p.iter_mut().zip(&self.values).for_each(|(p, v)| *p = [*v; N]);
        let mut states = [[0.0; N]; MOST_STAGED];
        states.iter_mut().zip(own).for_each(|(state, z)| *state = [z; N]);
        let (mut rates, mut force) = ([[0.0; N]; MOST_STAGED], [0.0; N]);
        self.term.force::<f64, N, false>(&at, &p, &states, &mut rates, &mut force);
        Answer { force, rates }
    }

    /// Returns whether it is a force on the mass.
    pub(super) fn acts(&self) -> bool {
        self.term.role().acts_on_mass()
    }

    /// Returns whether its force is tabulated over amplitude.
    pub(super) fn is_tabulated(&self) -> bool {
        self.acts() && !self.is_linear()
    }

    /// Returns whether its force depends on velocity, at this motion.
    pub(super) fn has_velocity(&self, mass: &Oscillator, a: f64) -> bool {
        let [still, moving] = [0.0, a * mass.omega_rad_s].map(|v| self.at::<1>(mass, [[a], [v]], 0.0, [0.0; 2]).force);
        still != moving
    }

    /// Returns whether its force is in proportion to the motion, whatever the amplitude.
    pub(super) fn is_linear(&self) -> bool {
        match self.term {
            Term::CoupledMode(_) | Term::StiffnessDrift(_) => true,
            Term::FreeForm(form) => form.law == Freed::Drift,
            _ => false,
        }
    }

    /// Force for a motion of unit amplitude of a law that is linear: its own matrices, found by
    /// probing it with each state.
    pub(super) fn linear(&self, mass: &Oscillator, omega_rad_s: f64, time_s: f64) -> Phasor {
        let j_omega = Phasor::new(0.0, omega_rad_s);
        let probe = |x: f64, v: f64, own: [f64; 2]| {
            let answer = self.at::<1>(mass, [[x], [v]], time_s, own);
            (answer.force[0], answer.rates.map(|r| r[0]))
        };
        let (x, v) = (probe(1.0, 0.0, [0.0; 2]), probe(0.0, 1.0, [0.0; 2]));
        let mut force = j_omega * v.0 + x.0;
        if self.term.states() == 2 {
            let (a, b) = (probe(0.0, 0.0, [1.0, 0.0]), probe(0.0, 0.0, [0.0, 1.0]));
            // (iω − A) s = B by Cramer's rule.
            let m = [[j_omega - a.1[0], Phasor::from(-b.1[0])], [Phasor::from(-a.1[1]), j_omega - b.1[1]]];
            let driven = [0, 1].map(|i| j_omega * v.1[i] + x.1[i]);
            let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
            let first = (driven[0] * m[1][1] - m[0][1] * driven[1]) / det;
            let second = (m[0][0] * driven[1] - m[1][0] * driven[0]) / det;
            force += first * a.0 + second * b.0;
        }
        force
    }
}
