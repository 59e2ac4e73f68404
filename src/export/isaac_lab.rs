//! Isaac Lab's noise models: Gaussian noise per sample, and a bias that is drawn at each reset and
//! then constant.

use super::drift::{self, Form};
use super::imu::Imu;
use super::sheet::{Field, Sheet};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("Isaac Lab, isaaclab.utils.noise, GaussianNoiseCfg and NoiseModelWithAdditiveBiasCfg");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::None));
    sheet.remarks(&a, &g);
    sheet.note(&format!(
        "std holds only for an update every {:?} s: noise is per sample, whatever the rate",
        1.0 / imu.rate_hz
    ));
    sheet.line("from isaaclab.utils.noise import GaussianNoiseCfg, NoiseModelWithAdditiveBiasCfg\n");
    for (name, errors, unit) in [("accelerometer", &imu.accelerometer, "m/s^2"), ("gyroscope", &imu.gyro, "rad/s")] {
        let sigma = errors.white.mean * imu.rate_hz.sqrt();
        for (key, value, means) in [
            ("std", sigma, "sigma per sample, not per sqrt(Hz): N sqrt(rate)"),
            ("bias_mean", errors.bias.mean, "mean of the bias"),
            ("bias_std", errors.bias.sd, "sigma of the bias between resets"),
        ] {
            sheet.field(Field { key: &format!("{name}_{key}"), value, unit, means });
        }
        sheet.line(&format!(
            "{name}_noise = NoiseModelWithAdditiveBiasCfg(\n    \
             noise_cfg=GaussianNoiseCfg(mean=0.0, std={name}_std, operation=\"add\"),\n    \
             bias_noise_cfg=GaussianNoiseCfg(mean={name}_bias_mean, std={name}_bias_std, operation=\"add\"),\n)\n"
        ));
    }
}
