//! The covariances of a `sensor_msgs/Imu` message, row by row: of one message, as it is sent.

use super::drift::{self, Form};
use super::filter::Filter;
use super::imu::Imu;
use super::sheet::{Field, Sheet};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("the definition of sensor_msgs/Imu, comments");
    imu.say_messages(sheet);
    if let Filter::LowPass(_) = imu.filter {
        sheet.note("an estimator that takes messages as independent needs the other variance: --to robot-localization");
    }
    fields(imu, sheet, "variance of one message", Filter::variance);
}

/// Writes the three matrices, with the variance by one of a filter's laws.
pub(super) fn fields(imu: &Imu, sheet: &mut Sheet, means: &str, variance: fn(Filter, f64, f64) -> f64) {
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::None));
    sheet.remarks(&a, &g);
    let unknown = [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let orientation = "-1 first: the sensor file has no orientation, so that readers disregard it";
    sheet.row(Field { key: "orientation_covariance", value: -1.0, unit: "rad^2", means: orientation }, &unknown);
    let means = format!("row-major about x, y, z: {means} on the diagonal; axes are taken as uncorrelated");
    for (sense, key, unit) in
        [(1, "angular_velocity_covariance", "(rad/s)^2"), (0, "linear_acceleration_covariance", "(m/s^2)^2")]
    {
        let instead = "nine zeros in the message mean unknown";
        let axes = imu.stated(sheet, sense, key, ("white noise", instead), &|errors| {
            variance(imu.filter, errors.white.mean, imu.rate_hz)
        });
        if let Some([x, y, z]) = axes {
            let matrix = [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z];
            sheet.row(Field { key, value: x, unit, means: &means }, &matrix);
        }
    }
}
