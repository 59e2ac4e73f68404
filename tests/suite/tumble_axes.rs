//! Columns of a tumble whose axes are exchanged or turned over are said with the order that is right, also where the
//! sensor goes from face to face: half a turn looks the same whichever way it goes.

use libtest_mimic::{Failed, Trial};
use proofmass::control::Control;
use proofmass::diagnosis::tumble::diagnose_in;

use super::diagnosis_tumble::many;
use super::tumble_bench::{Imu, model};
use super::world::{check, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![test("tumble: exchanged and reversed axes are said with the order that is right", axes)]
}

/// What is done to the columns ax … gz, and how those of the gyro are to be read.
type Plant = (&'static str, fn(&mut [Vec<f64>]), &'static str);

fn reverse(column: &mut [f64]) {
    column.iter_mut().for_each(|v| *v = -*v);
}

/// A mirrored accelerometer and a gyro about the mirrored axes turn the other way about the two axes that stay: an axial
/// vector changes by the determinant times the matrix.
const PLANTS: [Plant; 6] = [
    ("gyro z reversed", |c| reverse(&mut c[5]), "(gx, gy, −gz)"),
    ("gyro reversed", |c| c[3..].iter_mut().for_each(|c| reverse(c)), "(−gx, −gy, −gz)"),
    ("gyro x and y exchanged", |c| c.swap(3, 4), "(gy, gx, gz)"),
    ("accelerometer x reversed", |c| reverse(&mut c[0]), "(gx, −gy, −gz)"),
    ("accelerometer y reversed", |c| reverse(&mut c[1]), "(−gx, gy, −gz)"),
    ("accelerometer x and y exchanged", |c| c.swap(0, 1), "(−gy, −gx, −gz)"),
];

fn axes() -> Result<(), Failed> {
    for (from_face_to_face, poses) in [(true, 12), (false, 24)] {
        for (what, plant, order) in PLANTS {
            let wrong = many(6, |seed| {
                let imu = Imu { from_face_to_face, poses, ..Imu::without_defect(7000 + seed) };
                let (mut recording, ranges) = imu.record(7000 + seed);
                let mut columns: Vec<Vec<f64>> = recording.columns.iter().map(|c| c.values.clone()).collect();
                // The control: as they are, nothing is said of the axes.
                if let Err(error) = diagnose_in(&recording, &model(), Some(ranges.clone()), &Control::silent()) {
                    return Ok(Some(format!("{seed}, as they are: {error}")));
                }
                plant(&mut columns);
                recording.columns.iter_mut().zip(columns).for_each(|(column, values)| column.values = values);
                Ok(match diagnose_in(&recording, &model(), Some(ranges), &Control::silent()) {
                    Err(error) if error.to_string().contains(order) => None,
                    Err(error) => Some(format!("{seed}: {error}")),
                    Ok(answer) => Some(format!("{seed}: {:?}", answer.outcome)),
                })
            })?;
            check(wrong.is_empty(), format!("{what}, {poses} poses: {}", wrong.join("; ")))?;
        }
    }
    Ok(())
}
