//! Forces that a base model may lack: to the letter of a statement in the library, near to it, or
//! foreign.
//!
//! Internal units: time in seconds, displacement of about one. A force is per unit mass and stands
//! on the left-hand side.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// States how something slow goes with time, about one in size; T is the length of the recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "course")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Course {
    /// t/T.
    Linear,
    /// (t/T)^p.
    Power { p: f64 },
    /// 1 − e^(−t/τ), τ as a part of T.
    Settling { part: f64 },
    /// Sine of some periods over the recording.
    Sine { periods: f64, phase: f64 },
}

impl Course {
    /// Value at a part of the recording.
    pub fn at(&self, part: f64) -> f64 {
        let part = part.max(0.0);
        match *self {
            Self::Linear => part,
            Self::Power { p } => part.powf(p),
            Self::Settling { part: tau } => 1.0 - (-part / tau).exp(),
            Self::Sine { periods, phase } => (TAU * periods * part + phase).sin(),
        }
    }
}

/// One force. `size` is the number that is scaled to make the effect visible.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "law")]
#[expect(missing_docs, reason = "the line of a variant says what its fields are")]
pub enum Law {
    /// size·|x|^p·sgn x.
    OddSpring { size: f64, p: f64 },
    /// size·x².
    EvenSpring { size: f64 },
    /// ω₀²(sin(a x)/a − x), a² = size: a pendulum.
    Sine { size: f64 },
    /// size·|v|^p·sgn v.
    Drag { size: f64, p: f64 },
    /// size·x²·v.
    Squeeze { size: f64 },
    /// size·sgn v with sticking; `lean` makes it (1 + lean) forwards and (1 − lean) backwards.
    Friction { size: f64, lean: f64 },
    /// size·tanh(v/v_s).
    SmoothFriction { size: f64, v_s: f64 },
    /// size·(1 + rise·e^(−(v/v_s)²))·tanh(v/v_t).
    Stribeck { size: f64, rise: f64, v_s: f64, v_t: f64 },
    /// size·z, z′ = v − (b|v||z|^(n−1)z + g v|z|^n).
    BoucWen { size: f64, b: f64, g: f64, n: f64 },
    /// size·c(t)·ω₀²·x.
    SpringDrift { size: f64, course: Course },
    /// size·θ(t)·ω₀²·x with θ the environment's departure from its mean.
    SpringEnvironment { size: f64 },
    /// Mass 1 + size·c(t).
    MassDrift { size: f64, course: Course },
    /// Second mass: μ = size, own ω and ζ.
    Absorber { size: f64, omega: f64, zeta: f64 },
    /// Second resonance next to: z″ + 2ζωz′ + ω²z = size·u, read with x.
    Beside { size: f64, omega: f64, zeta: f64 },
    /// size·(x − gap)₊^p, `both` mirrored, `sign` −1 on the other side.
    Stop { size: f64, gap: f64, p: f64, both: bool, sign: f64 },
    /// −g·size·u²: the force is u + size·u².
    DriveSquare { size: f64 },
    /// The force is u without its part within ±size·rms.
    DriveDead { size: f64 },
    /// The force follows u through play of ±size: a gear.
    DrivePlay { size: f64 },
    /// size·ω₀²·x·cos 2πft.
    Parametric { size: f64, hz: f64 },
    /// size·D^α x by a ladder of relaxations around the resonance.
    Fractional { size: f64, alpha: f64 },
    /// size·ω₀²·x(t − delay).
    Feedback { size: f64, delay: f64 },
    /// Unmeasured force: white, two-sided intensity `size` per second, held over a fine grid.
    WhiteForce { size: f64 },
    /// Unmeasured force ±size that switches at random times, `dwell` seconds apart in the mean.
    Telegraph { size: f64, dwell: f64 },
    /// Unmeasured force: noise in a band, rms size.
    Foreign { size: f64, from_hz: f64, to_hz: f64 },
}

/// Relaxations of the fractional ladder.
const LADDER: usize = 6;

