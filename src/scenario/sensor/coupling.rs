//! The keys of study.toml by which a reading takes from another axis or instrument, from the
//! temperature or from a late clock: a gyro's scale factor, misalignments and g-sensitivity,
//! temperature coefficients, a time offset and a clock that drifts; and where a gyro's range ends.
//! Along one axis the g-sensitivity and all temperature coefficients except that of the gyro's scale
//! factor are sensor terms of their own, in the same slots.

use crate::units::key::Key;
use crate::units::key::Sign::{Any, NotNegative, Positive};
use crate::units::{DEGREE, DEGREE_PER_HOUR, MICRO_G, PPM, STANDARD_GRAVITY_M_S2};

const MILLI: f64 = 1e-3;
const MICRO: f64 = 1e-6;

/// Reading of a gyro per rate about its own axis.
pub const GYRO_SCALE_FACTOR: Key = Key::new(40, "gyro.scale_factor_ppm", "gyro scale-factor error", "ppm", PPM, Any);
/// Reading of a gyro per rate about each other axis: six numbers, drawn apart.
pub const GYRO_MISALIGNMENT: Key = Key::new(41, "gyro.misalignment_mrad", "gyro misalignment", "mrad", MILLI, Any);
/// Reading of a gyro per specific force along each axis: nine numbers, drawn apart.
pub const G_SENSITIVITY: Key =
    Key::new(42, "gyro.g_sensitivity_deg_h_g", "g-sensitivity", "°/h/g", DEGREE_PER_HOUR / STANDARD_GRAVITY_M_S2, Any);
/// Reading of an accelerometer per force along other axes: body axes are the accelerometer's, its x
/// axis exact and y in its x–y plane, so three numbers (y from x, z from x and y), drawn apart.
pub const ACCELEROMETER_MISALIGNMENT: Key =
    Key::new(43, "accelerometer.misalignment_mrad", "accelerometer misalignment", "mrad", MILLI, Any);

/// Change of an accelerometer's bias per kelvin.
pub const ACCELEROMETER_BIAS_PER_K: Key =
    Key::new(47, "accelerometer.bias_temperature_ug_k", "accelerometer bias over temperature", "µg/K", MICRO_G, Any);
/// Change of its scale factor per kelvin.
pub(crate) const ACCELEROMETER_SCALE_PER_K: Key = Key::new(
    48,
    "accelerometer.scale_temperature_ppm_k",
    "accelerometer scale factor over temperature",
    "ppm/K",
    PPM,
    Any,
);
/// Change of a gyro's bias per kelvin.
pub const GYRO_BIAS_PER_K: Key =
    Key::new(49, "gyro.bias_temperature_deg_h_k", "gyro bias over temperature", "°/h/K", DEGREE_PER_HOUR, Any);
/// Change of its scale factor per kelvin.
pub const GYRO_SCALE_PER_K: Key =
    Key::new(50, "gyro.scale_temperature_ppm_k", "gyro scale factor over temperature", "ppm/K", PPM, Any);
/// Delay of the stamps of all readings: the same for the six of a member.
pub const TIME_OFFSET: Key = Key::new(51, "sensor.time_offset_us", "time offset", "µs", MICRO, Any);

/// Standard deviation of the instant at which each sample of all readings is taken, about the one
/// that it is stamped with.
pub const TIME_JITTER: Key = Key::new(52, "sensor.time_jitter_us", "time jitter", "µs", MICRO, NotNegative);

/// Gain of the clock of all readings on the true time: stamps come later and later.
pub const CLOCK_DRIFT: Key = Key::new(53, "sensor.clock_drift_ppm", "clock drift", "ppm", PPM, Any);

/// Full scale of a gyro: the largest magnitude of a rate that it reads.
pub const GYRO_RANGE: Key = Key::new(70, "gyro.range_deg_s", "gyro range", "°/s", DEGREE, Positive);

/// Couplings of one axis to another one or to the other instrument.
pub const COUPLINGS: [&Key; 4] = [&ACCELEROMETER_MISALIGNMENT, &GYRO_SCALE_FACTOR, &GYRO_MISALIGNMENT, &G_SENSITIVITY];
/// Keys that follow the temperature, accelerometer before gyro and bias before scale factor.
pub const OVER_TEMPERATURE: [&Key; 4] =
    [&ACCELEROMETER_BIAS_PER_K, &ACCELEROMETER_SCALE_PER_K, &GYRO_BIAS_PER_K, &GYRO_SCALE_PER_K];

/// All that act along a trajectory by the motion or the temperature, in the order of a sensor
/// table.
pub const KEYS: [&Key; 12] = [
    &ACCELEROMETER_MISALIGNMENT,
    &GYRO_SCALE_FACTOR,
    &GYRO_MISALIGNMENT,
    &G_SENSITIVITY,
    &ACCELEROMETER_BIAS_PER_K,
    &ACCELEROMETER_SCALE_PER_K,
    &GYRO_BIAS_PER_K,
    &GYRO_SCALE_PER_K,
    &TIME_OFFSET,
    &TIME_JITTER,
    &CLOCK_DRIFT,
    &GYRO_RANGE,
];
/// Errors of the one clock of all axes.
pub const OF_THE_CLOCK: [&Key; 3] = [&TIME_OFFSET, &TIME_JITTER, &CLOCK_DRIFT];

/// Those that mean something only along a trajectory.
pub const IN_MOTION: [&Key; 7] =
    [&TIME_OFFSET, &TIME_JITTER, &CLOCK_DRIFT, &GYRO_SCALE_FACTOR, &GYRO_MISALIGNMENT, &GYRO_SCALE_PER_K, &GYRO_RANGE];
/// Those of them that act on a rate of rotation, which one axis has not.
pub const OF_ROTATION: [&Key; 4] = [&GYRO_SCALE_FACTOR, &GYRO_MISALIGNMENT, &GYRO_SCALE_PER_K, &GYRO_RANGE];
