//! The biases that are taken off a window's readings: from windows that share no reading with it,
//! or from a still stretch.

use std::ops::Range;

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::linear::{Linear, Part, ToEnd};
use super::median;
use super::recorded::Recorded;
use super::window::{Biases, Nine, Window};
use crate::error::{Error, Result};
use crate::motion::trajectory::Stretch;
use crate::numerics::order;
use crate::strapdown::linear::Square;
use crate::study::flown::Flown;
use crate::study::in_motion::InMotion;

/// From end errors to biases.
pub type ToBias = SMatrix<f64, 6, 9>;

/// A window that biases are fitted in.
pub struct Base {
    /// Window in which the biases are fitted.
    pub window: Window,
    /// Prediction of the linear model.
    pub linear: Linear,
    /// The stated sensor's errors in it.
    pub parts: Vec<Part>,
    /// The biases that fit it.
    pub biases: Biases,
    /// Map from its end errors to them.
    to_bias: ToBias,
    /// Their variances by the stated sensor.
    variance: Biases,
}

/// Least spread of end errors that a fit goes by: m, m/s, rad. Below it a sensor without noise
/// would make it singular.
const FLOOR: [f64; 3] = [1e-3, 1e-3, 1e-4];

impl Base {
    /// Fits the biases of a window about a first guess, by generalised least squares with the noise
    /// of the stated sensor.
    ///
    /// # Errors
    /// A proof mass that no integrator can step; motion in which the biases cannot be told apart.
    pub fn new(motion: &InMotion, window: Window, guess: &Biases) -> Result<Self> {
        let linear = Linear::new(motion, &window)?;
        let (parts, _) = linear.parts(motion)?;
        let mut spread = Square::from_diagonal(&Nine::from_fn(|i, _| FLOOR[i / 3].powi(2)));
        for part in &parts {
            if let Part::Noise { end, .. } = part {
                spread += **end;
            }
        }
        let fail = || {
            Error::new(
                format!("could not find the biases of the window from {:.3} s on", window.span_s[0]),
                "its motion does not tell them apart",
                "use longer windows (trajectory.compare.windows_s)",
            )
        };
        let weighted = spread.cholesky().ok_or_else(fail)?.solve(&linear.to_end).transpose();
        let inverse = (weighted * linear.to_end).try_inverse().ok_or_else(fail)?;
        let to_bias = inverse * weighted;
        let biases = guess + to_bias * window.error(motion, guess);
        Ok(Self { variance: inverse.diagonal(), window, linear, parts, biases, to_bias })
    }
}

/// The biases of one window.
pub struct Taken {
    /// Biases of both sensors, SI.
    pub biases: Biases,
    /// Source that they come from.
    pub source: Source,
}

/// Source of biases.
pub enum Source {
    /// Fitted in other windows.
    Others(Others),
    /// The mean of a still stretch.
    Still(Still),
}

/// Biases from the other windows.
pub struct Others {
    /// Places among the bases, with what their end errors do to the mean of the biases.
    pub bases: Vec<(usize, ToBias)>,
    /// Spread of the median over that of the mean.
    pub excess: f64,
    /// By what a random walk of unit K² has gone on between them and the window, s: of
    /// accelerometers and of gyros.
    pub walked_s: [f64; 2],
    /// Flights that they are of, where these are others than the window's.
    pub flights: Option<usize>,
}

/// Biases from a still stretch.
#[derive(Debug, Clone)]
pub struct Still {
    /// Its begin and end on the reference's clock, s.
    pub span_s: [f64; 2],
    /// The readings of it.
    pub readings: Range<usize>,
    /// Biases of both sensors, SI.
    pub biases: Biases,
    /// From body axes to north-east-down.
    attitude: UnitQuaternion<f64>,
    /// Readings of accelerometers and gyros in it without error, m/s² and rad/s.
    pub standing: [Vector3<f64>; 2],
}

/// The median of the biases of windows that share no reading with one; none where there is no such
/// window.
pub fn of_others(bases: &[Base], window: &Window) -> Option<Taken> {
    let places: Vec<usize> = (0..bases.len()).filter(|k| !bases[*k].window.meets(window)).collect();
    if places.is_empty() {
        return None;
    }
    let weight = |k: usize, component: usize| 1.0 / bases[k].variance[component];
    let sums = Biases::from_fn(|i, _| places.iter().map(|k| weight(*k, i)).sum());
    let biases = Biases::from_fn(|i, _| {
        let values: Vec<f64> = places.iter().map(|k| bases[*k].biases[i]).collect();
        let weights: Vec<f64> = places.iter().map(|k| weight(*k, i)).collect();
        median::weighted(&values, &weights)
    });
    let share = |k: usize| Biases::from_fn(|i, _| weight(k, i) / sums[i]);
    let own = places.iter().any(|k| bases[*k].window.flight == window.flight);
    let mut flights: Vec<usize> = places.iter().map(|k| bases[*k].window.flight).collect();
    flights.sort_unstable();
    flights.dedup();
    let walked = |first: usize| {
        let middle = |k: usize| 0.5 * (bases[k].window.span_s[0] + bases[k].window.span_s[1]);
        let part = |k: usize| share(k).fixed_rows::<3>(first).mean();
        let to: f64 = places.iter().map(|k| part(*k) * (middle(*k) - window.span_s[0]).abs()).sum();
        let pair = |j: &usize, k: &usize| part(*j) * part(*k) * (middle(*j) - middle(*k)).abs();
        let among: f64 = places.iter().flat_map(|j| places.iter().map(move |k| pair(j, k))).sum();
        (to - 0.5 * among).max(0.0)
    };
    let source = Source::Others(Others {
        bases: places.iter().map(|k| (*k, SMatrix::from_diagonal(&share(*k)) * bases[*k].to_bias)).collect(),
        excess: median::excess(places.len()),
        walked_s: if own { [walked(0), walked(3)] } else { [0.0; 2] },
        flights: (!own).then_some(flights.len()),
    });
    Some(Taken { biases, source })
}

