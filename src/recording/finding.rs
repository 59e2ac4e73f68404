//! What was found in a recording and survived: typed, so that programs can decide by it; the sentence stands beside it.

use std::fmt;

use super::dropped::{Dropped, Reason};
use super::time_unit::{Basis, TimeUnit};
use super::trajectory::Trajectory;
use crate::number::{duration, rounded, significant};

/// One thing that a person should know. Rows are counted from zero after the header, lines from one.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// The first line holds numbers.
    NoHeader,
    /// The numbers of a file without headings are those of a trajectory.
    TrajectoryRecognised {
        /// Which kind.
        kind: Trajectory,
    },
    /// A row of units below the headings.
    UnitsRow {
        /// Its line, counted from one.
        line: u64,
    },
    /// The column that holds the time was not named, and found.
    ClockFound {
        /// Its heading.
        heading: String,
        /// How.
        by: ClockBy,
    },
    /// One part of several was read.
    PartChosen {
        /// Topic, message or array.
        name: String,
        /// How many other parts there are.
        others: usize,
    },
    /// Bytes that are no part of the format were passed over.
    SkippedBytes {
        /// How many.
        bytes: u64,
        /// The first of them, counted from zero.
        first: u64,
    },
    /// The unit of some columns is not stated, and taken for granted.
    UnitAssumed {
        /// The columns.
        columns: Vec<String>,
        /// The unit.
        unit: &'static str,
        /// The option that states it.
        option: &'static str,
    },
    /// Lines between the rows that are comments or blank.
    SkippedLines {
        /// How many.
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
        /// How it was found.
        basis: Basis,
        /// Sampling rate that follows.
        rate_hz: f64,
    },
    /// Several samples share a stamp, or every stamp is rounded to a step near the sampling interval.
    CoarseStamps {
        /// Step between stamps that differ.
        step_s: f64,
        /// Sampling rate that follows.
        rate_hz: f64,
    },
    /// A counter ran over and began again.
    ClockWrapped {
        /// How often.
        times: usize,
        /// Where it begins again, in the unit of the stamps.
        modulus: f64,
        /// Unit of the stamps.
        unit: TimeUnit,
        /// The first row.
        first_row: usize,
    },
    /// The sampling rate changes slowly.
    RateVaries {
        /// Lowest rate.
        from_hz: f64,
        /// Highest rate.
        to_hz: f64,
        /// Rate used.
        mean_hz: f64,
    },
    /// More than 1 % of the steps are off by more than a quarter.
    UnevenClock {
        /// Share of steps that are off.
        share: f64,
        /// Sampling rate that follows.
        rate_hz: f64,
        /// What was done.
        treatment: Uneven,
    },
    /// Samples without a row that straight lines stand in for.
    GapsFilled {
        /// Samples filled.
        samples: usize,
        /// How many gaps.
        gaps: usize,
    },
    /// Gaps too long to be filled: the longest part is used.
    LongGaps {
        /// How many gaps.
        gaps: usize,
        /// Length of the first.
        first_s: f64,
        /// When it begins, from the first row.
        after_s: f64,
        /// Rows concerned.
        rows: usize,
        /// Rows there are.
        of: usize,
        /// When the part used begins, from the first row.
        from_s: f64,
    },
    /// Gaps that no averaging time reaches across.
    Breaks {
        /// How many gaps.
        gaps: usize,
    },
    /// Only part of the file was asked for.
    Cut {
        /// First row used.
        from_row: usize,
        /// Row behind the last one used.
        to_row: usize,
        /// Rows there are.
        of: usize,
    },
    /// Rows that repeat the row before them in every column, where no clock tells.
    RepeatedRows {
        /// Rows concerned.
        rows: usize,
        /// The first row.
        first_row: usize,
        /// Whether they stand for lost samples, not for samples written twice.
        lost: bool,
    },
    /// Missing readings of one column, filled by straight lines.
    MissingReadings {
        /// Heading.
        column: String,
        /// How many.
        readings: usize,
        /// Most in a row.
        longest: usize,
    },
    /// A column without any change.
    Constant {
        /// Heading.
        column: String,
        /// The value.
        value: f64,
    },
    /// Whole numbers of which double precision cannot tell neighbours apart.
    BeyondDouble {
        /// Heading.
        column: String,
        /// The first row.
        first_row: usize,
    },
    /// One extreme value far too often.
    Clipped {
        /// Heading.
        column: String,
        /// The value.
        value: f64,
        /// Whether it is the highest value, not the lowest.
        highest: bool,
        /// Rows concerned.
        rows: usize,
    },
    /// One value for a long time.
    Stuck {
        /// Heading.
        column: String,
        /// The first row.
        first_row: usize,
        /// Rows concerned.
        rows: usize,
    },
    /// A single reading far from its neighbours: `ratio` times the usual change.
    Leap {
        /// Heading.
        column: String,
        /// Where.
        near_row: usize,
        /// Change over the usual change.
        ratio: f64,
    },
}

