//! The readings of an IMU in motion, and its reference, on the IMU's own clock.

use nalgebra::{UnitQuaternion, Vector3};

use crate::model::Half;
use crate::motion::Place;
use crate::motion::file::format::Order;

/// Readings in order of time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Log {
    /// Since the IMU's first stamp, s.
    pub time_s: Vec<f64>,
    /// Rates as read, rad/s.
    pub rate: Vec<Vector3<f64>>,
    /// Specific forces as read, m/s².
    pub force: Vec<Vector3<f64>>,
    /// From one reading to the next, as a rule, s.
    pub interval_s: f64,
}

impl Log {
    /// Returns how long it lasts, s.
    pub(super) fn duration_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or_default() - self.time_s.first().copied().unwrap_or_default()
    }

    /// Fraction of the recording that has passed at a time.
    pub(super) fn fraction(&self, time_s: f64) -> f64 {
        (time_s - self.time_s[0]) / self.duration_s().max(f64::MIN_POSITIVE)
    }
}

/// Which halves of a pose the reference has: one of them at least.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Halves {
    /// Attitudes.
    pub attitude: bool,
    /// Positions.
    pub position: bool,
}

impl Halves {
    /// Returns whether one of them is there.
    pub(super) fn has(self, half: Half) -> bool {
        match half {
            Half::Attitude => self.attitude,
            Half::Position => self.position,
        }
    }

    /// The one that is not there.
    pub(super) fn lacks(self) -> Option<Half> {
        [Half::Attitude, Half::Position].into_iter().find(|half| !self.has(*half))
    }
}

/// Reference poses, north-east-down, in order of time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    /// On the clock of the IMU as both are stamped, s.
    pub time_s: Vec<f64>,
    /// Of the point that the reference follows, m; zero where it has none.
    pub position: Vec<Vector3<f64>>,
    /// From body axes to north-east-down; level where the reference has none.
    pub attitude: Vec<UnitQuaternion<f64>>,
    /// Row of its file of each pose.
    pub row: Vec<usize>,
    /// From one pose to the next, as a rule, s.
    pub interval_s: f64,
    /// Holds what of each pose is in it.
    pub halves: Halves,
    /// From the file's first pose to the zero of the IMU's times, s.
    pub zero_s: f64,
    /// States where the scalar of its quaternions stands, as they were read; none: it has none.
    pub quaternion: Option<Order>,
    /// Place of the first pose, where the file states latitudes.
    pub place: Option<Place>,
    /// From the file's own axes to north, east and down.
    pub turn: UnitQuaternion<f64>,
}

impl Motion {
    /// Those poses whose stamps on a clock that stamps so much later lie well within a log.
    pub(super) fn within(&self, log: &Log, shift_s: f64) -> Self {
        let [first, last] = [log.time_s.first(), log.time_s.last()].map(|t| t.copied().unwrap_or_default());
        let inside = |t: &f64| t + shift_s >= first + log.interval_s && t + shift_s <= last - log.interval_s;
        let from = self.time_s.iter().position(inside).unwrap_or_default();
        let to = self.time_s.iter().rposition(inside).map_or(self.time_s.len(), |k| k + 1);
        self.part(from, to)
    }

    /// On a clock that stamps so much later.
    pub(super) fn shifted(&self, shift_s: f64) -> Self {
        Self {
            time_s: self.time_s.iter().map(|t| t + shift_s).collect(),
            zero_s: self.zero_s - shift_s,
            ..self.clone()
        }
    }

    /// The poses from one to another, the latter left out.
    pub(super) fn part(&self, from: usize, to: usize) -> Self {
        Self {
            time_s: self.time_s[from..to].to_vec(),
            position: self.position[from..to].to_vec(),
            attitude: self.attitude[from..to].to_vec(),
            row: self.row[from..to].to_vec(),
            ..*self
        }
    }

    /// Without the poses in some ranges of places.
    pub(super) fn without(&self, ranges: &[[usize; 2]]) -> Self {
        let kept = |k: &usize| ranges.iter().all(|[from, to]| !(*from..*to).contains(k));
        let places: Vec<usize> = (0..self.time_s.len()).filter(kept).collect();
        Self {
            time_s: places.iter().map(|k| self.time_s[*k]).collect(),
            position: places.iter().map(|k| self.position[*k]).collect(),
            attitude: places.iter().map(|k| self.attitude[*k]).collect(),
            row: places.iter().map(|k| self.row[*k]).collect(),
            ..*self
        }
    }

    /// The middle of the time that it covers, s.
    pub(super) fn middle_s(&self) -> f64 {
        0.5 * (self.time_s.first().copied().unwrap_or_default() + self.time_s.last().copied().unwrap_or_default())
    }
}
