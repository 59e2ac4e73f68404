//! Dry friction: a constant force against the motion, f_c sgn x′, which can hold the mass still; of
//! one size in both directions, or of another in each ([`Sides::Apart`]).
//!
//! The form with two sizes is not searched for ([`Law::tried`]): while the mass slides, their
//! difference is a constant force, which is an offset of the reading and nothing else, so that only
//! a recording in which the mass sticks can show it. It can be simulated and fitted by name.
//!
//! The diagnosis takes each step with the force held and puts the instant at which the mass turns,
//! stops or breaks loose where it belongs inside the step (`Sliding`): a smoothed sign costs an
//! error of first order in the step at every turn. Studies take the smoothed sign ([`Law::force`]),
//! whose error is small next to their noise.

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{BaseLanes, Instant, LANES, Lanes, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// Says whether both directions rub alike.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Sides {
    /// By f_c in both.
    #[default]
    Alike,
    /// By f_c + f_d forwards and f_c − f_d backwards.
    Apart,
}

/// f_c sgn x′, with f_d besides while it slides where the sides differ.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CoulombFriction(pub Sides);

/// States the candidate for the library.
pub const CANDIDATE: Candidate = Candidate {
    id: "coulomb-friction",
    kind: Kind::Driven,
    statement: "Dry friction opposes motion with a constant force and can hold the mass still.",
    equation: "x″ + 2ζω₀x′ + f_c sgn x′ + ω₀²x = g·u",
    parameters: &[Parameter { name: "f_c", unit: "y/s^2", range: (-1.0, 1.0) }],
    acts: "equation of motion",
    signature: "more damping at low amplitude than at high; flat tops where motion stops",
    confusable_with: &["hysteresis", "quadratic-damping", "squeeze-film-damping"],
    reference: "Armstrong-Hélouvry, Dupont & Canudas de Wit, Automatica 30 (1994)",
};

/// States the candidate where the sides differ: the same one, with one parameter more.
pub(crate) const APART: Candidate = Candidate {
    statement: "Dry friction opposes motion, more in one direction than in the other, and can hold the mass still.",
    equation: "x″ + 2ζω₀x′ + f_c sgn x′ + f_d + ω₀²x = g·u while it slides",
    parameters: &[
        Parameter { name: "f_c", unit: "y/s^2", range: (-1.0, 1.0) },
        Parameter { name: "f_d", unit: "y/s^2", range: (-1.0, 1.0) },
    ],
    signature: "as with equal sides, and the mass comes to rest off its centre",
    ..CANDIDATE
};

/// Declares its keys in a study.
pub const GIVEN: &[Given] =
    &[Given::new(Key::new(6, "sensor.coulomb_friction_m_s2", "Coulomb friction", "m/s²", 1.0, Sign::NotNegative))];

impl Law for CoulombFriction {
    fn candidate(&self) -> &'static Candidate {
        match self.0 {
            Sides::Alike => &CANDIDATE,
            Sides::Apart => &APART,
        }
    }
    fn role(&self) -> Role {
        Role::Friction
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let scale = 0.1 * s.zeta * s.omega_rad_s * s.velocity;
        // Below zero it would feed the motion. The difference of the sides has either sign.
        let mut all = vec![Coordinate::Bounded(scale, 0.0, f64::MAX), Coordinate::Linear(scale)];
        all.truncate(self.values());
        all
    }
    fn starts(&self, _: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0; self.values()]]
    }
    fn has_corner(&self) -> bool {
        true
    }
    fn study(&self) -> &'static [Given] {
        match self.0 {
            Sides::Alike => GIVEN,
            Sides::Apart => &[],
        }
    }
    fn wgsl(&self) -> &'static str {
        "fn coulomb_friction(at: Instant, p0: f32, sum: f32) -> f32 {
    return fma(-p0, at.v / (abs(at.v) + p0 * at.step + 1e-30), sum);
}"
    }
    /// The sign smoothed over the velocity that friction could undo in one step.
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        let sign = at.v / (at.v.abs() + p[0] * at.step + T::of(1e-30));
        match self.0 {
            Sides::Alike => fma::<T, FMA>(-p[0], sign, sum),
            Sides::Apart => fma::<T, FMA>(-p[0], sign, fma::<T, FMA>(-p[1], sign.abs(), sum)),
        }
    }
}

