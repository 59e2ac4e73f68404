//! KF-GINS: biases as first-order Gauss–Markov processes with stationary σ and one correlation time
//! T for all; its filter drives them with 2σ²/T, which is K² for σ = K√(T/2).

use super::drift::{self, Form};
use super::imu::{Errors, Imu};
use super::sheet::{Sheet, number};
use proofmass_base::units::{DEGREE_PER_HOUR, DEGREE_PER_ROOT_HOUR};

/// Correlation time, h: a bias is a random walk for runs that are short against it.
const CORRELATION_H: f64 = 100.0;
const MILLI_GAL: f64 = 1e-5;

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("KF-GINS, dataset/kf-gins.yaml, imunoise, and GIEngine, initialize and insPropagation");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::Walk));
    sheet.remarks(&a, &g);
    sheet.note("gbstd and abstd also become the initial sigma of the biases: set initbgstd and initbastd apart");
    sheet.note("scale-factor states keep a token sigma of 1 ppm: this sensor states nothing more");
    sheet.line("imunoise:");
    sheet.indent(2);
    let sigma = (CORRELATION_H * 3600.0 / 2.0).sqrt();
    let white = "random-walk coefficient N as sigma (one-sided density / sqrt 2), continuous, not per sample";
    let drift = "stationary sigma of a Gauss-Markov bias: K sqrt(corrtime / 2), so that 2 sigma^2 / corrtime = K^2";
    let drive = |errors: &Errors| drift::process(errors, Form::Walk).drive;
    let [accelerometers, gyros] = [0, 1].map(|sense| [0, 1, 2].map(|axis| imu.axis(axis)[sense]));
    for (key, values, unit, means) in [
        ("arw", gyros.map(|e| e.white.mean / DEGREE_PER_ROOT_HOUR), "deg/sqrt(h)", white),
        ("vrw", accelerometers.map(|e| e.white.mean * 60.0), "m/s/sqrt(h)", white),
        ("gbstd", gyros.map(|e| drive(&e) * sigma / DEGREE_PER_HOUR), "deg/h", drift),
        ("abstd", accelerometers.map(|e| drive(&e) * sigma / MILLI_GAL), "mGal", drift),
        ("gsstd", [1.0; 3], "ppm", "stationary sigma of the gyro's scale factor"),
        ("asstd", [1.0; 3], "ppm", "stationary sigma of the accelerometer's scale factor"),
    ] {
        sheet.note(&format!("{key}: {unit}; {means}; documented in kf-gins.yaml, imunoise"));
        sheet.line(&format!("{key}: [{}]", values.map(number).join(", ")));
    }
    sheet.note("corrtime: h; correlation time of all of these; 1000 s into a run a walk's sigma is 0.14 % low");
    sheet.line(&format!("corrtime: {CORRELATION_H:?}"));
}
