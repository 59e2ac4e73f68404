//! States what was found in a recording and survived: typed, so that programs can decide by it; the
//! sentence stands next to it.

mod words;

use super::dropped::Dropped;
use super::time_unit::{Basis, TimeUnit};
use super::trajectory::Trajectory;
use crate::number::{duration, rounded};

/// One thing that a person should know. Rows are counted from zero after the header, lines from
/// one.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// The first line holds numbers.
    NoHeader,
    /// Lines before the headings, as instruments write them, which were left out.
    Preamble {
        /// Number of lines left out, without blank lines and comments.
        lines: u64,
        /// Line of the headings, counted from one.
        headings: u64,
    },
    /// The numbers of a file without headings are those of a trajectory.
    TrajectoryRecognised {
        /// Layout of the trajectory.
        kind: Trajectory,
    },
    /// A row of units below the headings.
    UnitsRow {
        /// Its line, counted from one.
        line: u64,
    },
    /// The column that holds the time was not named, and found.
    ClockFound {
        /// Heading of the column.
        heading: String,
        /// States how the clock was chosen.
        by: ClockBy,
    },
    /// One part of several was read.
    PartChosen {
        /// Topic, message or array.
        name: String,
        /// States how many other parts there are.
        others: usize,
    },
    /// Bytes that are no part of the format were passed over.
    SkippedBytes {
        /// Number of bytes passed over.
        bytes: u64,
        /// The first of them, counted from zero.
        first: u64,
    },
    /// The unit of some columns is not stated, and taken for granted.
    UnitAssumed {
        /// Headings of the columns without a unit.
        columns: Vec<String>,
        /// Unit that is assumed.
        unit: &'static str,
        /// The option that states it.
        option: &'static str,
        /// Holds what the size of the readings says about it.
        size: Size,
    },
    /// Counts, or numbers of no known unit, whose scale follows from gravity's length.
    CountsScaled {
        /// Headings of the columns.
        columns: Vec<String>,
        /// Counts in one standard gravity.
        per_g: f64,
    },
    /// Temperature and the like, which is no reading of a sensor and was left out.
    Environment {
        /// Headings of the columns.
        columns: Vec<String>,
    },
    /// Columns whose cells are no numbers, which were not read.
    ColumnsUnread {
        /// Headings of the columns, each with its first cell.
        columns: Vec<(String, String)>,
    },
    /// The rate that was given is used against the file's own clock.
    RateForced {
        /// Rate that was given, Hz.
        given_hz: f64,
        /// Rate of the file's own clock, Hz.
        clock_hz: f64,
    },
    /// Lines between the rows that are comments or blank.
    SkippedLines {
        /// Number of comment or blank lines.
        lines: u64,
        /// The first, counted from one.
        first_line: u64,
    },
    /// Rows that were not used.
    Dropped(Dropped),
    /// The heading of the time column does not name its unit.
    TimeUnit {
        /// Heading of the time column.
        heading: String,
        /// Unit of the stamps.
        unit: TimeUnit,
        /// States how it was found.
        basis: Basis,
        /// Sampling rate that follows.
        rate_hz: f64,
    },
    /// Several samples share a stamp, or every stamp is rounded to a step near the sampling
    /// interval.
    CoarseStamps {
        /// Step between stamps that differ.
        step_s: f64,
        /// Sampling rate that follows.
        rate_hz: f64,
    },
    /// Most of the time lies in pauses between groups of rows.
    InGroups {
        /// Number of groups.
        groups: usize,
        /// Share of the time that the pauses take.
        share: f64,
        /// Rows over the time of all of it, Hz.
        mean_hz: f64,
    },
    /// A counter ran over and began again.
    ClockWrapped {
        /// Number of times the counter overflowed.
        times: usize,
        /// States where it begins again, in the unit of the stamps.
        modulus: f64,
        /// Unit of the stamps.
        unit: TimeUnit,
        /// First row after an overflow.
        first_row: usize,
    },
    /// The sampling rate changes slowly.
    RateVaries {
        /// Lowest rate, Hz.
        from_hz: f64,
        /// Highest rate, Hz.
        to_hz: f64,
        /// Mean rate, which is used, Hz.
        mean_hz: f64,
    },
    /// More than 1 % of the steps are off by more than a quarter.
    UnevenClock {
        /// Share of steps that are off.
        share: f64,
        /// Sampling rate that follows.
        rate_hz: f64,
        /// States how the uneven clock was treated.
        treatment: Uneven,
    },
    /// Samples without a row that straight lines stand in for.
    GapsFilled {
        /// Number of samples that were interpolated.
        samples: usize,
        /// Number of gaps that were filled.
        gaps: usize,
    },
    /// Samples without a row that were drawn from the noise about them.
    GapsDrawn {
        /// Number of samples that were drawn.
        samples: usize,
        /// Number of gaps that were filled.
        gaps: usize,
    },
    /// Gaps too long to be filled: the longest part is used.
    LongGaps {
        /// Number of gaps that are too long to be filled.
        gaps: usize,
        /// Length of the first.
        first_s: f64,
        /// When it begins, from the first row.
        after_s: f64,
        /// Number of rows that are not used.
        rows: usize,
        /// Rows in the file.
        of: usize,
        /// When the part used begins, from the first row.
        from_s: f64,
    },
    /// Gaps that no averaging time reaches across.
    Breaks {
        /// Number of gaps in the recording.
        gaps: usize,
    },
    /// Only part of the file was asked for.
    Cut {
        /// First row that was used.
        from_row: usize,
        /// Row behind the last one used.
        to_row: usize,
        /// Rows in the file.
        of: usize,
    },
    /// Rows that repeat the row before them in every column, where no clock tells.
    RepeatedRows {
        /// Number of repeated rows.
        rows: usize,
        /// First repeated row.
        first_row: usize,
        /// States whether they stand for lost samples, not for samples written twice.
        lost: bool,
    },
    /// Missing readings of one column, filled by straight lines.
    MissingReadings {
        /// Heading of the column.
        column: String,
        /// Number of missing readings.
        readings: usize,
        /// Most in a row.
        longest: usize,
    },
    /// A column that is written in a few rows, and taken to go straight in between.
    WrittenInFew {
        /// Heading of the column.
        column: String,
        /// Rows that hold a value of it.
        readings: usize,
        /// Rows that were used.
        rows: usize,
    },
    /// A column without any change.
    Constant {
        /// Heading of the column.
        column: String,
        /// Value of every row.
        value: f64,
    },
    /// Whole numbers of which double precision cannot tell neighbours apart.
    BeyondDouble {
        /// Heading of the column.
        column: String,
        /// First row with such a number.
        first_row: usize,
    },
    /// One extreme value far too often.
    Clipped {
        /// Heading of the column.
        column: String,
        /// The value that recurs.
        value: f64,
        /// States whether it is the highest value, not the lowest.
        highest: bool,
        /// Number of rows with that value.
        rows: usize,
    },
    /// One value for a long time.
    Stuck {
        /// Heading of the column.
        column: String,
        /// First row with the stuck value.
        first_row: usize,
        /// Number of rows with the stuck value.
        rows: usize,
    },
    /// Single readings of a column at rest that are no part of its noise: the level about them
    /// takes their place.
    StraysLeftOut {
        /// Heading of the column.
        column: String,
        /// Number of readings left out.
        readings: usize,
        /// The first of them.
        named: Vec<Stray>,
        /// Distance of the farthest one, in standard deviations of the noise.
        farthest: f64,
    },
    /// Knocks in a column at rest: the level before and after, with noise, takes their place.
    KnocksLeftOut {
        /// Heading of the column.
        column: String,
        /// Number of knocks.
        knocks: usize,
        /// Readings left out with them.
        readings: usize,
        /// First row of the first one.
        first_row: usize,
    },
    /// A change of the level, `ratio` times the usual change.
    Leap {
        /// Heading of the column.
        column: String,
        /// Row near the jump.
        near_row: usize,
        /// Change over the usual change.
        ratio: f64,
    },
}