/// Returns the force that holds each lane back: forwards, and backwards.
pub fn resistance(p: &[Lanes]) -> [Lanes; 2] {
    match p {
        [size, difference, ..] => {
            [std::array::from_fn(|l| size[l] + difference[l]), std::array::from_fn(|l| size[l] - difference[l])]
        }
        [size] => [*size; 2],
        [] => [[0.0; LANES]; 2],
    }
}

/// The force of friction on a lane that slides this way; 0 where it holds.
#[inline(always)]
pub fn against(friction: &[Lanes; 2], side: f64, l: usize) -> f64 {
    // Two choices of one thing each, and no choice among three: that remains vector code.
    let forwards = if side > 0.0 { friction[0][l] } else { 0.0 };
    let backwards = if side < 0.0 { friction[1][l] } else { 0.0 };
    forwards - backwards
}

/// The way in which each lane slides: that of its velocity, or from rest that of a pull greater
/// than friction; 0 where it holds. `at` is displacement, velocity and what accelerates besides
/// friction and the base.
#[inline(always)]
pub fn sides(base: &BaseLanes, friction: &[Lanes; 2], at: [&Lanes; 3]) -> Lanes {
    let [x, v, acceleration] = at;
    let mut sides = [0.0; LANES];
    for l in 0..LANES {
        let pull = acceleration[l] - base.stiffness[l] * x[l];
        let from_rest = if (pull > friction[0][l]) | (-pull > friction[1][l]) { pull } else { 0.0 };
        let way = if v[l] == 0.0 { from_rest } else { v[l] };
        sides[l] = (if way > 0.0 { 1.0 } else { 0.0 }) - (if way < 0.0 { 1.0 } else { 0.0 });
    }
    sides
}

/// A step taken with each lane sliding the way it did at the beginning.
#[derive(Debug, Clone, Copy)]
pub struct Sliding<'a> {
    /// Length of a step, s.
    pub step_s: f64,
    /// The oscillator on each lane.
    pub base: &'a BaseLanes,
    /// Friction forwards and backwards.
    pub friction: &'a [Lanes; 2],
    /// The direction in which each lane slides, from `sides`.
    pub side: &'a Lanes,
    /// Acceleration besides that of the base at the beginning and at the end.
    pub ends: [&'a Lanes; 2],
}

impl Sliding<'_> {
    /// Puts the event where it belongs in the lanes that had one: those that changed direction, and
    /// those that were held.
    #[inline(always)]
    pub fn switch(&self, begin: [&Lanes; 2], end: [&mut Lanes; 2]) {
        let [x, v] = end;
        // No early end: the whole of it is vector code.
        let happens = |any, (side, v): (&f64, &f64)| any | (*side == 0.0) | (side * v < 0.0);
        if self.side.iter().zip(v.iter()).fold(false, happens) {
            self.resolve(begin, [x, v]);
        }
    }

    /// Rare, hence apart from the loop over the steps.
    #[inline(never)]
    fn resolve(&self, begin: [&Lanes; 2], end: [&mut Lanes; 2]) {
        let [x, v] = end;
        for l in 0..LANES {
            if self.side[l] != 0.0 && self.side[l] * v[l] >= 0.0 {
                continue;
            }
            let (stiffness, damping) = (self.base.stiffness[l], self.base.damping[l]);
            let whole = |x: f64, v: f64, a: f64| [x, v, a - stiffness * x - damping * v];
            let event = Event {
                step_s: self.step_s,
                stiffness,
                damping,
                friction: [self.friction[0][l], self.friction[1][l]],
                side: self.side[l],
                begin: whole(begin[0][l], begin[1][l], self.ends[0][l]),
                end: whole(x[l], v[l], self.ends[1][l]),
            };
            [x[l], v[l]] = event.resolved();
        }
    }
}

