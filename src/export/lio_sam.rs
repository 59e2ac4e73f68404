//! LIO-SAM: GTSAM's preintegration takes continuous-time covariances, σ² = imuAccNoise², and bias
//! factors get √Δt × imuAccBiasN.

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet, WALK, WHITE};
use proofmass_base::units::STANDARD_GRAVITY_M_S2;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("LIO-SAM, config/params.yaml, IMU Settings, and GTSAM, class PreintegrationParams");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.line("lio_sam:");
    sheet.indent(2);
    for (key, value, unit, means) in [
        ("imuAccNoise", imu.accelerometer.white.mean, "m/s^2/sqrt(Hz)", WHITE),
        ("imuGyrNoise", imu.gyro.white.mean, "rad/s/sqrt(Hz)", WHITE),
        ("imuAccBiasN", a.drive, "m/s^3/sqrt(Hz)", WALK),
        ("imuGyrBiasN", g.drive, "rad/s^2/sqrt(Hz)", WALK),
        ("imuGravity", STANDARD_GRAVITY_M_S2, "m/s^2", "standard gravity; enter your local value"),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
}
