//! Computes the navigator's own error along a flight, on perfect readings: no spread, the same for
//! every member, and corrected by the fixes as theirs are. The kernels integrate errors about the truth;
//! this one is added to what they report.

use nalgebra::Vector3;

use crate::kernel::aiding::{self, Fix};
use crate::kernel::cpu::navigate::roll_pitch_heading;
use crate::kernel::flight::{Flight, Vertical};
use crate::motion::mechanisation::{Correction, Difference, Increment, Run, increments};
use crate::study::in_motion::InMotion;

/// At the report samples of a flight: position (m) and velocity (m/s) along north, east and down, and roll, pitch and
/// heading (rad).
pub fn own_error(motion: &InMotion, flight: &Flight) -> Vec<[f64; 9]> {
    of_increments(motion, flight, &increments(&flight.course.truth))
}

/// Of a navigator that is given these increments.
pub fn of_increments(motion: &InMotion, flight: &Flight, increments: &[Increment]) -> Vec<[f64; 9]> {
    let held = flight.vertical == Vertical::Held;
    let run = Run { earth: flight.course.earth, integrator: motion.mechanisation, truth: &flight.course.truth, held };
    let errors = run.errors(increments, |sample, error| {
        aiding::at(&flight.fixes, sample as u64).map(|(_, fix)| correction(fix, error))
    });
    let clock = flight.clock();
    let at = |report: &u64| {
        let sample = report - clock.still_samples;
        let Some(error) = errors.get(sample as usize) else { return [0.0; 9] };
        let turn = roll_pitch_heading(error.attitude_rad, flight.heading_rad(sample));
        let mut all: [f64; 9] = std::array::from_fn(|i| [error.position_m, error.velocity_m_s, turn][i / 3][i % 3]);
        if held {
            (all[2], all[5]) = (0.0, 0.0);
        }
        all
    };
    clock.report_samples.iter().map(at).collect()
}

/// Returns what a fix without noise takes off an error.
fn correction(fix: &Fix, error: &Difference) -> Correction {
    let seen = [error.velocity_m_s, error.position_m];
    let rows = |first: usize| {
        Vector3::from_fn(|i, _| fix.gain[first + i].iter().enumerate().map(|(k, g)| g * seen[k / 3][k % 3]).sum())
    };
    let error = Difference { attitude_rad: rows(0), velocity_m_s: rows(3), position_m: rows(6) };
    Correction { error, force_m_s2: rows(9), rate_rad_s: rows(12) }
}
