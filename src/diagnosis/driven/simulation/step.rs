//! One step of a pass: the oscillator exactly, the terms and the input by the stages of Lawson's
//! method, and what follows the mass after it. What does not change during a pass is computed once.
//!
//! Not for readings, which come between the steps (`filter`).

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::driven::intake::observed::Observed;
use crate::model::Output;
use crate::physics::coulomb_friction::{self, Sliding};
use crate::physics::law::{Place, Role};
use crate::physics::library::Term;
use crate::physics::state::{
    BaseLanes, Constants, Instants, LANES, Lanes, MOST_STAGED, MOST_VALUES, Staged, Stride, Values,
};

use super::propagator::{Shift, Transition};

/// Most own states of all terms of a model together.
pub(super) const MOST_STATES: usize = 8;
/// Rows that hold the states of all terms that act on the mass and, from each term's first one on, as
/// many as a law is given.
const STAGED_ROWS: usize = 2 * MOST_STAGED;

/// Everything that moves during a pass.
pub(super) struct StepState {
    pub x: Lanes,
    pub v: Lanes,
    /// Bias of the reading, as estimated from readings so far.
    pub bias: Lanes,
    /// States of the terms.
    pub own: [Lanes; MOST_STATES],
}

/// Parts that move: the base model and its terms, at some parameters.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    pub base: BaseLanes,
    /// ω₀ and ζ, for the exact propagation.
    pub oscillator: [Lanes; 2],
    /// Terms of the model.
    pub terms: &'a [Term],
    /// Their parameters, term by term.
    pub parameters: &'a [Lanes],
    /// First parameter of each term.
    pub first: &'a [usize],
    pub interval_s: f64,
    /// Integration steps per sample.
    pub steps: usize,
    /// Quantity that is read.
    pub observed: Observed,
}

/// Plan of a pass, computed before its first step.
pub(super) struct Plan<'a> {
    parts: &'a Parts<'a>,
    /// Length of a step.
    pub step_s: f64,
    half: Transition,
    full: Transition,
    /// States whether nothing acts on the mass but the input.
    pub linear: bool,
    moving: Vec<Mover<'a>>,
    /// States whether one of those has states of its own.
    staged: bool,
    followers: Vec<Mover<'a>>,
    constants: Vec<Constants>,
    /// Terms that read before the offset is added.
    pub sensing: Vec<Mover<'a>>,
    /// Terms that read after it.
    pub adding: Vec<Mover<'a>>,
    /// States of what moves next to the mass.
    pub modes: Vec<usize>,
    /// Delay of the input.
    pub delay: Option<Shift>,
    friction: Option<[Lanes; 2]>,
    /// State of a low-pass.
    pub lagging: Option<usize>,
}