/// How a column was known to hold the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClockBy {
    /// The format says so.
    Format,
    /// Its heading, and its numbers rise.
    Heading,
    /// Its numbers alone: they rise in even steps.
    Numbers,
}

/// What was done about an uneven clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uneven {
    /// Values were interpolated at even times.
    Resampled,
    /// Only the stamps are uneven; the samples are smooth row by row.
    SamplesEven,
    /// Rows are used as if they were even.
    TakenAsEven,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoHeader => write!(f, "the file has no header; its columns are called 1, 2, 3, … here"),
            Self::TrajectoryRecognised { kind } => write!(
                f,
                "the file has no header; by its numbers it is a {} trajectory, whose columns are {}",
                kind.name(),
                kind.columns().join(" ")
            ),
            Self::UnitsRow { line } => write!(f, "line {line} holds the units of the columns"),
            Self::ClockFound { heading, by } => match by {
                ClockBy::Format => write!(f, "the clock is `{heading}`, which the format says"),
                ClockBy::Heading => write!(
                    f,
                    "the clock is the column `{heading}`, by its heading and as its numbers rise; to choose another one or a \
                     rate: --time, --rate-hz"
                ),
                ClockBy::Numbers => write!(
                    f,
                    "the clock is taken to be the column `{heading}`, whose numbers alone rise in even steps; to choose \
                     another one or a rate: --time, --rate-hz"
                ),
            },
            Self::PartChosen { name, others } => {
                write!(f, "`{name}` was read, and {} of the file left out", count(*others, "other part"))
            }
            Self::SkippedBytes { bytes, first } => {
                write!(f, "{bytes} bytes that are no part of any message were passed over, the first at byte {first}")
            }
            Self::UnitAssumed { columns, unit, option } => write!(
                f,
                "the unit of {} is not stated: taken as {unit}; if it is another one, name the columns and give {option}",
                columns.join(", ")
            ),
            Self::SkippedLines { lines, first_line } => {
                write!(
                    f,
                    "{lines} blank or comment lines between the rows were skipped, the first is line {first_line}"
                )
            }
            Self::Dropped(dropped) => drop_sentence(f, dropped),
            Self::TimeUnit { heading, unit, basis, rate_hz } => {
                let why = match basis {
                    _ if *unit == TimeUnit::Second => "the usual unit",
                    Basis::Heading | Basis::Default => "the usual unit",
                    Basis::Rate => "which agrees with the rate given",
                    Basis::Epoch => "counted from 1970",
                    Basis::Magnitude => "which gives the most plausible rate",
                };
                let (unit, rate) = (unit.name(), rounded(*rate_hz, 6));
                write!(
                    f,
                    "the heading `{heading}` names no unit of time: its stamps are taken to be in {unit}, {why} ({rate} Hz); \
                     if they are not, name the unit in the heading, e.g. `t_{unit}`"
                )
            }
            Self::CoarseStamps { step_s, rate_hz } => write!(
                f,
                "the time stamps are rounded to steps of {} s: every row is used as a sample, and the rate of {} Hz is that \
                 of the whole recording",
                significant(*step_s, 3),
                rounded(*rate_hz, 6)
            ),
            Self::ClockWrapped { times, modulus, unit, first_row } => write!(
                f,
                "the clock starts again after {modulus} {}, {times} {}, first in row {first_row}: a counter that overflowed; \
                 the times were made continuous",
                unit.name(),
                if *times == 1 { "time" } else { "times" }
            ),
            Self::RateVaries { from_hz, to_hz, mean_hz } => write!(
                f,
                "the sampling rate varies between {} and {} Hz over the recording; the mean, {} Hz, is used, so times and \
                 frequencies are off by up to {} %",
                rounded(*from_hz, 6),
                rounded(*to_hz, 6),
                rounded(*mean_hz, 6),
                significant(100.0 * ((to_hz / mean_hz - 1.0).max(1.0 - from_hz / mean_hz)), 2)
            ),
            Self::UnevenClock { share, rate_hz, treatment } => {
                let (share, rate) = (100.0 * share, rounded(*rate_hz, 6));
                write!(f, "the clock is uneven ({share:.1} % of the steps are off by more than a quarter)")?;
                match treatment {
                    Uneven::Resampled => write!(
                        f,
                        ": resampled to {rate} Hz by polynomials through six rows, which changes what lies near half that \
                         rate"
                    ),
                    Uneven::SamplesEven => write!(f, ", but the samples are even: taken as {rate} Hz throughout"),
                    Uneven::TakenAsEven => write!(f, ": the rows are taken as even samples at {rate} Hz"),
                }
            }
            Self::GapsFilled { samples, gaps } => {
                write!(
                    f,
                    "{} in {} filled by straight lines",
                    count(*samples, "missing sample"),
                    if *gaps == 1 { "a short gap was".into() } else { format!("{gaps} short gaps were") }
                )
            }
            Self::LongGaps { gaps, first_s, after_s, rows, of, from_s } => write!(
                f,
                "{}, the first of {first_s:.3} s after t = {after_s:.3} s; only the longest part is used, {rows} of {of} rows from \
                 t = {from_s:.3} s",
                count(*gaps, "long gap")
            ),
            Self::Breaks { gaps } => write!(f, "{}: no averaging time reaches across one", count(*gaps, "long gap")),
            Self::Cut { from_row, to_row, of } => write!(
                f,
                "rows {from_row} to {to_row} (exclusive) of {of} were used, as asked; rows, samples and times count from there"
            ),
            Self::RepeatedRows { rows, first_row, lost } => {
                write!(
                    f,
                    "{rows} rows, the first is row {first_row}, repeat the row before them exactly in every column: "
                )?;
                match lost {
                    true => write!(f, "taken for lost samples and filled by straight lines"),
                    false => write!(f, "taken for samples written twice and dropped"),
                }
            }
            Self::MissingReadings { column, readings, longest } => write!(
                f,
                "`{column}`: {readings} missing values were filled by straight lines, at most {longest} in a row"
            ),
            Self::Constant { column, value } => write!(f, "`{column}` is constant ({value}): a dead channel?"),
            Self::BeyondDouble { column, first_row } => write!(
                f,
                "`{column}` holds whole numbers beyond 2^53, first in row {first_row}: double precision cannot tell \
                 neighbouring ones apart; subtract a constant before they are logged"
            ),
            Self::Clipped { column, value, highest, rows } => write!(
                f,
                "`{column}` stays at {value} in {rows} rows and never goes {}: clipped?",
                if *highest { "above" } else { "below" }
            ),
            Self::Stuck { column, first_row, rows } => {
                write!(f, "`{column}` does not change for {rows} rows from row {first_row}: stuck?")
            }
            Self::Leap { column, near_row, ratio } => write!(
                f,
                "`{column}` leaps near row {near_row} by {ratio:.0} times its usual change: a stray reading or a knock? It \
                 makes the noise look larger"
            ),
        }
    }
}

