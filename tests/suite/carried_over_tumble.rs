//! What `diagnose` names of an IMU in many still poses, a study of `repaired.toml` holds axis by
//! axis.

use std::f64::consts::PI;
use std::path::Path;

use libtest_mimic::{Failed, Trial};
use nalgebra::{Matrix3, Vector3};
use proofmass::study::{self, tolerances};

use super::bench::{Bench, study as run_study};
use super::tumble_bench::{Imu, deg_c};
use super::world::{check, near, test};

const G: f64 = 9.80665;

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("carried over: scale factors, misalignment and g-sensitivity of poses are a study's", axes),
        test("carried over: biases that follow the temperature of poses follow it in a study", warmth),
        test("carried over: a gyro's misalignment of poses is a study's, a curved scale is said", rows),
    ]
}

/// `repaired.toml` of an IMU on a turntable, which a study has run.
fn repaired(imu: &Imu) -> Result<String, Failed> {
    repaired_with(imu, None)
}

/// The same with a column that says how warm it is.
fn repaired_with(imu: &Imu, column: Option<fn(f64) -> f64>) -> Result<String, Failed> {
    let bench = Bench::new()?;
    let (recording, ranges) = imu.record(5);
    let mut text = String::from("ax,ay,az,gx,gy,gz,temp\n");
    for k in 0..recording.samples() {
        let warmth = column.map_or(0.0, |of| of(minutes(k, recording.samples())));
        let cells = recording.columns.iter().map(|c| c.values[k]).chain([warmth]);
        let cells: Vec<String> = cells.map(|v| v.to_string()).collect();
        text += &(cells.join(",") + "\n");
    }
    let poses: String = ranges.iter().map(|range| format!("{},{}\n", range.start, range.end)).collect();
    bench.file("poses.csv", &format!("start_row,end_row_exclusive\n{poses}"))?;
    let model = "kind = \"tumble\"\nrate_hz = 50.0\ngravity_m_s2 = 9.81\nposes = \"poses.csv\"\n[columns]\n\
                 gyro = [\"gx\", \"gy\", \"gz\"]\naccelerometer = [\"ax\", \"ay\", \"az\"]\n";
    let environment = if column.is_some() { "environment = [\"temp\"]\n" } else { "" };
    let out = bench.path("out");
    bench
        .diagnose(&text, &format!("{model}{environment}"), &["--json", "--out", &out.display().to_string()])?
        .json()?;
    run_study(&out.join("repaired.toml"), &bench.path("study"), 64)?;
    Ok(std::fs::read_to_string(out.join("repaired.toml"))?)
}

/// Time of a sample from the middle of the recording.
fn minutes(sample: usize, samples: usize) -> f64 {
    (sample as f64 - 0.5 * samples as f64) / 50.0 / 60.0
}

/// Biases that follow the temperature by so much a kelvin, which swings by 4 K either way: thirty poses
/// known to 1.2 mm/s² and 0.9 mrad/s give 0.1 of each per kelvin. Sixty points of the profile miss a
/// tenth of a kelvin.
fn warmth() -> Result<(), Failed> {
    let mut imu = Imu::without_defect(5);
    imu.per_kelvin = [Vector3::new(0.01, -0.02, 0.03), Vector3::new(4e-3, 8e-3, -6e-3)];
    let text = repaired_with(&imu, Some(deg_c))?;
    check(!text.contains("Not in this study: temperature"), format!("it is said not to run:\n{text}"))?;
    holds(&text, ("accelerometer.bias_temperature_ug_k", 1e6 / G), [0.01, -0.02, 0.03], 6e-4)?;
    holds(&text, ("gyro.bias_temperature_deg_h_k", 648_000.0 / PI), [4e-3, 8e-3, -6e-3], 5e-4)?;
    let study = study::parse("repaired.toml", &text, Path::new(""))?;
    let warmer = study.in_motion.as_ref().ok_or("the study has one axis")?.course.temperature();
    let samples = (imu.poses * 150 - 50) as f64;
    for second in [5.0, 20.0, 28.0, 60.0, 81.0] {
        let here = deg_c((second - 0.5 * samples / 50.0) / 60.0) - warmer.reference_deg_c;
        near(&format!("kelvins after {second} s"), warmer.above_reference_k(second), here, 0.2)?;
        check((warmer.above_reference_k(second + 4.0) - here).abs() > 0.2, "another time is as warm")?;
    }
    // Control: counts are no temperature.
    let text = repaired_with(&imu, Some(|minutes| 20_000.0 + 300.0 * deg_c(minutes)))?;
    let said = text.replace("\n#   ", " ");
    check(said.contains("no temperature in °C") && !text.contains("\n[temperature]"), format!("counts as °C:\n{text}"))
}