impl Law {
    /// The number to scale.
    pub fn size_mut(&mut self) -> &mut f64 {
        match self {
            Self::OddSpring { size, .. }
            | Self::EvenSpring { size }
            | Self::Sine { size }
            | Self::Drag { size, .. }
            | Self::Squeeze { size }
            | Self::Friction { size, .. }
            | Self::SmoothFriction { size, .. }
            | Self::Stribeck { size, .. }
            | Self::BoucWen { size, .. }
            | Self::SpringDrift { size, .. }
            | Self::SpringEnvironment { size }
            | Self::MassDrift { size, .. }
            | Self::Absorber { size, .. }
            | Self::Beside { size, .. }
            | Self::Stop { size, .. }
            | Self::DriveSquare { size }
            | Self::DriveDead { size }
            | Self::DrivePlay { size }
            | Self::Parametric { size, .. }
            | Self::Fractional { size, .. }
            | Self::Feedback { size, .. }
            | Self::WhiteForce { size }
            | Self::Telegraph { size, .. }
            | Self::Foreign { size, .. } => size,
        }
    }

    /// States of its own next to x and v.
    pub fn states(&self) -> usize {
        match self {
            Self::BoucWen { .. } => 1,
            Self::Absorber { .. } | Self::Beside { .. } => 2,
            Self::Fractional { .. } => LADDER,
            _ => 0,
        }
    }

    /// Force on the left-hand side by a law of x and v alone; the laws with states or a drive are
    /// the oscillator's.
    pub fn plain(&self, x: f64, v: f64, omega: f64) -> f64 {
        match *self {
            Self::OddSpring { size, p } => size * x.abs().powf(p) * x.signum(),
            Self::EvenSpring { size } => size * x * x,
            Self::Sine { size } => {
                let a = size.sqrt();
                omega * omega * ((a * x).sin() / a - x)
            }
            Self::Drag { size, p } => size * v.abs().powf(p) * v.signum(),
            Self::Squeeze { size } => size * x * x * v,
            Self::SmoothFriction { size, v_s } => size * (v / v_s).tanh(),
            Self::Stribeck { size, rise, v_s, v_t } => {
                size * (1.0 + rise * (-(v / v_s).powi(2)).exp()) * (v / v_t).tanh()
            }
            Self::Stop { size, gap, p, both, sign } => {
                let one = |x: f64| if x > gap { size * (x - gap).powf(p) } else { 0.0 };
                sign * one(sign * x) - if both { sign * one(-sign * x) } else { 0.0 }
            }
            _ => 0.0,
        }
    }

    /// Rates of the law's own states from velocity, for those that only follow the motion.
    pub fn inner(&self, x: f64, v: f64, own: &[f64], omega: f64, rates: &mut [f64]) {
        match *self {
            Self::BoucWen { b, g, n, .. } => {
                let z = own[0];
                rates[0] = v - (b * v.abs() * z.abs().powf(n - 1.0) * z + g * v * z.abs().powf(n));
            }
            Self::Absorber { omega: w, zeta, .. } => {
                rates[0] = own[1];
                rates[1] = -2.0 * zeta * w * (own[1] - v) - w * w * (own[0] - x);
            }
            Self::Fractional { .. } => {
                for k in 0..LADDER {
                    rates[k] = v - ladder_rate(k, omega) * own[k];
                }
            }
            _ => {}
        }
    }

    /// Force by the law's own states.
    pub fn from_states(&self, x: f64, v: f64, own: &[f64], omega: f64) -> f64 {
        match *self {
            Self::BoucWen { size, .. } => size * own[0],
            Self::Absorber { size, omega: w, zeta } => -size * (w * w * (own[0] - x) + 2.0 * zeta * w * (own[1] - v)),
            Self::Fractional { size, alpha } => {
                // Weights of D^α: relaxation rates r spaced geometrically, weight r^α (diffusive
                // representation).
                let sum: f64 = (0..LADDER).map(|k| (ladder_rate(k, omega) / omega).powf(alpha) * own[k]).sum();
                size * omega * omega * sum
            }
            _ => 0.0,
        }
    }
}

/// Rate of the k-th relaxation: from a hundredth of ω₀ to a hundred times.
fn ladder_rate(k: usize, omega: f64) -> f64 {
    omega * 10f64.powf(-2.0 + 4.0 * k as f64 / (LADDER - 1) as f64)
}
