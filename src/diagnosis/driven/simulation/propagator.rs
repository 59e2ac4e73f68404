//! Carries a state or an input over a fixed time, as far as that is known before a pass begins: the
//! free oscillator, and an input moved by part of a grid point. Not the pass itself (`filter`).

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::physics::free_oscillator::transition;
use crate::physics::state::{LANES, Lanes};

/// exp(At) in every lane.
#[repr(C, align(64))]
pub(super) struct Transition {
    pub xx: Lanes,
    pub xv: Lanes,
    pub vx: Lanes,
    pub vv: Lanes,
}

impl Transition {
    /// Builds the transition of an oscillator with this ω and ζ after a time `t`.
    pub(super) fn new(oscillator: &[Lanes; 2], t: f64) -> Self {
        let mut m = Self { xx: [0.0; LANES], xv: [0.0; LANES], vx: [0.0; LANES], vv: [0.0; LANES] };
        for l in 0..LANES {
            [m.xx[l], m.xv[l], m.vx[l], m.vv[l]] = transition(oscillator[0][l], oscillator[1][l], t);
        }
        m
    }

    /// The same, times a length of time.
    pub(super) fn times(&self, length_s: f64) -> Self {
        let times = |row: &Lanes| row.map(|part| length_s * part);
        Self { xx: times(&self.xx), xv: times(&self.xv), vx: times(&self.vx), vv: times(&self.vv) }
    }

    /// Displacement and velocity afterwards.
    #[inline(always)]
    pub(super) fn apply(&self, x: &Lanes, v: &Lanes) -> (Lanes, Lanes) {
        let (mut nx, mut nv) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            nx[l] = self.xx[l] * x[l] + self.xv[l] * v[l];
            nv[l] = self.vx[l] * x[l] + self.vv[l] * v[l];
        }
        (nx, nv)
    }
}
