//! PX4's EKF2: σ of a prediction step of Δt, (σΔt)² for velocity and angle and (σ_bΔt)² for the
//! biases (`Ekf::predictCovariance`), so that N and K ask for N/√Δt and K/√Δt.
//!
//! Δt is EKF2's own, not the IMU's: as many whole messages as come nearest to EKF2_PREDICT_US
//! (`ImuDownSampler`).

use super::drift::{self, Form};
use super::imu::{Errors, Imu};
use super::message::Of;
use super::sheet::{Field, Sheet};

/// EKF2_PREDICT_US as PX4 sets it, s.
const PREDICT_S: f64 = 0.01;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("PX4, Parameter Reference, EKF2, and Ekf::predictCovariance");
    imu.say_messages(sheet);
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    let step_s = (PREDICT_S * imu.rate_hz).round().max(1.0) / imu.rate_hz;
    sheet.note(&format!(
        "for EKF2's step of {step_s} s: EKF2_PREDICT_US = 10000 in whole messages; with another step, these change by \
         the root of the ratio, old over new"
    ));
    sheet.note(
        "PX4's own values are much larger, as they hold a vehicle's vibration: do not fly with the sensor's alone",
    );
    let seen = |errors: &Errors| imu.filter.seen(errors.white.mean, imu.rate_hz);
    let walk = |errors: &Errors| drift::process(errors, Form::Walk).drive;
    let (white, moving) = ("white noise", "random walk or bias instability");
    let noise = "sigma of a prediction step, N / sqrt(step): it adds N^2 step to the variance of angle or velocity";
    let walks = "sigma of a prediction step, K / sqrt(step): it adds K^2 step to the variance of the bias";
    let [seen, walk]: [Of<'_>; 2] = [&seen, &walk];
    for (sense, key, unit, [least, most], means, what, of) in [
        (1, "EKF2_GYR_NOISE", "rad/s", [1e-4, 0.1], noise, white, seen),
        (0, "EKF2_ACC_NOISE", "m/s^2", [0.01, 1.0], noise, white, seen),
        (1, "EKF2_GYR_B_NOISE", "rad/s^2", [0.0, 0.01], walks, moving, walk),
        (0, "EKF2_ACC_B_NOISE", "m/s^3", [0.0, 0.01], walks, moving, walk),
    ] {
        let Some(axes) = imu.stated(sheet, sense, key, (what, "PX4 keeps its own value"), of) else { continue };
        let value = (axes.iter().map(|n| n * n).sum::<f64>() / 3.0 / step_s).sqrt();
        if value < least || value > most {
            sheet.note(&format!("{key}: outside of the {least} to {most} that PX4 documents"));
        }
        sheet.field(Field { key, value, unit, means });
    }
}
