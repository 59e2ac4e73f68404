//! The book is written: cases are made and sealed, each verdict is asked for and kept as a line,
//! the seal is checked after the last.

use std::collections::BTreeMap;
use std::path::Path;

use super::corpus::{self, CASES, Item, ROWS};
use super::entry::Entry;
use crate::ask::{self, Subject};
use crate::independent::case::Case;
use crate::independent::run::{self, Plan, keep, kept, seal};
use crate::real::Real;
use crate::scratch::Scratch;
use proofmass_base::control::Control;
use proofmass_base::error::{Error, Result};

/// States where a book lies, and where the real recordings do.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// The sealed truth.
    pub truth: &'a Path,
    /// The lines, one after the other as they are given.
    pub lines: &'a Path,
    /// Folder of the real recordings.
    pub data: &'a Path,
}

/// Returns the lines of a book; one that was cut is left out.
///
/// # Errors
/// The file is there and cannot be read.
pub fn read(path: &Path) -> Result<Vec<Entry>> {
    kept(path)
}

/// A case that is there to be asked.
pub(super) enum Made<'a> {
    /// A case of the second generator.
    Drawn(Box<Case>),
    /// A real recording.
    Recorded(&'a Real),
}

impl Made<'_> {
    /// Asks for the verdict and returns its line.
    pub(super) fn ask(&self, seed: u64, subject: &Subject<'_>, data: &Path, scratch: &Scratch) -> Result<Entry> {
        match self {
            Self::Drawn(case) => Ok(Entry::drawn(seed, case, run::ask(case, subject, scratch)?)),
            Self::Recorded(real) => {
                let folder = scratch.case()?;
                let files = real.files(data, folder.path())?;
                Ok(Entry::recorded(real, ask::ask(&files, subject)?))
            }
        }
    }

    /// Returns the name of the case in the book.
    pub(super) fn name(&self, seed: u64) -> String {
        match self {
            Self::Drawn(case) => corpus::name(seed, case.number),
            Self::Recorded(real) => real.id(),
        }
    }
}

/// Makes the cases of these items and seals them in a file; recordings come first, as they take
/// longest. Returns them with the seal.
pub(super) fn made<'a>(
    items: &[&Item<'a>],
    seed: u64,
    truth: &Path,
    control: &Control,
) -> Result<(String, Vec<Made<'a>>)> {
    let orders: Vec<run::Order> =
        items.iter().filter_map(|item| if let Item::Drawn(order) = item { Some(*order) } else { None }).collect();
    let (sealed, cases) = seal(Plan { seed, cases: CASES, rows: ROWS, kind: None }, &orders, truth, control)?;
    control.remark(&format!("sealed truth of {} cases, SHA-256 {sealed}", cases.len()));
    let recorded =
        items.iter().filter_map(|item| if let Item::Recorded(real) = item { Some(Made::Recorded(real)) } else { None });
    Ok((sealed, recorded.chain(cases.into_iter().map(|case| Made::Drawn(Box::new(case)))).collect()))
}

/// Asks for every verdict that is not `done` yet. Returns the whole book in the order of its items,
/// without cases that cannot be made.
///
/// # Errors
/// Nothing can be written, the sealed truth was changed, or the work was stopped.
pub fn run(
    items: &[Item<'_>],
    seed: u64,
    done: Vec<Entry>,
    places: &Places<'_>,
    subject: &Subject<'_>,
    control: &Control,
) -> Result<Vec<Entry>> {
    let mut lines: BTreeMap<String, Entry> = done.into_iter().map(|entry| (entry.case.clone(), entry)).collect();
    let open: Vec<&Item<'_>> = items.iter().filter(|item| !lines.contains_key(&item.name(seed))).collect();
    let (sealed, made) = made(&open, seed, places.truth, control)?;
    let scratch = Scratch::new(places.lines.parent())?;
    let fresh = keep(&made, places.lines, control, |made| made.ask(seed, subject, places.data, &scratch))?;
    // What was judged is what was sealed.
    run::open(places.truth, &sealed)?;
    lines.extend(fresh.into_iter().map(|entry| (entry.case.clone(), entry)));
    Ok(items.iter().filter_map(|item| lines.remove(&item.name(seed))).collect())
}

/// Returns the lines as the text of book.jsonl.
///
/// # Errors
/// None for the types of this crate, whose keys are strings.
pub fn text(book: &[Entry]) -> Result<String> {
    let line = |entry: &Entry| {
        serde_json::to_string(entry).map(|line| line + "\n").map_err(|e| {
            Error::new("could not write the book", e.to_string(), "this is a defect of the program; please report it")
        })
    };
    book.iter().map(line).collect()
}