/// A first guess: the median difference between readings and the reference's motion.
pub fn guess(recorded: &Recorded, flown: &Flown, motion: &InMotion) -> Biases {
    let (earth, back) = (motion.course.earth, motion.course.mounting().inverse());
    let mut apart: [Vec<f64>; 6] = Default::default();
    for piece in recorded.pieces.iter().filter(|piece| piece.len() > 1) {
        let (first, last) = (piece.start, piece.end - 1);
        let (from_s, steps) = (recorded.time_s[first], last - first);
        let over = Stretch { from_s, interval_s: (recorded.time_s[last] - from_s) / steps as f64, steps };
        let truth = recorded.trajectory.stretch(&earth, flown.lever_arm_m, over);
        for (k, sample) in (first..).zip(&truth.samples) {
            let force = recorded.force_m_s2[k] - back * sample.specific_force_m_s2;
            let rate = recorded.rate_rad_s[k] - back * sample.rate_rad_s;
            (0..3).for_each(|i| {
                apart[i].push(force[i]);
                apart[3 + i].push(rate[i]);
            });
        }
    }
    let mut medians = apart.into_iter().map(order::median);
    Biases::from_fn(|_, _| medians.next().flatten().unwrap_or_default())
}

/// The reference stands still below this speed, m/s.
const STANDS_M_S: f64 = 0.05;
/// Stretches are tried this far apart, s.
const STRIDE_S: f64 = 0.1;

/// The quietest stretch of this length during which the reference stands still.
///
/// # Errors
/// None is long enough or still.
pub fn still(recorded: &Recorded, flown: &Flown, motion: &InMotion) -> Result<Still> {
    let steps = (flown.still_s / recorded.interval_s).round().max(1.0) as usize;
    let stride = ((STRIDE_S / recorded.interval_s) as usize).max(1);
    let stands =
        |k: usize| recorded.trajectory.at(recorded.time_s[k], flown.lever_arm_m).velocity_m_s.norm() < STANDS_M_S;
    let unrest = |readings: &Range<usize>| {
        let n = readings.len() as f64;
        let rates = &recorded.rate_rad_s[readings.clone()];
        let mean = rates.iter().sum::<Vector3<f64>>() / n;
        rates.iter().map(|r| (r - mean).norm_squared()).sum::<f64>()
    };
    let begins = recorded.pieces.iter().flat_map(|p| (p.start..p.end.saturating_sub(steps)).step_by(stride));
    let stretches = begins.map(|k| k..k + steps).filter(|r| r.clone().step_by(stride).chain([r.end - 1]).all(stands));
    let quietest = stretches.map(|r| (unrest(&r), r)).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, readings)) = quietest else {
        return Err(Error::new(
            format!("could not find a still stretch in {}", recorded.imu),
            format!("the reference nowhere stays below {STANDS_M_S} m/s for {} s", flown.still_s),
            "shorten trajectory.compare.still_s, or take bias = \"others\"",
        ));
    };
    let span_s = [recorded.time_s[readings.start], recorded.time_s[readings.end - 1]];
    let earth = motion.course.earth;
    let middle = recorded.trajectory.at(0.5 * (span_s[0] + span_s[1]), flown.lever_arm_m).pose.attitude;
    let attitude = middle * motion.course.mounting();
    let up = Vector3::new(0.0, 0.0, -earth.gravity_m_s2(earth.start()));
    let standing = [attitude.inverse() * up, attitude.inverse() * earth.rate_rad_s(earth.start())];
    let mean = |values: &[Vector3<f64>]| values[readings.clone()].iter().sum::<Vector3<f64>>() / readings.len() as f64;
    let (force, rate) = (mean(&recorded.force_m_s2) - standing[0], mean(&recorded.rate_rad_s) - standing[1]);
    let biases = Biases::from_fn(|i, _| if i < 3 { force[i] } else { rate[i - 3] });
    Ok(Still { span_s, readings, biases, attitude, standing })
}

impl Still {
    /// Its length, s.
    pub fn seconds(&self) -> f64 {
        self.span_s[1] - self.span_s[0]
    }

    /// Covariance of the accelerometers' biases that attitude errors of the reference with these
    /// variances about north, east and down leave, (m/s²)².
    pub fn levelled(&self, variances: [f64; 3]) -> Matrix3<f64> {
        let turn = self.attitude.to_rotation_matrix().into_inner().transpose();
        let gravity = (self.attitude * self.standing[0]).cross_matrix();
        turn * gravity * Matrix3::from_diagonal(&variances.into()) * gravity.transpose() * turn.transpose()
    }
}

/// Keeps the shape of what is taken off and what it does to a window together.
pub fn at_end(to_end: &ToEnd, biases: &SMatrix<f64, 6, 6>) -> Square {
    to_end * biases * to_end.transpose()
}
