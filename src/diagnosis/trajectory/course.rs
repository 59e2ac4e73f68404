//! Dead reckoning of attitude with a sensor at a point of the parameters, and how each parameter
//! turns it.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::derivatives::{Both, Derivatives};
use super::integral::{Rule, cumulative, place};
use super::log::{Log, Motion};
use super::parameters::{
    ANCHOR, COSINES, DRIFT, FORCE_BIAS, FORCE_MATRIX, FORCE_PLACES, FORCE_WANDER, G_SENSITIVITY, GYRO_BIAS,
    GYRO_MISALIGNMENT, GYRO_OFF_DIAGONAL, GYRO_SCALE, GYRO_WANDER, MOUNTING, Point, clock_s, lowpass_s,
};

/// Holds what is fitted: readings, reference, and the rotation that the search starts from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case<'a> {
    /// Readings of the IMU, SI units.
    pub log: &'a Log,
    /// States how its readings change, where a low-pass of them can be seen.
    pub derivatives: Option<&'a Derivatives>,
    /// The poses of the reference.
    pub motion: &'a Motion,
    /// C₀, from the IMU's axes to the reference's body axes.
    pub turned: UnitQuaternion<f64>,
    /// Gravity of the place, m/s².
    pub gravity_m_s2: f64,
    /// N² of gyro and accelerometer, SI.
    pub random_walks: [f64; 2],
    /// Samples that are no reading (clipped, filled): their time is left out.
    pub masked: &'a [bool],
    /// IMU's stamps, in order, at which the reckoning goes through the reference anew: in the
    /// middle of what the gyro does not know, and of what the reference does not, s.
    pub cuts_s: &'a [f64],
    /// Holds what is taken to happen between readings.
    pub rule: Rule,
    /// The attitude that dead reckoning goes through.
    pub anchor: Anchor,
}

/// An attitude that dead reckoning goes through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    /// The reference's, in its middle.
    Reference,
    /// One that is itself to be found.
    Found {
        /// The sample at which it holds.
        sample: usize,
        /// From the IMU's axes to north-east-down.
        attitude: UnitQuaternion<f64>,
        /// Holds what turns it.
        turns: Turns,
    },
}

/// Holds what turns an attitude that was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turns {
    /// Parameters of the whole recording.
    AsAWhole,
    /// Each block of time by itself: noise of the gyro turns the attitude further and further, and
    /// what a block says of it holds within that block alone.
    ByBlock,
}

impl Anchor {
    /// Returns whether each block of time has its own.
    pub(super) fn is_by_block(self) -> bool {
        matches!(self, Self::Found { turns: Turns::ByBlock, .. })
    }

    /// The same with another thing to turn it.
    pub(super) fn turning(self, turns: Turns) -> Self {
        match self {
            Self::Reference => self,
            Self::Found { sample, attitude, .. } => Self::Found { sample, attitude, turns },
        }
    }

    /// Turned about north, east and down, where it is itself to be found.
    pub(super) fn turned(self, by_rad: Vector3<f64>) -> Self {
        match self {
            Self::Reference => self,
            Self::Found { sample, attitude, turns } => {
                Self::Found { sample, attitude: UnitQuaternion::from_scaled_axis(by_rad) * attitude, turns }
            }
        }
    }
}

