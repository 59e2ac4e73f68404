//! Simulated readings of some members, as a recording: what the sensors would have written to a
//! log.
//!
//! A reading is the truth plus the error that the kernels integrate: the specific force along the
//! axis, and a rate of zero. A still start is part of the log; what it takes off belongs to the
//! navigation and not to the sensor.

use crate::backend::cpu;
use crate::columns::Columns;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::kernel::cpu::lanes::LANES;
use crate::kernel::job::Job;
use crate::number::rounded;

/// Most numbers of a recording that is made in memory.
const MOST: u64 = 30_000_000;

/// Time, then the gyros and the accelerometers of the first `members` members, SI: `t_s`,
/// `gyro_1_rad_s` …, `accelerometer_1_m_s2` …; without a number where there is one member. A
/// reading of a member that diverged is missing.
///
/// # Errors
/// No members or more than the job has, more numbers than fit the memory, a member that cannot be
/// stepped; stopped.
pub fn samples(job: &Job, members: u64, control: &Control) -> Result<Columns> {
    let refuse = |cause: String, hint: String| Err(Error::new("could not write samples", cause, hint));
    if members == 0 || members > job.members {
        let hint = format!("give 1 to {}, or a larger --members", job.members);
        return refuse(format!("need members of the study, which has {}; got {members}", job.members), hint);
    }
    let numbers = (2 * members + 1).saturating_mul(job.clock.samples);
    if numbers > MOST {
        let fit = (MOST / job.clock.samples).saturating_sub(1) / 2;
        return refuse(
            format!("{members} members × {} samples are {numbers} numbers: at most {MOST}", job.clock.samples),
            if fit > 0 { format!("{fit} members fit") } else { "shorten `duration_s`, or lower the rate".into() },
        );
    }
    let rows = job.clock.samples as usize;
    let channels = || (0..members).map(|_| Vec::with_capacity(rows));
    let (mut gyros, mut accelerometers): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (channels().collect(), channels().collect());
    let groups = gyros.chunks_mut(LANES).zip(accelerometers.chunks_mut(LANES));
    for (group, (gyros, accelerometers)) in groups.enumerate() {
        cpu::readings::<f64>(job, (group * LANES) as u64, control, |seen| {
            for (l, (gyro, accelerometer)) in gyros.iter_mut().zip(accelerometers.iter_mut()).enumerate() {
                gyro.push(seen.gyro[l]);
                accelerometer.push(seen.felt[l] + seen.accelerometer[l]);
            }
        })?;
    }
    let sample_s = job.clock.sample_s();
    let mut columns = Columns::default();
    columns.numbers("t_s", (1..=rows).map(|n| rounded(n as f64 * sample_s, 14)).collect());
    for (name, unit, channels) in [("gyro", "rad_s", gyros), ("accelerometer", "m_s2", accelerometers)] {
        for (member, values) in channels.into_iter().enumerate() {
            match members {
                1 => columns.numbers(&format!("{name}_{unit}"), values),
                _ => columns.numbers(&format!("{name}_{}_{unit}", member + 1), values),
            }
        }
    }
    Ok(columns)
}
