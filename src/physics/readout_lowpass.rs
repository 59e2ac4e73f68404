//! A reading that is smoothed by a low-pass behind the mass: of first order, τy′ + y = x, or with a
//! second pole, Q²τ²y″ + τy′ + y = x.
//!
//! The form with two poles is not searched for ([`Law::tried`]): it nests a
//! delay nearly, so that listing both would turn a clear verdict into a tie. A diagnosis looks for
//! it where nothing simpler suffices. τ is what a slow reading lags by in either form; up to Q = 1/2 the
//! poles are real.

use super::candidate::{Candidate, Kind, Parameter};
use super::free_oscillator::transition;
use super::law::{Law, Order, Place, Role};
use super::scales::{Coordinate, Scales};
use super::state::{Constants, Instant, LANES, Lanes, MOST_STAGED, MOST_VALUES, Stride};

/// Number of poles of a low-pass.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Poles {
    /// One: first order.
    #[default]
    One,
    /// Two: second order.
    Two,
}

/// A low-pass behind the mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadoutLowpass(pub Poles);

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "readout-lowpass",
    kind: Kind::Driven,
    statement: "The readout smooths: a first-order low-pass stands behind the proof mass.",
    equation: "τy′ + y = x",
    parameters: &[Parameter { name: "tau", unit: "s", range: (0.0, 10.0) }],
    acts: "readout",
    signature: "phase and amplitude fall beyond a corner frequency; with a second pole (Q) twice as steeply",
    confusable_with: &["readout-delay", "parasitic-mode", "feedthrough"],
    reference: "IEEE 1293, frequency response",
};

/// States the candidate with a second pole: the same one, with one parameter more.
pub(crate) const TWO_POLES: Candidate = Candidate {
    statement: "The readout smooths: a low-pass with two poles stands behind the proof mass.",
    equation: "Q²τ²y″ + τy′ + y = x",
    parameters: &[
        Parameter { name: "tau", unit: "s", range: (0.0, 10.0) },
        Parameter { name: "Q", unit: "1", range: (LEAST_Q, MOST_Q) },
    ],
    ..CANDIDATE
};

/// Below this the second pole is a thousandth of the first one's time constant: first order.
const LEAST_Q: f64 = 0.03;
/// A filter that rings for longer than this, and peaks by more than 4 dB, is a resonance and no
/// low-pass.
const MOST_Q: f64 = 1.5;

