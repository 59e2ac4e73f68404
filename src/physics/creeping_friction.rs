//! Dry friction that creeps about standstill and may fall with speed, as a study runs it: what a
//! diagnosis names as Coulomb friction of a shape of its own ([`ShapedFriction`]).

use crate::numerics::elementary::{Real, fma};
use crate::numerics::exponential;

use super::candidate::{Candidate, Parameter};
use super::law::{Law, Role};
use super::power::{LEAST, bounded_power, by};
use super::scales::{Coordinate, Scales};
use super::shaped_friction::{FALLING, Shape, ShapedFriction};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// f_c (1 + r exp(−|x′/v_r|ᵈ)) tanh(x′/v_s).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CreepingFriction;

/// States the candidate for the library; a diagnosis names it as Coulomb friction.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "creeping-friction",
    equation: "x″ + 2ζω₀x′ + f_c (1 + r exp(−|x′/v_r|ᵈ)) tanh(x′/v_s) + ω₀²x = g·u",
    parameters: &[
        FALLING.parameters[0],
        FALLING.parameters[1],
        FALLING.parameters[2],
        FALLING.parameters[3],
        Parameter { name: "d", unit: "1", range: (0.5, 4.0) },
    ],
    confusable_with: &["coulomb-friction"],
    ..FALLING
};

/// Declares its keys in a study.
pub(crate) const GIVEN: &[Given] = &[
    Given::new(Key::new(
        93,
        "sensor.creeping_friction_m_s2",
        "friction that creeps, at speed",
        "m/s²",
        1.0,
        Sign::NotNegative,
    )),
    Given::new(Key::new(
        94,
        "sensor.creeping_friction_below_m_s",
        "velocity below which friction creeps v_s",
        "m/s",
        1.0,
        Sign::Positive,
    )),
    Given::new(Key::new(
        95,
        "sensor.creeping_friction_lift",
        "share r by which friction holds slow motion back more",
        "1",
        1.0,
        Sign::Any,
    )),
    Given::new(Key::new(
        96,
        "sensor.creeping_friction_lost_over_m_s",
        "velocity over which that is lost v_r",
        "m/s",
        1.0,
        Sign::Positive,
    )),
    Given::new(Key::new(
        97,
        "sensor.creeping_friction_power",
        "power of velocity by which that is lost",
        "1",
        1.0,
        Sign::Positive,
    )),
];

impl CreepingFriction {
    /// The values of a friction of any of its shapes.
    pub fn values_of(friction: ShapedFriction, p: &[f64]) -> [f64; 5] {
        match friction.0 {
            Shape::Smooth => [p[0], p[1], 0.0, p[1], 1.0],
            Shape::Falling => [p[0], p[1], p[2], p[3], 1.0],
            Shape::Bell => [p[0], p[1], p[2], p[3], 2.0],
        }
    }
}

impl Law for CreepingFriction {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    /// A study's own: never fitted.
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let mut all = ShapedFriction(Shape::Falling).coordinates(s);
        all.push(Coordinate::Log(0.5, 4.0));
        all
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        ShapedFriction(Shape::Falling).starts(s).into_iter().map(|start| [start, vec![1.0]].concat()).collect()
    }
    fn has_corner(&self) -> bool {
        true
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn creeping_friction(at: Instant, p0: f32, p1: f32, p2: f32, p3: f32, p4: f32, sum: f32) -> f32 {
    let size = p0 * fma(p2, exp(-pow(max(abs(at.v) / p3, 1e-6), p4)), 1.0);
    let slow = max(p1, p0 * (1.0 + max(p2, 0.0)) * at.step);
    return fma(-size, tanh(clamp(at.v / slow, -9.0, 9.0)), sum);
}"
    }
    /// Smoothed at least over the velocity that friction could undo in one step.
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        _: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        let one = T::of(1.0);
        let slow = p[1].max(p[0] * (one + p[2].max(T::of(0.0))) * at.step);
        let speed = bounded_power((at.v.abs() / p[3]).max(T::of(LEAST)), p[4]);
        let size = p[0] * fma::<T, FMA>(p[2], by(-speed, exponential::exp), one);
        fma::<T, FMA>(-size, by(at.v / slow, exponential::tanh), sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_problem::Mass;
    use super::*;

    // Without a spring v′ = −f tanh(v/s) is solved by sinh(v/s) = sinh(v₀/s) e^(−f t/s).
    #[test]
    fn without_a_lift_it_is_the_smooth_friction() {
        let (f, s, v0, t): (f64, f64, f64, f64) = (0.9, 0.4, 1.5, 2.0);
        let exact = s * ((v0 / s).sinh() * (-f * t / s).exp()).asinh();
        let p = CreepingFriction::values_of(ShapedFriction(Shape::Smooth), &[f, s]);
        let of = |p: &[f64]| Mass::default().moved(&CreepingFriction, p, [0.0, v0], t, 4000, |_| 0.0)[1];
        let v = of(&p);
        assert!((v - exact).abs() < 1e-10, "{v} {exact}");
        // With one it is either shape that falls.
        for shape in [Shape::Falling, Shape::Bell] {
            let (law, own) = (ShapedFriction(shape), [f, s, 0.7, 0.5]);
            let expected = Mass::default().moved(&law, &own, [0.0, v0], t, 4000, |_| 0.0)[1];
            let v = of(&CreepingFriction::values_of(law, &own));
            assert!((v - expected).abs() < 1e-9 && (v - exact).abs() > 1e-3, "{shape:?}: {v} {expected}");
        }
    }
}
