//! A reading that is coupled by a capacitor, as piezoelectric pick-ups, vibrometers and lock-in
//! inputs are: of first order, τy′ + y = τx′.
//!
//! It takes from the reading as much as a low-pass of the same τ shows, y = x − z with τz′ + z = x; so it
//! follows the mass as a low-pass does ([`ReadoutLowpass`]). Next to a low-pass it sees the mass itself,
//! which is right while that one is much the faster.

use super::candidate::{Candidate, Kind, Parameter};
use super::law::{Law, Order, Place, Role};
use super::readout_lowpass::{Poles, ReadoutLowpass};
use super::scales::{Coordinate, Scales};
use super::state::{Constants, Instant, Lanes, MOST_STAGED, MOST_VALUES, Stride};

/// τy′ + y = τx′.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutHighpass;

/// States the candidate for the library.
pub const CANDIDATE: Candidate = Candidate {
    id: "readout-highpass",
    kind: Kind::Driven,
    statement: "The readout is AC-coupled: a first-order high-pass stands behind the proof mass.",
    equation: "τy′ + y = τx′",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 1e4) }],
    acts: "readout",
    signature: "amplitude falls and phase leads below a corner frequency; a steady displacement fades away",
    confusable_with: &["input-lag", "feedthrough", "parasitic-mode", "warm-up"],
    reference: "IEEE 1293, frequency response; ISO 16063-21",
};

/// Low-pass that shows what the high-pass takes away.
const TAKEN: ReadoutLowpass = ReadoutLowpass(Poles::One);
/// Shortest time constant by the period of the resonance over 2π: far below it the reading is a
/// velocity, whose size and τ are one number.
const SHORTEST: f64 = 0.1;
/// Longest time constant by the length of the recording: what fades more slowly shows as a course of the
/// offset, and as nothing else.
const LONGEST: f64 = 0.1;

/// Coordinate of the time constant of a high-pass.
pub(super) fn time_constant(s: &Scales) -> Coordinate {
    let shortest = SHORTEST / s.omega_rad_s;
    Coordinate::Log(shortest, (LONGEST * s.duration_s).max(2.0 * shortest))
}

/// Time constants at which a fit begins, s: from a corner at the resonance to one far below it.
pub(super) fn time_constants_s(s: &Scales) -> [f64; 3] {
    [1.0, 8.0, 60.0].map(|t| t / s.omega_rad_s)
}

impl Law for ReadoutHighpass {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Filter(Place::HighPass)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        vec![time_constant(s), Coordinate::Linear(0.1 * s.output)]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        time_constants_s(s).map(|tau| vec![tau, 0.0]).to_vec()
    }
    fn states(&self) -> usize {
        TAKEN.states()
    }
    fn unknown_beginnings(&self) -> usize {
        TAKEN.unknown_beginnings()
    }
    /// Of a decay it changes size and phase, as a low-pass does.
    fn needs_input(&self) -> bool {
        true
    }
    /// Charges the capacitor with what the reading begins with, and with what is fitted.
    fn begin(&self, x: &Lanes, _: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        own[0] = std::array::from_fn(|l| x[l] + p[1][l]);
    }
    fn constants(&self, p: &[Lanes], step_s: f64) -> Constants {
        TAKEN.constants(p, step_s)
    }
    #[inline(always)]
    fn follow(&self, s: &Stride, constants: &Constants, p: &[Lanes], own: &mut [Lanes]) {
        TAKEN.follow(s, constants, p, own);
    }
    fn smoothed(&self, order: Order, motion: [&Lanes; 2], p: &[Lanes], own: &[Lanes]) -> Lanes {
        TAKEN.smoothed(order, motion, p, own)
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, _: &[f64; MOST_VALUES], own: &[f64; MOST_STAGED], y: f64) -> f64 {
        y - own[0]
    }
}

#[cfg(test)]
mod tests {
    use super::super::state::LANES;
    use super::*;

    const STEP_S: f64 = 0.05;

    /// Reading, and its first and second derivative, behind x = sin t at the end of `steps` steps.
    fn behind_a_sine(tau: f64, steps: usize) -> [f64; 3] {
        let lanes = |v: f64| [v; LANES];
        let (law, p) = (ReadoutHighpass, [lanes(tau), lanes(0.0)]);
        let constants = law.constants(&p, STEP_S);
        let mut own = [lanes(0.0)];
        law.begin(&lanes(0.0), &lanes(1.0), &p, &mut own);
        for n in 0..steps {
            let [t0, t1] = [n, n + 1].map(|n| n as f64 * STEP_S);
            let [x0, v0, x1, v1] = [t0.sin(), t0.cos(), t1.sin(), t1.cos()].map(lanes);
            law.follow(&Stride { step_s: STEP_S, x0, v0, x1, v1, input: [lanes(0.0); 3] }, &constants, &p, &mut own);
        }
        let (x, v) = (steps as f64 * STEP_S).sin_cos();
        let motion = [&lanes(x), &lanes(v)];
        let smooth = [Order::First, Order::Second].map(|order| law.smoothed(order, motion, &p, &own)[3]);
        [x - own[0][3], v - smooth[0], -x - smooth[1]]
    }

    // Long after the beginning jτ/(1 + jτ) of the sine: τ(τ sin t + cos t)/(1 + τ²). The control is a low-pass.
    #[test]
    fn a_sine_and_its_rates_come_out_as_the_frequency_response_says() {
        for tau in [0.3, 1.0, 7.0] {
            let steps = 4000;
            let (sin, cos) = (steps as f64 * STEP_S).sin_cos();
            let part = tau / (1.0 + tau * tau);
            let expected = [tau * sin + cos, tau * cos - sin, -tau * sin - cos].map(|y| part * y);
            let got = behind_a_sine(tau, steps);
            for (got, expected) in got.iter().zip(expected) {
                assert!((got - expected).abs() < 1e-6 / tau.min(1.0), "{tau}: {got} {expected}");
            }
            let low = (sin - tau * cos) / (1.0 + tau * tau);
            assert!((got[0] - low).abs() > 0.01, "{tau}");
        }
    }

    // From rest at a displacement of 1 the capacitor is charged with it: nothing is read.
    #[test]
    fn a_steady_displacement_is_not_read() {
        let lanes = |v: f64| [v; LANES];
        let mut own = [lanes(0.0)];
        ReadoutHighpass.begin(&lanes(1.0), &lanes(0.0), &[lanes(2.0), lanes(0.0)], &mut own);
        assert_eq!(own[0][0], 1.0);
    }
}
