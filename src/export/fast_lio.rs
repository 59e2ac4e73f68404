//! FAST-LIO: covariances, which it multiplies by Δt² at each step: acc_cov is a sample's variance
//! N²/Δt, b_acc_cov K²/Δt.

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("FAST-LIO, config yaml, mapping, and IMU_Processing.hpp, covariance propagation");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.note(&format!("these hold only for {} Hz", imu.rate_hz));
    sheet.line("mapping:");
    sheet.indent(2);
    let white = "variance, not sigma, per sample: N^2 rate";
    let walk = "variance, not sigma, per sample: K^2 rate, since the step's covariance is b_cov dt^2";
    let rate = imu.rate_hz;
    for (key, value, unit, means) in [
        ("acc_cov", imu.accelerometer.white.mean.powi(2) * rate, "(m/s^2)^2", white),
        ("gyr_cov", imu.gyro.white.mean.powi(2) * rate, "(rad/s)^2", white),
        ("b_acc_cov", a.drive.powi(2) * rate, "(m/s^3)^2", walk),
        ("b_gyr_cov", g.drive.powi(2) * rate, "(rad/s^2)^2", walk),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
}