/// Mean of a key over members for each axis, in its unit.
fn of_axes(repaired: &str, path: &str) -> Result<[f64; 3], Failed> {
    let study = study::parse("repaired.toml", repaired, Path::new(""))?;
    let motion = study.in_motion.as_ref().ok_or("the study has one axis")?;
    let key = tolerances::keys().find(|key| key.path == path).ok_or("no such key")?;
    Ok([0, 1, 2].map(|axis| motion.between[axis].moments(key).0 / key.factor))
}

/// Compares the numbers of a key, `unit` of which make one SI unit, with SI numbers.
fn holds(repaired: &str, (path, unit): (&str, f64), expected: [f64; 3], tolerance: f64) -> Result<(), Failed> {
    let (expected, tolerance) = (expected.map(|number| number * unit), tolerance * unit);
    let got = of_axes(repaired, path)?;
    (0..3).try_for_each(|axis| near(&format!("{path} of axis {axis}"), got[axis], expected[axis], tolerance))?;
    // Control: the same numbers with their signs turned are others.
    check((0..3).any(|axis| (got[axis] + expected[axis]).abs() > tolerance), format!("{path}: the sign is not seen"))
}

/// A pose of 100 samples with noise of at most 12 mm/s² is known to 1.2 mm/s², 1.2e-4 of gravity; thirty
/// poses give an axis to a fifth of that.
fn axes() -> Result<(), Failed> {
    let mut imu = Imu::without_defect(5);
    imu.scale[0].component_mul_assign(&Vector3::new(1.004, 1.0, 0.997));
    imu.scale[1].component_mul_assign(&Vector3::new(1.0, 1.02, 0.99));
    imu.alignment[0] = Matrix3::new(1.0, 4e-3, -3e-3, 0.0, 1.0, 6e-3, 0.0, 0.0, 1.0);
    imu.g_sensitivity = Matrix3::from_diagonal(&Vector3::new(1e-3, -2e-3, 3e-3));
    let text = repaired(&imu)?;
    let over_mean = |s: &Vector3<f64>| [0, 1, 2].map(|axis| s[axis] / s.mean() - 1.0);
    holds(&text, ("accelerometer.scale_factor_ppm", 1e6), over_mean(&imu.scale[0]), 2e-4)?;
    holds(&text, ("gyro.scale_factor_ppm", 1e6), over_mean(&imu.scale[1]), 3e-3)?;
    // y reads of x what x reads of y here, z of x and y the mean of what they read of z.
    holds(&text, ("accelerometer.misalignment_mrad", 1e3), [0.0, 4e-3, 1.5e-3], 2e-4)?;
    // A row of three elements, of which one is not zero.
    holds(&text, ("gyro.g_sensitivity_deg_h_g", G * 648_000.0 / PI), [1e-3, -2e-3, 3e-3].map(|k| k / 3.0), 1e-4)
}

fn rows() -> Result<(), Failed> {
    let mut imu = Imu::without_defect(5);
    imu.alignment[1] = Matrix3::new(1.0, 0.01, 0.02, -0.01, 1.0, 0.03, 0.02, -0.03, 1.0);
    imu.quadratic[0] = Vector3::new(1e-3, -1e-3, 2e-3);
    let text = repaired(&imu)?;
    holds(&text, ("gyro.misalignment_mrad", 1e3), [0.015, 0.01, -0.005], 3e-3)?;
    holds(&text, ("accelerometer.k2_ug_per_g2", G * 1e6), [1e-3, -1e-3, 2e-3], 1e-4)?;
    // The cube is fitted beside the square; none was planted. Of a square as large as that, a pose of
    // 10 m/s² would take 1e-4 for it.
    let cubes = of_axes(&text, "accelerometer.k3_ug_per_g3")?.map(|k3| k3 / (G * G * 1e6));
    check(cubes.iter().all(|k3| k3.abs() < 2e-5) && cubes != [0.0; 3], format!("k₃ is {cubes:?}"))?;
    check(!text.contains("Not in this study: scale-nonlinearity"), format!("it is said not to run:\n{text}"))?;
    // Control: what was not named is not written.
    check(!text.contains("scale_factor_ppm"), format!("a scale factor that is not there:\n{text}"))
}
