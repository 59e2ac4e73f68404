//! `proofmass trial --shard K/N`: one shard of a blind trial, and its state file; and the trial
//! from all of them.
//!
//! While it runs, the sealed truth and the verdicts so far are kept in a separate folder next to
//! the state; `--resume` continues from there.

use std::path::{Path, PathBuf};

use super::super::numbers;
use super::answer::{self, FILES, Run, STATES};
use crate::output::remark;
use crate::sharded::tell;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Result};
use proofmass_base::output::{self, Folder};
use proofmass_base::shard::Shard;
use proofmass_base::shard::file::{Place, read_head};
use proofmass_base::shard::gather::Found;
use proofmass_trial::ask::Subject;
use proofmass_trial::blind::{self, Verdicts};
use proofmass_trial::divided;
use proofmass_trial::outcome::Outcome;
use proofmass_trial::plan::Plan;

/// Request to a shard.
pub(crate) struct Request<'a> {
    /// Plan of the undivided trial.
    pub plan: Plan,
    /// Which shard of it.
    pub shard: Shard,
    /// Says where its state goes.
    pub out: &'a Path,
    /// Replace a file that is not this trial's.
    pub force: bool,
    /// Go on with what is there.
    pub resume: bool,
}

/// Draws, seals and asks the cases of a shard.
///
/// # Errors
/// When the folder cannot be written, when what is there belongs to another trial, or on Ctrl-C.
pub(crate) fn run(request: &Request<'_>, subject: &Subject<'_>, control: &Control, json: bool) -> Result<()> {
    let mut header = divided::header(request.plan, request.shard)?;
    let place = Place::take(request.out, &header, request.force)?;
    let path = place.path().to_path_buf();
    let work = request.out.join(format!(".{}.work", request.shard.file_name()));
    if request.resume && !work.is_dir() {
        return match read_head(&path) {
            Ok(there) if there.run == header.run && there.is_done() => tell(&there, "", &path, json),
            _ => Err(Error::new(
                "could not resume",
                format!("no interrupted shard {} in {}", request.shard, request.out.display()),
                "leave --resume out to start over, or give the --out of the interrupted shard",
            )),
        };
    }
    if !request.resume && work.is_dir() {
        std::fs::remove_dir_all(&work).map_err(|e| Error::io("replace", &work, &e))?;
    }
    std::fs::create_dir_all(&work).map_err(|e| Error::io("create the folder", &work, &e))?;
    let [truth, state] = STATES.map(|name| work.join(name));
    let mut results = Vec::new();
    for piece in &mut header.pieces {
        let numbers = piece.piece.units.start as usize..piece.piece.units.end as usize;
        let (sealed, cases) = blind::prepare_some(request.plan, numbers, &work, request.resume, control)?;
        remark!("sealed truth of {} cases, SHA-256 {}", cases.len(), sealed.sha256);
        let done = if request.resume { blind::earlier(&state, &sealed)?.0 } else { Verdicts::new() };
        blind::run(&cases, &sealed, &state, done, subject, control)?;
        // What goes into the file is what was sealed.
        sealed.open()?;
        results.push(divided::pack(&truth, &state)?);
        piece.next = piece.piece.units.end;
    }
    place.write(&header, &results)?;
    std::fs::remove_dir_all(&work).map_err(|e| Error::io("remove", &work, &e))?;
    tell(&header, "", &path, json)
}

/// Puts the shards of a trial together.
///
/// # Errors
/// A file that is damaged; a folder that cannot be written.
pub(crate) fn merge(found: &[Found], places: &[PathBuf], out: Option<(&Path, bool)>, json: bool) -> Result<()> {
    let request = |force| output::Request {
        command: "merge",
        inputs: places.to_vec(),
        reads: found.iter().map(|f| f.path.clone()).collect(),
        writes: FILES.into_iter().chain([STATES[0]]).map(str::to_owned).chain(numbers::files(false)).collect(),
        force,
        keeps: false,
    };
    let folder = out.map(|(path, force)| Folder::open(path, request(force))).transpose()?;
    let merged = divided::merged(found)?;
    let outcome = Outcome::of(&merged.cases, &merged.verdicts, &merged.sha256);
    let run =
        Run { plan: &merged.plan, outcome: &outcome, cases: &merged.cases, verdicts: &merged.verdicts, real: &[] };
    let folders: Vec<String> = places.iter().map(|path| path.display().to_string()).collect();
    answer::give(&run, &format!("proofmass merge {}", folders.join(" ")), folder, &[(STATES[0], merged.truth)], json)
}