/// One lane's step: what the integration found with the force held.
#[derive(Debug, Clone, Copy)]
struct Event {
    step_s: f64,
    stiffness: f64,
    damping: f64,
    /// Friction forwards and backwards.
    friction: [f64; 2],
    side: f64,
    /// Displacement, velocity and acceleration before.
    begin: [f64; 3],
    end: [f64; 3],
}

impl Event {
    /// Displacement and velocity at the end of the step, with the event where it belongs.
    fn resolved(&self) -> [f64; 2] {
        let (h, side) = (self.step_s, self.side);
        let ([x0, v0, a0], [x1, v1, a1]) = (self.begin, self.end);
        let (mut rest_s, mut x, mut pull, mut held) = (0.0, x0, a0, 0.0);
        if side != 0.0 {
            let t = self.turn();
            rest_s = t * h;
            // Hermite's cubics of displacement and velocity between both ends.
            let rise = x1 - x0;
            x = x0 + t * (h * v0 + t * (3.0 * rise - h * (2.0 * v0 + v1) + t * (h * (v0 + v1) - 2.0 * rise)));
            let gain = v1 - v0;
            let (bend, twist) = (3.0 * gain / h - 2.0 * a0 - a1, a0 + a1 - 2.0 * gain / h);
            let rate = a0 + t * (2.0 * bend + 3.0 * t * twist);
            let [with, back] = if side > 0.0 { self.friction } else { [self.friction[1], self.friction[0]] };
            held = side * with;
            pull = rate + held;
            if side * pull < -back {
                // It slides on the other way: friction has jumped, and the oscillator answers that.
                let (r, c) = (h - rest_s, self.damping);
                let jump = (with + back) * side;
                let bend = c * c - self.stiffness;
                let of_x = r * r * (0.5 - r * (c / 6.0 - r * bend / 24.0));
                let of_v = r * (1.0 - r * (0.5 * c - r * bend / 6.0));
                return [x1 + jump * of_x, v1 + jump * of_v];
            }
        }
        // Held: what pulls at the end of the step, with the mass where it rests.
        let last = a1 + held + self.stiffness * (x1 - x) + self.damping * v1;
        let excess = last.abs() - self.friction[usize::from(last < 0.0)];
        if excess <= 0.0 {
            return [x, 0.0];
        }
        // The pull grows in proportion to time, and from where it exceeds friction so does the
        // acceleration.
        let way = last.signum();
        let loose_s = (h - rest_s) * (excess / (way * (last - pull)).max(excess));
        [x + way * excess * loose_s * loose_s / 6.0, 0.5 * way * excess * loose_s]
    }

    /// Returns the place in the step, from 0 to 1, at which the velocity (Hermite's cubic) passes
    /// zero.
    fn turn(&self) -> f64 {
        let h = self.step_s;
        let ([_, v0, a0], [_, v1, a1]) = (self.begin, self.end);
        let gain = v1 - v0;
        let (bend, twist) = (3.0 * gain - h * (2.0 * a0 + a1), h * (a0 + a1) - 2.0 * gain);
        let mut t = (-v0 / gain).clamp(0.0, 1.0);
        for _ in 0..3 {
            let value = v0 + t * (h * a0 + t * (bend + t * twist));
            let slope = h * a0 + t * (2.0 * bend + 3.0 * t * twist);
            // A slope that would lead up again is that of a cubic bent too far; the chord is safe.
            let slope = if slope * gain > 0.1 * gain * gain { slope } else { gain };
            t = (t - value / slope).clamp(0.0, 1.0);
        }
        t
    }
}
