//! A mass that follows its input at once: at every moment it stands where its spring balances the input
//! and the terms.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::physics::state::{Instants, LANES, Lanes, Stride};

use super::step::{Plan, Stage, StepState};

/// Times that the balance is found again by the forces at the last one. Each multiplies the error by the
/// share of the spring's force that a law takes: of 3 %, four leave less than 10⁻⁷.
const BALANCING: usize = 4;

impl Plan<'_> {
    /// Puts the mass where its spring balances the input and the terms, at the time of `at`; its velocity
    /// is nothing.
    pub(super) fn settle(&self, at: &mut Instants<'_, f64, LANES>, u: Lanes, motion: &mut StepState) {
        let base = &self.parts.base;
        at.input = u;
        at.v = [0.0; LANES];
        for l in 0..LANES {
            at.x[l] = base.gain[l] * u[l] / base.stiffness[l];
        }
        let rounds = if self.linear { 0 } else { BALANCING };
        for _ in 0..rounds {
            let a = self.acceleration(at, motion, Stage { lead_s: 0.0, weight_s: 0.0, begins: true });
            for l in 0..LANES {
                at.x[l] = a[l] / base.stiffness[l];
            }
        }
        (motion.x, motion.v) = (at.x, at.v);
    }

    /// One step of a mass that stands at every moment where its spring balances; `at` stands at its end.
    pub(super) fn settled(&self, at: &mut Instants<'_, f64, LANES>, u: [Lanes; 3], motion: &mut StepState) -> Stride {
        let (x0, v0) = (motion.x, motion.v);
        self.settle(at, u[2], motion);
        Stride { step_s: self.step_s, x0, v0, x1: motion.x, v1: motion.v, input: u }
    }
}
