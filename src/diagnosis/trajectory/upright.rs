//! Checks against the accelerometer which way gravity points in the frame of the reference, and in which
//! unit its positions are.
//!
//! Accelerations of the reference are held against the specific force along its own attitudes: between the
//! two lies gravity, whatever frame they stand in, and their ratio is that of the units. Nothing is said
//! where the body hardly accelerates.

use nalgebra::Vector3;

use super::fitted::Fitted;
use super::log::{Log, Motion};
use super::parameters::{Point, TILT};
use super::permutation::Permutation;
use super::start::{Start, accelerated};
use crate::motion::file::format::Up;
use crate::number::{rounded, short};

/// Holds what is wrong with how positions were read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Wrong {
    /// Positions in another unit: its name, and how many there seem to be in a metre.
    Unit(&'static str, f64),
    /// Gravity along another axis of the file than was taken.
    Up(Axis),
}

/// The axis of a file that points up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Axis {
    /// One that a model can state.
    Stated(Up),
    /// None of those.
    Other,
}

/// Part of the variance of accelerations that the specific force must explain.
const EXPLAINS: f64 = 0.5;
/// Ratios of the units of length that are in use, and their names; a ratio counts within a factor of √2, so
/// that no two overlap.
const UNITS: [(f64, &str); 2] = [(1e3, "mm"), (1e2, "cm")];
/// Part of gravity within which a difference is gravity: an accelerometer's bias is a quarter of it at most
/// (ADXL345 datasheet: 0 g offset of ±250 mg).
const IS_GRAVITY: f64 = 0.25;
/// Cosine of 45°: beyond, another axis of the file is nearer to gravity.
const NEARER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A tilt below which nothing is said, rad: that of a mounting that costs nothing.
const LEVEL_RAD: f64 = 1e-3;

/// Returns what is wrong, if the specific force says so.
pub(super) fn wrong(log: &Log, motion: &Motion, start: &Start, gravity_m_s2: f64) -> Option<Wrong> {
    if !motion.halves.position || start.gyro != Permutation::NONE {
        return None;
    }
    let windows = accelerated(log, motion, start.offset_s);
    let felt = |pose: usize, read: &Vector3<f64>| motion.attitude[pose] * (start.turned * read);
    let pairs: Vec<_> = windows.iter().map(|w| (w.acceleration, felt(w.pose, &w.read))).collect();
    let count = pairs.len().max(1) as f64;
    let [moved, felt] = pairs.iter().fold([Vector3::zeros(); 2], |s, (a, f)| [s[0] + a, s[1] + f]).map(|s| s / count);
    let (mut products, mut squares) = (0.0, [f64::MIN_POSITIVE; 2]);
    for (a, f) in &pairs {
        let (a, f) = (a - moved, f - felt);
        products += a.dot(&f);
        squares[0] += a.norm_squared();
        squares[1] += f.norm_squared();
    }
    if products <= 0.0 || products * products < EXPLAINS * squares[0] * squares[1] {
        return None;
    }
    let ratio = products / squares[1];
    let is_near = |(per_metre, _): &&(f64, &str)| (ratio / per_metre).ln().abs() < 0.5 * std::f64::consts::LN_2;
    if let Some((_, name)) = UNITS.iter().find(is_near) {
        return Some(Wrong::Unit(name, ratio));
    }
    let gravity = moved - felt;
    let is_gravity = (gravity.norm() / gravity_m_s2 - 1.0).abs() < IS_GRAVITY;
    (is_gravity && gravity.z < NEARER * gravity.norm()).then(|| Wrong::Up(axis(&(motion.turn.inverse() * -gravity))))
}

/// Says by what angle the vertical of a reference and gravity disagree, where a fit shows it: below the angle
/// at which a mounting costs nothing, nothing is said.
pub(super) fn tilted(fit: &Fitted, gravity_m_s2: f64) -> Option<String> {
    if !fit.has(TILT.start) {
        return None;
    }
    let sine = |point: &Point| point[TILT.start].hypot(point[TILT.start + 1]) / gravity_m_s2;
    let (angle_rad, ci95) = fit.number(&|point| sine(point).min(1.0).asin());
    (ci95[0] > LEVEL_RAD).then(|| {
        let [angle, half] = [angle_rad, 0.5 * (ci95[1] - ci95[0])].map(|a| short(a.to_degrees()));
        format!("the reference's vertical and gravity disagree by {angle}° ± {half}°: all of its frame is tilted")
    })
}

/// The axis of a file that comes nearest to a direction.
fn axis(up: &Vector3<f64>) -> Axis {
    match (up.iamax(), up[up.iamax()] > 0.0) {
        (1, true) => Axis::Stated(Up::Y),
        (1, false) => Axis::Stated(Up::MinusY),
        (2, true) => Axis::Stated(Up::Z),
        (2, false) => Axis::Stated(Up::MinusZ),
        _ => Axis::Other,
    }
}

impl Wrong {
    /// Returns what is wrong, and what to do.
    pub(super) fn words(self) -> (String, String) {
        match self {
            Self::Unit(name, ratio) => (
                format!(
                    "its positions accelerate some {} times as much as the accelerometer reads: {name} for m?",
                    rounded(ratio, 2)
                ),
                "give its positions in metres".into(),
            ),
            Self::Up(Axis::Stated(up)) => (
                format!("its {} axis points up: only so does gravity pull as the accelerometer reads", up.name()),
                format!("set up = \"{}\" under [reference]", up.name()),
            ),
            Self::Up(Axis::Other) => (
                "its x axis is vertical: gravity pulls along it by what the accelerometer reads".into(),
                "turn its positions and quaternions so that z is up".into(),
            ),
        }
    }
}
