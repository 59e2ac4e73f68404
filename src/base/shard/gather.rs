//! The files of a run found in folders: all of one run, no unit twice, none missing; what is wrong
//! is named.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use super::Shard;
use super::file::{Contents, Header, read_head};
use crate::error::{Error, Result};
use crate::output::names::matches;

/// A file and its head.
#[derive(Debug, Clone)]
pub struct Found {
    /// Path of the file.
    pub path: PathBuf,
    /// Head of the file.
    pub header: Header,
    /// Its bytes, where another process has sent them.
    pub received: Option<Vec<u8>>,
}

impl Found {
    /// A file that another process has sent instead of its path alone.
    ///
    /// # Errors
    /// It is damaged.
    pub fn received(path: PathBuf, bytes: Vec<u8>) -> Result<Self> {
        let header = Contents::parse(&path, bytes.clone())?.header;
        Ok(Self { path, header, received: Some(bytes) })
    }

    /// All of it.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn contents(&self) -> Result<Contents> {
        match &self.received {
            Some(bytes) => Contents::parse(&self.path, bytes.clone()),
            None => Contents::read(&self.path),
        }
    }
}

/// Beginning and end of the names of the files.
const PATTERN: [&str; 2] = ["shard-", ".state"];
/// So many of a kind are named.
const NAMED: usize = 6;

/// The states in folders, each once, in the order of their names; a path to a file is that file.
///
/// # Errors
/// A folder that cannot be read, a file that is no state of a shard.
pub fn find(places: &[PathBuf]) -> Result<Vec<Found>> {
    let mut paths: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    for place in places {
        let full = |path: PathBuf| (path.canonicalize().unwrap_or_else(|_| path.clone()), path);
        if place.is_file() {
            paths.extend([full(place.clone())]);
            continue;
        }
        let entries = std::fs::read_dir(place).map_err(|e| Error::io("read", place, &e))?;
        for entry in entries {
            let name = entry.map_err(|e| Error::io("read", place, &e))?.file_name();
            if matches(&PATTERN.join("*"), &name.to_string_lossy()) {
                paths.extend([full(place.join(name))]);
            }
        }
    }
    let found = paths.into_values().map(|path| Ok(Found { header: read_head(&path)?, path, received: None }));
    found.collect()
}

/// Returns what no file of a run holds: for each part, units that are still to do.
pub fn missing(found: &[Found]) -> Vec<(usize, Range<u64>)> {
    let Some(first) = found.first() else { return Vec::new() };
    let mut gaps = Vec::new();
    for (part, units) in first.header.run.parts.iter().enumerate() {
        let mut at = 0;
        for (covered, _) in covered(found, part) {
            if covered.start > at {
                gaps.push((part, at..covered.start));
            }
            at = at.max(covered.end);
        }
        if at < *units {
            gaps.push((part, at..*units));
        }
    }
    gaps
}

/// Returns what of a part is done, in order, and by whom.
fn covered(found: &[Found], part: usize) -> Vec<(Range<u64>, &Found)> {
    let of = |file| {
        let Found { header, .. }: &Found = file;
        let pieces = header.pieces.iter().filter(|p| p.piece.part == part && p.next > p.piece.units.start);
        pieces.map(move |p| (p.piece.units.start..p.next, file))
    };
    let mut all: Vec<(Range<u64>, &Found)> = found.iter().flat_map(of).collect();
    all.sort_by_key(|(units, _)| (units.start, units.end));
    all
}

const ATTEMPT: &str = "could not merge";
/// States belong to the version that wrote them.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Refuses files that are not all of one run of this version, or hold a unit twice.
///
/// # Errors
/// The first file that is in the way, by its name.
pub fn belong_together(found: &[Found], places: &[PathBuf]) -> Result<()> {
    if found.is_empty() {
        let names: Vec<String> = places.iter().map(|p| p.display().to_string()).collect();
        let cause = format!("no file {} in {}", PATTERN.join("K-of-N"), names.join(", "));
        return Err(Error::new(ATTEMPT, cause, "give the folders that the shards were written to"));
    }
    // The run of most files is the one that is meant.
    let mut runs: Vec<(usize, &Found)> = Vec::new();
    for file in found {
        match runs.iter_mut().find(|(_, first)| first.header.run == file.header.run) {
            Some((count, _)) => *count += 1,
            None => runs.push((1, file)),
        }
    }
    runs.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    if let [(_, meant), (_, foreign), ..] = &runs[..] {
        let (one, other) = (&meant.header.run, &foreign.header.run);
        let difference = if one.command != other.command {
            format!("a `{}`, not a `{}`", other.command, one.command)
        } else if one.version != other.version {
            format!("of version {}, not {}", other.version, one.version)
        } else {
            format!("made with another input, seed or number of {}, or the recordings have changed", one.unit)
        };
        let cause = format!(
            "{} belongs to another run than {}: it is {difference}",
            foreign.path.display(),
            meant.path.display()
        );
        return Err(Error::new(
            ATTEMPT,
            cause,
            "leave that file out, or run that shard again with the same study and seed",
        ));
    }
    let version = &found[0].header.run.version;
    if version != VERSION {
        let cause = format!("the shards were written by version {version}, and this is {VERSION}");
        return Err(Error::new(ATTEMPT, cause, "merge them with that version, or run all shards again with this one"));
    }
    for part in 0..found[0].header.run.parts.len() {
        for pair in covered(found, part).windows(2) {
            let [(before, one), (after, other)] = pair else { continue };
            if after.start < before.end {
                let cause = format!(
                    "{} and {} overlap: both hold {} {} to {}",
                    one.path.display(),
                    other.path.display(),
                    found[0].header.run.unit,
                    after.start,
                    before.end.min(after.end) - 1
                );
                return Err(Error::new(ATTEMPT, cause, "leave one of the two out"));
            }
        }
    }
    Ok(())
}

