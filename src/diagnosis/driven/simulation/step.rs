//! One step of a pass: the oscillator exactly, the terms and the input by the stages of Lawson's
//! method, and what follows the mass after it. What does not change during a pass is computed once.
//!
//! Not for readings, which come between the steps (`filter`).

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use crate::driven::intake::observed::Observed;
use crate::model::Output;
use crate::physics::coulomb_friction::{self, Sliding};
use crate::physics::law::{Order, Place, Role};
use crate::physics::library::Term;
use crate::physics::state::{BaseLanes, Constants, Instants, LANES, Lanes, MOST_STAGED, Staged, Stride};

use super::force::Force;
use super::mover::{MOST_STATES, Mover, movers};
use super::propagator::Transition;

/// Rows that hold the states of all terms that act on the mass and, from each term's first one on, as
/// many as a law is given.
const STAGED_ROWS: usize = 2 * MOST_STAGED;

/// One of the four stages of a step.
#[derive(Clone, Copy)]
pub(super) struct Stage {
    /// Time since the step began, s.
    pub lead_s: f64,
    /// Weight of its rates in the step, s.
    pub weight_s: f64,
    /// States whether it is the first.
    pub begins: bool,
}

/// Everything that moves during a pass. Rows begin on lines of the cache: a vector that is stored across
/// two of them is not at hand when it is read again.
#[repr(C, align(64))]
pub(super) struct StepState {
    pub x: Lanes,
    pub v: Lanes,
    /// Bias of the reading, as estimated from readings so far.
    pub bias: Lanes,
    /// States of the terms.
    pub own: [Lanes; MOST_STATES],
    /// States of the terms that act on the mass at one stage of a step, and their rates there.
    here: [Lanes; STAGED_ROWS],
    rate: [Lanes; STAGED_ROWS],
    /// By how much these states change over the step, so far.
    sums: [Lanes; MOST_STAGED],
    /// Way in which each lane slides in this step.
    side: Lanes,
    /// Dry friction against it.
    held_back: Lanes,
}

impl StepState {
    /// A mass at this displacement and velocity, with the states of its terms.
    pub(super) fn new([x, v]: [Lanes; 2], own: [Lanes; MOST_STATES]) -> Self {
        let none = [0.0; LANES];
        let (here, rate) = ([none; STAGED_ROWS], [none; STAGED_ROWS]);
        Self { x, v, bias: none, own, here, rate, sums: [none; MOST_STAGED], side: none, held_back: none }
    }
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
#[repr(C, align(64))]
pub(super) struct Plan<'a> {
    half: Transition,
    full: Transition,
    /// Displacement and velocity at the second and the last stage, by the acceleration of the one before.
    pushes: [Transition; 2],
    pub parts: &'a Parts<'a>,
    /// Adds the force of a term.
    force: Force,
    /// Length of a step.
    pub step_s: f64,
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
    /// By how much the input acts later than it was recorded, s.
    pub late_s: Option<Lanes>,
    friction: Option<[Lanes; 2]>,
    /// State of a low-pass.
    pub lagging: Option<usize>,
}

