//! A blind trial divided among machines: each shard draws, seals and asks its own cases; the whole
//! truth and every verdict from all files.
//!
//! Results in a file: the sealed truth of the shard's cases, a line break, and the lines of their
//! verdicts.

use std::path::Path;

use sha2::{Digest, Sha256};

use super::blind::{Verdicts, verdicts};
use super::case::Case;
use super::plan::Plan;
use super::seal::{Sealed, Truth};
use proofmass_base::document::hexadecimal;
use proofmass_base::error::{Error, Result};
use proofmass_base::shard::file::{Header, Progress, Run, damaged};
use proofmass_base::shard::gather::Found;
use proofmass_base::shard::{Part, Piece, Shard};

/// The subcommand that divides trials.
pub const COMMAND: &str = "trial";

/// The head of a shard's file before anything is done. Cases of all families follow each other: any
/// stretch is like another.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub fn header(plan: Plan, shard: Shard) -> Result<Header> {
    let units = plan.families().len() as u64;
    let document = serde_json::to_value(plan)
        .map_err(|e| Error::new("could not divide the trial", e.to_string(), "report this as a defect"))?;
    let run = Run {
        command: COMMAND.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        identity: hexadecimal(&Sha256::digest(format!("{plan:?}"))),
        unit: "cases".into(),
        parts: vec![units],
    };
    let pieces = shard.pieces(&[Part { units, grain: 1, effort: 1 }]).into_iter();
    let begun = |piece: Piece| Progress { next: piece.units.start, piece, bytes: 0 };
    Ok(Header { run, input: None, document, shard, pieces: pieces.map(begun).collect() })
}

/// Returns what a shard's file holds, from the two files that the trial leaves.
///
/// # Errors
/// One of them cannot be read.
pub fn pack(truth: &Path, verdicts: &Path) -> Result<Vec<u8>> {
    let read = |path: &Path| std::fs::read(path).map_err(|e| Error::io("read", path, &e));
    Ok([read(truth)?, b"\n".to_vec(), read(verdicts)?].concat())
}

/// A trial, put together.
pub struct Merged {
    /// Plan that the cases were drawn by.
    pub plan: Plan,
    /// Cases of the campaign.
    pub cases: Vec<Case>,
    /// Verdicts so far.
    pub verdicts: Verdicts,
    /// The whole truth as one trial seals it.
    pub truth: Vec<u8>,
    /// SHA-256 of the plan, in hexadecimal digits.
    pub sha256: String,
}

/// The trial from the files of all shards.
///
/// # Errors
/// A file that is damaged, or whose truth is not the one that its verdicts were given on.
pub fn merged(found: &[Found]) -> Result<Merged> {
    let first =
        found.first().ok_or_else(|| Error::new("could not merge", "there are no shards", "give their folders"))?;
    let plan: Plan = serde_json::from_value(first.header.document.clone())
        .map_err(|e| damaged(&first.path, &format!("the file is damaged: {e}")))?;
    let (mut cases, mut all) = (Vec::new(), Verdicts::new());
    for file in found {
        let contents = file.contents()?;
        for (_, bytes) in contents.pieces() {
            let end = bytes.iter().position(|b| *b == b'\n').unwrap_or(bytes.len());
            let truth: Truth = serde_json::from_slice(&bytes[..end])
                .map_err(|e| damaged(&file.path, &format!("the file is damaged: {e}")))?;
            let sealed = Sealed { path: file.path.clone(), sha256: hexadecimal(&Sha256::digest(&bytes[..end])) };
            let (said, _) = verdicts(&bytes[end..], &sealed);
            if truth.plan != plan || truth.cases.iter().any(|case| !said.contains_key(&case.number)) {
                return Err(damaged(&file.path, "its verdicts do not belong to the truth that it holds"));
            }
            cases.extend(truth.cases);
            all.extend(said);
        }
    }
    cases.sort_by_key(|case| case.number);
    let truth = Truth::new(plan, cases);
    let (bytes, sha256) = truth.sealed()?;
    Ok(Merged { plan, cases: truth.cases, verdicts: all, truth: bytes, sha256 })
}