/// Refuses files that are not the whole of a run.
///
/// # Errors
/// As [`belong_together`], and the shards that are not there or not finished, by their names.
pub fn are_whole(found: &[Found], places: &[PathBuf]) -> Result<()> {
    belong_together(found, places)?;
    let gaps = missing(found);
    if gaps.is_empty() {
        return Ok(());
    }
    let unfinished: Vec<String> =
        found.iter().filter(|f| !f.header.is_done()).map(|f| f.path.display().to_string()).collect();
    let named = |names: &[String]| {
        let more = names.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{}{more}", names[..names.len().min(NAMED)].join(", "))
    };
    if !unfinished.is_empty() {
        let (cause, hint) = (format!("not finished: {}", named(&unfinished)), "run these shards again with --resume");
        return Err(Error::new(ATTEMPT, cause, hint));
    }
    let absent = absent(found);
    let cause = match absent.is_empty() {
        false => format!("missing: {}", named(&absent)),
        true => {
            let unit = &found[0].header.run.unit;
            let words: Vec<String> =
                gaps.iter().map(|(_, gap)| format!("{unit} {} to {}", gap.start, gap.end - 1)).collect();
            format!("missing: {}", named(&words))
        }
    };
    Err(Error::new(ATTEMPT, cause, "run these shards, or give the folders that they are in too"))
}

/// Names of the files that are not there, where all are of the same number.
fn absent(found: &[Found]) -> Vec<String> {
    let of = found[0].header.shard.of;
    if found.iter().any(|f| f.header.shard.of != of) {
        return Vec::new();
    }
    let there = |number: u64| found.iter().any(|f| f.header.shard.number == number);
    (1..=of).filter(|n| !there(*n)).map(|number| Shard { number, of }.file_name()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Piece;
    use super::super::file::{Progress, Run};
    use super::*;

    fn found(identity: &str, shard: &str, units: Range<u64>, next: u64) -> Found {
        let run = Run {
            command: "study".into(),
            version: VERSION.into(),
            identity: identity.into(),
            unit: "members".into(),
            parts: vec![100],
        };
        let shard: Shard = shard.parse().expect("a shard");
        let pieces = vec![Progress { piece: Piece { part: 0, units }, next, bytes: 0 }];
        let header = Header { run, input: None, document: serde_json::Value::Null, shard, pieces };
        Found { path: shard.file_name().into(), header, received: None }
    }

    fn cause(files: &[Found]) -> String {
        are_whole(files, &[]).map_or_else(|e| e.cause, |()| "whole".into())
    }

    #[test]
    fn what_is_wrong_is_named() {
        let (a, b, c) = (found("x", "1/3", 0..30, 30), found("x", "2/3", 30..60, 60), found("x", "3/3", 60..100, 100));
        assert_eq!(cause(&[b.clone(), c.clone(), a.clone()]), "whole");
        assert_eq!(cause(&[a.clone(), c.clone()]), "missing: shard-2-of-3.state");
        assert_eq!(missing(&[a.clone(), c.clone()]), [(0, 30..60)]);
        let half = found("x", "2/3", 30..60, 40);
        assert_eq!(cause(&[a.clone(), half, c.clone()]), "not finished: shard-2-of-3.state");
        let foreign = found("y", "2/3", 30..60, 60);
        assert!(cause(&[a.clone(), foreign, c.clone()]).starts_with("shard-2-of-3.state belongs to another run than"));
        let wide = found("x", "1/2", 0..50, 50);
        let words = "shard-1-of-2.state and shard-2-of-3.state overlap: both hold members 30 to 49";
        assert_eq!(cause(&[wide.clone(), b, c.clone()]), words);
        assert_eq!(cause(&[wide, c]), "missing: members 50 to 59");
        assert!(cause(&[]).contains("no file shard-K-of-N.state"));
        let mut older = found("x", "1/1", 0..100, 100);
        assert_eq!(cause(std::slice::from_ref(&older)), "whole");
        older.header.run.version = "0.0.9".into();
        assert_eq!(cause(&[older]), format!("the shards were written by version 0.0.9, and this is {VERSION}"));
    }
}
