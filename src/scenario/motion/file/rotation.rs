//! Attitudes out of the numbers of a row.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};

use super::layout::Rotation;
use super::refusal::{Refusal, refusal};

/// By how much a quaternion's length, or a matrix' rows, may miss one: rounding of printed numbers.
const ROUNDING: f64 = 1e-2;

/// The attitude of each row; none where the numbers are no rotation. Rows are the numbers of their
/// attitude.
///
/// # Errors
/// Degrees where radians are expected, left-handed matrices, quaternions that are not of length
/// one.
pub(super) fn attitudes(kind: Rotation, rows: &[Vec<f64>]) -> Result<Vec<Option<UnitQuaternion<f64>>>, Refusal> {
    let all: Vec<Option<UnitQuaternion<f64>>> = match kind {
        Rotation::Quaternion(_) => rows.iter().map(|row| quaternion(row)).collect(),
        Rotation::Euler(unit) => {
            if unit != Some(1.0) && unit.is_some() {
                return Ok(rows.iter().map(|row| euler(row, unit.unwrap_or(1.0))).collect());
            }
            if let Some(sentence) = in_degrees(rows) {
                return Err(refusal(sentence, "if so, head the columns roll_deg, pitch_deg, yaw_deg"));
            }
            rows.iter().map(|row| euler(row, 1.0)).collect()
        }
        Rotation::Matrix => {
            if let Some(at) = rows.iter().position(|row| matrix(row).is_some_and(|m| m.determinant() < -0.5)) {
                return Err(refusal(
                    format!("the rotation matrices are left-handed: that of row {at} has determinant −1"),
                    "reverse one axis of the body, or exchange two axes",
                ));
            }
            rows.iter().map(|row| matrix(row).map(of_matrix)).collect()
        }
    };
    let wrong = rows.iter().zip(&all).filter(|(row, a)| a.is_none() && !row.iter().any(|x| x.is_nan())).count();
    if wrong * 20 > rows.len() {
        let what = match kind {
            Rotation::Matrix => "matrices are not rotations",
            _ => "quaternions do not have unit length",
        };
        let first = all.iter().position(Option::is_none).unwrap_or_default();
        return Err(refusal(
            format!("{wrong} of {} {what}, the first in row {first}", rows.len()),
            "are these the right columns? name the layout with format = \"euroc\", \"tum\", \"kitti\" or \"csv\"",
        ));
    }
    Ok(all)
}

/// Scalar first.
fn quaternion(row: &[f64]) -> Option<UnitQuaternion<f64>> {
    let [w, x, y, z] = *row else { return None };
    let raw = Quaternion::new(w, x, y, z);
    ((raw.norm() - 1.0).abs() < ROUNDING).then(|| UnitQuaternion::from_quaternion(raw))
}

/// Roll, pitch, yaw about x, y, z, turned in the order yaw, pitch, roll.
fn euler(row: &[f64], unit: f64) -> Option<UnitQuaternion<f64>> {
    let [roll, pitch, yaw] = *row else { return None };
    row.iter().all(|x| x.is_finite()).then(|| UnitQuaternion::from_euler_angles(roll * unit, pitch * unit, yaw * unit))
}

/// A matrix whose rows are of length one and stand upright on each other.
fn matrix(row: &[f64]) -> Option<Matrix3<f64>> {
    let matrix = (row.len() == 9).then(|| Matrix3::from_row_slice(row))?;
    ((matrix * matrix.transpose() - Matrix3::identity()).amax() < ROUNDING).then_some(matrix)
}

fn of_matrix(matrix: Matrix3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix))
}

/// Why angles without a unit cannot be radians: a pitch beyond a right angle, or steps of 360.
fn in_degrees(rows: &[Vec<f64>]) -> Option<String> {
    const NAMES: [&str; 3] = ["roll", "pitch", "yaw"];
    let largest = |k: usize| rows.iter().filter_map(|r| r.get(k)).fold(0.0f64, |a, x| a.max(x.abs()));
    let pitch = largest(1);
    if pitch > 1.02 * std::f64::consts::FRAC_PI_2 {
        return Some(format!("pitch reaches {pitch:.1}, beyond π/2: degrees for radians?"));
    }
    let turn = |k: usize| {
        let steps = rows.windows(2).filter_map(|w| Some((w[1].get(k)? - w[0].get(k)?).abs()));
        steps.fold(0.0f64, f64::max)
    };
    let [angle] = [0, 2].into_iter().filter(|k| (330.0..390.0).contains(&turn(*k))).take(1).collect::<Vec<_>>()[..]
    else {
        let beyond = [0, 2].into_iter().find(|k| largest(*k) > 4.0 * std::f64::consts::PI)?;
        return Some(format!("{} reaches {:.1}: degrees for radians?", NAMES[beyond], largest(beyond)));
    };
    Some(format!("{} jumps by {:.1} where it wraps around: degrees for radians?", NAMES[angle], turn(angle)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_told_from_radians() {
        let rows = |turn: f64, unit: f64| -> Vec<Vec<f64>> {
            let wrapped = |x: f64| (x + 180.0f64).rem_euclid(360.0) - 180.0;
            (0..400).map(|k| vec![0.0, 0.5, wrapped(f64::from(k) * turn) * unit]).collect()
        };
        let degree = std::f64::consts::PI / 180.0;
        let refused = attitudes(Rotation::Euler(None), &rows(2.0, 1.0)).expect_err("degrees");
        assert!(refused.cause.contains("degrees for radians"), "{refused:?}");
        assert!(attitudes(Rotation::Euler(None), &rows(2.0, degree)).is_ok());
        assert!(attitudes(Rotation::Euler(Some(degree)), &rows(2.0, 1.0)).is_ok());
    }

    #[test]
    fn left_handed_matrices_and_long_quaternions_are_refused() {
        let mirror = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0];
        let refused = attitudes(Rotation::Matrix, &[mirror]).expect_err("mirror");
        assert!(refused.cause.contains("left-handed"), "{refused:?}");
        let order = super::super::format::Order::ScalarFirst;
        assert!(attitudes(Rotation::Quaternion(order), &vec![vec![2.0, 0.0, 0.0, 0.0]; 9]).is_err());
        let half = attitudes(Rotation::Quaternion(order), &[vec![0.5, 0.5, 0.5, 0.5]]).expect("a rotation");
        assert!(half[0].is_some_and(|q| (q.angle() - std::f64::consts::TAU / 3.0).abs() < 1e-12));
    }
}
