//! VINS-Mono and VINS-Fusion. `IntegrationBase` forms the covariance of a step Δt of midpoint
//! integration with two independent samples, ½Δt each, and the bias' with Δt: ½ acc_n² Δt² and
//! acc_w² Δt². They are N²Δt and K²Δt for acc_n = N√(2/Δt) and acc_w = K/√Δt.

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet};
use proofmass_base::units::STANDARD_GRAVITY_M_S2;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.line("%YAML:1.0");
    sheet.head("vins_estimator, factor/integration_base.h, noise and midPointIntegration; config yaml, imu parameters");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.note(&format!(
        "acc_n and gyr_n hold only for {} Hz: covariance per step = 0.5 acc_n^2 dt^2; acc_n = N sqrt(2 rate)",
        imu.rate_hz
    ));
    let white = "per sample as sigma: N sqrt(2 rate), sqrt(2) above the sample's own, since the midpoint rule \
    averages two samples";
    let walk = "per sample as sigma: K sqrt(rate), since the step's covariance is acc_w^2 dt^2";
    let rate = imu.rate_hz;
    for (key, value, unit, means) in [
        ("acc_n", imu.accelerometer.white.mean * (2.0 * rate).sqrt(), "m/s^2", white),
        ("gyr_n", imu.gyro.white.mean * (2.0 * rate).sqrt(), "rad/s", white),
        ("acc_w", a.drive * rate.sqrt(), "m/s^3", walk),
        ("gyr_w", g.drive * rate.sqrt(), "rad/s^2", walk),
        ("g_norm", STANDARD_GRAVITY_M_S2, "m/s^2", "standard gravity; enter your local value"),
    ] {
        sheet.field(Field { key, value, unit, means });
    }
}
