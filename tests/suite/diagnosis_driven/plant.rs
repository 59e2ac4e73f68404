//! Recordings with known physics, made without any code of the fit: a sum of sines known in closed form at every instant,
//! forty plain Runge–Kutta steps per sample, effects written out as in a textbook.

use std::f64::consts::TAU;

use proofmass::rng::{Philox, Stream};
use rand_distr::{Distribution, StandardNormal, Uniform};

/// Integration steps per sample.
const STEPS: usize = 40;

/// What is planted; each with one strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effect {
    Nothing,
    Cubic,
    Quadratic,
    QuadraticDamping,
    SqueezeFilm,
    Coulomb,
    Hysteresis,
    StiffnessDrift,
    ParasiticMode,
    DriveSquare,
    EndStop,
    ForceNoise,
    Saturation,
    Quantisation,
    Delay,
    Lowpass,
    ReadoutPolynomial,
    Feedthrough,
    Ramp,
    WarmUp,
    Walk,
    Pickup,
    /// Not in the library: a damper with a memory of many time constants (fractional order).
    FractionalDamper,
    /// Not in the library: the spring loses stiffness for good whenever a new largest excursion is reached.
    SofteningAfterExcursion,
    /// Not in the library: the gain of the drive falls with the mean square of the velocity, with a slow memory.
    HeatedDrive,
}

impl Effect {
    /// The library's word for it; `None` where it has none.
    pub fn id(self) -> Option<&'static str> {
        Some(match self {
            Effect::Cubic => "cubic-stiffness",
            Effect::Quadratic => "quadratic-stiffness",
            Effect::QuadraticDamping => "quadratic-damping",
            Effect::SqueezeFilm => "squeeze-film-damping",
            Effect::Coulomb => "coulomb-friction",
            Effect::Hysteresis => "hysteresis",
            Effect::StiffnessDrift => "stiffness-drift",
            Effect::ParasiticMode => "parasitic-mode",
            Effect::DriveSquare => "drive-nonlinearity",
            Effect::EndStop => "end-stop",
            Effect::ForceNoise => "force-noise",
            Effect::Saturation => "readout-saturation",
            Effect::Quantisation => "readout-quantisation",
            Effect::Delay => "readout-delay",
            Effect::Lowpass => "readout-lowpass",
            Effect::ReadoutPolynomial => "readout-nonlinearity",
            Effect::Feedthrough => "feedthrough",
            Effect::Ramp => "bias-drift",
            Effect::WarmUp => "warm-up",
            Effect::Walk => "bias-random-walk",
            Effect::Pickup => "periodic-disturbance",
            _ => return None,
        })
    }

    /// Everything that the library can name.
    pub fn library() -> Vec<Effect> {
        use Effect::*;
        vec![
            Cubic,
            Quadratic,
            QuadraticDamping,
            SqueezeFilm,
            Coulomb,
            Hysteresis,
            StiffnessDrift,
            ParasiticMode,
            DriveSquare,
            EndStop,
            ForceNoise,
            Saturation,
            Quantisation,
            Delay,
            Lowpass,
            ReadoutPolynomial,
            Feedthrough,
            Ramp,
            WarmUp,
            Walk,
            Pickup,
        ]
    }
}

/// A recording to be made.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    pub effect: Effect,
    /// Root-mean-square change of the output that the effect makes, relative to the output.
    pub share: f64,
    pub samples: usize,
    pub rate_hz: f64,
    pub resonance_hz: f64,
    pub zeta: f64,
    /// White readout noise, relative to the output.
    pub noise: f64,
    pub seed: u64,
    /// Whether an input drives it; otherwise it rings down.
    pub driven: bool,
}

/// Input and reading.
pub struct Planted {
    pub input: Vec<f64>,
    pub reading: Vec<f64>,
    /// The strength that gave the share asked for, in the effect's own parameter.
    pub strength: f64,
}