impl<'a> Plan<'a> {
    /// For steps of these parts.
    pub(super) fn of(parts: &'a Parts<'a>) -> Self {
        let Parts { terms, first, parameters, .. } = *parts;
        let step_s = parts.interval_s / parts.steps as f64;
        let placed = |kept: fn(&Term) -> bool| -> Vec<Mover<'a>> {
            let mut all = movers(terms, first, parameters);
            all.retain(|m| kept(m.term));
            all
        };
        let moving = placed(|t| t.role() == Role::Force);
        let mut followers = placed(|t| t.role().follows());
        // A low-pass sees the others where they have come to.
        followers.sort_by_key(|m| m.role == Role::LowPass);
        let constants = followers.iter().map(|m| m.term.constants(&m.values, step_s)).collect();
        let place = |m: &Mover<'a>| m.role.place();
        let mut readers = placed(|t| t.role().place().is_some());
        readers.sort_by_key(place);
        let (sensing, adding): (Vec<_>, Vec<_>) =
            readers.into_iter().partition(|m| place(m).is_some_and(Place::is_before_offset));
        let of = |role: Role| {
            let found = terms.iter().zip(first).find(|(t, _)| t.role() == role);
            found.map(|(_, f)| &parameters[*f])
        };
        let rubbing = terms.iter().zip(first).find(|(t, _)| t.role() == Role::Friction);
        Self {
            parts,
            step_s,
            half: Transition::new(&parts.oscillator, 0.5 * step_s),
            full: Transition::new(&parts.oscillator, step_s),
            linear: !terms.iter().any(|t| t.role().acts_on_mass()),
            staged: moving.iter().any(|m| m.term.states() > 0),
            moving,
            followers,
            constants,
            modes: sensing.iter().filter(|m| m.role == Role::Mode).map(|m| m.state).collect(),
            sensing,
            adding,
            delay: delay(of(Role::InputDelay), of(Role::InputLead))
                .map(|d| Shift::new(&d, parts.interval_s / (2 * parts.steps) as f64)),
            friction: rubbing.map(|(t, first)| coulomb_friction::resistance(&parameters[*first..first + t.values()])),
            lagging: placed(|t| t.role() == Role::LowPass).first().map(|m| m.state),
        }
    }

    /// One step under nothing but the input: exact but for the input within it, which is a
    /// parabola.
    #[inline(always)]
    pub(super) fn swing(&self, u: [Lanes; 3], motion: &mut StepState) -> Stride {
        let Self { parts, half, full, .. } = self;
        let (h, x, v) = (self.step_s, motion.x, motion.v);
        let mut a = [[0.0; LANES]; 3];
        for s in 0..3 {
            for l in 0..LANES {
                a[s][l] = parts.base.gain[l] * u[s][l];
            }
        }
        let (mut nx, mut nv) = full.apply(&x, &v);
        for l in 0..LANES {
            nx[l] += h / 6.0 * (full.xv[l] * a[0][l] + 4.0 * half.xv[l] * a[1][l]);
            nv[l] += h / 6.0 * (full.vv[l] * a[0][l] + 4.0 * half.vv[l] * a[1][l] + a[2][l]);
        }
        (motion.x, motion.v) = (nx, nv);
        Stride { step_s: h, x0: x, v0: v, x1: nx, v1: nv, input: u }
    }

    /// One step under forces that depend on the motion; `at` stands at its beginning.
    #[inline(always)]
    pub(super) fn pushed(&self, at: &mut Instants<'_, f64, LANES>, u: [Lanes; 3], motion: &mut StepState) -> Stride {
        let Self { parts, half, full, .. } = self;
        let (h, from, staged, friction) = (self.step_s, at.time, self.staged, self.friction.as_ref());
        let (mut x, mut v, own) = (motion.x, motion.v, &mut motion.own);
        let (hx, hv) = half.apply(&x, &v);
        let (fx, fv) = full.apply(&x, &v);
        let mut a = [[0.0; LANES]; 4];
        let mut rate = [[0.0; LANES]; STAGED_ROWS];
        let mut sums = [[0.0; LANES]; MOST_STAGED];
        let mut here: [Lanes; STAGED_ROWS] = std::array::from_fn(|s| own[s]);
        let mut side = [0.0; LANES];
        for stage in 0..4 {
            let lead = if stage == 3 { h } else { 0.5 * h };
            if staged && stage > 0 {
                for s in 0..MOST_STAGED {
                    for l in 0..LANES {
                        here[s][l] = own[s][l] + lead * rate[s][l];
                    }
                }
            }
            match stage {
                0 => (at.x, at.v, at.time, at.input) = (x, v, from, u[0]),
                1 => {
                    for l in 0..LANES {
                        at.x[l] = hx[l] + 0.5 * h * half.xv[l] * a[0][l];
                        at.v[l] = hv[l] + 0.5 * h * half.vv[l] * a[0][l];
                    }
                    (at.time, at.input) = (from + 0.5 * h, u[1]);
                }
                2 => {
                    at.x = hx;
                    for l in 0..LANES {
                        at.v[l] = hv[l] + 0.5 * h * a[1][l];
                    }
                }
                _ => {
                    for l in 0..LANES {
                        at.x[l] = fx[l] + h * half.xv[l] * a[2][l];
                        at.v[l] = fv[l] + h * half.vv[l] * a[2][l];
                    }
                    (at.time, at.input) = (from + h, u[2]);
                }
            }
            let mut acceleration = [0.0; LANES];
            for l in 0..LANES {
                acceleration[l] = parts.base.gain[l] * at.input[l];
            }
            // In the order of their states: rows beyond a term's own are zero until the next writes them.
            for m in &self.moving {
                let (Some(own), Some(rate)) = (here[m.state..].first_chunk(), rate[m.state..].first_chunk_mut()) else {
                    continue;
                };
                m.term.force::<f64, LANES, false>(at, &m.values, own, rate, &mut acceleration);
            }
            if let Some(friction) = friction {
                if stage == 0 {
                    side = coulomb_friction::sides(&parts.base, friction, [&x, &v, &acceleration]);
                }
                for l in 0..LANES {
                    acceleration[l] -= coulomb_friction::against(friction, side[l], l);
                }
            }
            let weight = if stage == 0 || stage == 3 { h / 6.0 } else { h / 3.0 };
            if staged {
                for s in 0..MOST_STAGED {
                    for l in 0..LANES {
                        sums[s][l] += weight * rate[s][l];
                    }
                }
            }
            a[stage] = acceleration;
        }
        let (x0, v0) = (x, v);
        for l in 0..LANES {
            x[l] = fx[l] + h / 6.0 * (full.xv[l] * a[0][l] + 2.0 * half.xv[l] * (a[1][l] + a[2][l]));
            v[l] = fv[l] + h / 6.0 * (full.vv[l] * a[0][l] + 2.0 * half.vv[l] * (a[1][l] + a[2][l]) + a[3][l]);
        }
        if let Some(friction) = friction {
            let sliding = Sliding { step_s: h, base: &parts.base, friction, side: &side, ends: [&a[0], &a[3]] };
            sliding.switch([&x0, &v0], [&mut x, &mut v]);
        }
        if staged {
            for s in 0..MOST_STAGED {
                for l in 0..LANES {
                    own[s][l] += sums[s][l];
                }
            }
        }
        (motion.x, motion.v) = (x, v);
        Stride { step_s: h, x0, v0, x1: x, v1: v, input: u }
    }

    /// Velocity or acceleration of mass and modes together, as the displacement that stands for it,
    /// under an input that acts now.
    pub(super) fn observed(&self, at: &Instants<'_, f64, LANES>, acting: Lanes, motion: &StepState) -> Lanes {
        let Parts { base, observed, .. } = *self.parts;
        let mut y = at.v;
        if observed.output == Output::Acceleration {
            let at = Instants { input: acting, ..*at };
            let mut push: Lanes = std::array::from_fn(|l| base.gain[l] * acting[l]);
            let mut rate: Staged<f64, LANES> = [[0.0; LANES]; MOST_STAGED];
            for m in &self.moving {
                let Some(own) = motion.own[m.state..].first_chunk() else { continue };
                m.term.force::<f64, LANES, false>(&at, &m.values, own, &mut rate, &mut push);
            }
            let sides = self.friction.map(|friction| coulomb_friction::sides(&base, &friction, [&at.x, &at.v, &push]));
            for l in 0..LANES {
                let free = push[l] - base.stiffness[l] * at.x[l] - base.damping[l] * at.v[l];
                y[l] = match self.friction.as_ref().zip(sides) {
                    Some((_, sides)) if sides[l] == 0.0 => 0.0,
                    Some((friction, _)) => free - self.mean_friction(friction, [at.v[l], free], l),
                    None => free,
                };
            }
        }
        for (m, l) in self.sensing.iter().filter(|m| m.role == Role::Mode).flat_map(|m| (0..LANES).map(move |l| (m, l)))
        {
            let ([gain, omega, zeta, ..], [x, v, ..]) = (&m.values, &motion.own[m.state..]) else {
                continue;
            };
            y[l] += match observed.output {
                Output::Acceleration => gain[l] * acting[l] - omega[l] * (omega[l] * x[l] + 2.0 * zeta[l] * v[l]),
                _ => v[l],
            };
        }
        y.map(|seen| observed.displacement(seen))
    }

    /// Dry friction at a lane's velocity and acceleration, as a reading that is the mean over its sample
    /// sees it turn round.
    fn mean_friction(&self, friction: &[Lanes; 2], [v, acceleration]: [f64; 2], l: usize) -> f64 {
        let held = coulomb_friction::against(friction, v, l);
        let turning = 0.5 * self.parts.interval_s * (acceleration.abs() + held.abs());
        if v.abs() < turning { held * v.abs() / turning } else { held }
    }

    /// Carries the terms that follow the mass over one step of it.
    #[inline(always)]
    pub(super) fn follow(&self, stride: Stride, own: &mut [Lanes; MOST_STATES]) {
        let modes = &self.modes;
        let (x0, v0) =
            if modes.is_empty() { (stride.x0, stride.v0) } else { together(modes, own, [&stride.x0, &stride.v0]) };
        for (m, constants) in self.followers.iter().zip(&self.constants) {
            if m.role == Role::LowPass && !modes.is_empty() {
                let (x1, v1) = together(modes, own, [&stride.x1, &stride.v1]);
                let seen = Stride { x0, v0, x1, v1, ..stride };
                m.term.follow(&seen, constants, &m.values, &mut own[m.state..]);
            } else {
                m.term.follow(&stride, constants, &m.values, &mut own[m.state..]);
            }
        }
    }
}

