//! ArduPilot's SITL: uniform noise in ±amplitude at its own sensor rate, above a level that cannot
//! be lowered; no random walk.
//!
//! A uniform number in ±A has σ = A/√3, so that N asks for A = N√(3 rate). `SIM_GYR1_RND` is drawn
//! next to the fixed level (the amplitudes add in squares); `SIM_ACC1_RND` is added to the fixed
//! amplitude, in versions that draw it as noise.

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet};
use proofmass_base::units::DEGREE;

/// Rate of SITL's first IMU, Hz.
const RATE_HZ: f64 = 1000.0;
/// Amplitude of the accelerometer's noise that is always there, m/s².
const ACCELEROMETER_FLOOR_M_S2: f64 = 0.01;
const GYRO_FLOOR_DEG_S: f64 = 0.04;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("ArduPilot, SITL parameters, and AP_InertialSensor_SITL, generate_accel and generate_gyro");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::None));
    sheet.remarks(&a, &g);
    sheet.note("SITL's rate is its own, 1000 Hz, and RND acts with the motors on, at full throttle as written here");
    sheet.note("recent versions use SIM_ACC1_RND only for vibration (SIM_VIB_FREQ): their accelerometer noise is the fixed one");
    let amplitude = |white: f64| white * (3.0 * RATE_HZ).sqrt();
    let (accelerometer, gyro) = (amplitude(imu.accelerometer.white.mean), amplitude(imu.gyro.white.mean) / DEGREE);
    for (name, wanted, floor, unit) in
        [("accelerometer", accelerometer, ACCELEROMETER_FLOOR_M_S2, "m/s^2"), ("gyro", gyro, GYRO_FLOOR_DEG_S, "deg/s")]
    {
        if wanted > 0.0 && wanted < floor {
            sheet.note(&format!(
                "{name}: SITL's fixed noise of {floor} {unit} (uniform) is above this sensor's: its white noise is {:.3} times N",
                floor / wanted
            ));
        }
    }
    let uniform = "per sample at 1000 Hz: the amplitude of uniform noise, sqrt(3) sigma";
    let acceleration = format!("{uniform}; N sqrt(3 rate), less the fixed 0.01");
    let rate = format!("{uniform}; sqrt(3 N^2 rate - 0.04^2), next to the fixed 0.04");
    let gyro_extra = (gyro * gyro - GYRO_FLOOR_DEG_S.powi(2)).max(0.0).sqrt();
    let accelerometer_extra = (accelerometer - ACCELEROMETER_FLOOR_M_S2).max(0.0);
    sheet.field(Field { key: "SIM_ACC1_RND", value: accelerometer_extra, unit: "m/s^2", means: &acceleration });
    sheet.field(Field { key: "SIM_GYR1_RND", value: gyro_extra, unit: "deg/s", means: &rate });
    for (sense, sensor, unit) in [(0, "ACC1", "m/s^2"), (1, "GYR1", "rad/s")] {
        for (number, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            let key = format!("SIM_{sensor}_BIAS_{axis}");
            let value = imu.axis(number)[sense].bias.mean;
            sheet.field(Field { key: &key, value, unit, means: "constant bias, the mean over sensors" });
        }
    }
}
