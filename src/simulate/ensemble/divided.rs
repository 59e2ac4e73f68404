//! A study divided among shards: how its ensembles are cut, what a shard does, and the whole put
//! together again.

use std::path::Path;

use super::backends::Backends;
use super::checkpoint::Keeper;
use super::encode::unpack;
use super::integrate::summed;
use super::options::Options;
use super::state::{BLOCK, Run, State};
use super::verify;
use crate::backend::cpu::Precision;
use crate::control::Control;
use crate::error::Result;
use crate::kernel::job::Job;
use crate::parallel;
use crate::shard::file::damaged;
use crate::shard::gather::Found;
use crate::shard::{Part, Piece};
use crate::statistics::{Origin, Statistics};

/// Cuts the ensembles of a study: between blocks, by the work of each.
pub fn parts(jobs: &[Job]) -> Vec<Part> {
    jobs.iter().map(|job| Part { units: job.members, grain: BLOCK, effort: job.steps_per_member() }).collect()
}

/// Integrates the pieces of a shard; `keeper` keeps them in its file.
///
/// # Errors
/// As [`Backends::run`].
pub fn run_pieces<'a>(
    jobs: &[Job],
    pieces: impl Iterator<Item = &'a Piece>,
    mut backends: Backends,
    options: &Options,
    keeper: &mut Keeper,
) -> Result<()> {
    for piece in pieces {
        if let Some(job) = jobs.get(piece.part) {
            backends.run(job, options, keeper)?;
        }
    }
    keeper.write()
}

/// Files read at a time.
const AT_A_TIME: usize = 16;

/// Puts the ensembles of a study together from the files of its shards, which must be the whole of
/// it.
///
/// # Errors
/// A file that cannot be read, is damaged, or is another run's.
pub fn merge(found: &[Found], identity: &str, jobs: &[Job], control: &Control) -> Result<Vec<Statistics>> {
    let precision = Precision::default();
    let runs: Vec<Run<'_>> = (1..).zip(jobs).map(|(part, job)| Run { identity, part, job, precision }).collect();
    let mut states: Vec<State> = runs.iter().map(|run| State::new(run, 0..0)).collect();
    let progress = control.stage("merging", found.len() as u64);
    for some in found.chunks(AT_A_TIME) {
        control
            .go_on()
            .map_err(|s| s.during("could not finish the merge", "run it again: the shards are as they were"))?;
        for (path, contents) in some.iter().map(|f| &f.path).zip(parallel::map(some, Found::contents)) {
            for (piece, results) in contents?.pieces().filter(|(_, results)| !results.is_empty()) {
                let part = piece.piece.part;
                let (Some(run), Some(state)) = (runs.get(part), states.get_mut(part)) else {
                    return Err(damaged(path, "it holds a part that the study does not have"));
                };
                unpack(results, run, state).map_err(|what| damaged(path, &what))?;
            }
            progress.step();
        }
    }
    let whole = |(mut state, job): (State, &Job)| {
        (state.members, state.next_member, state.under_way) = (0..job.members, job.members, None);
        join(&mut state.origins);
        let first = found.first().map_or(Path::new("shards"), |f| &f.path);
        verify::check(&state, job).map_err(|what| damaged(first, &format!("the shards do not add up: {what}")))?;
        Ok(summed(job, &state, state.seconds))
    };
    states.into_iter().zip(jobs).map(whole).collect()
}

/// Puts origins in the order of their members, those of machines with the same bits in one.
fn join(origins: &mut Vec<Origin>) {
    origins.sort_by_key(|o| o.members.start);
    origins.dedup_by(|next, last| {
        let one = last.members.end == next.members.start
            && last.machine.same_bits(&next.machine)
            && last.reason == next.reason;
        if one {
            last.members.end = next.members.end;
        }
        one
    });
}
