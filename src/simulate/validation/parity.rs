//! CPU in f32 against a GPU: the same study, percentile by percentile, for every integrator and
//! with everything on.

use std::sync::Arc;

use super::jobs::{Place, Sine, job, masses};
use super::row::Row;
use crate::control::Control;
use crate::error::Result;
use crate::kernel::job::Job;
use crate::motion::temperature::Temperature;
use crate::sensor::Sensor;
use crate::statistics::Statistics;
use crate::statistics::histogram::BIN_SD;
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
        let temperature = Arc::new(Temperature::new(vec![[0.0, 21.0], [5.0, 31.0]], 20.0));
        let job = Job { temperature, ..job(sensor, MEMBERS, &[0.5, 5.0], force, integrator) };
        let (here, there) = (cpu.run(&job)?, gpu.run(&job)?);
        let what = format!(
            "{integrator}, all errors on: largest difference of mean, sd or (beyond a bin) percentile in sd, CPU − {}",
            gpu.name
        );
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
    a.k3_per_m2_s4 = 1e-6;
    a.feedthrough = 1e-3;
    a.velocity_random_walk_m_s_rts = 60.0 * MICRO_G;
    a.bias_instability_m_s2 = 40.0 * MICRO_G;
    a.acceleration_random_walk_m_s2_rts = 10.0 * MICRO_G;
    a.quantisation_m_s2 = 0.5 * MILLI_G;
    a.range_m_s2 = 4.9;
    a.misalignment_m_s2 = MILLI_G;
    a.initial_tilt_m_s2 = 0.5 * MILLI_G;
    a.bias_m_s2_per_k = 20.0 * MICRO_G;
    a.scale_factor_per_k = 1e-4;
    (a.markov_m_s2, a.markov_time_s) = (40.0 * MICRO_G, 0.7);
    (a.warm_up_m_s2, a.warm_up_time_s) = (MILLI_G, 0.9);
    (a.sinusoid_m_s2, a.sinusoid_frequency_rad_s, a.sinusoid_phase_rad) = (MILLI_G, 4.0, 1.0);
    let g = &mut sensor.gyro;
    g.bias_rad_s = 5.0 * DEGREE_PER_HOUR;
    g.angle_random_walk_rad_rts = 1e-4;
    g.bias_instability_rad_s = 10.0 * DEGREE_PER_HOUR;
    g.rate_random_walk_rad_s_rts = 1e-5;
    g.g_sensitivity_rad_s_per_m_s2 = DEGREE_PER_HOUR;
    g.g2_sensitivity_rad_s_per_m2_s4 = DEGREE_PER_HOUR;
    g.bias_rad_s_per_k = DEGREE_PER_HOUR;
    (g.markov_rad_s, g.markov_time_s) = (10.0 * DEGREE_PER_HOUR, 1.3);
    (g.warm_up_rad_s, g.warm_up_time_s) = (5.0 * DEGREE_PER_HOUR, 1.1);
    (g.sinusoid_rate_rad_s, g.sinusoid_frequency_rad_s, g.sinusoid_phase_rad) = (5.0 * DEGREE_PER_HOUR, 5.0, 2.0);
    sensor
}

/// The largest difference of mean, standard deviation or percentile in units of the standard
/// deviation, over times and quantities. Percentiles count beyond one bin of their histogram only:
/// a member whose last bit carries it across an edge moves a percentile by a whole bin, and nothing
/// finer can be read from a histogram. Means and standard deviations are summed from the members
/// themselves and have no such grain.
pub fn difference(a: &Statistics, b: &Statistics) -> f64 {
    // The bins follow the standard deviation of a pilot, which is off by its own sampling error.
    const GRAIN: f64 = 1.05 * BIN_SD;
    let pairs = a.at.iter().flatten().zip(b.at.iter().flatten());
    let worst = pairs.flat_map(|(a, b)| {
        let sd = a.sd.max(f64::MIN_POSITIVE);
        let percentiles = a.percentiles.iter().zip(&b.percentiles).map(move |(p, q)| (p - q).abs() / sd - GRAIN);
        percentiles.chain([(a.mean - b.mean).abs() / sd, (a.sd - b.sd).abs() / sd])
    });
    worst.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::integrator::Integrator;

    #[test]
    fn one_bin_is_forgiven_and_two_or_a_shifted_mean_are_not() {
        let job = job(everything(), 1024, &[0.5], super::super::jobs::REST, Integrator::Ideal);
        let one = Place::cpu(&Control::silent()).run(&job).expect("a small ensemble runs");
        let shifted = |bins: f64, mean: f64| {
            let mut other = one.clone();
            for summary in other.at.iter_mut().flatten() {
                summary.percentiles.iter_mut().for_each(|p| *p += bins * BIN_SD * summary.sd);
                summary.mean += mean * summary.sd;
            }
            difference(&one, &other)
        };
        assert_eq!(shifted(1.0, 0.0), 0.0);
        assert!(shifted(2.0, 0.0) > 2e-3 && shifted(0.0, 3e-3) > 2e-3);
    }
}
