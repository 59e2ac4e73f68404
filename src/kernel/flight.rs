//! One ensemble of six-axis sensors carried along a course: three one-axis jobs, what couples their
//! axes, and how each member is aligned at the start.
//!
//! Each axis is a [`Job`] of its own, an accelerometer and a gyro, whose readings the one-axis
//! kernel makes; `navigate` makes position of them. Axes differ in their seed, so that the same
//! numbers are drawn apart.

use std::sync::Arc;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::aiding::Fix;
use super::chained::Once;
use super::environment::Follow;
use super::job::{Clock, Job};
use super::truth_step::TimeFactor;
use crate::rng::{Philox, Stream};

/// The seed of an axis: the ensemble's own for the first, so that it draws what a study of one axis
/// draws. Keys of Philox may be anything; the odd constant (2⁶⁴ over the golden ratio) keeps those
/// of neighbouring seeds apart.
pub fn axis_seed(seed: u64, axis: u64) -> u64 {
    seed ^ axis.wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

/// Navigation of the vertical channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Vertical {
    /// By the inertial sensors alone: its error grows without bound, e-fold in 570 s / 2.
    #[default]
    Free,
    /// By an aid without error, such as a barometer would be.
    Held,
}

/// Coupling of a reading to another axis or to the other instrument, SI. Rows are the axes that
/// read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coupling {
    /// Accelerometer reading per specific force along each axis, 1: misalignment.
    pub force_to_force: Matrix3<f64>,
    /// Gyro reading per rate about each axis, 1: scale factor on the diagonal, misalignment next to
    /// it.
    pub rate_to_rate: Matrix3<f64>,
    /// Gyro reading per specific force along each axis, rad/s per m/s²: g-sensitivity.
    pub force_to_rate: Matrix3<f64>,
}

/// Numbers of a coupling.
pub const COUPLINGS: usize = 27;

impl Coupling {
    /// Row by row, matrix by matrix.
    pub fn numbers(&self) -> [f64; COUPLINGS] {
        let matrices = [&self.force_to_force, &self.rate_to_rate, &self.force_to_rate];
        std::array::from_fn(|i| matrices[i / 9][(i % 9 / 3, i % 3)])
    }
}

/// Standard deviations of the attitude that a member begins with, about the axes of
/// north-east-down, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Misalignment {
    /// About north and east. After a still start, levelling takes its place.
    pub tilt_sd_rad: f64,
    /// Standard deviation of the initial heading, rad.
    pub heading_sd_rad: f64,
}

/// An ensemble of six-axis sensors along one trajectory.
#[derive(Clone)]
pub struct Flight {
    /// An accelerometer and a gyro along each body axis; clock and number of members are the same.
    pub axes: [Job; 3],
    /// Coupling of each member; `None` where nothing does.
    pub coupling: Option<Arc<dyn Fn(u64) -> Coupling + Send + Sync>>,
    /// Errors that follow temperature and late stamps, per member; `None` where nothing does.
    pub follow: Option<Arc<dyn Fn(u64) -> Follow + Send + Sync>>,
    /// Says whether the instants of samples are drawn.
    pub jitters: bool,
    /// True motion, sampled at the sensor's rate.
    pub course: Arc<TimeFactor>,
    /// Navigation of the vertical channel.
    pub vertical: Vertical,
    /// Attitude errors at the start.
    pub misalignment: Misalignment,
    /// Fixes that aid the navigation, in the order of time; empty where nothing does.
    pub fixes: Arc<Vec<Fix>>,
    /// Error of the navigator itself, on perfect readings, at each report sample: position (m) and velocity (m/s) along
    /// north, east and down, and roll, pitch and heading (rad). Every member has it; empty where none is counted.
    pub own: Arc<Vec<[f64; 9]>>,
}

/// State with which a member begins to navigate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Begin {
    /// Attitude error, four times the modified Rodrigues vector, rad.
    pub attitude: [f64; 3],
    /// Correction of the accelerometers' readings from here on, m/s².
    pub accelerometer: [f64; 3],
    /// Correction of the gyros', rad/s.
    pub gyro: [f64; 3],
}

impl Flight {
    /// Discrete time: interval, samples, report times.
    pub fn clock(&self) -> &Clock {
        &self.axes[0].clock
    }

    /// Number of members of the ensemble.
    pub fn members(&self) -> u64 {
        self.axes[0].members
    }

