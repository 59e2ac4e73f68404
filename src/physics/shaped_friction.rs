//! Dry friction whose force over the velocity has a shape of its own: what a diagnosis names as
//! Coulomb friction where a contact creeps before it slides.
//!
//! The sign is smooth about standstill, tanh(x′/v_s), and in the wider shapes slow motion is held
//! back by a share r more than fast motion (Stribeck's effect). The sharp sign
//! ([`CoulombFriction`](super::coulomb_friction::CoulombFriction)) is the limit of small v_s, which
//! its own integration by events takes better. A study runs all of them as one law
//! ([`CreepingFriction`](super::creeping_friction::CreepingFriction)).

use crate::numerics::elementary::{Real, fma};
use crate::numerics::exponential;

use super::candidate::{Candidate, Parameter};
use super::coulomb_friction;
use super::law::{Law, Role, StartGrid};
use super::power::by;
use super::scales::{Coordinate, Scales};
use super::side_by_side::each;
use super::state::{Instant, Instants, MOST_STAGED, MOST_VALUES, Staged, Values};

/// Shape of the force over the velocity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shape {
    /// f_c tanh(x′/v_s).
    #[default]
    Smooth,
    /// f_c (1 + r exp(−|x′|/v_r)) tanh(x′/v_s), after Tustin.
    Falling,
    /// f_c (1 + r exp(−(x′/v_r)²)) tanh(x′/v_s), after Armstrong-Hélouvry.
    Bell,
}

/// Dry friction of one of these shapes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ShapedFriction(pub Shape);

const SIZE: Parameter = coulomb_friction::CANDIDATE.parameters[0];
const SMOOTHNESS: Parameter = Parameter { name: "v_s", unit: "y/s", range: (0.0, 10.0) };

/// States the candidate with a smooth sign: dry friction, with one parameter more.
const SMOOTH: Candidate = Candidate {
    statement: "Dry friction opposes motion with a force that is constant at speed and goes to zero with it.",
    equation: "x″ + 2ζω₀x′ + f_c tanh(x′/v_s) + ω₀²x = g·u",
    parameters: &[SIZE, SMOOTHNESS],
    signature: "more damping at low amplitude than at high, without a hold",
    reference: "Andersson, Söderberg & Björklund, Tribology International 40 (2007)",
    ..coulomb_friction::CANDIDATE
};

/// States the candidate where slow motion is held back more than fast.
pub(super) const FALLING: Candidate = Candidate {
    statement: "Dry friction opposes motion, slow motion more than fast (Stribeck).",
    equation: "x″ + 2ζω₀x′ + f_c (1 + r exp(−|x′|/v_r)) tanh(x′/v_s) + ω₀²x = g·u",
    parameters: &[
        SIZE,
        SMOOTHNESS,
        Parameter { name: "r", unit: "1", range: LIFTS },
        Parameter { name: "v_r", unit: "y/s", range: (0.0, 10.0) },
    ],
    signature: "more damping at low amplitude than at high, most of all where it barely moves",
    ..coulomb_friction::CANDIDATE
};

/// States the candidate where that follows a bell.
const BELL: Candidate = Candidate {
    equation: "x″ + 2ζω₀x′ + f_c (1 + r exp(−(x′/v_r)²)) tanh(x′/v_s) + ω₀²x = g·u",
    ..FALLING
};

/// Least and largest v_s, in velocities of the motion: below it the sign is sharp, above it the
/// friction is a damper.
const SPEEDS: [f64; 2] = [0.003, 3.0];
/// Least v_r, in velocities of the motion.
const SLOWEST: f64 = 0.03;
/// Shares r that a fit may take.
const LIFTS: (f64, f64) = (-1.0, 10.0);

impl ShapedFriction {
    /// Every shape.
    pub const ALL: [Self; 3] = [Self(Shape::Smooth), Self(Shape::Falling), Self(Shape::Bell)];

    /// Adds the forces on N masses to their accelerations: one loop for each shape, as a choice
    /// inside the loop keeps it from becoming vector code.
    #[inline(always)]
    pub(super) fn forces<T: Real, const N: usize, const FMA: bool>(
        &self,
        at: &Instants<'_, T, N>,
        p: &Values<T, N>,
        own: &Staged<T, N>,
        rates: &mut Staged<T, N>,
        acceleration: &mut [T; N],
    ) {
        match self.0 {
            Shape::Smooth => each::<_, T, N, FMA>(&Self(Shape::Smooth), at, p, own, rates, acceleration),
            Shape::Falling => each::<_, T, N, FMA>(&Self(Shape::Falling), at, p, own, rates, acceleration),
            Shape::Bell => each::<_, T, N, FMA>(&Self(Shape::Bell), at, p, own, rates, acceleration),
        }
    }
}

