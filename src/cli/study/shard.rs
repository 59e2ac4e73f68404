//! `proofmass study --shard K/N`: one share of a study, and its state file.

use std::path::Path;

use crate::sharded::tell;
use proofmass_base::error::Result;
use proofmass_base::progress;
use proofmass_base::shard::Shard;
use proofmass_base::shard::file::Place;
use proofmass_simulate::drift::divided::Divided;
use proofmass_simulate::ensemble::divided::run_pieces;
use proofmass_simulate::ensemble::{Backends, Choice, Keeper, Kept, Options};
use proofmass_study::Study;

/// Request to a shard.
pub(super) struct Request<'a> {
    /// Number of the shard and of all shards.
    pub shard: Shard,
    /// The study's file, where it has one.
    pub input: Option<&'a Path>,
    /// Says where its state goes.
    pub out: &'a Path,
    /// Backend to integrate on.
    pub backend: Choice,
    /// Replace a file that is not this run's.
    pub force: bool,
    /// Go on with what the file holds.
    pub resume: bool,
}

/// Integrates a shard and says where its state is.
///
/// # Errors
/// A backend that is not there, a folder that cannot be written, a state of another run, Ctrl-C.
pub(super) fn run(study: &Study, request: &Request<'_>, json: bool) -> Result<()> {
    let control = progress::terminal();
    let divided = Divided::of(study, request.input, &control)?;
    let header = divided.header(request.shard);
    let place = Place::take(request.out, &header, request.force)?;
    let path = place.path().to_path_buf();
    let kept = match request.resume {
        true => Kept::resume(place, header.clone())?,
        false => Kept::new(place, header.clone()),
    };
    let mut keeper = Keeper::shard(kept);
    let options = Options { backend: request.backend, control, ..Options::default() };
    run_pieces(&divided.jobs, header.pieces.iter().map(|p| &p.piece), Backends::default(), &options, &mut keeper)?;
    tell(&header, " (those of the error budget included)", &path, json)
}
