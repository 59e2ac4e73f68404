//! The share of a study in motion that one shard integrates, and its sums in the shard's file.

use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::totals::Totals;
use crate::error::{Error, Result};
use crate::shard::file::{Contents, Header, Place, damaged};
use crate::statistics::Machine;

/// Sums of a shard, in its file.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Results {
    /// Machine that integrated it.
    pub machine: Machine,
    /// Wall time, s.
    pub seconds: f64,
    /// Sums at every report time.
    pub totals: Totals,
}

impl Results {
    /// From the bytes of a file.
    ///
    /// # Errors
    /// They are no such sums.
    pub(crate) fn read(bytes: &[u8], path: &Path) -> Result<Self> {
        serde_json::from_slice(bytes)
            .map_err(|e| damaged(path, &format!("its sums are not those of a study in motion: {e}")))
    }
}

/// A shard: its file, and what that held when the run began.
#[derive(Debug)]
pub struct Share {
    place: Place,
    header: Header,
    before: Option<Results>,
}

impl Share {
    /// A shard that begins anew.
    pub fn new(place: Place, header: Header) -> Self {
        Self { place, header, before: None }
    }

    /// A shard that goes on from its file.
    ///
    /// # Errors
    /// There is none, it is damaged, or it belongs to another run.
    pub fn resume(place: Place, header: &Header) -> Result<Self> {
        let contents = Contents::resumed(&place, header)?;
        let results = contents.pieces().find(|(_, bytes)| !bytes.is_empty());
        let before = results.map(|(_, bytes)| Results::read(bytes, place.path())).transpose()?;
        Ok(Self { place, before, header: contents.header })
    }

    /// Members of the shard; none where there are more shards than blocks of members.
    pub(super) fn members(&self) -> Range<u64> {
        self.header.pieces.first().map_or(0..0, |p| p.piece.units.clone())
    }

    /// First member that is not summed yet, with the sums of those before it.
    ///
    /// # Errors
    /// The sums are another machine's.
    pub(super) fn begun(&mut self, machine: &Machine) -> Result<(u64, Option<Results>)> {
        let next = self.header.pieces.first().map_or(0, |p| p.next);
        match self.before.take() {
            Some(before) if !before.machine.same_bits(machine) => Err(Error::new(
                format!("could not resume from {}", self.path().display()),
                format!(
                    "it was integrated on {}, which does not give the bits of {}",
                    before.machine.name, machine.name
                ),
                "resume it with the --backend of that run, or leave --resume out to start over",
            )),
            Some(before) => Ok((next, Some(before))),
            None => Ok((self.members().start, None)),
        }
    }

    /// Forgets what the file held: another machine begins anew.
    pub(super) fn restart(&mut self) {
        self.before = None;
    }

    /// Path of the file.
    pub(super) fn path(&self) -> &Path {
        self.place.path()
    }

    /// Writes the sums of the members before `next`.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub(super) fn write(&self, next: u64, results: &Results) -> Result<()> {
        let mut header = self.header.clone();
        let bytes = serde_json::to_vec(results)
            .map_err(|e| Error::new("could not write a shard's state", e.to_string(), "report this as a defect"))?;
        match header.pieces.first_mut() {
            Some(piece) => {
                piece.next = next;
                self.place.write(&header, &[bytes])
            }
            None => self.place.write(&header, &[]),
        }
    }
}
