//! States what must hold before a tumble recording is judged; each failure says what was wrong and
//! what to do.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use super::calibration::{Point, gyro};
use super::imu::Observed;
use super::selection::interleaved;
use super::standing::Folds;
use super::start::{MISSED_RAD, misses_rad, scales, turned_over_angle};
use crate::error::{Error, Result};
use crate::model::{Split, Tumble};
use crate::numerics::moments::mean;
use crate::numerics::order::median;
use crate::recording::Recording;

/// Fewer poses than this leave no more equations than the base model and one candidate have
/// unknowns.
const FEWEST_POSES: usize = 8;
/// Variance within a pose over that of its noise from which it was moved: a tenfold standard
/// deviation.
const RESTLESS: f64 = 100.0;

fn fail(path: &Path, cause: impl Into<String>, hint: &str) -> Error {
    Error::new(format!("could not diagnose {}", path.display()), cause, hint)
}

/// Gravity in m/s², not in g, mg or mm/s².
pub(crate) fn gravity(gravity_m_s2: f64, findings: &mut Vec<String>) -> Result<()> {
    if !(1.0..=30.0).contains(&gravity_m_s2) {
        return Err(Error::new(
            "could not use the model",
            format!("gravity_m_s2 = {gravity_m_s2}; need m/s², between 1 and 30"),
            "on Earth it is 9.78 at the equator to 9.83 at the poles; a wrong unit is off by a factor of 9.8 or 1000",
        ));
    }
    if !(9.76..=9.84).contains(&gravity_m_s2) {
        findings.push(format!("gravity_m_s2 = {gravity_m_s2} occurs nowhere on Earth; all scale factors depend on it"));
    }
    Ok(())
}

/// No channel is constant.
pub(crate) fn channels(recording: &Recording, model: &Tumble) -> Result<()> {
    for name in model.columns.gyro.iter().flatten().chain(&model.columns.accelerometer) {
        let values = recording.column(name).unwrap_or_default();
        if values.windows(2).all(|w| w[0] == w[1]) {
            return Err(fail(
                &recording.path,
                format!("`{name}` never changes"),
                "a dead or unplugged channel cannot be calibrated; record again",
            ));
        }
    }
    Ok(())
}

/// Enough poses to tell anything.
pub(crate) fn enough(path: &Path, poses: usize) -> Result<()> {
    if poses >= FEWEST_POSES {
        return Ok(());
    }
    Err(fail(
        path,
        format!("{poses} still poses; the base model and one candidate need at least {FEWEST_POSES}"),
        "keep the sensor still on each of its faces and in tilted attitudes, at least two seconds each; 20 to 40 \
        poses are usual",
    ))
}

/// Checks whether the poses that were given lie where the recording is still: rows counted from
/// another start, or at another rate, put them into the moves.
pub(crate) fn still(path: &Path, observed: &Observed<'_>, findings: &mut Vec<String>) -> Result<()> {
    let imu = &observed.imu;
    let scatter = |of: &[f64]| {
        let mean = of.iter().sum::<f64>() / of.len().max(1) as f64;
        of.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / of.len().max(1) as f64
    };
    // Noise by differences of neighbours, which hardly see a motion; where rounding hides it, the
    // step stands for it.
    let noise = |of: &[f64]| of.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (2 * of.len().max(1)) as f64;
    let mut moved = vec![false; observed.poses.len()];
    for column in imu.gyro.iter().flatten().chain(&imu.accelerometer) {
        let usual = median(observed.poses.iter().map(|p| noise(&column[p.samples.clone()])).collect()).unwrap_or(0.0);
        let step = column.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|c| *c > 0.0).fold(f64::INFINITY, f64::min);
        let quiet = usual.max(if step.is_finite() { step * step / 12.0 } else { 0.0 });
        let restless = observed.poses.iter().map(|p| scatter(&column[p.samples.clone()]) > RESTLESS * quiet);
        moved.iter_mut().zip(restless).for_each(|(m, r)| *m |= r);
    }
    let count = moved.iter().filter(|m| **m).count();
    if 3 * count > moved.len() {
        return Err(fail(
            path,
            format!("{count} of the {} poses given are not still", moved.len()),
            "rows are counted from zero after the header, the end exclusive; without `poses` the tool finds them itself",
        ));
    }
    if count > 0 {
        findings.push(format!(
            "{count} of the {} poses given are not still throughout; they get a lower weight",
            moved.len()
        ));
    }
    Ok(())
}