fn drop_sentence(f: &mut fmt::Formatter<'_>, dropped: &Dropped) -> fmt::Result {
    let Dropped { reason, rows, first_row } = *dropped;
    let counted = count(rows, "row");
    let were = if rows == 1 { "was" } else { "were" };
    match reason {
        Reason::CutShort => return write!(f, "the last row ({first_row}) is cut short; it was left out"),
        Reason::SameStamp => write!(f, "{counted} {were} dropped because they repeat the time stamp before them"),
        Reason::WrittenTwice => write!(
            f,
            "{counted} {were} dropped because they repeat the time stamp and the readings before them: written twice"
        ),
        Reason::NoStamp => write!(f, "{counted} {were} dropped for want of a time stamp"),
        Reason::StoppedClock => write!(f, "{counted} {were} dropped because the clock stands still there"),
        Reason::MissingReading => write!(f, "{counted} {were} not used because a reading is missing"),
        Reason::HoldsPlace => write!(f, "{counted} {were} not used: repeated in place of lost samples"),
        Reason::OutsideRows | Reason::OutsideSeconds | Reason::OutsideSplit | Reason::BeyondGap => {
            write!(f, "{counted} {were} not used: {}", reason.words())
        }
    }?;
    write!(f, "; the first is row {first_row}")
}

/// "1 row", "2 rows".
fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// Drops what a better finding explains: a column of rounded whole numbers may seem constant.
pub fn settle(findings: &mut Vec<Finding>) {
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