    /// Seed of the ensemble.
    pub fn seed(&self) -> u64 {
        self.axes[0].seed
    }

    /// The navigator's own error after this many samples; none where nothing is reported.
    pub fn own_at(&self, samples: u64) -> [f64; 9] {
        let report = self.clock().report_samples.binary_search(&samples);
        report.ok().and_then(|report| self.own.get(report)).copied().unwrap_or_default()
    }

    /// Number of members times samples.
    pub fn member_steps(&self) -> u64 {
        self.members().saturating_mul(self.clock().samples)
    }

    /// The navigation's start of a member whose axes' own mean errors over the still start are
    /// these: accelerometer (m/s²) and gyro (rad/s) of each. What couples the axes stands still as
    /// well.
    pub fn aligned(&self, member: u64, means: [(f64, f64); 3]) -> Begin {
        let mut mean = (Vector3::from_fn(|i, _| means[i].0), Vector3::from_fn(|i, _| means[i].1));
        if let Some(coupling) = &self.coupling {
            let (coupling, [force, rate]) = (coupling(member), self.course.standing());
            mean.0 += coupling.force_to_force * force;
            mean.1 += coupling.rate_to_rate * rate + coupling.force_to_rate * force;
        }
        if let Some(follow) = &self.follow {
            let [force, rate] = follow(member).standing(self.course.standing(), self.course.standing_warmer_k());
            mean.0 += force;
            mean.1 += rate;
        }
        self.begin(member, Some(mean))
    }

    /// Three standard normal numbers of which a member's first attitude is made.
    fn turns(&self, member: u64) -> [f64; 3] {
        let (seed, stream) = (self.seed(), Stream::Start);
        match &self.axes[0].chained {
            None => {
                let mut draw = Philox::new(seed, member, stream);
                std::array::from_fn(|_| draw.normal())
            }
            Some(chained) => {
                std::array::from_fn(|i| chained.once(Once { seed, counter: i as u32, stream: stream as u32 }, member))
            }
        }
    }

    /// Heading of the vehicle at a sample, counted from the end of the still start, rad.
    pub fn heading_rad(&self, sample: u64) -> f64 {
        self.course.heading_rad(sample)
    }

    /// The navigation's start of a member whose mean reading errors over the still start are these
    /// (m/s², rad/s), in body axes.
    ///
    /// Levelling turns the mean specific force into the vertical; what its size then departs from
    /// gravity by is taken for a bias along it. The gyros' mean, less the Earth's rate as the
    /// levelled attitude sees it, is taken for their bias.
    pub fn begin(&self, member: u64, mean: Option<(Vector3<f64>, Vector3<f64>)>) -> Begin {
        let [north, east, down] = self.turns(member);
        let Misalignment { tilt_sd_rad, heading_sd_rad } = self.misalignment;
        let Some((accelerometer, gyro)) = mean else {
            let turn = Vector3::new(tilt_sd_rad * north, tilt_sd_rad * east, heading_sd_rad * down);
            return Begin { attitude: rodrigues(&UnitQuaternion::from_scaled_axis(turn)), ..Begin::default() };
        };
        let Some(start) = self.course.truth.samples.first() else { return Begin::default() };
        let [standing, _] = self.course.standing();
        let felt = standing + accelerometer;
        let vertical = start.attitude * standing;
        let level =
            Rotation3::rotation_between(&(start.attitude * felt), &vertical).unwrap_or_else(Rotation3::identity);
        let heading = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, heading_sd_rad * down));
        let error = heading * UnitQuaternion::from_rotation_matrix(&level);
        let size = felt.norm();
        let along = if size > 0.0 { felt * ((size - standing.norm()) / size) } else { Vector3::zeros() };
        let earth = self.course.earth.rate_rad_s(self.course.place(0));
        let unseen = start.attitude.inverse() * (earth - error.inverse() * earth);
        Begin { attitude: rodrigues(&error), accelerometer: along.into(), gyro: (gyro + unseen).into() }
    }
}

/// Four times the modified Rodrigues vector of a rotation: tan(angle/4) along its axis, times four.
/// Near zero, the rotation vector.
fn rodrigues(turn: &UnitQuaternion<f64>) -> [f64; 3] {
    let (w, v) = if turn.w < 0.0 { (-turn.w, -turn.imag()) } else { (turn.w, turn.imag()) };
    (v * (4.0 / (1.0 + w))).into()
}
