//! `mpirun -n 4 proofmass study …`: ranks take the shards, rank 0 merges and writes.
//!
//! MPI carries bytes only: each rank keeps its state in the folder that all share, sends it to rank
//! 0 when it is done, and rank 0 puts them together as `proofmass merge` does. A run that was
//! killed goes on with any number of ranks: what no state holds is divided anew.

use std::path::{Path, PathBuf};

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Root, Source};
use serde_json::json;

use super::answer;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Kind, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::progress;
use proofmass_base::shard::Shard;
use proofmass_base::shard::file::{Contents, Header, Place};
use proofmass_base::shard::gather::{Found, are_whole, belong_together, find, missing};
use proofmass_simulate::drift::carried;
use proofmass_simulate::drift::divided::{Divided, merged};
use proofmass_simulate::ensemble::divided::run_pieces;
use proofmass_simulate::ensemble::{Backends, Choice, Keeper, Kept, Options};
use proofmass_study::Study;

/// Request to the ranks.
pub(super) struct Request<'a> {
    /// Reads the study; with it, where its results go and what will be written there.
    pub read: &'a dyn Fn() -> Result<Asked>,
    /// The study's file, where it has one.
    pub input: Option<&'a Path>,
    /// Backend to integrate on.
    pub backend: Choice,
    /// Replace files that are not this run's.
    pub force: bool,
    /// Go on with what stands in the folder.
    pub resume: bool,
}

/// A study, and where its results go.
pub(super) struct Asked {
    /// The study, checked.
    pub study: Study,
    /// The folder that all ranks share.
    pub out: PathBuf,
    /// Files that rank 0 writes there.
    pub outputs: output::Request,
}

/// The ranks of a run.
struct Ranks {
    world: SimpleCommunicator,
}

impl Ranks {
    fn number(&self) -> i32 {
        self.world.rank()
    }

    fn shard(&self) -> Shard {
        Shard { number: self.world.rank() as u64 + 1, of: self.world.size() as u64 }
    }

    /// On which of the GPUs of its machine a rank computes.
    fn gpu(&self) -> usize {
        let local = |name: &&str| std::env::var(name).ok()?.parse().ok();
        let names = ["OMPI_COMM_WORLD_LOCAL_RANK", "MPI_LOCALRANKID", "SLURM_LOCALID"];
        names.iter().find_map(local).unwrap_or(self.world.rank() as usize)
    }

    /// The bytes of all ranks, in their order, on rank 0; nothing on the others.
    fn gather(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        if self.number() > 0 {
            self.world.process_at_rank(0).send(bytes);
            return None;
        }
        let others = (1..self.world.size()).map(|rank| self.world.process_at_rank(rank).receive_vec::<u8>().0);
        Some(std::iter::once(bytes.to_vec()).chain(others).collect())
    }

    /// Goes on where all ranks can. Where one cannot, rank 0 returns its error and the others end
    /// without a word.
    fn agree<T>(&self, result: Result<T>) -> Result<T> {
        let said = result.as_ref().err().map_or_else(Vec::new, |e| {
            serde_json::to_vec(&json!([e.attempt, e.cause, e.hint])).unwrap_or_else(|_| b"[]".to_vec())
        });
        let errors = self.gather(&said);
        let mut failed =
            errors.as_ref().and_then(|all| all.iter().position(|said| !said.is_empty())).map_or(-1, |n| n as i64);
        self.world.process_at_rank(0).broadcast_into(&mut failed);
        match (usize::try_from(failed), errors, result) {
            (Err(_), _, result) => result,
            (Ok(0), Some(_), Err(error)) => Err(error),
            (Ok(rank), Some(errors), _) => {
                let [attempt, cause, hint]: [String; 3] = serde_json::from_slice(&errors[rank]).unwrap_or_default();
                Err(Error::new(attempt, format!("on rank {rank}: {cause}"), hint))
            }
            (Ok(_), None, _) => Err(Error { hint: SILENT.into(), ..Error::new("", "", "") }),
        }
    }
}

/// Marks the error that another rank tells.
const SILENT: &str = "told by rank 0";

/// Runs a study on all ranks.
///
/// # Errors
/// As `study` and `merge`; told by rank 0 for all.
pub(super) fn run(request: &Request<'_>, json: bool) -> Result<()> {
    let Some(universe) = mpi::initialize() else {
        return Err(Error::new("could not start MPI", "it was started before", "report this as a defect"));
    };
    let ranks = Ranks { world: universe.world() };
    match on(&ranks, request, json) {
        Err(error) if error.kind == Kind::Interrupted => {
            // The others may be gone: nothing is waited for any more.
            std::mem::forget(universe);
            Err(error)
        }
        Err(error) if error.hint == SILENT => {
            drop(universe);
            std::process::exit(2)
        }
        done => done,
    }
}

