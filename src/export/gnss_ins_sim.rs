//! gnss-ins-sim's `imu_err`: N for white noise, and a first-order Gauss–Markov bias by its
//! stationary σ and correlation time τ, which walks with K for σ = K√(τ/2) (function `bias_drift`).

use super::drift::{self, Form};
use super::imu::{Errors, Imu};
use super::sheet::{Sheet, number};
use proofmass_base::units::{DEGREE_PER_HOUR, DEGREE_PER_ROOT_HOUR};

pub(super) fn write(imu: &Imu, sheet: &mut Sheet) {
    sheet.head("gnss-ins-sim, README, section IMU, and pathgen.py, bias_drift");
    let [a, g] = [&imu.accelerometer, &imu.gyro].map(|errors| drift::process(errors, Form::GaussMarkov));
    sheet.remarks(&a, &g);
    if imu.accelerometer.bias.sd > 0.0 || imu.gyro.bias.sd > 0.0 {
        sheet.note("the bias is the same in each of its runs: the spread between sensors is not represented");
    }
    sheet.note("versions before the issue #19 was closed drive the bias with drift/rate instead, and walk too little");
    sheet.line("import numpy as np\n");
    sheet.line("imu_err = {");
    sheet.indent(4);
    let white = "random-walk coefficient N as sigma (one-sided density / sqrt 2), continuous, not per sample";
    let sigma = "stationary sigma of a Gauss-Markov bias: K sqrt(corr / 2)";
    let corr = "correlation time; 1e6 s makes the bias a random walk";
    let process = |errors: &Errors| drift::process(errors, Form::GaussMarkov);
    let stationary = |errors: &Errors| process(errors).drive * (process(errors).correlation_s / 2.0).sqrt();
    let [accelerometers, gyros] = [0, 1].map(|sense| [0, 1, 2].map(|axis| imu.axis(axis)[sense]));
    for (key, values, unit, means) in [
        ("gyro_b", gyros.map(|e| e.bias.mean / DEGREE_PER_HOUR), "deg/h", "constant bias"),
        ("gyro_arw", gyros.map(|e| e.white.mean / DEGREE_PER_ROOT_HOUR), "deg/sqrt(h)", white),
        ("gyro_b_stability", gyros.map(|e| stationary(&e) / DEGREE_PER_HOUR), "deg/h", sigma),
        ("gyro_b_corr", gyros.map(|e| process(&e).correlation_s), "s", corr),
        ("accel_b", accelerometers.map(|e| e.bias.mean), "m/s^2", "constant bias"),
        ("accel_vrw", accelerometers.map(|e| e.white.mean * 60.0), "m/s/sqrt(h)", white),
        ("accel_b_stability", accelerometers.map(|e| stationary(&e)), "m/s^2", sigma),
        ("accel_b_corr", accelerometers.map(|e| process(&e).correlation_s), "s", corr),
    ] {
        sheet.note(&format!("{key}: {unit}; {means}; documented in the README, section IMU"));
        sheet.line(&format!("'{key}': np.array([{}]),", values.map(number).join(", ")));
    }
    sheet.indent(0);
    sheet.line("}");
}