impl Case<'_> {
    /// The IMU's stamp of a pose.
    pub(super) fn stamp_s(&self, point: &Point, pose: usize) -> f64 {
        let t = self.motion.time_s[pose];
        t + clock_s(point) + point[DRIFT] * (t - self.motion.middle_s())
    }

    /// Times that are left out, on the clock of the poses, s.
    pub(super) fn left_out_s(&self, point: &Point) -> Vec<f64> {
        let all = self.log.time_s.iter().zip(self.masked);
        all.filter(|(_, masked)| **masked).map(|(time_s, _)| time_s - clock_s(point)).collect()
    }

    /// Returns whether the fit turns a mounting that the search began with further. Next to free axes of the
    /// gyro only specific force tells a mounting, and only positions say what that should be.
    pub(super) fn refines_mounting(&self) -> bool {
        let halves = self.motion.halves;
        self.turned.angle() > 0.0 && halves.attitude && halves.position
    }

    /// C at a point.
    pub(super) fn mounting(&self, point: &Point) -> UnitQuaternion<f64> {
        self.turned * UnitQuaternion::from_scaled_axis(vector(point, MOUNTING.start))
    }

    /// cos(nπu), n = 1, 2, at a time.
    pub(super) fn cosines(&self, time_s: f64) -> [f64; COSINES] {
        let u = self.log.fraction(time_s);
        std::array::from_fn(|n| (std::f64::consts::PI * (n + 1) as f64 * u).cos())
    }
}

/// Three numbers in a row.
pub(super) fn vector(point: &Point, start: usize) -> Vector3<f64> {
    Vector3::new(point[start], point[start + 1], point[start + 2])
}

/// I + S of the gyro.
pub(super) fn gyro_matrix(point: &Point) -> Matrix3<f64> {
    let mut matrix = Matrix3::from_diagonal(&(vector(point, GYRO_SCALE.start).add_scalar(1.0)));
    for (n, at) in GYRO_OFF_DIAGONAL.into_iter().enumerate() {
        matrix[at] = point[GYRO_MISALIGNMENT.start + n];
    }
    matrix
}

/// I + S of the accelerometer.
pub(super) fn accelerometer_matrix(point: &Point) -> Matrix3<f64> {
    let mut matrix = Matrix3::identity();
    FORCE_PLACES.into_iter().zip(FORCE_MATRIX).for_each(|(at, p)| matrix[at] += point[p]);
    matrix
}

/// Sensitivity K of the gyro to specific force, (rad/s)/(m/s²).
pub(super) fn g_sensitivity(point: &Point) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| point[G_SENSITIVITY.start + 3 * i + j])
}

/// Holds what the sensors felt, and the attitude that their gyro leads to.
#[derive(Debug, Clone)]
pub(super) struct Course {
    /// Rate in the IMU's axes, in rad per second of the IMU's clock.
    pub rate: Vec<Vector3<f64>>,
    /// Specific force in the IMU's axes, m/s².
    pub force: Vec<Vector3<f64>>,
    /// From the IMU's axes to north-east-down, from the anchor on.
    pub attitude: Vec<UnitQuaternion<f64>>,
    /// (I + S)⁻¹ of the gyro.
    pub gyro: Matrix3<f64>,
    /// Seconds of the reference, which are true ones, in one of the IMU's clock.
    pub pace: f64,
}

