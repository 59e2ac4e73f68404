//! Laws along one cycle of a motion, and the harmonics of their force.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use nalgebra::Complex;

use super::force::{Law, Oscillator};

/// Samples of a cycle.
const SAMPLES: usize = 32;
/// Highest harmonic that is followed.
pub(super) const HARMONICS: usize = 7;
/// Rounds in which the harmonics settle.
const ROUNDS: usize = 4;
/// Part of the largest force by which harmonics must change it to be followed.
pub(super) const HEARD: f64 = 1e-3;

type Phasor = Complex<f64>;

/// cos hθ and sin hθ of each sample of a cycle, for the harmonics h from zero.
struct Turns {
    cos: [[f64; SAMPLES]; HARMONICS + 1],
    sin: [[f64; SAMPLES]; HARMONICS + 1],
}

static TURNS: LazyLock<Turns> = LazyLock::new(|| {
    let at = |h: usize, k: usize| h as f64 * TAU * (k as f64 + 0.5) / SAMPLES as f64;
    let of = |f: fn(f64) -> f64| std::array::from_fn(|h| std::array::from_fn(|k| f(at(h, k))));
    Turns { cos: of(f64::cos), sin: of(f64::sin) }
});

/// Force of laws along a cycle, and its harmonics.
pub(super) struct Cycle<'a> {
    pub mass: &'a Oscillator,
    pub laws: &'a [&'a Law],
    pub omega_rad_s: f64,
}

impl Cycle<'_> {
    /// Force along a motion whose harmonics, from zero, are these.
    fn force(&self, motion: &[Phasor]) -> [f64; SAMPLES] {
        let (mut x, mut v) = ([0.0; SAMPLES], [0.0; SAMPLES]);
        for (h, part) in motion.iter().enumerate().filter(|(_, part)| **part != Phasor::from(0.0)) {
            let (cos, sin, omega) = (&TURNS.cos[h], &TURNS.sin[h], self.omega_rad_s * h as f64);
            for k in 0..SAMPLES {
                x[k] += part.re * cos[k] - part.im * sin[k];
                v[k] -= omega * (part.im * cos[k] + part.re * sin[k]);
            }
        }
        let mut force = [0.0; SAMPLES];
        for law in self.laws {
            let own = law.at(self.mass, [x, v], 0.0, [0.0; 2]).force;
            force.iter_mut().zip(own).for_each(|(f, own)| *f += own);
        }
        force
    }

    /// Harmonic h of a force, of which zero is its mean.
    fn harmonic(&self, force: &[f64; SAMPLES], h: usize) -> Phasor {
        let along = |turn: &[f64; SAMPLES]| force.iter().zip(turn).map(|(f, t)| f * t).sum::<f64>();
        let size = if h == 0 { 1.0 } else { 2.0 } / SAMPLES as f64;
        Phasor::new(along(&TURNS.cos[h]) * size, -along(&TURNS.sin[h]) * size)
    }

    /// Returns whether the force along a sine of this amplitude has a mean.
    pub(super) fn has_mean(&self, a: f64) -> bool {
        let force = self.force(&[Phasor::from(0.0), Phasor::from(a)]);
        self.harmonic(&force, 0).norm() > HEARD * force.iter().fold(0.0f64, |most, f| most.max(f.abs()))
    }

    /// Fundamental of the force along a motion of amplitude `a` with harmonics up to this one.
    pub(super) fn fundamental(&self, a: f64, harmonics: usize) -> Phasor {
        let mut motion = vec![Phasor::from(0.0), Phasor::from(a)];
        let mut force = self.force(&motion);
        let (stiffness, damping) = (self.mass.omega_rad_s.powi(2), self.mass.damping_per_s);
        for _ in 0..if harmonics > 1 { ROUNDS } else { 0 } {
            let part = |h: usize| {
                let omega = self.omega_rad_s * h as f64;
                self.harmonic(&force, h) / Phasor::new(stiffness - omega * omega, omega * damping)
            };
            motion = (0..=harmonics).map(|h| if h == 1 { Phasor::from(a) } else { part(h) }).collect();
            force = self.force(&motion);
        }
        self.harmonic(&force, 1)
    }
}
