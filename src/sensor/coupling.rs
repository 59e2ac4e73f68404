//! The keys of study.toml by which a reading takes from another axis or instrument: a gyro's scale factor, misalignments and
//! g-sensitivity. Along one axis the last two are sensor terms of their own, in the same slots.

use crate::units::key::Key;
use crate::units::key::Sign::Any;
use crate::units::{DEGREE_PER_HOUR, PPM, STANDARD_GRAVITY_M_S2};

const MILLI: f64 = 1e-3;

/// Reading of a gyro per rate about its own axis.
pub(crate) const GYRO_SCALE_FACTOR: Key =
    Key::new(40, "gyro.scale_factor_ppm", "gyro scale-factor error", "ppm", PPM, Any);
/// Reading of a gyro per rate about each other axis: six numbers, drawn apart.
pub(crate) const GYRO_MISALIGNMENT: Key =
    Key::new(41, "gyro.misalignment_mrad", "gyro misalignment", "mrad", MILLI, Any);
/// Reading of a gyro per specific force along each axis: nine numbers, drawn apart.
pub(crate) const G_SENSITIVITY: Key =
    Key::new(42, "gyro.g_sensitivity_deg_h_g", "g-sensitivity", "°/h/g", DEGREE_PER_HOUR / STANDARD_GRAVITY_M_S2, Any);
/// Reading of an accelerometer per force along other axes: body axes are the accelerometer's, its x axis exact and y in its
/// x–y plane, so three numbers (y from x, z from x and y), drawn apart.
pub(crate) const ACCELEROMETER_MISALIGNMENT: Key =
    Key::new(43, "accelerometer.misalignment_mrad", "accelerometer misalignment", "mrad", MILLI, Any);

/// All of them, in the order of a sensor table.
pub(crate) const KEYS: [&Key; 4] =
    [&ACCELEROMETER_MISALIGNMENT, &GYRO_SCALE_FACTOR, &GYRO_MISALIGNMENT, &G_SENSITIVITY];

/// Those that mean something only where there are other axes, or a turn.
pub(crate) const BETWEEN_AXES: [&Key; 2] = [&GYRO_SCALE_FACTOR, &GYRO_MISALIGNMENT];
