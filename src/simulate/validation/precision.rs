//! f32 against f64, member by member: rounding must stay far below the noise that is simulated.

use super::jobs::{Sine, job, masses};
use super::row::Row;
use crate::backend::cpu::outcomes;
use crate::control::Control;
use crate::error::Result;
use crate::kernel::job::Job;
use crate::sensor::Sensor;
use crate::statistics::Moments;
use crate::statistics::quantity::POSITION;
use crate::units::{MICRO_G, MILLI_G, STANDARD_GRAVITY_M_S2};

const MEMBERS: u64 = 256;

/// All rows: each integrator for 100 s under 1 g and a vibration, with a bias of 1 mg.
///
/// # Errors
/// Ctrl-C.
pub fn rows(control: &Control) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let mut last = None;
    for (mass, integrator) in masses() {
        let mut sensor = Sensor { proof_mass: Some(mass), ..Sensor::default() };
        sensor.accelerometer.bias_m_s2 = MILLI_G;
        sensor.accelerometer.velocity_random_walk_m_s_rts = 60.0 * MICRO_G / 2_f64.sqrt();
        let force = Sine { amplitude_m_s2: 5.0, frequency_hz: 3.0, offset_m_s2: STANDARD_GRAVITY_M_S2 };
        let job = job(sensor, MEMBERS, &[100.0], force, integrator);
        rows.push(Row::at_most(
            format!("f32 − f64 of {integrator} after 100 s, rms fraction of the noise drift"),
            difference(&job, &job, control)?,
            1e-3,
        ));
        last = Some(job);
    }
    if let Some(job) = last {
        // Control: other random numbers are not within rounding.
        let other = Job { seed: job.seed + 1, ..job.clone() };
        rows.push(Row::at_most("f32 − f64 with another seed", difference(&job, &other, control)?, 1e-3).control());
    }
    Ok(rows)
}

/// Rms over members of the difference in position, as a share of the spread of the f64 run.
fn difference(job: &Job, oracle: &Job, control: &Control) -> Result<f64> {
    let (twin, oracle) = (outcomes::<f32>(job, control)?, outcomes::<f64>(oracle, control)?);
    let spread = Moments::of(oracle.iter().map(|m| m[POSITION])).sd();
    let squares: f64 = twin.iter().zip(&oracle).map(|(a, b)| (a[POSITION] - b[POSITION]).powi(2)).sum();
    Ok((squares / MEMBERS as f64).sqrt() / spread)
}
