//! A second resonance next to the one modelled: it answers the same input and is read together with
//! the mass.

use std::f64::consts::TAU;

use super::candidate::{Candidate, Kind, Parameter};
use super::free_oscillator::{self, transition};
use super::law::{Law, Role, StartGrid};
use super::scales::{Coordinate, Scales};
use super::state::{Constants, Instant, LANES, Lanes, MOST_STAGED, MOST_VALUES, Stride};
use super::study::Given;
use crate::numerics::elementary::{Real, fma};
use crate::units::key::{Key, Sign};

/// A second resonance that answers the same input and adds to the reading, by its place among them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ParasiticMode(pub usize);

impl ParasiticMode {
    /// All that a diagnosis looks for.
    pub const ALL: [Self; 3] = [Self(0), Self(1), Self(2)];
}

/// States the candidate for the library.
pub(crate) const CANDIDATE: Candidate = Candidate {
    id: "parasitic-mode",
    kind: Kind::Driven,
    statement: "A second resonance answers the same input.",
    equation: "y = x + x₂, x₂″ + 2ζ₂ω₂x₂′ + ω₂²x₂ = g₂·u",
    parameters: &[
        Parameter { name: "g2", unit: "y/(u s^2)", range: (-1.0, 1.0) },
        Parameter { name: "omega2", unit: "rad/s", range: (0.1, 10.0) },
        Parameter { name: "zeta2", unit: "1", range: (1e-4, 0.6) },
    ],
    acts: "equation of motion",
    signature: "a second peak, or a dip next to one, in the frequency response",
    confusable_with: &["feedthrough", "readout-lowpass", "readout-delay"],
    reference: "Ewins, Modal Testing, 2nd ed., 2000, ch. 2",
};

/// Declares its keys in a study; its gain is that of the proof mass' own force, which is one, and
/// is turned round with the reading.
pub(crate) const GIVEN: &[Given] = &[
    Given::turning(Key::new(80, "sensor.parasitic_mode_gain", "gain of the parasitic mode g₂", "1", 1.0, Sign::Any)),
    Given::new(Key::new(81, "sensor.parasitic_mode_hz", "frequency of the parasitic mode", "Hz", TAU, Sign::Positive)),
    Given::new(Key::new(
        82,
        "sensor.parasitic_mode_damping_ratio",
        "damping ratio of the parasitic mode ζ₂",
        "1",
        1.0,
        Sign::NotNegative,
    )),
];

