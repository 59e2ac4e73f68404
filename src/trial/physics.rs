//! States what can be planted in a driven recording: the library's effects and physics that no
//! candidate describes.
//!
//! A term has one dimensionless amplitude, calibrated to a visible size, and a shape drawn
//! beforehand. The amplitude is made physical by the scales of the undisturbed motion (rms
//! displacement σ, velocity σv, input σu, stiffness k = ω₀², damping c = 2ζω₀, duration T):
//!
//! | effect | physical value | shape |
//! |---|---|---|
//! | cubic, quadratic stiffness | β = ±a k/σ², α = ±a k/σ | sign |
//! | quadratic, squeeze-film damping | a c/σv, a c/σ² | |
//! | Coulomb friction | a c σv, (1 ± lean) times it forwards and backwards | lean |
//! | hysteresis (Bouc–Wen, n = 1) | stiffness a k | yield/σ, share of β in β + γ |
//! | stiffness drift | k(1 ± a t/T), or k(1 ± a × environment) | sign, 1 for the column |
//! | parasitic mode | static gain a of the first's, with the ratio's sign | ± frequency ratio, damping ratio |
//! | coupled mode | mass a of the proof mass' | frequency ratio, damping ratio |
//! | drive nonlinearity | u ± a u²/σu | sign |
//! | end stop, saturation | at peak/(1 + a) | stiffness/k (stop only), side −1 0 1 |
//! | force noise | rms response a σ | |
//! | quantisation, periodic, warm-up, ramp, walk | a σ (step, amplitude, amplitude, end value, end deviation) | see `parameters` |
//! | delay, low-pass | a/ω₀ | |
//! | readout nonlinearity | a s₂/σ, a s₃/σ² | s₂, s₃ |

use serde::{Deserialize, Serialize};

use super::catalogue::catalogue;

catalogue! {
    /// An effect in a driven recording.
    Physics
    library {
        CubicStiffness,
        QuadraticStiffness,
        QuadraticDamping,
        SqueezeFilmDamping,
        CoulombFriction,
        Hysteresis,
        StiffnessDrift,
        ParasiticMode,
        DriveNonlinearity,
        EndStop,
        ForceNoise,
        ReadoutSaturation,
        ReadoutQuantisation,
        ReadoutDelay,
        ReadoutLowpass,
        ReadoutNonlinearity,
        Feedthrough,
        BiasDrift,
        WarmUp,
        BiasRandomWalk,
        PeriodicDisturbance,
    }
    foreign {
        FractionalDamper = "a damper of fractional order, as in rubber",
        SofteningWithHistory = "a spring that softens with the largest excursion it has seen",
        SlippingMount = "a mount that slips above a force and creeps with every slip",
        NegativeDamping = "negative damping near the rest position",
        BacklashSpring = "a spring with a dead zone",
        ParametricPumping = "a stiffness modulated by a clock",
        StiffnessJump = "a stiffness that changes once, suddenly",
        GainControl = "a readout gain that follows the mean amplitude",
        ClockWander = "sampling instants that wander",
        DampingDrift = "a damping that drifts",
    }
    alike {
        CoupledMode = ParasiticMode,
    }
}

use Physics::*;

impl Physics {
    /// Effects that no simulation predicts sample by sample.
    pub fn is_noise(self) -> bool {
        matches!(self, ForceNoise | ReadoutQuantisation | BiasRandomWalk)
    }

    /// Effects with corners or jumps in time, integrated with twice the sub-steps.
    pub fn is_abrupt(self) -> bool {
        matches!(self, CoulombFriction | Hysteresis | EndStop | BacklashSpring | SlippingMount | SofteningWithHistory)
    }
}

/// Scales of the motion before anything is planted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// rms displacement, output unit.
    pub x: f64,
    /// Largest displacement of the linear motion.
    pub peak: f64,
    /// Root-mean-square velocity.
    pub v: f64,
    /// Root-mean-square input.
    pub u: f64,
    /// Length of the recording.
    pub duration_s: f64,
    /// Natural frequency ω₀, rad/s.
    pub omega_rad_s: f64,
    /// Damping 2ζω₀, rad/s.
    pub damping_rad_s: f64,
    /// Output unit per input unit and s².
    pub gain: f64,
}

/// °C by which the environment column moves where it matters.
pub(crate) const DEGREES: f64 = 3.0;

/// An effect as planted: its physics and numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Kind of physics.
    pub physics: Physics,
    /// Dimensionless amplitude; see the module's table.
    pub amplitude: f64,
    /// Shape; see the module's table.
    pub shape: [f64; 2],
}

impl Term {
    /// Physical values by the symbols the library uses (output unit y, input unit u, seconds).
    pub fn parameters(&self, s: &Scales) -> Vec<(&'static str, f64)> {
        let (a, [p, q]) = (self.amplitude, self.shape);
        let k = s.omega_rad_s * s.omega_rad_s;
        let c = s.damping_rad_s;
        match self.physics {
            CubicStiffness => vec![("beta", p * a * k / (s.x * s.x))],
            QuadraticStiffness => vec![("alpha", p * a * k / s.x)],
            QuadraticDamping => vec![("c2", a * c / s.v)],
            SqueezeFilmDamping => vec![("c", a * c / (s.x * s.x))],
            CoulombFriction if p == 0.0 => vec![("f_c", a * c * s.v)],
            CoulombFriction => vec![("f_c", a * c * s.v), ("f_d", p * a * c * s.v)],
            Hysteresis => vec![("k_h", a * k), ("beta", q / (p * s.x)), ("gamma", (1.0 - q) / (p * s.x))],
            StiffnessDrift if q == 0.0 => vec![("kappa", p * a / s.duration_s)],
            StiffnessDrift => vec![("kappa", p * a / DEGREES)],
            ParasiticMode => {
                let omega2 = p.abs() * s.omega_rad_s;
                let g2 = a * p.signum() * p * p * s.gain;
                vec![("g2", g2), ("omega2", omega2), ("zeta2", q)]
            }
            CoupledMode => vec![("mu", a), ("omega2", p * s.omega_rad_s), ("zeta2", q)],
            DriveNonlinearity => vec![("kappa", p * a / s.u)],
            EndStop => vec![("gap", s.peak / (1.0 + a)), ("k_c", p * k)],
            ForceNoise => vec![("rms_displacement", a * s.x)],
            ReadoutSaturation => vec![("level", s.peak / (1.0 + a))],
            ReadoutQuantisation => vec![("step", a * s.x)],
            ReadoutDelay | ReadoutLowpass => vec![("tau", a / s.omega_rad_s)],
            ReadoutNonlinearity => vec![("k2", a * p / s.x), ("k3", a * q / (s.x * s.x))],
            Feedthrough => vec![("d", p * a * s.x / s.u)],
            BiasDrift => vec![("c", p * a * s.x / s.duration_s)],
            WarmUp => vec![("c", q * a * s.x), ("tau", p * s.duration_s)],
            BiasRandomWalk => vec![("K", a * s.x / s.duration_s.sqrt())],
            PeriodicDisturbance => vec![("amplitude", a * s.x), ("frequency", p)],
            _ => vec![("amplitude", a), ("shape", p), ("shape_2", q)],
        }
    }

    /// The first physical value.
    pub fn value(&self, s: &Scales) -> f64 {
        self.parameters(s).first().map_or(0.0, |p| p.1)
    }
}