impl Law for ShapedFriction {
    fn candidate(&self) -> &'static Candidate {
        match self.0 {
            Shape::Smooth => &SMOOTH,
            Shape::Falling => &FALLING,
            Shape::Bell => &BELL,
        }
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let speed = |least: f64| Coordinate::Log(least * s.velocity, SPEEDS[1] * s.velocity);
        // Below zero it would feed the motion.
        let size = Coordinate::Bounded(0.1 * s.zeta * s.omega_rad_s * s.velocity, 0.0, f64::MAX);
        let lift = Coordinate::Bounded(0.3, LIFTS.0, LIFTS.1);
        let mut all = vec![size, speed(SPEEDS[0]), lift, speed(SLOWEST)];
        all.truncate(self.values());
        all
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let (size, v) = (1e-3 * s.zeta * s.omega_rad_s * s.velocity, s.velocity);
        match self.0 {
            Shape::Smooth => [0.03, 0.1, 0.3, 0.8].map(|part| vec![size, part * v]).to_vec(),
            Shape::Falling | Shape::Bell => [(0.01, 0.2), (0.03, 0.2), (0.03, 0.5), (0.1, 0.5)]
                .map(|(smooth, slow)| vec![size, smooth * v, 0.5, slow * v])
                .to_vec(),
        }
    }
    fn start_grid(&self, s: &Scales) -> Option<StartGrid> {
        let starts = self.starts(s);
        let strength = starts[0][0];
        let directions = starts.into_iter().map(|start| start[1..].to_vec()).collect();
        Some(StartGrid::Directions { strength, directions })
    }
    /// About standstill it is a damper of f_c (1 + r)/v_s.
    fn fastest_rad_s(&self, p: &[f64], s: &Scales) -> f64 {
        let most = 1.0 + p.get(2).map_or(0.0, |r| r.max(0.0));
        (p[0] * most / p[1].max(1e-300)).min(7.0 * s.omega_rad_s)
    }
    fn has_corner(&self) -> bool {
        true
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        let sign = by(at.v / p[1], exponential::tanh);
        let slow = at.v.abs() / p[3];
        let lifted = |by_speed: T| p[0] * fma::<T, FMA>(p[2], by(-by_speed, exponential::exp), T::of(1.0));
        let size = match self.0 {
            Shape::Smooth => p[0],
            Shape::Falling => lifted(slow),
            Shape::Bell => lifted(slow * slow),
        };
        fma::<T, FMA>(-size, sign, sum)
    }
    /// The smooth one: a diagnosis looks for the others in its place.
    fn tried(_: usize) -> Vec<Self> {
        vec![Self(Shape::Smooth)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Without a spring v′ = −f tanh(v/s) is solved by sinh(v/s) = sinh(v₀/s) e^(−f t/s).
    #[test]
    fn a_free_mass_creeps_to_a_stop_as_the_integral_says() {
        let (f, s, v0, t): (f64, f64, f64, f64) = (0.9, 0.4, 1.5, 2.0);
        let exact = s * ((v0 / s).sinh() * (-f * t / s).exp()).asinh();
        let smooth = ShapedFriction(Shape::Smooth);
        let [_, v] = Mass::default().moved(&smooth, &[f, s], [0.0, v0], t, 4000, |_| 0.0);
        assert!((v - exact).abs() < 1e-10, "{v} {exact}");
        // With no lift the wider shapes are the same, and with some they are not.
        for shape in [Shape::Falling, Shape::Bell] {
            let falling = ShapedFriction(shape);
            let of = |r: f64| Mass::default().moved(&falling, &[f, s, r, 0.3], [0.0, v0], t, 4000, |_| 0.0)[1];
            assert!((of(0.0) - v).abs() < 1e-12 && (of(0.5) - v).abs() > 1e-3, "{} {}", of(0.0), of(0.5));
        }
    }

    // At v = v_r either has lost all of its lift but 1/e; at 2 v_r Tustin's has lost all but 1/e², a bell all
    // but 1/e⁴.
    #[test]
    fn the_lift_falls_as_stated() {
        let at = |shape, v: f64| {
            let still = Mass { omega: 0.0, zeta: 0.0, gain: 0.0 };
            let step = 1e-6;
            let moved = still.moved(&ShapedFriction(shape), &[2.0, 1e-3, 0.5, 0.3], [0.0, v], step, 1, |_| 0.0);
            (v - moved[1]) / step
        };
        for (shape, v, exponent) in
            [(Shape::Falling, 0.3, 1.0), (Shape::Bell, 0.3, 1.0), (Shape::Falling, 0.6, 2.0), (Shape::Bell, 0.6, 4.0)]
        {
            let expected = 2.0 * (1.0 + 0.5 * f64::exp(-exponent));
            assert!((at(shape, v) - expected).abs() < 1e-4, "{shape:?} {v}: {} {expected}", at(shape, v));
        }
    }
}
