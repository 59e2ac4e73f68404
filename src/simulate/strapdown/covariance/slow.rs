//! Slow errors with a time of their own in the linear model: a Gauss–Markov process, what dies out, a
//! sine. They have a place in it where that time is the same for all members.

use std::f64::consts::FRAC_PI_2;

use super::found::{Found, column};
use super::given::Given;
use crate::kernel::flight::Flight;
use crate::navigation::slow;
use crate::sensor::error_law::Shape;
use crate::sensor::{Sense, SensorTerm};
use crate::strapdown::family::{Column, Family, Gain, Process};

impl Given<'_> {
    /// The axes that have a term, each with its input and a number of its shape; `None` where that
    /// number is drawn.
    fn shaped(&self, term: SensorTerm, wanted: Shape) -> Option<Vec<(usize, usize, f64)>> {
        let first = if term.sense() == Sense::Gyro { 3 } else { 0 };
        let axes = (0..3).filter(|axis| self.moments[*axis] != (0.0, 0.0));
        axes.map(|axis| Some((axis, first + axis, self.tolerances[axis].shape(term, wanted)?))).collect()
    }

    /// A Gauss–Markov process; `None` where its correlation time is drawn.
    pub(super) fn markov(&self, term: SensorTerm, found: Option<&Found>, step_s: f64) -> Option<Family> {
        let squares = self.squares(term.sense());
        let mut process = ([f64::INFINITY; 6], [0.0; 6]);
        let (mut of_mean, mut with_end) = ([0.0; 6], [0.0; 6]);
        for (_, input, time_s) in self.shaped(term, Shape::Memory)? {
            // The model holds a process over a step. So lowered, one that forgets within a step has
            // the density that it has, 2 σ² τ.
            let half = 0.5 * step_s / time_s;
            let held = half.tanh() / half;
            (process.0[input], process.1[input]) = (time_s, squares[input] * held);
            if let Some(found) = found {
                let seconds = found.seconds;
                of_mean[input] = squares[input] * slow::markov(time_s, 1, seconds) / (seconds * seconds);
                with_end[input] = squares[input] * held * slow::mean_settling(time_s, seconds);
            }
        }
        let mut family = Family::new(Process::Markov { tau_s: process.0, variance: process.1 }, 1.0);
        if let Some(found) = found {
            family.found(&of_mean, &with_end, &found.state, &found.taken);
        }
        Some(family)
    }

    /// Returns the column of what dies out from the beginning of the run on; `None` where its time
    /// constant is drawn.
    pub(super) fn settling(&self, term: SensorTerm, flight: &Flight, found: Option<&Found>) -> Option<Vec<Column>> {
        let still_s = found.map_or(0.0, |found| found.seconds);
        let axes = self.shaped(term, Shape::Settling)?.into_iter();
        let one = |(axis, input, tau_s): (usize, usize, f64)| {
            column(Gain::Settling { input, still_s, tau_s }, self.moments[axis], found, flight)
        };
        Some(axes.map(one).collect())
    }

    /// A sine of any phase is a sine and a cosine, each with half its mean square; `None` where the
    /// frequency is drawn, or the phase within bounds.
    pub(super) fn sines(&self, term: SensorTerm, flight: &Flight, found: Option<&Found>) -> Option<Vec<Column>> {
        let still_s = found.map_or(0.0, |found| found.seconds);
        let mut columns = Vec::new();
        for (axis, input, omega_rad_s) in self.shaped(term, Shape::Frequency)? {
            let (mean, variance) = self.moments[axis];
            let mut add = |phase_rad: f64, moments: (f64, f64)| {
                columns.push(column(Gain::Sine { input, still_s, omega_rad_s, phase_rad }, moments, found, flight));
            };
            if self.tolerances[axis].has_any_phase(term) {
                let half = 0.5 * (mean * mean + variance);
                add(0.0, (0.0, half));
                add(FRAC_PI_2, (0.0, half));
            } else {
                add(self.tolerances[axis].shape(term, Shape::Phase)?, (mean, variance));
            }
        }
        Some(columns)
    }
}
