//! Findings on a recorded flight that were survived: typed; the sentence stands next to it.

use std::fmt;

use crate::number::rounded;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::source::ErrorSource;

/// One thing that a person should know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finding {
    /// Rows without a reading were left out.
    LeftOut {
        /// Number of rows left out.
        rows: usize,
        /// The first, counted from zero after the header.
        first_row: usize,
    },
    /// Readings are missing in between, and short holes were bridged by straight lines.
    Bridged {
        /// Number of readings that were made up.
        readings: usize,
    },
    /// Holes that no window goes across.
    Holes {
        /// Number of holes in the readings.
        holes: usize,
        /// The longest, s.
        longest_s: f64,
    },
    /// The log and the reference share a part of their time.
    Overlap {
        /// Duration, s.
        seconds: f64,
        /// Rows of the log within it: the first and the last.
        rows: [usize; 2],
        /// Rows of the log outside it.
        outside: usize,
    },
    /// The units of the log are not stated.
    UnitsTaken,
    /// The readings follow the reference badly.
    Follows {
        /// Correlation of the angular rates.
        correlation: f64,
    },
    /// No window of a length fits.
    NoWindow {
        /// The length, s.
        seconds: f64,
        /// The longest stretch without a hole, s.
        longest_s: f64,
    },
    /// Windows of a length without any other to take biases from.
    NoOther {
        /// The length, s.
        seconds: f64,
        /// Number of windows of that length.
        windows: usize,
    },
    /// Windows of a length with too few others next to them to take the reference's attitude error
    /// from.
    ReferenceOfOthers {
        /// The length, s.
        seconds: f64,
        /// Number of windows of that length.
        windows: usize,
    },
    /// A still stretch that was found.
    Still {
        /// Its begin on the reference's clock, s.
        from_s: f64,
        /// Its length, s.
        seconds: f64,
    },
    /// The sensor has a slow error that the bands of the windows do not have.
    NotInBands {
        /// Source of the error.
        source: ErrorSource,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::LeftOut { rows, first_row } => {
                write!(
                    f,
                    "{rows} rows of the IMU's log hold no reading or repeat a stamp and were left out, the first is row {first_row}"
                )
            }
            Self::Bridged { readings } => {
                write!(f, "{readings} readings are missing from the IMU's log; straight lines stand in their place")
            }
            Self::Holes { holes, longest_s } => write!(
                f,
                "the IMU's log has {holes} holes, up to {} s long; no window goes across one",
                rounded(longest_s, 3)
            ),
            Self::Overlap { seconds, rows, outside } => write!(
                f,
                "the IMU's log and the reference share {} s: rows {} to {} of the log; {outside} rows lie outside",
                rounded(seconds, 4),
                rows[0],
                rows[1]
            ),
            Self::UnitsTaken => write!(f, "the IMU's log states no units: its readings are taken for rad/s and m/s²"),
            Self::Follows { correlation } => write!(
                f,
                "the angular rates of log and reference correlate by {} only: a time offset, another mounting, or a reference \
                 that hardly turns",
                rounded(correlation, 2)
            ),
            Self::NoWindow { seconds, longest_s } => write!(
                f,
                "no window of {seconds} s fits: the longest stretch without a hole lasts {} s",
                rounded(longest_s, 4)
            ),
            Self::NoOther { seconds, windows } => write!(
                f,
                "{windows} windows of {seconds} s have no other next to them to take biases from, and were left out"
            ),
            Self::ReferenceOfOthers { seconds, windows } => write!(
                f,
                "{windows} windows of {seconds} s have too few others beside them: in their inflated bands the \
                 reference errs as those of the other flights do"
            ),
            Self::Still { from_s, seconds } => {
                write!(
                    f,
                    "the biases are the mean of the quietest {seconds} s, from {} s of the reference on",
                    rounded(from_s, 4)
                )
            }
            Self::NotInBands { source } => {
                let why = match source {
                    ErrorSource::Term(term) if term.law() == ErrorLaw::Settling => {
                        "no window tells how long the sensor has been on"
                    }
                    _ => "it is not in the windows' covariance, and the bands are too narrow by it",
                };
                write!(f, "the bands leave out the {}: {why}", source.name())
            }
        }
    }
}
