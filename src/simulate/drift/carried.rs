//! A study divided among machines, as each shard's file carries it: the study itself, so that
//! whoever merges needs nothing else.
//!
//! Recordings that it reads must stand where they stood. Not for what is summed: a shard of one
//! axis packs ensembles (`ensemble::divided`), one along a trajectory its sums
//! (`strapdown::divided`).

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::control::Control;
use crate::document::hexadecimal;
use crate::error::{Error, Result};
use crate::shard::file::{Header, Progress, Run};
use crate::shard::gather::Found;
use crate::shard::{Part, Piece, Shard, rest};
use crate::study::{Overrides, Study, Surroundings, parse_watched};

/// The subcommand that divides studies.
pub const COMMAND: &str = "study";

/// The study, in a file.
#[derive(Serialize, Deserialize)]
struct Carried {
    /// Source that it was read from, for messages.
    source: String,
    text: String,
    members: u64,
    seed: u64,
    /// Folder from which its relative paths start.
    folder: PathBuf,
}

/// A study as a line of parts.
pub(crate) struct Line {
    parts: Vec<Part>,
    run: Run,
    input: Option<PathBuf>,
    document: serde_json::Value,
}

fn full(path: &Path) -> PathBuf {
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}

impl Line {
    /// A study that was read from `input`, or the default one, and what it is divided in.
    ///
    /// # Errors
    /// None that a user can make.
    pub(crate) fn of(study: &Study, parts: Vec<Part>, input: Option<&Path>) -> Result<Self> {
        let carried = Carried {
            source: input.map_or_else(|| "the default study".into(), |path| path.display().to_string()),
            text: study.text.clone(),
            members: study.members,
            seed: study.seed,
            folder: full(if study.folder.as_os_str().is_empty() { Path::new(".") } else { &study.folder }),
        };
        let document = serde_json::to_value(carried)
            .map_err(|e| Error::new("could not divide the study", e.to_string(), "report this as a defect"))?;
        Ok(Self { run: run(study, &parts), parts, input: input.map(full), document })
    }

    /// The head of a shard's file before anything is done.
    pub(crate) fn header(&self, shard: Shard) -> Header {
        self.with(shard, shard.pieces(&self.parts))
    }

    /// The same of a shard that takes its share of what is left of a run.
    pub(crate) fn rest(&self, shard: Shard, gaps: &[(usize, Range<u64>)]) -> Header {
        self.with(shard, rest(shard, &self.parts, gaps))
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

fn run(study: &Study, parts: &[Part]) -> Run {
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
        parts: parts.iter().map(|part| part.units).collect(),
    }
}

/// Refuses a state, with the cause and a hint.
pub fn refuse(cause: String, hint: &str) -> Error {
    Error::new("could not merge the shards of a study", cause, hint)
}

/// The study that files carry.
///
/// # Errors
/// There are no files; the study or what it reads is not there any more.
pub fn study(found: &[Found], control: &Control) -> Result<Study> {
    let first = found.first().ok_or_else(|| refuse("there are none".into(), "give the folders that hold them"))?;
    let carried: Carried = serde_json::from_value(first.header.document.clone())
        .map_err(|e| refuse(format!("{}: {e}", first.path.display()), "run that shard again"))?;
    let Carried { source, text, members, seed, folder } = carried;
    let overrides = Overrides { members: Some(members), seed: Some(seed), ..Overrides::default() };
    parse_watched(&source, &text, &overrides, &Surroundings::new(folder, control))
}

/// The digest of the run that files are of, where it is that of this study in these parts.
///
/// # Errors
/// A recording of the study has changed.
pub fn identity(study: &Study, parts: &[Part], found: &[Found]) -> Result<String> {
    let run = run(study, parts);
    if found.iter().any(|file| file.header.run != run) {
        if study.reads.is_empty() {
            let cause = format!("{} is not the study that their results are of", study.name);
            return Err(refuse(cause, "run the shards again"));
        }
        let reads: Vec<String> = study.reads.iter().map(|path| path.display().to_string()).collect();
        let cause = format!("{} reads other data than its shards did: {}", study.name, reads.join(", "));
        return Err(refuse(cause, "merge where the same recordings are at the same paths, or run the shards again"));
    }
    Ok(run.identity)
}