impl Law for ReadoutLowpass {
    fn candidate(&self) -> &'static Candidate {
        match self.0 {
            Poles::One => &CANDIDATE,
            Poles::Two => &TWO_POLES,
        }
    }
    fn role(&self) -> Role {
        Role::Filter(Place::LowPass)
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let tau = Coordinate::Log(1e-4 / s.omega_rad_s, 100.0 / s.omega_rad_s);
        let held = Coordinate::Linear(0.1 * s.output);
        match self.0 {
            Poles::One => vec![tau, held],
            Poles::Two => {
                let slope = Coordinate::Linear(0.1 * s.output * s.omega_rad_s);
                vec![tau, Coordinate::Log(LEAST_Q, MOST_Q), held, slope]
            }
        }
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let constants = [0.005, 0.04, 0.2, 1.0].map(|t| t / s.omega_rad_s);
        match self.0 {
            Poles::One => constants.map(|t| vec![t, 0.0]).to_vec(),
            Poles::Two => {
                let two = |q: f64| constants.map(|t| vec![t, q, 0.0, 0.0]);
                [0.2, 0.4, 0.7].map(two).concat()
            }
        }
    }
    fn states(&self) -> usize {
        match self.0 {
            Poles::One => 1,
            Poles::Two => 2,
        }
    }
    /// Returns the number of its states: a recording may begin in the middle of a motion, so what
    /// they hold is unknown.
    fn unknown_beginnings(&self) -> usize {
        self.states()
    }
    fn begin(&self, x: &Lanes, v: &Lanes, p: &[Lanes], own: &mut [Lanes]) {
        let held = match self.0 {
            Poles::One => &p[1],
            Poles::Two => &p[2],
        };
        for l in 0..LANES {
            own[0][l] = x[l] - p[0][l] * v[l] + held[l];
        }
        if self.0 == Poles::Two {
            for l in 0..LANES {
                own[1][l] = v[l] + p[3][l];
            }
        }
    }
    /// Time constant in steps, and what a step leaves of a difference: as a factor, or for two
    /// poles, after Q²τ² in steps squared, as exp(At).
    fn constants(&self, p: &[Lanes], step_s: f64) -> Constants {
        let mut constants = [[0.0; LANES]; 6];
        for l in 0..LANES {
            let tau = p[0][l];
            constants[0][l] = tau / step_s;
            if self.0 == Poles::One {
                constants[1][l] = (-step_s / tau).exp();
                continue;
            }
            let q = p[1][l];
            constants[1][l] = (q * tau / step_s).powi(2);
            let left = transition(1.0 / (q * tau), 0.5 / q, step_s);
            (0..4).for_each(|i| constants[2 + i][l] = left[i]);
        }
        constants
    }
    /// The displacement over a step is Hermite's cubic through both ends; a cubic's answer is known
    /// in closed form.
    #[inline(always)]
    fn follow(&self, s: &Stride, constants: &Constants, _: &[Lanes], own: &mut [Lanes]) {
        let cubic = |l: usize, ratio: f64, square: f64| {
            let (rise, a, b) = (s.x1[l] - s.x0[l], s.step_s * s.v0[l], s.step_s * s.v1[l]);
            let c3 = a + b - 2.0 * rise;
            let c2 = 3.0 * rise - 2.0 * a - b - 3.0 * ratio * c3;
            let c1 = a - 2.0 * ratio * c2 - 6.0 * square * c3;
            [s.x0[l] - ratio * c1 - 2.0 * square * c2, c1, c2, c3]
        };
        if self.0 == Poles::One {
            let [ratios, decays, ..] = constants;
            let own = &mut own[0];
            for l in 0..LANES {
                let [c0, c1, c2, c3] = cubic(l, ratios[l], 0.0);
                own[l] = c0 + c1 + c2 + c3 + (own[l] - c0) * decays[l];
            }
            return;
        }
        let [ratios, squares, xx, xv, vx, vv] = constants;
        for l in 0..LANES {
            let [c0, c1, c2, c3] = cubic(l, ratios[l], squares[l]);
            let (z, w) = (own[0][l] - c0, own[1][l] - c1 / s.step_s);
            own[0][l] = c0 + c1 + c2 + c3 + xx[l] * z + xv[l] * w;
            own[1][l] = (c1 + 2.0 * c2 + 3.0 * c3) / s.step_s + vx[l] * z + vv[l] * w;
        }
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, _: &[f64; MOST_VALUES], own: &[f64; MOST_STAGED], _: f64) -> f64 {
        own[0]
    }
    fn smoothed(&self, order: Order, [x, v]: [&Lanes; 2], p: &[Lanes], own: &[Lanes]) -> Lanes {
        let of = |l: usize| match (self.0, order) {
            (Poles::One, Order::First) => (x[l] - own[0][l]) / p[0][l],
            (Poles::One, Order::Second) => (v[l] - (x[l] - own[0][l]) / p[0][l]) / p[0][l],
            (Poles::Two, Order::First) => own[1][l],
            (Poles::Two, Order::Second) => (x[l] - own[0][l] - p[0][l] * own[1][l]) / (p[1][l] * p[0][l]).powi(2),
        };
        std::array::from_fn(of)
    }
    /// The first order alone: see the module.
    fn tried(_: usize) -> Vec<Self> {
        vec![Self(Poles::One)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what a low-pass holds after `steps` steps of `step_s` behind x = sin t, from rest at
    /// 0.
    fn behind_a_sine(law: ReadoutLowpass, p: &[f64], step_s: f64, steps: usize) -> f64 {
        let p: Vec<Lanes> = p.iter().map(|v| [*v; LANES]).collect();
        let constants = law.constants(&p, step_s);
        let mut own = [[0.0; LANES]; 2];
        for n in 0..steps {
            let [t0, t1] = [n, n + 1].map(|n| n as f64 * step_s);
            let [x0, v0, x1, v1] = [t0.sin(), t0.cos(), t1.sin(), t1.cos()].map(|v| [v; LANES]);
            law.follow(&Stride { step_s, x0, v0, x1, v1, input: [[0.0; LANES]; 3] }, &constants, &p, &mut own);
        }
        own[0][3]
    }

    // Long after the beginning the reading is the sine times the frequency response at 1 rad/s,
    // 1/(1 − Q²τ² + jτ), with two poles, and 1/((1 + jτ₁)(1 + jτ₂)) of two real ones.
    #[test]
    fn a_sine_comes_out_as_the_frequency_response_says() {
        let (step_s, steps) = (0.05, 2000);
        let t = step_s * steps as f64;
        let response = |re: f64, im: f64| (t.sin() * re - t.cos() * im) / (re * re + im * im);
        for (tau, q) in [(0.6, 0.5), (0.6, 0.9), (0.6, 0.2), (0.02, 0.5), (2.0, 0.05)] {
            let got = behind_a_sine(ReadoutLowpass(Poles::Two), &[tau, q, 0.0, 0.0], step_s, steps);
            let expected = response(1.0 - (q * tau).powi(2), tau);
            assert!((got - expected).abs() < 1e-6, "{tau} {q}: {got} {expected}");
        }
        let (one, two): (f64, f64) = (0.3, 0.1);
        let (tau, q) = (one + two, (one * two).sqrt() / (one + two));
        let got = behind_a_sine(ReadoutLowpass(Poles::Two), &[tau, q, 0.0, 0.0], step_s, steps);
        assert!((got - response(1.0 - one * two, one + two)).abs() < 1e-6);
        let first = behind_a_sine(ReadoutLowpass(Poles::One), &[tau], step_s, steps);
        assert!((first - response(1.0, tau)).abs() < 1e-6 && (first - got).abs() > 0.01, "{first} {got}");
    }

    #[test]
    fn a_second_pole_of_next_to_nothing_is_first_order() {
        let first = behind_a_sine(ReadoutLowpass(Poles::One), &[0.4], 0.05, 50);
        let second = behind_a_sine(ReadoutLowpass(Poles::Two), &[0.4, LEAST_Q, 0.0, 0.0], 0.05, 50);
        assert!((first - second).abs() < 2.0 * LEAST_Q.powi(2), "{first} {second}");
    }
}
