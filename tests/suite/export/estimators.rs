//! Estimators: the covariance of a step that they form, against N²Δt and K²Δt (IEEE 952).

use libtest_mimic::Failed;

use super::super::world::{check, near};
use super::{DEG_H, DEG_RTH, DT, RATE_HZ, SENSOR, WALK, WHITE, exported, number, scaled};

/// Variance of velocity or angle, and of the bias, that a step adds.
type Step = fn(&str, usize) -> Result<[f64; 2], Failed>;

const ESTIMATORS: &[(&str, Step)] = &[
    // σ_d = σ/√Δt held for Δt; σ_b√Δt.
    ("kalibr", |text, gyro| {
        let name = ["accelerometer", "gyroscope"][gyro];
        let (n, k) =
            (number(text, &format!("{name}_noise_density"), 0)?, number(text, &format!("{name}_random_walk"), 0)?);
        Ok([(n / DT.sqrt() * DT).powi(2), k * k * DT])
    }),
    // V Q Vᵀ of midpoint integration: ½Δt for each of two samples, Δt for the bias.
    ("vins", |text, gyro| {
        let (n, w) = (number(text, ["acc_n", "gyr_n"][gyro], 0)?, number(text, ["acc_w", "gyr_w"][gyro], 0)?);
        Ok([2.0 * (0.5 * DT * n).powi(2), (w * DT).powi(2)])
    }),
    // GTSAM: a continuous covariance over Δt held for Δt; √Δt × BiasN.
    ("lio-sam", |text, gyro| {
        let (n, w) = (
            number(text, ["imuAccNoise", "imuGyrNoise"][gyro], 0)?,
            number(text, ["imuAccBiasN", "imuGyrBiasN"][gyro], 0)?,
        );
        Ok([n * n / DT * DT * DT, (DT.sqrt() * w).powi(2)])
    }),
    // cov Δt².
    ("fast-lio", |text, gyro| {
        let (n, w) =
            (number(text, ["acc_cov", "gyr_cov"][gyro], 0)?, number(text, ["b_acc_cov", "b_gyr_cov"][gyro], 0)?);
        Ok([n * DT * DT, w * DT * DT])
    }),
    // Noise × √f held for Δt; walk/√f.
    ("orb-slam3", |text, gyro| {
        let f = number(text, "IMU.Frequency", 0)?;
        let (n, w) = (
            number(text, ["IMU.NoiseAcc", "IMU.NoiseGyro"][gyro], 0)?,
            number(text, ["IMU.AccWalk", "IMU.GyroWalk"][gyro], 0)?,
        );
        Ok([(n * f.sqrt() * DT).powi(2), (w / f.sqrt()).powi(2)])
    }),
    // q Δt with q = N² and 2σ²/T; °/√h, m/s/√h, °/h, mGal, h.
    ("kf-gins", |text, gyro| {
        let corr_s = number(text, "corrtime", 0)? * 3600.0;
        let (n, sigma) = match gyro {
            0 => (number(text, "vrw", 0)? / 60.0, number(text, "abstd", 0)? * 1e-5),
            _ => (number(text, "arw", 0)? * DEG_RTH, number(text, "gbstd", 0)? * DEG_H),
        };
        Ok([n * n * DT, 2.0 * sigma * sigma / corr_s * DT])
    }),
];

pub fn covariances() -> Result<(), Failed> {
    for (name, step) in ESTIMATORS {
        let text = exported(name, SENSOR)?;
        for gyro in 0..2 {
            let [white, walk] = step(&text, gyro)?;
            // Nine printed digits, squared.
            near(&format!("{name}: white noise of a step"), white / (WHITE[gyro].powi(2) * DT), 1.0, 4e-8)?;
            near(&format!("{name}: random walk of a step"), walk / (WALK[gyro].powi(2) * DT), 1.0, 4e-8)?;
        }
    }
    // A density for N, and a sample for a density.
    for (name, keys, factor) in
        [("kalibr", ["accelerometer_noise_density"], 2f64.sqrt()), ("lio-sam", ["imuAccNoise"], RATE_HZ.sqrt())]
    {
        let text = scaled(&exported(name, SENSOR)?, &keys, factor);
        let step = ESTIMATORS.iter().find(|e| e.0 == name).ok_or("no such law")?.1;
        let ratio = step(&text, 0)?[0] / (WHITE[0].powi(2) * DT);
        check((ratio - factor * factor).abs() < 1e-6, format!("{name}: the control is blind: {ratio}"))?;
    }
    Ok(())
}
