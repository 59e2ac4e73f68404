//! CPU in f32 against a GPU: the same study, percentile by percentile, for every integrator and with everything on.

use super::jobs::{Place, Sine, job, masses};
use super::row::Row;
use crate::control::Control;
use crate::error::Result;
use crate::kernel::job::Job;
use crate::sensor::Sensor;
use crate::statistics::Statistics;
use crate::units::{DEGREE_PER_HOUR, MICRO_G, MILLI_G};

const MEMBERS: u64 = 2048;

/// All rows for one GPU.
///
/// # Errors
/// As the backends.
pub fn rows(gpu: &mut Place, control: &Control) -> Result<Vec<Row>> {
    let mut cpu = Place::cpu(control);
    let mut rows = Vec::new();
    for (mass, integrator) in masses() {
        let mut sensor = Sensor { proof_mass: Some(mass), ..everything() };
        sensor.proof_mass.iter_mut().for_each(|m| m.force_noise_m_s_rts = 1e-4);
        let force = Sine { amplitude_m_s2: 5.0, frequency_hz: 3.0, offset_m_s2: 0.0 };
        let job = job(sensor, MEMBERS, &[0.5, 5.0], force, integrator);
        let (here, there) = (cpu.run(&job)?, gpu.run(&job)?);
        let what = format!("{integrator}, all errors on: largest difference of a percentile in sd, CPU − {}", gpu.name);
        rows.push(Row::at_most(what, difference(&here, &there), 2e-3));
        if rows.len() == 1 {
            // Control: another seed is another ensemble.
            let there = gpu.run(&Job { seed: job.seed + 1, ..job.clone() })?;
            rows.push(Row::at_most("CPU − GPU with another seed", difference(&here, &there), 2e-3).control());
        }
    }
    Ok(rows)
}

/// A sensor with every error.
pub fn everything() -> Sensor {
    let mut sensor = Sensor::default();
    let a = &mut sensor.accelerometer;
    a.bias_m_s2 = MILLI_G;
    a.scale_factor = 1e-3;
    a.k2_per_m_s2 = 1e-6;
    a.velocity_random_walk_m_s_rts = 60.0 * MICRO_G;
    a.bias_instability_m_s2 = 40.0 * MICRO_G;
    a.acceleration_random_walk_m_s2_rts = 10.0 * MICRO_G;
    a.quantisation_m_s2 = 0.5 * MILLI_G;
    a.range_m_s2 = 4.9;
    let g = &mut sensor.gyro;
    g.bias_rad_s = 5.0 * DEGREE_PER_HOUR;
    g.angle_random_walk_rad_rts = 1e-4;
    g.bias_instability_rad_s = 10.0 * DEGREE_PER_HOUR;
    g.rate_random_walk_rad_s_rts = 1e-5;
    sensor
}

/// The largest difference of mean or percentile in units of the standard deviation, over times and quantities.
pub fn difference(a: &Statistics, b: &Statistics) -> f64 {
    let pairs = a.at.iter().flatten().zip(b.at.iter().flatten());
    let worst = pairs.flat_map(|(a, b)| {
        let sd = a.sd.max(f64::MIN_POSITIVE);
        let percentiles = a.percentiles.iter().zip(&b.percentiles).map(move |(p, q)| (p - q).abs() / sd);
        percentiles.chain([(a.mean - b.mean).abs() / sd, (a.sd - b.sd).abs() / sd])
    });
    worst.fold(0.0, f64::max)
}