impl Finding {
    /// Returns whether a unit that was taken for granted is in doubt.
    pub fn is_questionable(&self) -> bool {
        matches!(self, Self::UnitAssumed { size: Size::NotGravity { .. } | Size::Noisy { .. }, .. })
    }
}

/// A single reading far from the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stray {
    /// Its row.
    pub row: usize,
    /// Its value, in the file's unit.
    pub value: f64,
    /// Distance from the level about it, in standard deviations of the noise.
    pub deviations: f64,
}

/// The size of readings whose unit is not stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// Nothing can be told of it.
    Unknown,
    /// It agrees with the unit that is taken.
    Plausible,
    /// The length of the mean specific force is that of gravity in the unit that is taken.
    Gravity {
        /// Length of the mean, in units of the file.
        length: f64,
    },
    /// The length of the mean specific force is that of gravity in no unit.
    NotGravity {
        /// Length of the mean, in units of the file.
        length: f64,
    },
    /// A rate at rest is noisier than any gyro's.
    Noisy {
        /// Noise over that of the noisiest gyro.
        ratio: f64,
    },
}

/// States how a column was known to hold the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClockBy {
    /// The format says so.
    Format,
    /// Its heading, and its numbers rise.
    Heading,
    /// Its numbers alone: they rise in even steps.
    Numbers,
}

/// Holds what was done about an uneven clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uneven {
    /// Values were interpolated at even times.
    Resampled,
    /// Only the stamps are uneven; the samples are smooth row by row.
    SamplesEven,
    /// Rows are used as if they were even.
    TakenAsEven,
}

/// Marks filled gaps as drawn by [`lost`](super::lost): for recordings at rest.
pub fn drawn(findings: &mut [Finding]) {
    for finding in findings {
        if let Finding::GapsFilled { samples, gaps } = *finding {
            *finding = Finding::GapsDrawn { samples, gaps };
        }
    }
}

/// Drops what a better finding explains: a column of rounded whole numbers may seem constant.
pub(crate) fn settle(findings: &mut Vec<Finding>) {
    let rounded: Vec<String> = findings
        .iter()
        .filter_map(|f| if let Finding::BeyondDouble { column, .. } = f { Some(column.clone()) } else { None })
        .collect();
    findings.retain(|f| !matches!(f, Finding::Constant { column, .. } if rounded.contains(column)));
}

/// Every finding as a sentence.
pub fn sentences(findings: &[Finding]) -> Vec<String> {
    findings.iter().map(ToString::to_string).collect()
}

/// A length of time in words, for errors of this layer.
pub(super) fn at(seconds: f64) -> String {
    if seconds < 1.0 { format!("{} s", rounded(seconds, 6)) } else { duration(seconds) }
}
