//! The state file of a shard of a study while it is being filled, piece by piece.

use std::path::Path;

use super::encode::{pack, unpack};
use super::state::{Run, State};
use super::verify;
use crate::backend::cpu::Precision;
use crate::error::{Error, Result};
use crate::kernel::job::Job;
use crate::shard::file::{Contents, Header, Place, damaged};
use proofmass_base::signal::Keeping;

/// A shard's file, and what is packed for it.
#[derive(Debug)]
pub struct Kept {
    place: Place,
    header: Header,
    /// Packed results of each piece, empty where it was not begun.
    results: Vec<Vec<u8>>,
    /// Pieces that this run begins with: those before are another run's.
    first: usize,
    /// The piece begun last.
    at: Option<usize>,
    /// Keeps a signal from ending the process before what was done is written.
    _keeping: Keeping,
}

impl Kept {
    /// A shard that begins anew.
    pub fn new(place: Place, header: Header) -> Self {
        let results = vec![Vec::new(); header.pieces.len()];
        Self { place, header, results, first: 0, at: None, _keeping: Keeping::begin() }
    }

    /// A shard that goes on from its file.
    ///
    /// # Errors
    /// There is none, it is damaged, or it belongs to another run.
    pub fn resume(place: Place, header: Header) -> Result<Self> {
        let contents = Contents::resumed(&place, &header)?;
        let results = contents.pieces().map(|(_, bytes)| bytes.to_vec()).collect();
        Ok(Self { results, header: contents.header, ..Self::new(place, header) })
    }

    /// A shard that keeps what its file holds, as far as it has come, and goes on with the pieces
    /// of the head.
    pub fn behind(place: Place, mut header: Header, before: Option<&Contents>) -> Self {
        let mut pieces = Vec::new();
        let mut results = Vec::new();
        for (progress, bytes) in before.iter().flat_map(|before| before.pieces()) {
            let mut done = progress.clone();
            done.piece.units.end = done.next;
            pieces.push(done);
            results.push(bytes.to_vec());
        }
        let first = pieces.len();
        results.resize(first + header.pieces.len(), Vec::new());
        pieces.append(&mut header.pieces);
        header.pieces = pieces;
        Self { results, first, ..Self::new(place, header) }
    }

    /// Returns the identity of the run.
    pub(super) fn identity(&self) -> &str {
        &self.header.run.identity
    }

    /// Returns the path of the file.
    pub(super) fn path(&self) -> &Path {
        self.place.path()
    }

    /// Packs the piece begun last, and begins the next one or goes on with it.
    pub(super) fn begin(&mut self, last: Option<&State>, job: &Job, precision: Precision) -> Result<State> {
        self.note(last)?;
        let at = self.at.map_or(self.first, |at| at + 1);
        self.at = Some(at);
        let Some(progress) = self.header.pieces.get(at) else {
            return Err(Error::new("could not run a shard", "it has no such piece", "report this as a defect"));
        };
        let run = Run { identity: &self.header.run.identity, part: progress.piece.part + 1, job, precision };
        if self.results[at].is_empty() {
            return Ok(State::new(&run, progress.piece.units.clone()));
        }
        let mut state = State::new(&run, 0..0);
        let read = unpack(&self.results[at], &run, &mut state).and_then(|()| verify::check(&state, job));
        read.map_err(|what| damaged(self.place.path(), &what))?;
        Ok(state)
    }

    fn note(&mut self, last: Option<&State>) -> Result<()> {
        if let (Some(at), Some(state)) = (self.at, last) {
            self.results[at] = pack(state)
                .map_err(|e| Error::new("could not write a shard's state", e.to_string(), "report this as a defect"))?;
            self.header.pieces[at].next = state.next_member;
        }
        Ok(())
    }

    pub(super) fn write(&mut self, last: Option<&State>) -> Result<()> {
        self.note(last)?;
        self.place.write(&self.header, &self.results)
    }
}
