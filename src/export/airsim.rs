//! AirSim's settings.json: N for white noise, and a bias that walks by stability/√τ (class
//! ImuSimple).

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet};
use proofmass_base::units::{DEGREE_PER_HOUR, DEGREE_PER_ROOT_HOUR, MICRO_G, MILLI_G};

/// The times that AirSim itself starts from, s: gyro, accelerometer.
const TAU_S: [f64; 2] = [500.0, 800.0];

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    for (indent, line) in [
        (0, "{"),
        (2, "\"SettingsVersion\": 1.2,"),
        (2, "\"SimMode\": \"Multirotor\","),
        (2, "\"Vehicles\": {"),
        (4, "\"Drone1\": {"),
        (6, "\"VehicleType\": \"SimpleFlight\","),
        (6, "\"Sensors\": {"),
        (8, "\"Imu\": {"),
    ] {
        sheet.indent(indent);
        sheet.line(line);
    }
    sheet.indent(10);
    sheet.head("AirSim, docs/sensors.md, section IMU, and ImuSimpleParams.hpp, initializeFromSettings");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    let white = "random-walk coefficient N as sigma (one-sided density / sqrt 2), continuous, not per sample";
    let walk = "not a bias instability: the bias walks by this over sqrt(Tau), so it is K sqrt(Tau)";
    let [gyro_s, accelerometer_s] = TAU_S;
    for (key, value, unit, means) in [
        ("AngularRandomWalk", imu.gyro.white.mean / DEGREE_PER_ROOT_HOUR, "deg/sqrt(h)", white),
        ("GyroBiasStabilityTau", gyro_s, "s", "only its ratio to GyroBiasStability matters"),
        ("GyroBiasStability", g.drive * gyro_s.sqrt() / DEGREE_PER_HOUR, "deg/h", walk),
        ("VelocityRandomWalk", imu.accelerometer.white.mean / MILLI_G, "mg/sqrt(Hz)", white),
        ("AccelBiasStabilityTau", accelerometer_s, "s", "only its ratio to AccelBiasStability matters"),
        ("AccelBiasStability", a.drive * accelerometer_s.sqrt() / MICRO_G, "ug", walk),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
    sheet.line("\"SensorType\": 2,");
    sheet.line("\"Enabled\": true");
    for indent in [8, 6, 4, 2, 0] {
        sheet.indent(indent);
        sheet.line("}");
    }
}
