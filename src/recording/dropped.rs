//! The rows of a file that were not used, and why: rows read = rows used + rows dropped.

use serde::{Serialize, Serializer};

/// Why rows were not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The user asked for other rows.
    OutsideRows,
    /// Before the first or after the last second that the user asked for.
    OutsideSeconds,
    /// Beyond a long gap, on the side of the shorter part.
    BeyondGap,
    /// Outside the samples that the model's split names.
    OutsideSplit,
    /// The file ends within the row.
    CutShort,
    /// No time stamp.
    NoStamp,
    /// The time stamp of the row before, with other readings, where every sample has a stamp of its
    /// own.
    SameStamp,
    /// The row before once more.
    WrittenTwice,
    /// Holds the place of a lost sample by repeating the row before.
    HoldsPlace,
    /// The clock stood still.
    StoppedClock,
    /// A reading is missing.
    MissingReading,
    /// Noise parameters of an amplifier, behind the response of a two-port.
    NoiseParameters,
}

impl Reason {
    /// In words, for a table and for JSON.
    pub fn words(self) -> &'static str {
        match self {
            Reason::OutsideRows => "outside the rows asked for",
            Reason::OutsideSeconds => "outside the seconds asked for",
            Reason::BeyondGap => "beyond a long gap",
            Reason::OutsideSplit => "outside the samples that [split] names",
            Reason::CutShort => "the file ends within the row",
            Reason::NoStamp => "no time stamp",
            Reason::SameStamp => "same time stamp as the row before",
            Reason::WrittenTwice => "written twice",
            Reason::HoldsPlace => "repeats the row before in place of a lost sample",
            Reason::StoppedClock => "the clock stands still",
            Reason::MissingReading => "a reading is missing",
            Reason::NoiseParameters => "noise parameters, no response",
        }
    }
}

impl Serialize for Reason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.words())
    }
}

/// Rows that were not used for one reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dropped {
    /// Reason for leaving the rows out.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub reason: Reason,
    /// Number of rows dropped for this reason.
    pub rows: usize,
    /// The first of them, counted from zero after the header.
    pub first_row: usize,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Tally {
    all: Vec<Dropped>,
}

impl Tally {
    pub(super) fn add(&mut self, reason: Reason, row: usize) {
        match self.all.iter_mut().find(|d| d.reason == reason) {
            Some(dropped) => {
                dropped.rows += 1;
                dropped.first_row = dropped.first_row.min(row);
            }
            None => self.all.push(Dropped { reason, rows: 1, first_row: row }),
        }
    }

    /// A stretch of rows.
    pub(super) fn add_all(&mut self, reason: Reason, rows: std::ops::Range<usize>) {
        if rows.is_empty() {
            return;
        }
        self.add(reason, rows.start);
        if let Some(dropped) = self.all.iter_mut().find(|d| d.reason == reason) {
            dropped.rows += rows.len() - 1;
        }
    }

    /// Rows that were dropped elsewhere.
    pub(super) fn join(&mut self, others: &[Dropped]) {
        self.all.extend_from_slice(others);
    }

    /// Every reason once, in the order first met.
    pub(super) fn all(self) -> Vec<Dropped> {
        self.all
    }
}
