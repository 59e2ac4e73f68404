//! The covariances that robot_localization reads from `sensor_msgs/Imu`: its filters take the errors
//! of messages as independent, so that theirs is the variance with which a sum of messages grows.
//!
//! Not its process noise: Q times the step is how much the vehicle's motion changes (`Ekf::predict`),
//! of which a sensor states nothing.

use super::filter::Filter;
use super::imu::Imu;
use super::ros_covariance;
use super::sheet::Sheet;

/// Smaller variances of a measurement are raised to this (`Ekf::correct`).
const LEAST: f64 = 1e-9;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("robot_localization, Preparing Your Data for Use with robot_localization, and Ekf::correct");
    imu.say_messages(sheet);
    sheet.note("for the messages on imuN: ekf_localization_node and ukf_localization_node read these from each one");
    sheet.note("a state for a bias does not exist there: subtract the bias before, the rest stays in the estimate");
    sheet
        .note("process_noise_covariance is not written: it is the vehicle's motion per second, not the sensor's noise");
    let least = [imu.accelerometer, imu.gyro].map(|e| imu.filter.independent(e.white.mean, imu.rate_hz));
    if least.iter().any(|variance| *variance > 0.0 && *variance < LEAST) {
        sheet.note("variances below 1e-9 are raised to 1e-9 there");
    }
    ros_covariance::fields(imu, sheet, "variance of independent messages with the same sum", Filter::independent);
}