/// Returns by how much the input that acts is later than the one recorded.
fn delay(late: Option<&Lanes>, early: Option<&Lanes>) -> Option<Lanes> {
    let of = |lanes: Option<&Lanes>| lanes.copied().unwrap_or([0.0; LANES]);
    let (late_s, early_s) = (of(late), of(early));
    (late.is_some() || early.is_some()).then(|| std::array::from_fn(|l| late_s[l] - early_s[l]))
}

/// A term, its values and where its states begin.
pub(super) struct Mover<'a> {
    pub term: &'a Term,
    pub role: Role,
    /// Index of its first value among those of all terms.
    pub first: usize,
    /// Its values, with those of the first recording where it has some of each.
    pub values: Values<f64, LANES>,
    pub state: usize,
}

/// Terms in their order; those that move the mass have the first states.
pub(super) fn movers<'a>(terms: &'a [Term], first: &[usize], parameters: &[Lanes]) -> Vec<Mover<'a>> {
    let mut next = [0, MOST_STAGED];
    let mut all = Vec::new();
    for (term, first) in terms.iter().zip(first) {
        let (next, end) =
            if term.role().acts_on_mass() { (&mut next[0], MOST_STAGED) } else { (&mut next[1], MOST_STATES) };
        if *next + term.states() <= end {
            let mut values = [[0.0; LANES]; MOST_VALUES];
            values.iter_mut().zip(&parameters[*first..]).take(term.values()).for_each(|(row, p)| *row = *p);
            all.push(Mover { term, role: term.role(), first: *first, values, state: *next });
            *next += term.states();
        }
    }
    all
}

/// Displacement and velocity of mass and modes together; those of modes are states at these places.
#[inline(always)]
pub(crate) fn together(modes: &[usize], own: &[Lanes; MOST_STATES], [x, v]: [&Lanes; 2]) -> (Lanes, Lanes) {
    let (mut x, mut v) = (*x, *v);
    for m in modes {
        for l in 0..LANES {
            x[l] += own[*m][l];
            v[l] += own[m + 1][l];
        }
    }
    (x, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_that_was_recorded_late_acts_before_its_record() {
        let [late, early] = [[3.0; LANES], [1.0; LANES]];
        assert_eq!(delay(None, None), None);
        assert_eq!(delay(Some(&late), None), Some(late));
        assert_eq!(delay(None, Some(&early)), Some([-1.0; LANES]));
        assert_eq!(delay(Some(&late), Some(&early)), Some([2.0; LANES]));
    }
}