/// The accelerometer moves from pose to pose more than the gyro does: otherwise the two are
/// swapped, or nothing was turned.
pub(crate) fn moving(path: &Path, observed: &Observed<'_>) -> Result<()> {
    let spread = |of: &dyn Fn(usize) -> (Vector3<f64>, Vector3<f64>)| {
        let count = observed.poses.len() as f64;
        let centre = (0..observed.poses.len()).map(|k| of(k).0).sum::<Vector3<f64>>() / count;
        let squares = (0..observed.poses.len()).map(|k| {
            let (mean, variance) = of(k);
            (mean - centre).norm_squared() / variance.sum().max(f64::MIN_POSITIVE)
        });
        (squares.sum::<f64>() / count).sqrt()
    };
    let accelerometer = spread(&|k| (observed.poses[k].accelerometer, observed.poses[k].accelerometer_variance));
    let gyro = match observed.imu.gyro {
        Some(_) => spread(&|k| (observed.poses[k].gyro, observed.poses[k].gyro_variance)),
        None => 0.0,
    };
    if gyro > 20.0 && gyro > accelerometer {
        return Err(fail(
            path,
            "the columns given as gyro change from pose to pose more than those given as accelerometer",
            "the two are probably swapped under [columns]",
        ));
    }
    if accelerometer < 20.0 {
        return Err(fail(
            path,
            "the accelerometer reads nearly the same in every pose",
            "turn the sensor to many attitudes between the poses; a sensor that stays at rest is kind = \"static\"",
        ));
    }
    Ok(())
}

/// The gyro's axes turn the way the accelerometer's do: otherwise columns are swapped or mounted
/// the other way round.
pub(crate) fn axes(path: &Path, observed: &Observed<'_>, guess: &Point, model: &Tumble) -> Result<()> {
    let (Some(names), Some(recorded)) = (&model.columns.gyro, &observed.imu.gyro) else { return Ok(()) };
    // The same however the axes are read.
    let most = turned_over_angle(observed, guess);
    let as_given = turn_error(observed, guess, most);
    if as_given < MISSED_RAD {
        return Ok(());
    }
    let mut best: Option<(f64, String)> = None;
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for signs in 0..8u32 {
            let sign = |i: usize| if signs >> i & 1 == 1 { -1.0 } else { 1.0 };
            let turned = Matrix3::from_fn(|i, j| if order[i] == j { sign(i) } else { 0.0 });
            let mut trial = observed.clone();
            let gyro: [Vec<f64>; 3] = std::array::from_fn(|i| {
                let centre = guess[gyro::OFFSET.start + order[i]];
                recorded[order[i]].iter().map(|v| sign(i) * (v - centre)).collect()
            });
            trial.imu.gyro = Some([&gyro[0], &gyro[1], &gyro[2]]);
            let mut point = *guess;
            gyro::OFFSET.for_each(|p| point[p] = 0.0);
            let error = turn_error(&trial, &point, most);
            if turned != Matrix3::identity() && best.as_ref().is_none_or(|b| error < b.0) {
                let named = (0..3).map(|i| format!("{}{}", if sign(i) < 0.0 { "−" } else { "" }, names[order[i]]));
                best = Some((error, named.collect::<Vec<_>>().join(", ")));
            }
        }
    }
    match best {
        Some((error, order)) if error < 0.3 * as_given => Err(fail(
            path,
            format!(
                "rotations by the gyro miss gravity by {:.0}°; with its columns read as ({order}) they miss it by \
                {:.1}°",
                as_given.to_degrees(),
                error.to_degrees()
            ),
            "gyro and accelerometer must share their x, y and z: reorder the columns, or change the sign in the file",
        )),
        _ => Ok(()),
    }
}

/// Mean angle between gravity as carried by the gyro and as read, over the moves, at the best of these scales: half a
/// turn looks the same whichever way it goes, and may be what most moves are.
fn turn_error(observed: &Observed<'_>, point: &Point, most: f64) -> f64 {
    let error = |scale: f64| mean(&misses_rad(observed, point, scale));
    scales(most, 1.125).map(error).fold(f64::INFINITY, f64::min)
}

/// Which poses are held out: the model's split, or interleaved folds.
pub(crate) fn folds(observed: &Observed<'_>, split: &Split, findings: &mut Vec<String>) -> Result<Folds> {
    if split.test.is_empty() {
        return Ok(interleaved(observed.poses.len()));
    }
    for [from, to] in &split.train {
        if split.test.iter().any(|[a, b]| from < b && a < to) {
            return Err(Error::new(
                "could not use the model's split",
                format!("train rows {from} to {to} overlap the test rows"),
                "a row may train or validate, not both",
            ));
        }
    }
    let folds: Folds = observed
        .poses
        .iter()
        .map(|p| split.test.iter().any(|[a, b]| *a <= p.samples.start && p.samples.end <= *b).then_some(0))
        .collect();
    let tested = folds.iter().flatten().count();
    if tested < 3 || folds.len() - tested < FEWEST_POSES {
        return Err(Error::new(
            "could not use the model's split",
            format!("{tested} poses lie in the test rows and {} outside", folds.len() - tested),
            "need at least 3 poses to validate and 8 to fit; without [split], poses are held out in turn",
        ));
    }
    findings.push(format!("{tested} of {} poses were held out as the model's split says", folds.len()));
    Ok(folds)
}