impl Law for ParasiticMode {
    fn candidate(&self) -> &'static Candidate {
        &CANDIDATE
    }
    fn role(&self) -> Role {
        Role::Mode
    }
    fn coordinates(&self, s: &Scales) -> Vec<Coordinate> {
        let omega = s.omega_rad_s;
        vec![
            Coordinate::Linear(0.1 * s.gain.abs()),
            Coordinate::Log(
                0.05 * omega,
                (20.0 * omega).min(0.95 * std::f64::consts::PI / s.interval_s).max(0.1 * omega),
            ),
            Coordinate::Log(1e-4, 0.6),
            Coordinate::Linear(0.1 * s.output),
            Coordinate::Linear(0.1 * s.output * omega),
        ]
    }
    fn starts(&self, s: &Scales) -> Vec<Vec<f64>> {
        let nyquist = std::f64::consts::PI / s.interval_s;
        let grid = [0.25, 0.4, 0.6, 0.8, 1.25, 1.6, 2.1, 2.8, 3.7, 5.0, 7.0].map(|r| r * s.omega_rad_s);
        let peaks = s.lines_hz.iter().take(3).map(|f| f * TAU);
        let mut starts: Vec<Vec<f64>> =
            grid.into_iter().filter(|w| *w < 0.9 * nyquist).map(|w| vec![0.0, w, 0.1, 0.0, 0.0]).collect();
        starts.extend(peaks.filter(|w| *w < 0.95 * nyquist).map(|w| vec![0.0, w, 0.02, 0.0, 0.0]));
        starts
    }
    fn states(&self) -> usize {
        2
    }
    fn unknown_beginnings(&self) -> usize {
        2
    }
    /// Its own motion is exact; Simpson's rule over the input's push errs by (ω₂h)⁴/2880 of it,
    /// 2e-5 at half a radian.
    fn fastest_rad_s(&self, p: &[f64], _: &Scales) -> f64 {
        0.35 * p[1]
    }
    /// A study has one.
    fn study(&self) -> &'static [Given] {
        if self.0 == 0 { GIVEN } else { &[] }
    }
    fn wgsl(&self) -> &'static str {
        "fn parasitic_mode_rates(at: Instant, p0: f32, p1: f32, p2: f32, own: vec2<f32>) -> vec2<f32> {
    let spring = fma(-(p1 * p1), own.x, p0 * at.input);
    return vec2<f32>(own.y, fma(-(2.0 * p2 * p1), own.y, spring));
}
fn parasitic_mode(at: Instant, p0: f32, p1: f32, p2: f32, own: vec2<f32>, sum: f32) -> f32 {
    return sum;
}"
    }
    fn at_rest(&self, _: f64, p: &[f64]) -> f64 {
        if p[1] == 0.0 { 0.0 } else { p[0] / (p[1] * p[1]) }
    }
    fn stiffens(&self, p: &[f64]) -> f64 {
        free_oscillator::fastest_rad_s(p[1], p[2]).powi(2)
    }
    /// exp(At) over a step, and its answer to a push half a step before the end.
    fn constants(&self, p: &[Lanes], step_s: f64) -> Constants {
        let mut constants = [[0.0; LANES]; 6];
        for l in 0..LANES {
            let full = transition(p[1][l], p[2][l], step_s);
            let [_, xv, _, vv] = transition(p[1][l], p[2][l], 0.5 * step_s);
            for (c, value) in constants.iter_mut().zip(full.into_iter().chain([xv, vv])) {
                c[l] = value;
            }
        }
        constants
    }
    /// Linear and moved by the input alone, it needs no stages.
    #[inline(always)]
    fn follow(&self, s: &Stride, constants: &Constants, p: &[Lanes], own: &mut [Lanes]) {
        let [xx, xv, vx, vv, half_xv, half_vv] = constants;
        let [begin, middle, end] = &s.input;
        let (gain, sixth) = (&p[0], s.step_s / 6.0);
        let (x, v) = (own[0], own[1]);
        let (mut nx, mut nv) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let push = sixth * gain[l];
            nx[l] = xx[l] * x[l] + xv[l] * v[l] + push * (xv[l] * begin[l] + 4.0 * half_xv[l] * middle[l]);
            let rest = vv[l] * begin[l] + 4.0 * half_vv[l] * middle[l] + end[l];
            nv[l] = vx[l] * x[l] + vv[l] * v[l] + push * rest;
        }
        (own[0], own[1]) = (nx, nv);
    }
    fn needs_input(&self) -> bool {
        true
    }
    /// Frequencies 14 % apart and where the residual stands out, at three dampings.
    fn start_grid(&self, s: &Scales) -> Option<StartGrid> {
        let nyquist = std::f64::consts::PI / s.interval_s;
        let grid = (0..30).map(|i| 0.2 * s.omega_rad_s * 1.14f64.powi(i));
        let peaks = s.lines_hz.iter().take(3).map(|f| f * TAU);
        let omegas: Vec<f64> = grid.chain(peaks).filter(|w| *w < 0.95 * nyquist).collect();
        let directions = omegas.iter().flat_map(|w| [0.01, 0.05, 0.25].map(|z| vec![*w, z, 0.0, 0.0])).collect();
        Some(StartGrid::Directions { strength: 1e-3 * s.gain.abs(), directions })
    }
    /// Velocity and acceleration of the mode.
    #[inline(always)]
    fn rates<T: Real, const FMA: bool>(
        &self,
        at: &Instant<'_, T>,
        p: &[T; MOST_VALUES],
        own: &[T; MOST_STAGED],
    ) -> [T; MOST_STAGED] {
        let spring = fma::<T, FMA>(-(p[1] * p[1]), own[0], p[0] * at.input);
        let mut rates = [T::of(0.0); MOST_STAGED];
        rates[0] = own[1];
        rates[1] = fma::<T, FMA>(-(T::of(2.0) * p[2] * p[1]), own[1], spring);
        rates
    }
    #[inline(always)]
    fn reading(&self, _: &Instant<'_, f64>, _: &[f64; MOST_VALUES], own: &[f64; MOST_STAGED], y: f64) -> f64 {
        y + own[0]
    }
}
