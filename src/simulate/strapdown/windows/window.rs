//! One window: the reference's truth over it, and what dead reckoning from the reference's state
//! makes of the readings.

use std::sync::Arc;

use nalgebra::{SVector, Vector3};

use super::recorded::Recorded;
use crate::kernel::cpu::navigate::roll_pitch_heading;
use crate::kernel::flight::Vertical;
use crate::kernel::truth_step::TimeFactor;
use crate::motion::Earth;
use crate::motion::mechanisation::{Difference, Increment, Navigator, State, integrals};
use crate::motion::trajectory::Stretch;
use crate::study::flown::Flown;
use crate::study::in_motion::InMotion;

/// Errors of position (m), velocity (m/s), and roll, pitch and heading (rad).
pub type Nine = SVector<f64, 9>;
/// Biases of accelerometers (m/s²) and gyros (rad/s) along body axes.
pub type Biases = SVector<f64, 6>;

/// A window of a recorded flight.
#[derive(Debug, Clone)]
pub struct Window {
    /// Its length as the study gives it, s.
    pub seconds: f64,
    /// When it begins and ends on the reference's clock, s.
    pub span_s: [f64; 2],
    /// The rows of the log at its ends.
    pub rows: [usize; 2],
    /// Which flight it is of.
    pub flight: usize,
    /// The truth over it.
    pub course: Arc<TimeFactor>,
    /// Standard deviations of the truth's position, m, and velocity, m/s, along each axis.
    pub reference: [f64; 2],
    /// Readings integrated, biases and all.
    increments: Vec<Increment>,
}

impl Window {
    /// The window of `steps` intervals that begins with this reading.
    pub fn new(recorded: &Recorded, asked: Asked<'_>, first: usize, steps: usize) -> Self {
        let last = first + steps;
        let span_s = [recorded.time_s[first], recorded.time_s[last]];
        let interval_s = (span_s[1] - span_s[0]) / steps as f64;
        let earth = earth_at(recorded, &asked, span_s[0]);
        let over = Stretch { from_s: span_s[0], interval_s, steps };
        let truth = recorded.trajectory.stretch(&earth, asked.flown.lever_arm_m, over);
        let of = |values: &[Vector3<f64>]| integrals(&values[first..=last], interval_s);
        let both = of(&recorded.rate_rad_s).into_iter().zip(of(&recorded.force_m_s2));
        Self {
            seconds: asked.seconds,
            span_s,
            rows: [recorded.row[first], recorded.row[last]],
            flight: asked.flight,
            reference: recorded.trajectory.departure.of_spline(),
            course: Arc::new(TimeFactor::new(truth, earth, asked.motion.course.mounting())),
            increments: both.map(|(rotation_rad, velocity_m_s)| Increment { rotation_rad, velocity_m_s }).collect(),
        }
    }

    /// Intervals between its readings.
    pub fn steps(&self) -> usize {
        self.increments.len()
    }

    /// Error at its end of the navigator that begins with the reference's state and takes these
    /// biases off the readings.
    pub fn error(&self, motion: &InMotion, biases: &Biases) -> Nine {
        let (course, truth) = (&self.course, &self.course.truth);
        let (Some(first), Some(last)) = (truth.samples.first(), truth.samples.last()) else { return Nine::zeros() };
        let dt = truth.interval_s;
        let held = motion.vertical == Vertical::Held;
        let start = State::at_start(&course.earth, first);
        let mut navigator = Navigator::new(course.earth, motion.mechanisation, dt, start);
        let (force, rate) = (biases.fixed_rows::<3>(0) * dt, biases.fixed_rows::<3>(3) * dt);
        for (increment, sample) in self.increments.iter().zip(&truth.samples[1..]) {
            let rotation_rad = increment.rotation_rad - rate;
            navigator.step(Increment { rotation_rad, velocity_m_s: increment.velocity_m_s - force });
            if held {
                navigator.state.hold_vertical(&course.earth, sample);
            }
        }
        let difference = Difference::of(&navigator.state, last);
        let turn = roll_pitch_heading(difference.attitude_rad, course.heading_rad(self.steps() as u64));
        let parts = [difference.position_m, difference.velocity_m_s, turn];
        Nine::from_fn(|i, _| parts[i / 3][i % 3])
    }

    /// Returns whether it shares time with another window of the same flight.
    pub fn meets(&self, other: &Self) -> bool {
        self.flight == other.flight && self.span_s[0] < other.span_s[1] && other.span_s[0] < self.span_s[1]
    }
}

/// Purpose of a window.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// Study that the windows are compared with.
    pub motion: &'a InMotion,
    /// Recorded flight of the study.
    pub flown: &'a Flown,
    /// Length of the window, s.
    pub seconds: f64,
    /// Number of the flight.
    pub flight: usize,
}

/// The Earth as it is where a window begins.
fn earth_at(recorded: &Recorded, asked: &Asked<'_>, time_s: f64) -> Earth {
    let earth = asked.motion.course.earth;
    let position = |t: f64| recorded.trajectory.at(t, asked.flown.lever_arm_m).pose.position_m;
    let moved = position(time_s) - position(0.0);
    // Metres along the meridian, as if they had been flown in a second.
    let place = earth.start().moved(earth.place_rates(earth.start(), moved), 1.0);
    Earth { latitude_rad: earth.latitude_rad.map(|_| place.latitude_rad), height_m: place.height_m, ..earth }
}
