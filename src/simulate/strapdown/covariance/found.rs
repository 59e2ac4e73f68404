//! Computes what a still start finds of constant errors, and what it leaves of them; the attitude
//! that a run begins with.

use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::kernel::flight::Flight;
use crate::strapdown::family::{Column, Gain};
use crate::strapdown::linear::{Drive, Felt};

/// Effect of a still start on mean reading errors.
pub struct Found {
    /// Duration, s.
    pub seconds: f64,
    /// Errors at its end per unit of mean.
    pub state: Drive,
    /// Correction per unit of mean.
    pub taken: SMatrix<f64, 6, 6>,
    /// Correction of the gyros per radian of heading error.
    heading: Vector3<f64>,
}

/// Computes what levelling and the gyros' mean make of mean errors.
pub fn found(flight: &Flight) -> Found {
    let course = &flight.course;
    let start = course.truth.samples.first();
    let (turn, gravity) = start.map_or((Matrix3::identity(), 1.0), |s| {
        (s.attitude.to_rotation_matrix().into_inner(), course.standing()[0].norm())
    });
    // The levelled attitude turns an error to the north into a tilt about east.
    let tilt = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0) / gravity * turn;
    let earth = course.earth.rate_rad_s(course.place(0));
    let unseen = -turn.transpose() * earth.cross_matrix();
    let down = turn.transpose() * Matrix3::from_diagonal(&Vector3::z()) * turn;
    let mut state = Drive::zeros();
    state.fixed_view_mut::<3, 3>(0, 0).copy_from(&tilt);
    let mut taken = SMatrix::<f64, 6, 6>::zeros();
    taken.fixed_view_mut::<3, 3>(0, 0).copy_from(&down);
    taken.fixed_view_mut::<3, 3>(3, 0).copy_from(&(unseen * tilt));
    taken.fixed_view_mut::<3, 3>(3, 3).copy_from(&Matrix3::identity());
    let seconds = flight.clock().still_samples as f64 * flight.clock().sample_s();
    Found { seconds, state, taken, heading: unseen * Vector3::z() }
}

/// A constant that begins with what the still start has found of it.
pub fn column(gain: Gain, (mean, variance): (f64, f64), found: Option<&Found>, flight: &Flight) -> Column {
    let mut column = Column { state: SMatrix::zeros(), taken: SMatrix::zeros(), gain, mean, variance };
    if let Some(found) = found {
        let inputs = gain.mean(&Felt::standing(&flight.course), -found.seconds, found.seconds);
        column.state = found.state * inputs;
        column.taken = found.taken * inputs;
    }
    column
}

/// The attitude at the start.
pub fn alignment(flight: &Flight, found: Option<&Found>) -> Vec<Column> {
    let misalignment = flight.misalignment;
    let axes = [misalignment.tilt_sd_rad, misalignment.tilt_sd_rad, misalignment.heading_sd_rad];
    let given = axes.into_iter().enumerate().filter(|(axis, sd)| *sd > 0.0 && (*axis == 2 || found.is_none()));
    let column = |(axis, sd): (usize, f64)| {
        let mut column = column(Gain::None, (0.0, sd * sd), None, flight);
        column.state[axis] = 1.0;
        if let Some(found) = found {
            (0..3).for_each(|i| column.taken[3 + i] = found.heading[i]);
        }
        column
    };
    given.map(column).collect()
}
