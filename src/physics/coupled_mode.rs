//! A second mass that hangs on the first by a spring and a damper, moves with it and pulls back on
//! it.
//!
//! Linear, and so close to `parasitic_mode`: two masses with light damping are two modes side by
//! side up to how their damping is shared out, and no input that both models hear alike tells them
//! apart. It is therefore no candidate of its own in the search ([`Law::tried`]); a diagnosis looks
//! for it from the two modes that it would be, where a mode stands or nothing simpler ends the
//! matter. It can be simulated and fitted by name.

use std::f64::consts::TAU;

use crate::numerics::elementary::{Real, fma};

use super::candidate::{Candidate, Kind, Parameter};
use super::free_oscillator::fastest_rad_s;
use super::law::{Law, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Instant, MOST_STAGED, MOST_VALUES};
use super::study::Given;
use crate::units::key::{Key, Sign};

/// A second mass on the first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CoupledMode;

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "coupled-mode",
    kind: Kind::Driven,
    statement: "A second mass is coupled to the proof mass and reacts on it: frame, electrode or package move too.",
    equation: "x″ + 2ζω₀x′ + ω₀²x = g·u + μ(ω₂²(z − x) + 2ζ₂ω₂(z′ − x′)), z″ + 2ζ₂ω₂(z′ − x′) + ω₂²(z − x) = 0",
    parameters: &[
        Parameter { name: "mu", unit: "1", range: (0.0, 1.0) },
        Parameter { name: "omega2", unit: "rad/s", range: (0.1, 10.0) },
        Parameter { name: "zeta2", unit: "1", range: (1e-4, 0.6) },
    ],
    acts: "equation of motion",
    signature: "the resonance is split in two with a dip between them, at the second mass' own frequency",
    confusable_with: &["parasitic-mode"],
    reference: "Den Hartog, Mechanical Vibrations, 4th ed., 1956, § 3.2 (vibration absorber)",
};

/// Declares its keys in a study.
pub(crate) const GIVEN: &[Given] = &[
    Given::new(Key::new(
        77,
        "sensor.coupled_mode_mass_ratio",
        "mass of the coupled mode μ over the proof mass",
        "1",
        1.0,
        Sign::NotNegative,
    )),
    Given::new(Key::new(78, "sensor.coupled_mode_hz", "frequency of the coupled mode", "Hz", TAU, Sign::Positive)),
    Given::new(Key::new(
        79,
        "sensor.coupled_mode_damping_ratio",
        "damping ratio of the coupled mode ζ₂",
        "1",
        1.0,
        Sign::NotNegative,
    )),
];

