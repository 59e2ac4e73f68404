//! States where the search starts next to a reference that has no attitudes: the clocks laid on
//! each other, the attitude at one instant, and the gyro's bias.
//!
//! What a reference's positions say of specific force, p̈ − g, is as long as what the accelerometer
//! reads, however the IMU is turned: that shift of the clocks is taken at which both lengths go
//! together best. Over some seconds the gyro's bias turns little, so that the rotation of what it
//! reckons onto the reference has a closed form (Wahba's problem; Markley, JAS 36, 1988). From
//! there the fit itself goes on over stretches twice as long each time.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::course::{Anchor, Case, Course, Turns, reckoned, vector};
use super::fit::Fit;
use super::integral::{Rule, between, cumulative, place};
use super::log::{Log, Motion};
use super::parameters::{ANCHOR, FORCE_BIAS, GYRO_BIAS, PARAMETERS, Point};
use super::rates::SHIFTS_S;
use super::start::{Start, nearest, refined};
use crate::control::{Control, Stopped};

/// Over which positions are differenced twice, s: from one to the next. The longer ones for
/// positions that are noisy or far apart.
const SPACINGS_S: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];
/// Most instants that are compared.
const MOST: usize = 2000;
/// Fewest instants that tell anything.
const FEWEST: usize = 10;
/// The first stretch, s, and in poses.
const FIRST: (f64, usize) = (10.0, 40);
/// Fraction of the variance of one that the other explains, above which they go together.
pub(super) const ALIKE: f64 = 0.3;

/// Specific forces over the same windows, in the axes of the reference and in those of the IMU at
/// its first sample.
struct Pairs {
    reference: Vec<Vector3<f64>>,
    read: Vec<Vector3<f64>>,
}

/// Holds what gyro and accelerometer lead to from the first sample on: the double integral of the
/// specific force, without gravity.
struct Reckoned {
    velocity: Vec<Vector3<f64>>,
    way: Vec<Vector3<f64>>,
}

impl Reckoned {
    fn of(log: &Log, felt: &[Vector3<f64>]) -> Self {
        let velocity = cumulative(&log.time_s, felt, Rule::Straight);
        let way = cumulative(&log.time_s, &velocity, Rule::Straight);
        Self { velocity, way }
    }

    /// Second differences at poses that are `reach` apart, next to those of the reference.
    fn pairs(&self, (log, motion): (&Log, &Motion), reach: usize, shift_s: f64, gravity_m_s2: f64) -> Pairs {
        let (first, last) = (log.time_s[0], log.time_s[log.time_s.len() - 1]);
        let at = |t: f64| between(&log.time_s, &self.way, &self.velocity, place(&log.time_s, t + shift_s));
        let count = motion.time_s.len();
        let (mut reference, mut read) = (Vec::new(), Vec::new());
        for k in (reach..count.saturating_sub(reach)).step_by((count / MOST).max(1)) {
            let times = [motion.time_s[k - reach], motion.time_s[k], motion.time_s[k + reach]];
            let [before, after] = [times[1] - times[0], times[2] - times[1]];
            let even = (before / after - 1.0).abs() < 0.01 && after < 1.5 * reach as f64 * motion.interval_s;
            if !even || times[0] + shift_s < first || times[2] + shift_s > last {
                continue;
            }
            let way = motion.position[k + reach] - motion.position[k] * 2.0 + motion.position[k - reach];
            reference.push(way / (before * after) - Vector3::new(0.0, 0.0, gravity_m_s2));
            read.push((at(times[2]) - at(times[1]) * 2.0 + at(times[0])) / (before * after));
        }
        Pairs { reference, read }
    }
}

