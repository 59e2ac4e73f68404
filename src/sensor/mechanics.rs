//! The keys of study.toml that describe the proof mass: its modes, or the paper's m, D₀, k and ε, and further terms.

use std::f64::consts::TAU;

use crate::units::key::Key;
use crate::units::key::Sign::{Any, NotNegative, Positive};
use crate::units::{DENSITY_TO_RANDOM_WALK, MICRO_G};

/// Undamped natural frequency.
pub const RESONANCE: Key = Key::new(0, "sensor.resonance_hz", "resonance", "Hz", TAU, Positive);
/// Damping ratio ζ.
pub const DAMPING_RATIO: Key = Key::new(1, "sensor.damping_ratio", "damping ratio ζ", "1", 1.0, NotNegative);
/// Cubic stiffness β.
pub const CUBIC_STIFFNESS: Key =
    Key::new(2, "sensor.cubic_stiffness_per_m2_s2", "cubic stiffness β", "1/(m² s²)", 1.0, Any);
/// Quadratic stiffness α.
pub const QUADRATIC_STIFFNESS: Key =
    Key::new(3, "sensor.quadratic_stiffness_per_m_s2", "quadratic stiffness α", "1/(m s²)", 1.0, Any);
/// Quadratic damping c₂.
pub const QUADRATIC_DAMPING: Key =
    Key::new(4, "sensor.quadratic_damping_per_m", "quadratic damping c₂", "1/m", 1.0, NotNegative);
/// Squeeze-film damping c₃.
pub const SQUEEZE_FILM: Key =
    Key::new(5, "sensor.squeeze_film_per_m2_s", "squeeze-film damping", "1/(m² s)", 1.0, NotNegative);
/// Coulomb friction f_c.
pub const COULOMB_FRICTION: Key =
    Key::new(6, "sensor.coulomb_friction_m_s2", "Coulomb friction", "m/s²", 1.0, NotNegative);
/// Brownian force noise.
pub const FORCE_NOISE: Key = Key::new(
    7,
    "sensor.force_noise_density_ug_rthz",
    "force noise density (one-sided)",
    "µg/√Hz",
    MICRO_G * DENSITY_TO_RANDOM_WALK,
    NotNegative,
)
.one_sided();
/// m.
pub const MASS: Key = Key::new(8, "sensor.mass_kg", "proof mass m", "kg", 1.0, Positive);
/// D₀.
pub const DAMPING: Key = Key::new(9, "sensor.damping_n_s_m", "damping D₀", "N s/m", 1.0, NotNegative);
/// k.
pub const STIFFNESS: Key = Key::new(10, "sensor.stiffness_n_m", "stiffness k", "N/m", 1.0, Positive);
/// ε.
pub const CUBIC_SPRING: Key = Key::new(11, "sensor.cubic_stiffness_n_m3", "cubic stiffness ε", "N/m³", 1.0, Any);

/// One way to describe the linear mass and its cubic spring.
pub const MODAL: &[Key] = &[RESONANCE, DAMPING_RATIO, CUBIC_STIFFNESS];
/// The other way.
pub const PHYSICAL: &[Key] = &[MASS, DAMPING, STIFFNESS, CUBIC_SPRING];
/// What stands beside either.
pub const FURTHER: &[Key] = &[QUADRATIC_STIFFNESS, QUADRATIC_DAMPING, SQUEEZE_FILM, COULOMB_FRICTION, FORCE_NOISE];
/// All of them, in the order of a sensor table.
pub const KEYS: [&[Key]; 3] = [MODAL, FURTHER, PHYSICAL];
