//! ORB-SLAM3: continuous-time densities. Inside, noise is multiplied by √frequency and walks are
//! divided by it.

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet, WALK, WHITE};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.line("%YAML:1.0");
    sheet.head("ORB-SLAM3, Calibration_Tutorial, section IMU parameters, and Tracking, ParseIMUParamFile");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    for (key, value, unit, means) in [
        ("IMU.NoiseGyro", imu.gyro.white.mean, "rad/s/sqrt(Hz)", WHITE),
        ("IMU.NoiseAcc", imu.accelerometer.white.mean, "m/s^2/sqrt(Hz)", WHITE),
        ("IMU.GyroWalk", g.drive, "rad/s^2/sqrt(Hz)", WALK),
        ("IMU.AccWalk", a.drive, "m/s^3/sqrt(Hz)", WALK),
        ("IMU.Frequency", imu.rate_hz, "Hz", "rate of the IMU, which makes the others discrete"),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
}
