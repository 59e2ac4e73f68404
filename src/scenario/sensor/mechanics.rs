//! The keys of study.toml that describe the proof mass: its modes, or the paper's m, D₀, k and ε,
//! and further terms.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use crate::physics::{coefficients, cubic_stiffness};
use crate::units::key::Key;
use crate::units::key::Sign::{Any, NotNegative, Positive};
use crate::units::{DENSITY_TO_RANDOM_WALK, MICRO_G};

/// The resonance frequency.
pub const RESONANCE: Key = Key::new(0, "sensor.resonance_hz", "resonance", "Hz", TAU, Positive);
/// The damping ratio.
pub const DAMPING_RATIO: Key = Key::new(1, "sensor.damping_ratio", "damping ratio ζ", "1", 1.0, NotNegative);
/// Cubic stiffness β per unit mass, 1/(m² s²).
pub const CUBIC_STIFFNESS: Key = cubic_stiffness::GIVEN[0].key;
/// The thermomechanical force noise.
pub const FORCE_NOISE: Key = Key::new(
    7,
    "sensor.force_noise_density_ug_rthz",
    "force noise density (one-sided)",
    "µg/√Hz",
    MICRO_G * DENSITY_TO_RANDOM_WALK,
    NotNegative,
)
.one_sided();
/// The proof mass.
pub const MASS: Key = Key::new(8, "sensor.mass_kg", "proof mass m", "kg", 1.0, Positive);
/// The viscous damping.
pub const DAMPING: Key = Key::new(9, "sensor.damping_n_s_m", "damping D₀", "N s/m", 1.0, NotNegative);
/// The linear spring.
pub const STIFFNESS: Key = Key::new(10, "sensor.stiffness_n_m", "stiffness k", "N/m", 1.0, Positive);
/// The cubic spring.
pub const CUBIC_SPRING: Key = Key::new(11, "sensor.cubic_stiffness_n_m3", "cubic stiffness ε", "N/m³", 1.0, Any);

/// One way to describe the linear mass and its cubic spring.
pub const MODAL: &[Key] = &[RESONANCE, DAMPING_RATIO, CUBIC_STIFFNESS];
/// The keys that state a sensor by the paper's mass, damping and springs.
pub const PHYSICAL: &[Key] = &[MASS, DAMPING, STIFFNESS, CUBIC_SPRING];
/// Returns the keys next to either: the further laws, and the noise of the force.
pub fn further() -> &'static [Key] {
    static FURTHER: LazyLock<Vec<Key>> = LazyLock::new(|| {
        let laws = coefficients::keys().filter(|key| key.slot != CUBIC_STIFFNESS.slot);
        laws.chain([&FORCE_NOISE]).copied().collect()
    });
    &FURTHER
}

/// All of them, in the order of a sensor table.
pub fn keys() -> impl Iterator<Item = &'static Key> {
    MODAL.iter().chain(further()).chain(PHYSICAL)
}