fn on(ranks: &Ranks, request: &Request<'_>, json: bool) -> Result<()> {
    let control = if ranks.number() == 0 { progress::terminal() } else { progress::terminal().without_stages() };
    let ready = || -> Result<(Asked, Divided)> {
        let asked = (request.read)()?;
        let divided = Divided::of(&asked.study, request.input, &control)?;
        Ok((asked, divided))
    };
    let (asked, divided) = ranks.agree(ready())?;
    let out = asked.out.clone();
    let earlier = ranks.agree(if request.resume { earlier(&divided, ranks.shard(), &out) } else { Ok(Vec::new()) })?;
    // All have seen what is there before anyone changes it.
    ranks.world.barrier();
    let begun = ranks.agree(begin(ranks, request, &divided, &earlier, &out))?;
    let Begun { mut keeper, header, path } = begun;
    let options = Options { backend: request.backend, control: control.clone(), ..Options::default() };
    let pieces = header.pieces.iter().map(|p| &p.piece);
    let ran = run_pieces(&divided.jobs, pieces, Backends::on_nth(ranks.gpu()), &options, &mut keeper);
    let ran = ran.map_err(|e| Error { cause: format!("rank {}: {}", ranks.number(), e.cause), ..e });
    if let Err(error) = &ran
        && error.kind == Kind::Interrupted
    {
        return ran;
    }
    ranks.agree(ran)?;
    let bytes = ranks.agree(std::fs::read(&path).map_err(|e| Error::io("read", &path, &e)))?;
    let Some(all) = ranks.gather(&bytes) else { return Ok(()) };
    let of = ranks.shard().of;
    let received =
        (1..).zip(all).map(|(number, bytes)| Found::received(out.join(Shard { number, of }.file_name()), bytes));
    let mut found = received.collect::<Result<Vec<Found>>>()?;
    // States of an earlier number of ranks hold the rest.
    found.extend(earlier.into_iter().filter(|f| f.header.shard.of != of));
    answer(asked, &found, &control, json)
}

/// A rank that is ready to compute.
struct Begun {
    keeper: Keeper,
    header: Header,
    path: PathBuf,
}

/// The states of the run that was stopped in a folder.
fn earlier(divided: &Divided, shard: Shard, out: &Path) -> Result<Vec<Found>> {
    let places = [out.to_path_buf()];
    let found = if out.is_dir() { find(&places)? } else { Vec::new() };
    let hint = "leave --resume out to start over, or give the study and the --out of the interrupted run";
    if found.is_empty() {
        return Err(Error::new("could not resume", format!("no interrupted run in {}", out.display()), hint));
    }
    belong_together(&found, &places)?;
    match found[0].header.run == divided.header(shard).run {
        true => Ok(found),
        false => {
            let cause =
                format!("{} belongs to another run: another study, seed or number of members", found[0].path.display());
            Err(Error::new("could not resume", cause, hint))
        }
    }
}

fn begin(ranks: &Ranks, request: &Request<'_>, divided: &Divided, earlier: &[Found], out: &Path) -> Result<Begun> {
    let shard = ranks.shard();
    let own = earlier.iter().find(|f| f.header.shard == shard);
    let planned = divided.header(shard);
    let pieces = |header: &Header| header.pieces.iter().map(|p| p.piece.clone()).collect::<Vec<_>>();
    let as_planned =
        |f: &Found| f.header.shard.of == shard.of && pieces(&f.header) == pieces(&divided.header(f.header.shard));
    // As many ranks as before, each with its own share: each goes on in the middle of a batch.
    if earlier.iter().all(as_planned) {
        if ranks.number() == 0 && !request.resume {
            remove_others(&planned, out)?;
        }
        let place = Place::take(out, &planned, request.force)?;
        let path = place.path().to_path_buf();
        let kept = match own {
            Some(_) => Kept::resume(place, planned.clone())?,
            None => Kept::new(place, planned.clone()),
        };
        return Ok(Begun { keeper: Keeper::shard(kept), header: planned, path });
    }
    let header = divided.rest(shard, &missing(earlier));
    let place = Place::take(out, &header, request.force)?;
    let path = place.path().to_path_buf();
    let before = own.map(|own| Contents::read(&own.path)).transpose()?;
    let kept = Kept::behind(place, header.clone(), before.as_ref());
    Ok(Begun { keeper: Keeper::shard(kept), header, path })
}

/// A run that begins anew replaces its own states, also those of another number of ranks.
fn remove_others(header: &Header, out: &Path) -> Result<()> {
    let found = if out.is_dir() { find(&[out.to_path_buf()]).unwrap_or_default() } else { Vec::new() };
    let ours = |f: &Found| f.header.run.command == header.run.command && f.header.input == header.input;
    for other in found.iter().filter(|f| ours(f) && f.header.shard.of != header.shard.of) {
        std::fs::remove_file(&other.path).map_err(|e| Error::io("remove", &other.path, &e))?;
    }
    Ok(())
}

/// Rank 0 puts the states together, prints the answer and writes the report.
fn answer(asked: Asked, found: &[Found], control: &Control, json: bool) -> Result<()> {
    are_whole(found, std::slice::from_ref(&asked.out))?;
    let mut folder = Folder::open(&asked.out, asked.outputs)?;
    let study = carried::study(found, control)?;
    let drift = merged(&study, found, control)?;
    answer::print(&study, &drift, answer::Beside::default(), Some(found.len()), json)?;
    answer::write(&mut folder, &study, &drift, answer::Beside::default())?;
    if json { Ok(()) } else { answer::point_to(&asked.out) }
}