impl Pairs {
    /// Squared correlation of their lengths.
    fn lengths(&self) -> f64 {
        if self.read.len() < FEWEST {
            return 0.0;
        }
        let n = self.read.len() as f64;
        let means = [&self.reference, &self.read].map(|v| v.iter().map(Vector3::norm).sum::<f64>() / n);
        let (mut both, mut one, mut other) = (0.0, 0.0, 0.0);
        for (a, b) in self.reference.iter().zip(&self.read) {
            let (a, b) = (a.norm() - means[0], b.norm() - means[1]);
            (both, one, other) = (both + a * b, one + a * a, other + b * b);
        }
        if both > 0.0 { both * both / (one * other).max(f64::MIN_POSITIVE) } else { 0.0 }
    }

    /// The rotation of what is read onto the reference, and how sure it is of heading: what goes
    /// together to the sides over what does not go together at all.
    fn turn(&self) -> (UnitQuaternion<f64>, f64) {
        if self.reference.len() < FEWEST {
            return (UnitQuaternion::identity(), 0.0);
        }
        let both = self.reference.iter().zip(&self.read);
        let products = both.clone().fold(Matrix3::zeros(), |sum, (a, b)| sum + a * b.transpose());
        let turn = nearest(&products);
        let left: f64 = both.map(|(a, b)| (a - turn * b).norm_squared()).sum();
        let sure = products.singular_values()[1] / left.sqrt().max(f64::MIN_POSITIVE);
        (UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn)), sure)
    }

    /// Fraction of the reference's variance that what is read explains where both are in the same
    /// axes.
    fn explained(&self) -> f64 {
        if self.reference.len() < FEWEST {
            return 0.0;
        }
        let mean = self.reference.iter().sum::<Vector3<f64>>() / self.reference.len() as f64;
        let left: f64 = self.reference.iter().zip(&self.read).map(|(a, b)| (a - b).norm_squared()).sum();
        let all: f64 = self.reference.iter().map(|a| (a - mean).norm_squared()).sum();
        1.0 - left / all.max(f64::MIN_POSITIVE)
    }
}

/// Distances of poses, each once, that the spacings come to.
fn reaches(motion: &Motion) -> Vec<usize> {
    let mut all = SPACINGS_S.map(|s| ((s / motion.interval_s).round() as usize).max(1)).to_vec();
    all.dedup();
    all.retain(|reach| 4 * reach < motion.time_s.len());
    all
}

/// The outcome of the search.
pub(super) struct Found {
    /// States where the search starts.
    pub start: Start,
    /// The attitude that dead reckoning goes through.
    pub anchor: Anchor,
    /// By how much that axis of the IMU that turns least does turn, root mean square, rad.
    pub least_turn_rad: f64,
}