/// Makes it.
pub fn plant(plan: &Plan) -> Planted {
    let lines = lines(plan);
    let plain = simulate(plan, &lines, 0.0);
    let size = rms(&plain);
    let mut strength = if plan.effect == Effect::Nothing { 0.0 } else { guess(plan, size) };
    if plan.effect != Effect::Nothing {
        for _ in 0..12 {
            let changed = simulate(plan, &lines, strength);
            let change = rms(&changed.iter().zip(&plain).map(|(a, b)| a - b).collect::<Vec<_>>()) / size;
            let wrong = (plan.share / change.max(1e-12)).clamp(0.2, 5.0);
            strength = match plan.effect {
                // A stop or rail farther away does less.
                Effect::Saturation | Effect::EndStop => strength * wrong.clamp(0.5, 2.0).powf(-0.12),
                _ => strength * wrong,
            };
            if (wrong - 1.0).abs() < 0.02 {
                break;
            }
        }
    }
    let mut reading = simulate(plan, &lines, strength);
    let noise: Vec<f64> =
        StandardNormal.sample_iter(Philox::new(plan.seed, 1, Stream::Host)).take(plan.samples).collect();
    for (y, e) in reading.iter_mut().zip(&noise) {
        *y += plan.noise * size * e;
    }
    match plan.effect {
        Effect::Saturation => reading.iter_mut().for_each(|y| *y = y.clamp(-strength, strength)),
        Effect::Quantisation => reading.iter_mut().for_each(|y| *y = (*y / strength).round() * strength),
        _ => {}
    }
    let input = (0..plan.samples).map(|k| force(&lines, k as f64 / plan.rate_hz)).collect();
    Planted { input, reading, strength }
}

struct Line {
    amplitude: f64,
    omega: f64,
    phase: f64,
}

fn lines(plan: &Plan) -> Vec<Line> {
    if !plan.driven {
        return Vec::new();
    }
    let phases: Vec<f64> = match Uniform::new(0.0, TAU) {
        Ok(uniform) => uniform.sample_iter(Philox::new(plan.seed, 2, Stream::Excitation)).take(400).collect(),
        Err(_) => Vec::new(),
    };
    // Spaced unevenly so that the record is not periodic; from a tenth of the resonance to 2.5 times it, below 0.4 rate.
    let (low, high) = (0.1 * plan.resonance_hz, (2.5 * plan.resonance_hz).min(0.4 * plan.rate_hz));
    phases
        .chunks_exact(2)
        .enumerate()
        .map(|(i, p)| Line {
            amplitude: 0.1,
            omega: TAU * (low + (high - low) * (i as f64 + p[1] / TAU) / 200.0),
            phase: p[0],
        })
        .collect()
}