impl Course {
    /// Reckoned with the parameters of a point.
    pub(super) fn of(case: &Case<'_>, point: &Point) -> Self {
        let gyro = gyro_matrix(point).try_inverse().unwrap_or_else(Matrix3::identity);
        let accelerometer = accelerometer_matrix(point).try_inverse().unwrap_or_else(Matrix3::identity);
        let k = g_sensitivity(point);
        let wander = |start: usize, time_s: f64| {
            let cosines = case.cosines(time_s);
            Vector3::from_fn(|i, _| (0..COSINES).map(|n| point[start + COSINES * i + n] * cosines[n]).sum::<f64>())
        };
        let (log, lowpass_s) = (case.log, lowpass_s(point));
        let pace = 1.0 / (1.0 + point[DRIFT]);
        // Straight lines cut the peaks of a smooth curve: each integral loses a twelfth of the
        // second derivative times the square of the interval. What was filtered is smooth; what was
        // not may vibrate.
        let cut = match case.rule {
            Rule::Straight => (lowpass_s / log.interval_s).powi(2).min(1.0),
            Rule::Cubic => 0.0,
        };
        // What a low-pass takes: v = y + τ dy/dt.
        let taken = |of: fn(&Both) -> &[Vector3<f64>], n: usize, integrals: f64| match case.derivatives {
            Some(d) if lowpass_s > 0.0 => of(&d.first)[n] * lowpass_s - of(&d.above)[n] * (integrals * cut),
            _ => Vector3::zeros(),
        };
        let (mut rate, mut force) = (Vec::with_capacity(log.rate.len()), Vec::with_capacity(log.rate.len()));
        for n in 0..log.rate.len() {
            let f = accelerometer
                * (log.force[n] + taken(|b| &b.force, n, 2.0)
                    - vector(point, FORCE_BIAS.start)
                    - wander(FORCE_WANDER.start, log.time_s[n]));
            let w = gyro
                * (log.rate[n] + taken(|b| &b.rate, n, 1.0)
                    - vector(point, GYRO_BIAS.start)
                    - wander(GYRO_WANDER.start, log.time_s[n])
                    - k * f);
            rate.push(w * pace);
            force.push(f);
        }
        let mut course = Self { attitude: reckoned(log, &rate, case.rule), rate, force, gyro, pace };
        match case.anchor {
            Anchor::Reference => course.through_reference(case, point),
            Anchor::Found { sample, attitude, .. } => {
                let off = UnitQuaternion::from_scaled_axis(vector(point, ANCHOR.start));
                let anchor = off * attitude * course.attitude[sample].inverse();
                course.attitude.iter_mut().for_each(|q| *q = anchor * *q);
            }
        }
        course
    }

    /// Lays each piece between two cuts through the reference, in its middle, so that errors that
    /// grow are smallest.
    fn through_reference(&mut self, case: &Case<'_>, point: &Point) {
        let log = case.log;
        let stamps: Vec<f64> = (0..case.motion.time_s.len()).map(|pose| case.stamp_s(point, pose)).collect();
        let mut anchors = Vec::with_capacity(case.cuts_s.len() + 1);
        let (mut samples, mut poses) = (0..0, 0..0);
        for cut_s in case.cuts_s.iter().chain(&[f64::INFINITY]) {
            samples = samples.end..log.time_s.partition_point(|t| t < cut_s);
            poses = poses.end..stamps.partition_point(|t| t < cut_s);
            // A piece without a pose is never asked for.
            if !poses.is_empty() {
                let middle = poses.start + poses.len() / 2;
                let imu = self.attitude_at(log, stamps[middle]);
                let anchor = case.motion.attitude[middle] * case.mounting(point) * imu.inverse();
                anchors.push((samples.clone(), anchor));
            }
        }
        for (samples, anchor) in anchors {
            self.attitude[samples].iter_mut().for_each(|q| *q = anchor * *q);
        }
    }

    /// The attitude at an IMU's stamp, which may lie between samples.
    pub(super) fn attitude_at(&self, log: &Log, stamp_s: f64) -> UnitQuaternion<f64> {
        let (k, u) = place(&log.time_s, stamp_s);
        let step = log.time_s[k + 1] - log.time_s[k];
        // The integral of a rate that changes evenly, from the sample on.
        let turn = (self.rate[k] + (self.rate[k + 1] - self.rate[k]) * (0.5 * u)) * (u * step);
        self.attitude[k] * UnitQuaternion::from_scaled_axis(turn)
    }
}

/// Attitudes from rates, the first one being none: coning made good by the one before.
pub(super) fn reckoned(log: &Log, rate: &[Vector3<f64>], rule: Rule) -> Vec<UnitQuaternion<f64>> {
    let angles = cumulative(&log.time_s, rate, rule);
    let mut attitude = UnitQuaternion::identity();
    let mut before = Vector3::zeros();
    let mut all = Vec::with_capacity(rate.len());
    all.push(attitude);
    for pair in angles.windows(2) {
        let now = pair[1] - pair[0];
        attitude *= UnitQuaternion::from_scaled_axis(now + before.cross(&now) / 12.0);
        attitude.renormalize();
        all.push(attitude);
        before = now;
    }
    all
}
