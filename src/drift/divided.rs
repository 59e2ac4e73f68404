//! A study divided among machines: what each shard's file says of it, and the answer from all files.
//!
//! The files carry the study itself, so that whoever merges needs nothing else; recordings that it reads must stand where they
//! stood.

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Drift, answer, jobs};
use crate::control::Control;
use crate::document::hexadecimal;
use crate::ensemble::divided::{merge, parts};
use crate::error::{Error, Result};
use crate::kernel::job::Job;
use crate::shard::file::{Header, Progress, Run};
use crate::shard::gather::Found;
use crate::shard::{Piece, Shard, rest};
use crate::study::{Study, read_again};

/// The subcommand that divides studies.
pub(crate) const COMMAND: &str = "study";

/// The study, as a shard's file carries it.
#[derive(Serialize, Deserialize)]
struct Carried {
    /// What it was read from, for messages.
    source: String,
    text: String,
    members: u64,
    seed: u64,
    /// What its relative paths start from.
    folder: PathBuf,
}

/// A study and its ensembles.
pub(crate) struct Divided {
    /// The ensembles: the parts that are divided.
    pub jobs: Vec<Job>,
    run: Run,
    input: Option<PathBuf>,
    document: serde_json::Value,
}

fn full(path: &Path) -> PathBuf {
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}

fn run(study: &Study, jobs: &[Job]) -> Run {
    // The study and what stands in the recordings that it reads.
    let mut identity = Sha256::new_with_prefix(&study.identity);
    study.reads.iter().filter_map(|path| std::fs::read(path).ok()).for_each(|bytes| {
        identity.update(Sha256::digest(bytes));
    });
    Run {
        command: COMMAND.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        identity: hexadecimal(&identity.finalize()),
        unit: "members".into(),
        parts: jobs.iter().map(|job| job.members).collect(),
    }
}

impl Divided {
    /// A study that was read from `input`, or the default one.
    ///
    /// # Errors
    /// As [`jobs`].
    pub(crate) fn of(study: &Study, input: Option<&Path>) -> Result<Self> {
        let jobs = jobs(study)?;
        let carried = Carried {
            source: input.map_or_else(|| "the default study".into(), |path| path.display().to_string()),
            text: study.text.clone(),
            members: study.members,
            seed: study.seed,
            folder: full(if study.folder.as_os_str().is_empty() { Path::new(".") } else { &study.folder }),
        };
        let document = serde_json::to_value(carried)
            .map_err(|e| Error::new("could not divide the study", e.to_string(), "report this as a defect"))?;
        Ok(Self { run: run(study, &jobs), jobs, input: input.map(full), document })
    }

    /// The head of a shard's file before anything is done.
    pub(crate) fn header(&self, shard: Shard) -> Header {
        self.with(shard, shard.pieces(&parts(&self.jobs)))
    }

    /// The same of a shard that takes its share of what is left of a run.
    #[cfg_attr(not(feature = "mpi"), allow(dead_code, reason = "ranks take what is left of a run"))]
    pub(crate) fn rest(&self, shard: Shard, gaps: &[(usize, Range<u64>)]) -> Header {
        self.with(shard, rest(shard, &parts(&self.jobs), gaps))
    }

    fn with(&self, shard: Shard, pieces: Vec<Piece>) -> Header {
        let begun = |piece: Piece| Progress { next: piece.units.start, piece, bytes: 0 };
        Header {
            run: self.run.clone(),
            input: self.input.clone(),
            document: self.document.clone(),
            shard,
            pieces: pieces.into_iter().map(begun).collect(),
        }
    }
}

/// The study and its answer from the files of all shards.
///
/// # Errors
/// A file that is damaged; a recording of the study that has changed or is not there.
pub(crate) fn merged(found: &[Found], control: &Control) -> Result<(Study, Drift)> {
    let refuse = |cause: String, hint: &str| Error::new("could not merge the shards of a study", cause, hint);
    let first = found.first().ok_or_else(|| refuse("there are none".into(), "give the folders that hold them"))?;
    let carried: Carried = serde_json::from_value(first.header.document.clone())
        .map_err(|e| refuse(format!("{}: {e}", first.path.display()), "run that shard again"))?;
    let Carried { source, text, members, seed, folder } = carried;
    let study = read_again(&source, &text, members, seed, &folder)?;
    let jobs = jobs(&study)?;
    let run = run(&study, &jobs);
    if run != first.header.run {
        let reads: Vec<String> = study.reads.iter().map(|path| path.display().to_string()).collect();
        let cause = format!("{source} reads other data than its shards did: {}", reads.join(", "));
        return Err(refuse(cause, "merge where the same recordings are at the same paths, or run the shards again"));
    }
    let mut statistics = merge(found, &run.identity, &jobs, control)?.into_iter();
    let drift = answer(&study, control, |_, name| {
        statistics.next().ok_or_else(|| refuse(format!("nothing was summed for: {name}"), "report this as a defect"))
    })?;
    Ok((study, drift))
}