fn force(lines: &[Line], t: f64) -> f64 {
    lines.iter().map(|l| l.amplitude * (l.omega * t + l.phase).sin()).sum()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// A strength to begin the search for the share with.
fn guess(plan: &Plan, size: f64) -> f64 {
    let omega = TAU * plan.resonance_hz;
    let share = plan.share;
    match plan.effect {
        Effect::Cubic | Effect::Quadratic => share * omega * omega / size.powi(2) * plan.zeta,
        Effect::Saturation | Effect::EndStop => 2.0 * size,
        Effect::SofteningAfterExcursion | Effect::HeatedDrive => 0.1 * share * plan.zeta,
        Effect::Quantisation => share * size * 12f64.sqrt(),
        Effect::Delay | Effect::Lowpass => share / omega,
        Effect::StiffnessDrift => share * plan.zeta,
        Effect::Coulomb => share * plan.zeta * omega * omega * size,
        _ => share * size,
    }
}

/// Readings without readout noise (rails and rounding included, for the size of the change).
fn simulate(plan: &Plan, lines: &[Line], strength: f64) -> Vec<f64> {
    use Effect::*;
    let omega = TAU * plan.resonance_hz;
    let omega2 = omega * omega;
    let gain = omega2;
    let h = 1.0 / plan.rate_hz / STEPS as f64;
    let duration = plan.samples as f64 / plan.rate_hz;
    let mut kicks = StandardNormal.sample_iter(Philox::new(plan.seed, 3, Stream::Force));
    let mut walk = 0.0;
    // Displacement, velocity, one or two more states; memory of the fractional damper as five relaxations.
    let mut s = [0.0f64; 8];
    if !plan.driven {
        s[0] = 1.0;
    }
    let (mut largest, mut heat) = (0.0f64, 0.0f64);
    let mut drive = 0.0;
    let mut out = Vec::with_capacity(plan.samples);
    let relaxations = [0.03, 0.1, 0.3, 1.0, 3.0];
    // The step's inputs at its beginning, middle and end, by rotation of phasors (exact, and faster than sines).
    let mut phasors: Vec<(f64, f64)> = lines.iter().map(|l| l.phase.sin_cos()).collect();
    let turns: Vec<(f64, f64)> = lines.iter().map(|l| (0.5 * h * l.omega).sin_cos()).collect();
    let mut advance = || {
        let mut sum = 0.0;
        for ((p, t), l) in phasors.iter_mut().zip(&turns).zip(lines) {
            *p = (p.0 * t.1 + p.1 * t.0, p.1 * t.1 - p.0 * t.0);
            sum += l.amplitude * p.0;
        }
        sum
    };
    let mut u_now = force(lines, 0.0);
    for k in 0..plan.samples {
        let t = k as f64 / plan.rate_hz;
        let x = s[0];
        out.push(match plan.effect {
            Saturation if strength > 0.0 => x.clamp(-strength, strength),
            Quantisation if strength > 0.0 => (x / strength).round() * strength,
            Delay => x,
            Lowpass if strength > 0.0 => s[2],
            ReadoutPolynomial => x + 0.5 * strength * x * x + strength * x * x * x,
            Feedthrough => x + strength * u_now,
            Ramp => x + strength * (t / duration - 0.5),
            WarmUp => x + strength * (-t / (0.15 * duration)).exp(),
            Walk => x + walk,
            Pickup => x + strength * (TAU * 0.137 * plan.rate_hz * t + 1.0).sin(),
            ParasiticMode => x + s[2],
            _ => x,
        });
        if plan.effect == Walk {
            walk += strength * kicks.next().unwrap_or(0.0) / (plan.samples as f64).sqrt();
        }
        for _ in 0..STEPS {
            let u = [u_now, advance(), advance()];
            u_now = u[2];
            if plan.effect == ForceNoise {
                drive = strength * kicks.next().unwrap_or(0.0) * omega2 * (plan.zeta / (omega * h)).sqrt();
            }
            let time = t;
            let softness =
                if plan.effect == SofteningAfterExcursion { 1.0 - strength * largest.min(10.0) } else { 1.0 };
            let hot = if plan.effect == HeatedDrive { 1.0 - strength * heat } else { 1.0 };
            let rates = |s: &[f64; 8], u: f64| -> [f64; 8] {
                let (x, v) = (s[0], s[1]);
                let mut d = [0.0; 8];
                let mut a = gain * u * hot - 2.0 * plan.zeta * omega * v - omega2 * softness * x + drive;
                match plan.effect {
                    Cubic => a -= strength * x * x * x,
                    Quadratic => a -= strength * x * x,
                    QuadraticDamping => a -= strength * v.abs() * v,
                    SqueezeFilm => a -= strength * omega * x * x * v,
                    Coulomb => a -= strength * (v / (1e-4 * omega)).clamp(-1.0, 1.0),
                    Hysteresis => {
                        a -= strength * omega2 * s[2];
                        d[2] = v - (v.abs() * s[2] + v * s[2].abs()) / (2.0 * 0.5);
                    }
                    StiffnessDrift => a -= omega2 * strength * (time / duration - 0.5) * x,
                    DriveSquare => a += gain * strength * u * u,
                    EndStop if strength > 0.0 => {
                        a -= 20.0 * omega2 * ((x - strength).max(0.0) - (-x - strength).max(0.0));
                    }
                    Lowpass if strength > 0.0 => d[2] = (x - s[2]) / strength,
                    ParasiticMode => {
                        let second = 2.3 * omega;
                        d[2] = s[3];
                        d[3] = strength * second * second * u - 2.0 * 0.05 * second * s[3] - second * second * s[2];
                    }
                    FractionalDamper => {
                        for (i, tau) in relaxations.iter().enumerate() {
                            d[2 + i] = (x - s[2 + i]) / (tau / omega);
                            a -= strength * omega2 * (x - s[2 + i]);
                        }
                    }
                    _ => {}
                }
                d[0] = v;
                d[1] = a;
                d
            };
            let plus = |s: &[f64; 8], d: &[f64; 8], w: f64| std::array::from_fn(|i| s[i] + w * d[i]);
            let k1 = rates(&s, u[0]);
            let k2 = rates(&plus(&s, &k1, 0.5 * h), u[1]);
            let k3 = rates(&plus(&s, &k2, 0.5 * h), u[1]);
            let k4 = rates(&plus(&s, &k3, h), u[2]);
            s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
            largest = largest.max(s[0].abs());
            heat += h * (20.0 / duration) * ((s[1] / omega).powi(2) - heat);
        }
    }
    if plan.effect == Delay && strength > 0.0 {
        return delayed(plan, lines, strength);
    }
    out
}

/// A delayed reading is the reading of a system whose input comes later.
fn delayed(plan: &Plan, lines: &[Line], delay_s: f64) -> Vec<f64> {
    let later: Vec<Line> = lines
        .iter()
        .map(|l| Line { amplitude: l.amplitude, omega: l.omega, phase: l.phase - l.omega * delay_s })
        .collect();
    simulate(&Plan { effect: Effect::Nothing, ..*plan }, &later, 0.0)
}
