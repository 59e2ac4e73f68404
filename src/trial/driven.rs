//! One blind driven case: all its numbers, and the recording they make.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::equation::Oscillator;
use super::excitation::Excitation;
use super::physics::{DEGREES, Physics, Scales, Term};
use super::proof_mass::{self, Clock};
use super::readout::{self, Noise, Tap};
use super::refit;

/// Samples before the first recorded one, so that the record does not begin at rest.
const RUN_IN: usize = 300;
/// Integration steps per sample; twice as many for abrupt physics.
const SUBSTEPS: usize = 20;

/// Log-likelihood that an effect must be worth to one who knows all else, or it does not act: odds
/// of 3000 to 1.
const LEAST_LOG_LIKELIHOOD: f64 = 8.0;

/// A planted effect with its size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Planted {
    /// Effect that is planted.
    pub term: Term,
    /// rms of what the best linear proof mass cannot explain, over the rms output: the size that
    /// can be seen.
    pub visible: f64,
    /// rms change of the output before any refit, over the rms output.
    pub raw: f64,
}

/// The numbers of a driven case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Seed of noise and environment.
    pub seed: u64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Number of samples in the recording.
    pub samples: usize,
    /// Natural frequency ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Damping ratio ζ.
    pub zeta: f64,
    /// Output unit per input unit and s².
    pub gain: f64,
    /// Reading at rest, output unit.
    pub offset: f64,
    /// Displacement and velocity at the beginning: of the run-in, or of a ring-down.
    pub start: [f64; 2],
    /// Input of the recording.
    pub excitation: Excitation,
    /// White readout noise, standard deviation.
    pub noise: f64,
    /// Scales of the undisturbed motion, to which amplitudes refer.
    pub scales: Scales,
    /// rms of the undisturbed output in this recording; below `scales.x` where the loud part is
    /// withheld.
    pub output_rms: f64,
    /// Planted effects, largest first.
    pub planted: Vec<Planted>,
    /// Hints given in model.toml: resonance in Hz and damping ratio, wrong by up to a factor of
    /// two.
    pub hints: Option<[f64; 2]>,
}

/// Columns as the file will hold them.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Absent for a ring-down.
    pub force: Option<Vec<f64>>,
    /// Output column, with noise.
    pub reading: Vec<f64>,
    /// A slow environment, given where an effect follows it.
    pub temperature: Option<Vec<f64>>,
}

/// Inputs tabulated once per case.
pub(super) struct Scene<'a> {
    case: &'a Driven,
    lead: usize,
    substeps: usize,
    /// On half-steps, from the start of the run-in.
    input: Vec<f64>,
    environment: Vec<f64>,
}

impl Driven {
    /// A proof mass at rest at its offset, with nothing planted and no noise; its scales are those
    /// of its motion.
    pub fn linear(oscillator: Oscillator, excitation: Excitation, rate_hz: f64, samples: usize, seed: u64) -> Self {
        let Oscillator { omega_rad_s, zeta, gain, start } = oscillator;
        let duration_s = samples as f64 / rate_hz;
        let damping_rad_s = 2.0 * zeta * omega_rad_s;
        let unit = Scales { x: 1.0, peak: 1.0, v: 1.0, u: 1.0, duration_s, omega_rad_s, damping_rad_s, gain };
        let mut case = Self {
            seed,
            rate_hz,
            samples,
            omega_rad_s,
            zeta,
            gain,
            offset: 0.0,
            start,
            excitation,
            noise: 0.0,
            scales: unit,
            output_rms: 1.0,
            planted: Vec::new(),
            hints: None,
        };
        case.scales = case.measure_scales();
        case.output_rms = case.scales.x;
        case
    }

    /// Returns whether an effect follows the environment column.
    pub fn has_environment(&self) -> bool {
        self.planted.iter().any(|p| p.term.physics == Physics::StiffnessDrift && p.term.shape[1] != 0.0)
    }

    /// A slow, smooth environment, about ±1 and zero on average over the recording.
    fn environment_at(&self, t_s: f64) -> f64 {
        let phase = (self.seed % 1000) as f64 / 1000.0 * TAU;
        let waves = [(0.7, 1.3 * TAU, phase), (0.5, 3.1 * TAU, 2.0 * phase)];
        let turn = t_s / self.scales.duration_s;
        waves.iter().map(|(a, w, p)| a * ((w * turn + p).sin() - (p.cos() - (w + p).cos()) / w)).sum()
    }

    fn is_abrupt(&self) -> bool {
        self.planted.iter().any(|p| p.term.physics.is_abrupt())
    }

    /// Simulates the recording.
    pub fn render(&self) -> Columns {
        let scene = Scene::new(self, if self.is_abrupt() { 2 * SUBSTEPS } else { SUBSTEPS });
        let terms: Vec<Term> = self.planted.iter().map(|p| p.term).collect();
        let reading = scene.output(&terms, self.noise);
        let force = scene.has_input().then(|| scene.input_at_samples());
        let at = |n: usize| self.environment_at(n as f64 / self.rate_hz);
        let temperature = self.has_environment().then(|| (0..self.samples).map(|n| 25.0 + DEGREES * at(n)).collect());
        Columns { force, reading, temperature }
    }