/// Aligns the clocks, then finds attitude and gyro bias.
///
/// # Errors
/// When stopped.
pub(super) fn start(case: &Case<'_>, control: &Control) -> Result<Found, Stopped> {
    let (log, motion, gravity_m_s2) = (case.log, case.motion, case.gravity_m_s2);
    let both = (log, motion);
    let attitude = reckoned(log, &log.rate, Rule::Straight);
    let felt: Vec<Vector3<f64>> = attitude.iter().zip(&log.force).map(|(q, f)| q * f).collect();
    let raw = Reckoned::of(log, &felt);
    let mut offset = (0.0, ALIKE);
    for reach in reaches(motion) {
        control.go_on()?;
        let score = |shift_s: f64| raw.pairs(both, reach, shift_s, gravity_m_s2).lengths();
        let count = (SHIFTS_S.0 / SHIFTS_S.1) as i32;
        let mut best = (0.0, 0.0);
        for shift_s in (-count..=count).map(|k| f64::from(k) * SHIFTS_S.1) {
            control.go_on()?;
            let score = score(shift_s);
            if score > best.1 {
                best = (shift_s, score);
            }
        }
        if best.1 > offset.1 {
            offset = (refined(best.0, SHIFTS_S.1, score), best.1);
        }
    }
    let motion = &motion.shifted(offset.0).within(log, 0.0);
    let mut stretch = Stretch::best((log, motion), &raw, gravity_m_s2, control)?;
    let sample = place(&log.time_s, stretch.middle_s(motion)).0;
    let mut anchor = Anchor::Found { sample, attitude: stretch.turn * attitude[sample], turns: Turns::AsAWhole };
    let mut point: Point = [0.0; PARAMETERS];
    loop {
        let whole = stretch.is_all(motion);
        let free: Vec<usize> = GYRO_BIAS.chain(ANCHOR).chain(FORCE_BIAS.filter(|_| whole)).collect();
        let part = motion.part(stretch.from, stretch.to);
        let fit = Fit::new(&Case { motion: &part, anchor, ..*case }, &point, &free, control)?;
        point = fit.linear.solve(&free, |_| true).point;
        anchor = anchor.turned(vector(&point, ANCHOR.start));
        ANCHOR.for_each(|p| point[p] = 0.0);
        if whole {
            break;
        }
        stretch = stretch.doubled(motion);
    }
    let course = Course::of(&Case { motion, anchor, ..*case }, &point);
    let felt: Vec<Vector3<f64>> = course.attitude.iter().zip(&course.force).map(|(q, f)| q * f).collect();
    let led = Reckoned::of(log, &felt);
    let alike = |reach: usize| led.pairs((log, motion), reach, 0.0, gravity_m_s2).explained();
    let explained = reaches(motion).into_iter().map(alike).fold(0.0, f64::max);
    let biases = [GYRO_BIAS, FORCE_BIAS].map(|range| vector(&point, range.start));
    let turns = |axis: usize| {
        let directions: Vec<Vector3<f64>> = course.attitude.iter().map(|q| q * Vector3::ith(axis, 1.0)).collect();
        let count = directions.len() as f64;
        let mean = directions.iter().sum::<Vector3<f64>>() / count;
        (directions.iter().map(|d| (d - mean).norm_squared()).sum::<f64>() / count).sqrt()
    };
    Ok(Found {
        start: Start::as_given(offset.0, explained, biases),
        anchor: anchor.turning(Turns::ByBlock),
        least_turn_rad: (0..3).map(turns).fold(f64::INFINITY, f64::min),
    })
}

/// Poses from one to another, and the rotation of the IMU's first axes onto the reference's there.
struct Stretch {
    from: usize,
    to: usize,
    turn: UnitQuaternion<f64>,
}

impl Stretch {
    /// The one of the first length in which the body accelerates most to the sides, by which
    /// heading is told.
    fn best(
        (log, motion): (&Log, &Motion),
        raw: &Reckoned,
        gravity_m_s2: f64,
        control: &Control,
    ) -> Result<Self, Stopped> {
        let count = motion.time_s.len();
        let length = ((FIRST.0 / motion.interval_s).round() as usize).max(FIRST.1).min(count);
        let spacings = reaches(motion);
        let mut best: Option<(f64, Self)> = None;
        for from in (0..=count - length).step_by((length / 2).max(1)) {
            control.go_on()?;
            let (from, to) = (from, from + length);
            let part = motion.part(from, to);
            for reach in spacings.iter().copied().filter(|reach| 4 * reach < length) {
                let (turn, sure) = raw.pairs((log, &part), reach, 0.0, gravity_m_s2).turn();
                if best.as_ref().is_none_or(|b| sure > b.0) {
                    best = Some((sure, Self { from, to, turn }));
                }
            }
        }
        Ok(best.map_or(Self { from: 0, to: count, turn: UnitQuaternion::identity() }, |b| b.1))
    }

    fn middle_s(&self, motion: &Motion) -> f64 {
        0.5 * (motion.time_s[self.from] + motion.time_s[self.to - 1])
    }

    fn is_all(&self, motion: &Motion) -> bool {
        self.from == 0 && self.to == motion.time_s.len()
    }

    fn doubled(&self, motion: &Motion) -> Self {
        let half = (self.to - self.from).div_ceil(2);
        Self { from: self.from.saturating_sub(half), to: (self.to + half).min(motion.time_s.len()), turn: self.turn }
    }
}