impl<'a> Plan<'a> {
    /// For steps of these parts.
    pub(super) fn of(parts: &'a Parts<'a>, force: Force) -> Self {
        let Parts { terms, first, parameters, .. } = *parts;
        let step_s = parts.interval_s / parts.steps as f64;
        let placed = |kept: fn(&Term) -> bool| -> Vec<Mover<'a>> {
            let mut all = movers(terms, first, parameters);
            all.retain(|m| kept(m.term));
            all
        };
        let moving = placed(|t| t.role() == Role::Force);
        let mut followers = placed(|t| t.role().follows());
        // A filter sees the others where they have come to.
        followers.sort_by_key(|m| matches!(m.role, Role::Filter(_)));
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
        let half = Transition::new(&parts.oscillator, 0.5 * step_s);
        Self {
            parts,
            force,
            step_s,
            pushes: [half.times(0.5 * step_s), half.times(step_s)],
            half,
            full: Transition::new(&parts.oscillator, step_s),
            linear: !terms.iter().any(|t| t.role().acts_on_mass()),
            staged: moving.iter().any(|m| m.term.states() > 0),
            moving,
            followers,
            constants,
            modes: sensing.iter().filter(|m| m.role == Role::Mode).map(|m| m.state).collect(),
            sensing,
            adding,
            late_s: delay(of(Role::InputDelay), of(Role::InputLead)),
            friction: rubbing.map(|(t, first)| coulomb_friction::resistance(&parameters[*first..first + t.values()])),
            lagging: placed(|t| t.role() == Role::Filter(Place::LowPass)).first().map(|m| m.state),
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
        let Self { half, full, pushes, .. } = self;
        let (h, from, x0, v0) = (self.step_s, at.time, motion.x, motion.v);
        let (hx, hv) = half.apply(&x0, &v0);
        let (fx, fv) = full.apply(&x0, &v0);
        (at.x, at.v, at.input) = (x0, v0, u[0]);
        let a0 = self.acceleration(at, motion, Stage { lead_s: 0.0, weight_s: h / 6.0, begins: true });
        (at.time, at.input) = (from + 0.5 * h, u[1]);
        for l in 0..LANES {
            at.x[l] = hx[l] + pushes[0].xv[l] * a0[l];
            at.v[l] = hv[l] + pushes[0].vv[l] * a0[l];
        }
        let a1 = self.acceleration(at, motion, Stage { lead_s: 0.5 * h, weight_s: h / 3.0, begins: false });
        at.x = hx;
        for l in 0..LANES {
            at.v[l] = hv[l] + 0.5 * h * a1[l];
        }
        let a2 = self.acceleration(at, motion, Stage { lead_s: 0.5 * h, weight_s: h / 3.0, begins: false });
        (at.time, at.input) = (from + h, u[2]);
        for l in 0..LANES {
            at.x[l] = fx[l] + pushes[1].xv[l] * a2[l];
            at.v[l] = fv[l] + pushes[1].vv[l] * a2[l];
        }
        let a3 = self.acceleration(at, motion, Stage { lead_s: h, weight_s: h / 6.0, begins: false });
        for l in 0..LANES {
            motion.x[l] = fx[l] + h / 6.0 * (full.xv[l] * a0[l] + 2.0 * half.xv[l] * (a1[l] + a2[l]));
            motion.v[l] = fv[l] + h / 6.0 * (full.vv[l] * a0[l] + 2.0 * half.vv[l] * (a1[l] + a2[l]) + a3[l]);
        }
        if let Some(friction) = &self.friction {
            let (base, side) = (&self.parts.base, &motion.side);
            let sliding = Sliding { step_s: h, base, friction, side, ends: [&a0, &a3] };
            sliding.switch([&x0, &v0], [&mut motion.x, &mut motion.v]);
        }
        if self.staged {
            for s in 0..MOST_STAGED {
                for l in 0..LANES {
                    motion.own[s][l] += motion.sums[s][l];
                }
            }
        }
        Stride { x0, v0, x1: motion.x, v1: motion.v, input: u, step_s: h }
    }

    /// Acceleration besides that of the base at one stage of a step, where `at` stands.
    #[inline(always)]
    pub(super) fn acceleration(&self, at: &Instants<'_, f64, LANES>, motion: &mut StepState, stage: Stage) -> Lanes {
        let StepState { x, v, own, rate, here, sums, side, held_back, .. } = motion;
        let base = &self.parts.base;
        let mut sum = [0.0; LANES];
        for l in 0..LANES {
            sum[l] = base.gain[l] * at.input[l];
        }
        if self.staged {
            for s in 0..MOST_STAGED {
                for l in 0..LANES {
                    here[s][l] = if stage.begins { own[s][l] } else { own[s][l] + stage.lead_s * rate[s][l] };
                }
            }
        }
        // In the order of their states: rows beyond a term's own are zero until the next writes them.
        for m in &self.moving {
            let (Some(own), Some(rate)) = (here[m.state..].first_chunk(), rate[m.state..].first_chunk_mut()) else {
                continue;
            };
            self.force.add(m, at, own, rate, &mut sum);
        }
        if let Some(friction) = &self.friction {
            if stage.begins {
                *side = coulomb_friction::sides(base, friction, [x, v, &sum]);
                for l in 0..LANES {
                    held_back[l] = coulomb_friction::against(friction, side[l], l);
                }
            }
            for l in 0..LANES {
                sum[l] -= held_back[l];
            }
        }
        if self.staged {
            for s in 0..MOST_STAGED {
                for l in 0..LANES {
                    sums[s][l] = if stage.begins { 0.0 } else { sums[s][l] } + stage.weight_s * rate[s][l];
                }
            }
        }
        sum
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
                self.force.add(m, &at, own, &mut rate, &mut push);
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

    /// Passes the velocity or acceleration of mass and modes together, as the displacement that stands for
    /// it, through a filter.
    pub(super) fn filtered(
        &self,
        filter: &Mover<'_>,
        place: Place,
        at: &Instants<'_, f64, LANES>,
        motion: &StepState,
        y: &mut Lanes,
    ) {
        let observed = self.parts.observed;
        let order = if observed.output == Output::Velocity { Order::First } else { Order::Second };
        let (x, v) = together(&self.modes, &motion.own, [&at.x, &at.v]);
        let smooth = filter.term.smoothed(order, [&x, &v], &filter.values, &motion.own[filter.state..]);
        for l in 0..LANES {
            let smooth = observed.displacement(smooth[l]);
            y[l] = if place == Place::HighPass { y[l] - smooth } else { smooth };
        }
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
            if matches!(m.role, Role::Filter(_)) && !modes.is_empty() {
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
