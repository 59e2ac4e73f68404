//! The calibration of an IMU as text to be pasted: valid as TOML and as Python.

use proofmass_diagnosis::verdict::{SensorCalibration, Triads};
use proofmass_physics::candidate::Kind;

/// States what the text says, for a heading.
pub(super) fn meaning(calibration: &Triads, kind: Kind) -> String {
    let leaves = match &calibration.leaves[..] {
        [] => String::new(),
        ids => format!(
            ". Left in the readings is what was named besides, {}, by its equation and parameters",
            ids.join(" and ")
        ),
    };
    format!("{}{leaves}", of_a_kind(kind))
}

fn of_a_kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Trajectory => {
            "calibrated = matrix · (reading − bias), with offset, scale and misalignment fitted whether they were named or \
             not; what this motion does not determine is left as it is, and its ± is what a sensor may have. Otherwise ± \
             is half the width of the 95 % interval, 0 where the axes are those of the accelerometer by definition"
        }
        _ => {
            "calibrated = matrix · (reading − bias), with offset, scale and misalignment of every axis fitted whether they \
             were named or not; ± is half the width of the 95 % interval"
        }
    }
}

/// Both sensors. The readings of an IMU in motion are in the unit of what they measure, those of
/// other kinds in counts.
pub(super) fn text(calibration: &Triads, kind: Kind) -> String {
    let counts = kind != Kind::Trajectory;
    let sensors = [("accelerometer", Some(&calibration.accelerometer)), ("gyro", calibration.gyro.as_ref())];
    sensors.into_iter().filter_map(|(name, sensor)| Some(of(name, sensor?, counts))).collect()
}

fn of(name: &str, sensor: &SensorCalibration, counts: bool) -> String {
    let half = |ci95: [f64; 2]| 0.5 * (ci95[1] - ci95[0]);
    let unit = sensor.unit.replace("^2", "²");
    let biases: Vec<(f64, f64)> = sensor.bias.iter().zip(sensor.bias_ci95).map(|(b, c)| (*b, half(c))).collect();
    let (read, gain) = if counts { ("count", format!("{unit} per count")) } else { (&*unit, "1".to_owned()) };
    let mut out = format!("{name}_bias = {}  # {read}, ± {}\n", list(&biases, fixed), halves(&biases));
    out += &format!("{name}_matrix = [  # {gain}\n");
    for (row, intervals) in sensor.matrix.iter().zip(sensor.matrix_ci95) {
        let entries: Vec<(f64, f64)> = row.iter().zip(intervals).map(|(v, c)| (*v, half(c))).collect();
        out += &format!("  {},  # ± {}\n", list(&entries, scientific), halves(&entries));
    }
    out + "]\n"
}

fn list(values: &[(f64, f64)], write: fn(f64, f64) -> String) -> String {
    format!("[{}]", values.iter().map(|(v, half)| write(*v, *half)).collect::<Vec<_>>().join(", "))
}

fn halves(values: &[(f64, f64)]) -> String {
    values
        .iter()
        .map(|(_, half)| if *half == 0.0 { "0".to_owned() } else { format!("{half:.1e}") })
        .collect::<Vec<_>>()
        .join(", ")
}

/// With the decimals that the interval allows, and one more.
fn fixed(value: f64, half: f64) -> String {
    let decimals = if half > 0.0 && half.is_finite() { (2.0 - half.log10().floor()).clamp(0.0, 12.0) } else { 6.0 };
    // Adding zero turns a negative zero into zero.
    format!("{:.*}", decimals as usize, value + 0.0)
}

/// Zeros that no fit moved stay short.
fn scientific(value: f64, _: f64) -> String {
    if value == 0.0 { "0.0".into() } else { format!("{value:.7e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_is_toml_and_holds_the_numbers() {
        let sensor = SensorCalibration {
            matrix: [[1.25e-3, -2e-6, 0.0], [0.0, 1.5e-3, 3e-6], [0.0, 0.0, 1.125e-3]],
            matrix_ci95: [[[1.0, 1.002]; 3]; 3],
            bias: [-12.25, 0.0, 4096.5],
            bias_ci95: [[-12.5, -12.0], [-0.25, 0.25], [4096.0, 4097.0]],
            unit: "m/s^2".into(),
        };
        let both = Triads { gyro: Some(sensor.clone()), accelerometer: sensor.clone(), leaves: vec!["g-sensitivity"] };
        assert!(meaning(&both, Kind::Tumble).contains("named besides, g-sensitivity, by its equation"));
        let read: toml::Table = text(&both, Kind::Tumble).parse().expect("TOML");
        for name in ["gyro", "accelerometer"] {
            let matrix = read[&format!("{name}_matrix")].clone().try_into::<[[f64; 3]; 3]>().expect("a matrix");
            assert_eq!(matrix, sensor.matrix);
            assert_eq!(read[&format!("{name}_bias")].clone().try_into::<[f64; 3]>().expect("a bias"), sensor.bias);
        }
        assert!(
            text(&both, Kind::Tumble).contains("m/s² per count") && !text(&both, Kind::Trajectory).contains("count")
        );
    }
}