    /// Scales of the motion without any effect.
    pub fn measure_scales(&self) -> Scales {
        let scene = Scene::new(self, SUBSTEPS / 2);
        let motion = scene.motion(&[]);
        let record = &motion.signal[scene.lead * scene.substeps..];
        let input = scene.input_at_samples();
        let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt();
        Scales {
            x: rms(record),
            peak: record.iter().fold(0.0, |m, x| m.max(x.abs())),
            v: motion.velocity_rms,
            u: rms(&input).max(f64::MIN_POSITIVE),
            duration_s: self.samples as f64 / self.rate_hz,
            omega_rad_s: self.omega_rad_s,
            damping_rad_s: 2.0 * self.zeta * self.omega_rad_s,
            gain: self.gain,
        }
    }
}

impl Driven {
    /// Returns whether the nth effect does anything next to the others: a stop that they keep the
    /// mass from reaching does not. By the most that anyone could see of it, who knew all else: the
    /// log-likelihood that its change of the reading gives.
    pub fn acts(&self, nth: usize) -> bool {
        let scene = Scene::coarse(self);
        let mut terms: Vec<Term> = self.planted.iter().map(|p| p.term).collect();
        let with = scene.output(&terms, 0.0);
        terms.remove(nth);
        let change: f64 = with.iter().zip(scene.output(&terms, 0.0)).map(|(a, b)| (a - b).powi(2)).sum();
        0.5 * change / self.noise.powi(2) > LEAST_LOG_LIKELIHOOD
    }

    /// Visible size of the nth effect over the noise that it must be seen in: the readout's, and
    /// that of any planted effect that is itself noise.
    pub fn over_noise(&self, nth: usize) -> f64 {
        let others = self.planted.iter().enumerate().filter(|(n, p)| *n != nth && p.term.physics.is_noise());
        let noise = (self.noise / self.output_rms).powi(2) + others.map(|(_, p)| p.visible.powi(2)).sum::<f64>();
        self.planted[nth].visible / noise.sqrt()
    }
}

impl<'a> Scene<'a> {
    /// Tabulates the inputs of a case.
    pub(super) fn new(case: &'a Driven, substeps: usize) -> Self {
        let lead = match case.excitation {
            Excitation::None | Excitation::Recorded { .. } => 0,
            _ => RUN_IN,
        };
        let half_step_s = 0.5 / (case.rate_hz * substeps as f64);
        let start_s = -(lead as f64) / case.rate_hz;
        let count = 2 * substeps * (lead + case.samples - 1) + 1;
        let input = case.excitation.tabulate(start_s, half_step_s, count);
        let environment = if case.has_environment() {
            (0..count).map(|k| case.environment_at(start_s + k as f64 * half_step_s)).collect()
        } else {
            Vec::new()
        };
        Self { case, lead, substeps, input, environment }
    }

    pub(super) fn coarse(case: &'a Driven) -> Self {
        Self::new(case, if case.is_abrupt() { SUBSTEPS } else { SUBSTEPS / 2 })
    }

    fn has_input(&self) -> bool {
        self.case.excitation != Excitation::None
    }

    fn input_at_samples(&self) -> Vec<f64> {
        let stride = 2 * self.substeps;
        self.input.iter().skip(self.lead * stride).step_by(stride).copied().collect()
    }

    fn motion(&self, terms: &[Term]) -> proof_mass::MechanicalSignal {
        let c = self.case;
        let clock = Clock {
            input: &self.input,
            step_s: 1.0 / (c.rate_hz * self.substeps as f64),
            start_s: -(self.lead as f64) / c.rate_hz,
            environment: &self.environment,
        };
        let oscillator = Oscillator { omega_rad_s: c.omega_rad_s, zeta: c.zeta, gain: c.gain, start: c.start };
        proof_mass::integrate(oscillator, terms, c.scales, &clock, c.seed)
    }

    /// The output column with these effects and this noise.
    pub(super) fn output(&self, terms: &[Term], noise: f64) -> Vec<f64> {
        let motion = self.motion(terms);
        let input = self.input_at_samples();
        let tap = Tap {
            signal: &motion.signal,
            lead: self.lead * self.substeps,
            substeps: self.substeps,
            rate_hz: self.case.rate_hz,
            input: &input,
        };
        let noise = Noise { deviation: noise, seed: self.case.seed };
        readout::read(&tap, terms, &self.case.scales, self.case.offset, noise)
    }

    /// Visible and raw size of one effect, relative to the rms output; infinite where the motion
    /// diverges.
    pub(super) fn size_of(&self, term: Term, undisturbed: &[f64]) -> [f64; 2] {
        let output = self.output(&[term], 0.0);
        if output.iter().any(|y| !y.is_finite()) {
            return [f64::INFINITY; 2];
        }
        let input = if self.has_input() { &self.input[2 * self.substeps * self.lead..] } else { &[] };
        let window = refit::Window { input, output: &output, substeps: self.substeps, rate_hz: self.case.rate_hz };
        let visible =
            refit::refine(&window, self.case.omega_rad_s, self.case.zeta, 6).map_or(f64::INFINITY, |f| f.rms());
        let change: f64 = output.iter().zip(undisturbed).map(|(a, b)| (a - b).powi(2)).sum();
        [visible, (change / output.len() as f64).sqrt()].map(|size| size / self.case.output_rms)
    }
}
