//! PX4's SITL for Gazebo Classic, `gazebo_imu_plugin`: continuous densities, made discrete exactly
//! (Maybeck 4-114).

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet, WHITE};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.line("<plugin name=\"rotors_gazebo_imu_plugin\" filename=\"libgazebo_imu_plugin.so\">");
    sheet.indent(2);
    sheet.head("PX4-SITL_gazebo-classic, gazebo_imu_plugin.h, struct ImuParameters, and addNoise");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::GaussMarkov));
    sheet.remarks(&a, &g);
    if imu.accelerometer.bias.mean != 0.0 || imu.gyro.bias.mean != 0.0 {
        sheet.note(
            "the plugin's bias has mean zero: the mean of this one's is taken into its sigma, sqrt(mean^2 + sd^2)",
        );
    }
    let walk = "continuous density that drives the bias, as sigma: the random walk K";
    for (name, errors, drift, unit, density, per_root_s) in [
        ("gyroscope", &imu.gyro, &g, "rad/s", "rad/s/sqrt(Hz)", "rad/s^2/sqrt(Hz)"),
        ("accelerometer", &imu.accelerometer, &a, "m/s^2", "m/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)"),
    ] {
        for (key, value, unit, means) in [
            ("NoiseDensity", errors.white.mean, density, WHITE),
            ("RandomWalk", drift.drive, per_root_s, walk),
            ("BiasCorrelationTime", drift.correlation_s, "s", "1e6 s makes the bias a random walk"),
            ("TurnOnBiasSigma", errors.bias.mean.hypot(errors.bias.sd), unit, "sigma of the bias from run to run"),
        ] {
            sheet.field(Field { key: &format!("{name}{key}"), value, unit, means });
        }
    }
    sheet.indent(0);
    sheet.line("</plugin>");
}
