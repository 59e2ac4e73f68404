//! How far many models of one recording stay from its readings: on the CPU in groups of 64 points over all threads. Its
//! twin on a GPU is `gpu::misfits`.

use crate::error::{Error, Result};
use crate::kernel::cpu::lanes::{LANES, Level};
use crate::kernel::cpu::misfit::{Group, Misfit as Work, Shared};
use crate::kernel::misfit::{Job, Misfit, Parts, Point, stretches};
use crate::numerics::elementary::Real;
use crate::parallel;
use crate::progress;

/// Evaluates every point; the result does not depend on the number of threads. `T` is f32, or f64 for references.
///
/// # Errors
/// When stopped by Ctrl-C.
pub fn evaluate<T: Real>(job: &Job<'_>, points: &[Point]) -> Result<Vec<Misfit>> {
    let shared = Shared::<T>::of(job, Parts::of(points));
    let (stretches, level) = (stretches(job), Level::best());
    let group = |_, points: &[Point]| {
        let mut group = Group::<T>::load(job, points);
        for (samples, block) in &stretches {
            if progress::interrupted() {
                break;
            }
            let (samples, block, blocks) = (samples.clone(), *block, job.blocks.len());
            level.run(Work { shared: &shared, group: &mut group, samples, block, blocks });
        }
        let sums = |l: usize| group.sums.iter().map(|s| s[l]).collect::<Vec<f64>>();
        (0..points.len()).map(|l| finish(job, &sums(l), group.lost(l))).collect::<Vec<Misfit>>()
    };
    let all: Vec<Vec<Misfit>> = parallel::map_chunks(points, LANES, group);
    if progress::interrupted() {
        return Err(stopped());
    }
    Ok(all.into_iter().flatten().collect())
}

/// What a search says when it was stopped.
pub(super) fn stopped() -> Error {
    Error::interrupted("could not finish the search among candidates", "run it again")
}

/// One point's sums, blocks first, back in the recording's units.
pub(super) fn finish(job: &Job<'_>, sums: &[f64], lost: bool) -> Misfit {
    let (squares, along) = sums.split_at(job.blocks.len());
    let y = job.units.output;
    Misfit {
        squares: squares.iter().map(|s| if lost || !s.is_finite() { f64::INFINITY } else { s * y * y }).collect(),
        along: along.iter().map(|s| s * y).collect(),
    }
}
