//! Writes what the members of a tile share as the kernel reads it.

use crate::kernel::force;
use crate::kernel::job::Job;

/// The force over some samples as the kernel reads it.
pub(super) fn forces(job: &Job, first: u64, count: u64) -> Vec<[f32; 4]> {
    let table = force::table::<f32>(job, first, count);
    let begin = table.first().map(|f| [f.begin, 0.0, 0.0, 0.0]);
    let rest = table.iter().map(|f| [f.end, f.middle, f.to_middle, f.to_end]);
    begin.into_iter().chain(rest).collect()
}

/// Writes what is known of each of some samples, as the kernel reads it: how much warmer than its
/// reference the sensor is, and behind that what the late force has more than the force itself. A
/// buffer is never empty.
pub(super) fn per_sample(job: &Job, first: u64, count: u64) -> Vec<f32> {
    let (mut all, late) = (job.warmer_k(first, count), force::late::<f32>(job, first, count));
    if !late.is_empty() {
        all.resize(count as usize, 0.0);
        all.extend(late);
    }
    if all.is_empty() { vec![0.0] } else { all }
}
