//! One inertial sensor in SI units: what an accelerometer and its gyro do to the truth.
//!
//! This is a single concrete sensor, after tolerances have been drawn; what may vary is described by `study`.
//! Zero switches a term off (`range_m_s2`: infinity). White levels are two-sided coefficients N as in IEEE 952:
//! N = n/√2 for a one-sided density n, and a white sequence at rate f has σ = N√f.

pub mod source;

/// Which of an IMU's two kinds of sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// Specific force, m/s².
    Accelerometer,
    /// Angular rate, rad/s.
    Gyro,
}

impl Sense {
    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accelerometer => "accelerometer",
            Self::Gyro => "gyro",
        }
    }
}

/// The proof mass: x″ + 2ζω₀x′ + ω₀²x + βx³ = f (paper's eq. 6; eq. 4 is β = 0), with further terms that a diagnosis may
/// have found: + αx² + c₂|x′|x′ + c₃x²x′ + f_c sgn x′.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProofMass {
    /// Undamped natural frequency ω₀.
    pub natural_frequency_rad_s: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// Cubic stiffness β, 1/(m² s²).
    pub cubic_per_m2_s2: f64,
    /// Quadratic stiffness α, 1/(m s²).
    pub quadratic_per_m_s2: f64,
    /// Quadratic damping c₂, 1/m.
    pub quadratic_damping_per_m: f64,
    /// Squeeze-film damping c₃, 1/(m² s).
    pub squeeze_film_per_m2_s: f64,
    /// Coulomb friction f_c, m/s².
    pub coulomb_m_s2: f64,
    /// Random-walk coefficient of Brownian force noise per unit mass, m/s²·√s (two-sided).
    pub force_noise_m_s_rts: f64,
}

impl ProofMass {
    /// Whether there is anything beyond the linear and the cubic spring.
    pub fn has_further_terms(&self) -> bool {
        self.quadratic_per_m_s2 != 0.0
            || self.quadratic_damping_per_m != 0.0
            || self.squeeze_film_per_m2_s != 0.0
            || self.coulomb_m_s2 != 0.0
    }
}

/// The accelerometer's reading errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accelerometer {
    /// Constant bias, m/s².
    pub bias_m_s2: f64,
    /// Scale-factor error, 1.
    pub scale_factor: f64,
    /// Second-order nonlinearity K₂, 1/(m/s²).
    pub k2_per_m_s2: f64,
    /// Velocity random walk N, m/s/√s.
    pub velocity_random_walk_m_s_rts: f64,
    /// Bias instability B (minimum Allan deviation / 0.664), m/s².
    pub bias_instability_m_s2: f64,
    /// Acceleration random walk K, m/s²/√s.
    pub acceleration_random_walk_m_s2_rts: f64,
    /// Quantisation step of the reading, m/s².
    pub quantisation_m_s2: f64,
    /// Full scale, m/s².
    pub range_m_s2: f64,
}

/// Without any error.
impl Default for Accelerometer {
    fn default() -> Self {
        Self {
            bias_m_s2: 0.0,
            scale_factor: 0.0,
            k2_per_m_s2: 0.0,
            velocity_random_walk_m_s_rts: 0.0,
            bias_instability_m_s2: 0.0,
            acceleration_random_walk_m_s2_rts: 0.0,
            quantisation_m_s2: 0.0,
            range_m_s2: f64::INFINITY,
        }
    }
}

/// The gyro's errors; its integral is tilt, which through gravity becomes a horizontal acceleration error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gyro {
    /// Constant bias, rad/s.
    pub bias_rad_s: f64,
    /// Angle random walk N, rad/√s.
    pub angle_random_walk_rad_rts: f64,
    /// Bias instability B, rad/s.
    pub bias_instability_rad_s: f64,
    /// Rate random walk K, rad/s/√s.
    pub rate_random_walk_rad_s_rts: f64,
}

/// One member of an ensemble: a sensor and how strongly it is excited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Mechanics; `None` is an ideal proof mass (x follows f at once).
    pub proof_mass: Option<ProofMass>,
    /// Reading errors.
    pub accelerometer: Accelerometer,
    /// Tilt errors.
    pub gyro: Gyro,
    /// Factor on the study's shared excitation.
    pub excitation_gain: f64,
}

/// Without any error, excited as the study says.
impl Default for Sensor {
    fn default() -> Self {
        Self { proof_mass: None, accelerometer: Accelerometer::default(), gyro: Gyro::default(), excitation_gain: 1.0 }
    }
}