impl Law for CoupledMode {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Force
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let omega = s.omega_rad_s;
        vec![
            // The ratio of two masses.
            Coordinate::Bounded(0.1, 0.0, 10.0),
            Coordinate::Log(0.05 * omega, 20.0 * omega),
            Coordinate::Log(1e-4, 0.6),
            Coordinate::Linear(0.1 * s.output),
            Coordinate::Linear(0.1 * s.output * omega),
        ]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let ratios = [0.4, 0.7, 0.85, 0.95, 1.05, 1.2, 1.4, 2.1, 3.7];
        ratios.map(|r| vec![0.01, r * s.omega_rad_s, 0.05, 0.0, 0.0]).to_vec()
    }
    fn states(&self) -> usize {
        2
    }
    fn unknown_beginnings(&self) -> usize {
        2
    }
    fn fastest_rad_s(&self, p: &[f64], _: &Scales) -> f64 {
        p[1]
    }
    fn study(&self) -> &'static [Given] {
        GIVEN
    }
    fn wgsl(&self) -> &'static str {
        "fn coupled_mode_rates(at: Instant, p0: f32, p1: f32, p2: f32, own: vec2<f32>) -> vec2<f32> {
    let stretch = own.x - at.x;
    let slip = own.y - at.v;
    return vec2<f32>(own.y, -(p1 * p1 * stretch + 2.0 * p2 * p1 * slip));
}
fn coupled_mode(at: Instant, p0: f32, p1: f32, p2: f32, own: vec2<f32>, sum: f32) -> f32 {
    return fma(-p0, coupled_mode_rates(at, p0, p1, p2, own).y, sum);
}"
    }
    /// The squares of the pair's two frequencies sum up to ω₀² + (1 + μ)ω₂²; against each other the
    /// masses are damped by (1 + μ)ζ₂ω₂.
    fn stiffens(&self, p: &[f64]) -> f64 {
        let both = (1.0 + p[0].max(0.0)).sqrt();
        fastest_rad_s(both * p[1], both * p[2]).powi(2)
    }
    /// The second mass hangs where the first is.
    fn at_rest(&self, displacement: f64, _: &[f64]) -> f64 {
        displacement
    }
    #[inline(always)]
    fn force<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        own: &[T; MOST_STAGED],
        sum: T,
    ) -> T {
        fma::<T, FMA>(-p[0], self.rates::<T, FMA>(at, p, own)[1], sum)
    }
    /// Velocity and acceleration of the second mass.
    #[inline(always)]
    fn rates<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        own: &[T; MOST_STAGED],
    ) -> [T; MOST_STAGED] {
        let (stretch, slip) = (own[0] - at.x, own[1] - at.v);
        let damping = T::of(2.0) * p[2] * p[1];
        let mut rates = [T::of(0.0); MOST_STAGED];
        rates[0] = own[1];
        rates[1] = -(p[1] * p[1] * stretch + damping * slip);
        rates
    }
    /// None: see the module.
    fn tried(_: usize) -> Vec<Self> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Displacement and velocity of both masses after `time_s`, from `s` on; no damping of the
    /// first.
    fn moved(p: [f64; 3], omega: f64, mut s: [f64; 4], time_s: f64) -> [f64; 4] {
        let (steps, values) = (20_000, [p[0], p[1], p[2], 0.0, 0.0, 0.0]);
        let h = time_s / f64::from(steps);
        let slope = |s: [f64; 4]| {
            let at = Instant { x: s[0], v: s[1], ..Instant::default() };
            let mut own = [0.0; MOST_STAGED];
            own[..2].copy_from_slice(&s[2..]);
            let pulled = CoupledMode.force::<f64, false>(&at, &values, &own, -omega * omega * s[0]);
            let rates = CoupledMode.rates::<f64, false>(&at, &values, &own);
            [s[1], pulled, rates[0], rates[1]]
        };
        let add = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
        for _ in 0..steps {
            let k1 = slope(s);
            let k2 = slope(add(s, k1, 0.5 * h));
            let k3 = slope(add(s, k2, 0.5 * h));
            let k4 = slope(add(s, k3, h));
            s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        s
    }

    // Both masses tuned alike (ω₂ = ω₀): Ω² = ω₀²(1 + μ/2 ∓ √(μ + μ²/4)) (Den Hartog, § 3.2), and
    // released in the shape z/x = ω₂²/(ω₂² − Ω²) the pair is back after a period 2π/Ω.
    #[test]
    fn a_tuned_pair_has_the_two_frequencies_of_the_absorber() {
        let (omega, mu) = (4.0f64, 0.05f64);
        for side in [-1.0, 1.0] {
            let square = omega * omega * (1.0 + 0.5 * mu + side * (mu + 0.25 * mu * mu).sqrt());
            let begin = [1.0, 0.0, omega * omega / (omega * omega - square), 0.0];
            let period = 2.0 * std::f64::consts::PI / square.sqrt();
            let end = moved([mu, omega, 0.0], omega, begin, period);
            for (a, b) in end.iter().zip(begin) {
                assert!((a - b).abs() < 1e-8, "{end:?} {begin:?}");
            }
            let other = moved([2.0 * mu, omega, 0.0], omega, begin, period);
            assert!((other[2] - begin[2]).abs() > 1e-2, "a heavier mass has another period");
        }
    }

    // The larger frequency of the tuned pair (Den Hartog, § 3.2) is below the bound for the steps of
    // a study, which is no more than √2 above it.
    #[test]
    fn the_bound_of_the_steps_lies_above_the_pairs_faster_mode() {
        for (omega, mu) in [(4.0f64, 0.05f64), (4.0, 1.0), (0.3, 10.0)] {
            let square = omega * omega * (1.0 + 0.5 * mu + (mu + 0.25 * mu * mu).sqrt());
            let bound = omega * omega + CoupledMode.stiffens(&[mu, omega, 0.0]);
            assert!(bound >= square && bound < 2.0 * square, "{mu}: {bound} {square}");
        }
    }

    // The pair's momentum changes by the first spring alone: without it, it stays.
    #[test]
    fn what_pulls_on_the_first_pulls_back_on_the_second() {
        let (mu, begin) = (0.3, [0.1, 0.5, -0.2, 0.0]);
        let end = moved([mu, 3.0, 0.2], 0.0, begin, 2.0);
        let momentum = |s: [f64; 4]| s[1] + mu * s[3];
        assert!((momentum(end) - momentum(begin)).abs() < 1e-10 && (end[3] - begin[3]).abs() > 0.1, "{end:?}");
    }
}
