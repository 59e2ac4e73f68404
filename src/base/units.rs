//! Datasheet units to SI and back. Every constant is a factor: `si = datasheet × FACTOR`.
//!
//! Inside the crate everything is SI (m, s, rad, m/s²) and f64 until a kernel chooses otherwise.

pub mod key;
pub mod number;

/// Standard gravity, m/s² (CGPM 1901, exact by convention): the "g" of datasheets.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;
/// A thousandth of standard gravity, m/s².
pub const MILLI_G: f64 = 1e-3 * STANDARD_GRAVITY_M_S2;
/// µg → m/s²; also µg/√Hz → (m/s²)/√Hz.
pub const MICRO_G: f64 = 1e-6 * STANDARD_GRAVITY_M_S2;
/// A millionth.
pub const PPM: f64 = 1e-6;
/// A degree, rad.
pub const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// A degree an hour, rad/s.
pub const DEGREE_PER_HOUR: f64 = DEGREE / 3600.0;
/// A degree a root hour, rad/√s.
pub const DEGREE_PER_ROOT_HOUR: f64 = DEGREE / 60.0;
/// A degree an hour a root hour, rad/s/√s.
pub const DEGREE_PER_HOUR_PER_ROOT_HOUR: f64 = DEGREE / (3600.0 * 60.0);
/// One-sided noise density n (unit/√Hz) → random-walk coefficient N (unit·√s), two-sided: N = n/√2
/// (IEEE 952).
pub const DENSITY_TO_RANDOM_WALK: f64 = std::f64::consts::FRAC_1_SQRT_2;
