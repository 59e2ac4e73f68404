//! Findings as sentences.

use std::fmt;

use super::{ClockBy, Finding, Size, Uneven};
use crate::dropped::{Dropped, Reason};
use crate::number::{rounded, significant};
use crate::time_unit::{Basis, TimeUnit};

/// So many columns are named in a sentence.
const NAMED: usize = 6;

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoHeader => write!(f, "the file has no header; its columns are called 1, 2, 3, … here"),
            Self::Preamble { lines, headings } => write!(
                f,
                "{} before the headings in line {headings} {} left out",
                count(*lines as usize, "line"),
                if *lines == 1 { "was" } else { "were" }
            ),
            Self::TrajectoryRecognised { kind } => write!(
                f,
                "the file has no header; by its numbers it is a {} trajectory, whose columns are {}",
                kind.name(),
                kind.columns().join(" ")
            ),
            Self::UnitsRow { line } => write!(f, "line {line} holds the units of the columns"),
            Self::ClockFound { heading, by } => match by {
                ClockBy::Format => write!(f, "the clock is `{heading}`, as the format specifies"),
                ClockBy::Heading => write!(
                    f,
                    "column `{heading}` is used as the clock, because of its name and its increasing values; to \
                    choose another column or a rate: --time, --rate-hz"
                ),
                ClockBy::Numbers => write!(
                    f,
                    "column `{heading}` is used as the clock, because only its values increase in even steps; to \
                    choose another column or a rate: --time, --rate-hz"
                ),
            },
            Self::PartChosen { name, others } => {
                write!(f, "`{name}` was read, and {} of the file left out", count(*others, "other part"))
            }
            Self::SkippedBytes { bytes, first } => {
                write!(f, "{bytes} bytes that belong to no message were skipped, the first at byte {first}")
            }
            Self::UnitAssumed { columns, unit, option, size } => write!(
                f,
                "the unit of {} is not stated: taken as {unit}{}; if it is another one, name the unit in the headings \
                 (`allan` takes {option} as well)",
                columns.join(", "),
                of_size(size)
            ),
            Self::CountsScaled { columns, per_g } => write!(
                f,
                "{} are counts: gravity's length is {} of them, so one is about {}, unless a constant is added to them; the \
                 datasheet's scale is to be preferred (--accelerometer-scale)",
                columns.join(", "),
                significant(*per_g, 4),
                format_args!("{}mg", significant(1e3 / per_g, 4))
            ),
            Self::Environment { columns } => write!(
                f,
                "{} {} taken as environment, not as a reading of the sensor; to analyse it, name it under --columns",
                columns.join(", "),
                if columns.len() == 1 { "is" } else { "are" }
            ),
            Self::ColumnsUnread { columns } => {
                let named: Vec<String> =
                    columns.iter().take(NAMED).map(|(name, cell)| format!("`{name}` (`{cell}`)")).collect();
                let more = match columns.len().saturating_sub(NAMED) {
                    0 => String::new(),
                    n => format!(" and {n} more"),
                };
                let is_sensor =
                    |cell: &str| ["acc", "gyr", "mag"].iter().any(|word| cell.to_lowercase().starts_with(word));
                let by_row = match columns.iter().any(|(_, cell)| is_sensor(cell)) {
                    true => "; if the rows alternate between sensors, write one file per sensor",
                    false => "",
                };
                write!(
                    f,
                    "not read, because the first cell is no number: {}{more}; a number is digits with a decimal point, and at \
                     most a power of ten{by_row}",
                    named.join(", ")
                )
            }
            Self::RateForced { given_hz, clock_hz } => write!(
                f,
                "the rate given, {} Hz, is used against the file's own clock, which says {} Hz",
                rounded(*given_hz, 6),
                rounded(*clock_hz, 6)
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
            Self::InGroups { groups, share, mean_hz } => write!(
                f,
                "the rows stand in {groups} groups, and {:.0} % of the time lies in the pauses between them: samples that were \
                 taken evenly, and stamped in groups as they arrived, would have {mean_hz} Hz (--rate-hz {mean_hz} \
                 --force-rate)",
                100.0 * share
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
                    Uneven::SamplesEven => {
                        write!(f, ", but the samples are evenly spaced: taken as {rate} Hz throughout")
                    }
                    Uneven::TakenAsEven => write!(f, ": the rows are taken as evenly spaced samples at {rate} Hz"),
                }
            }
            Self::GapsFilled { samples, gaps } => {
                write!(f, "{} filled by linear interpolation", in_gaps(*samples, *gaps))
            }
            Self::GapsDrawn { samples, gaps } => {
                write!(f, "{} drawn from the noise of the readings about them", in_gaps(*samples, *gaps))
            }
            Self::LongGaps { gaps, first_s, after_s, rows, of, from_s } => write!(
                f,
                "{}, the first of {first_s:.3} s after t = {after_s:.3} s; only the longest part is used, {rows} of {of} rows from \
                 t = {from_s:.3} s",
                count(*gaps, "long gap")
            ),
            Self::Breaks { gaps } => write!(f, "{}: no averaging window spans a gap", count(*gaps, "long gap")),
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
                    true => write!(f, "taken for lost samples and filled in"),
                    false => write!(f, "taken for samples written twice and dropped"),
                }
            }
            Self::MissingReadings { column, readings, longest } => {
                write!(f, "`{column}`: {readings} missing values were filled in, at most {longest} in a row")
            }
            Self::WrittenInFew { column, readings: 0, .. } => write!(f, "`{column}` holds no value, and is left out"),
            Self::WrittenInFew { column, readings, rows } => {
                write!(f, "`{column}` is written in {readings} of {rows} rows, and taken to go straight in between")
            }
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
            Self::StraysLeftOut { column, readings, named, farthest } => {
                let listed: Vec<String> =
                    named.iter().map(|s| format!("{} in row {}", significant(s.value, 6), s.row)).collect();
                let more = match readings - named.len() {
                    0 => String::new(),
                    n => format!(" and {n} more"),
                };
                write!(
                    f,
                    "`{column}`: {} left out of the noise as stray ({}{more}), {}{} standard deviations off: the level \
                     about it takes its place",
                    if *readings == 1 { "1 reading was".into() } else { format!("{readings} readings were") },
                    listed.join(", "),
                    if *readings == 1 { "" } else { "up to " },
                    significant(*farthest, 3)
                )
            }
            Self::KnocksLeftOut { column, knocks, readings, first_row } => write!(
                f,
                "`{column}`: {} of {readings} readings together, the first at row {first_row}, {} left out of the noise",
                count(*knocks, "knock"),
                if *knocks == 1 { "was" } else { "were" }
            ),
            Self::Leap { column, near_row, ratio } => write!(
                f,
                "`{column}` jumps near row {near_row} by {ratio:.0} times its usual change: a step? It inflates the noise \
                 estimate"
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
        Reason::NoStamp => write!(f, "{counted} {were} dropped because they have no time stamp"),
        Reason::StoppedClock => write!(f, "{counted} {were} dropped because the clock stands still there"),
        Reason::MissingReading => write!(f, "{counted} {were} not used because a reading is missing"),
        Reason::HoldsPlace => write!(f, "{counted} {were} not used: repeated in place of lost samples"),
        Reason::NoiseParameters => {
            return write!(f, "{counted} of noise parameters behind the response {were} left out");
        }
        Reason::OutsideRows | Reason::OutsideSeconds | Reason::OutsideSplit | Reason::BeyondGap => {
            write!(f, "{counted} {were} not used: {}", reason.words())
        }
    }?;
    write!(f, "; the first is row {first_row}")
}

/// Words for the size of readings, after "taken as …".
fn of_size(size: &Size) -> String {
    match size {
        Size::Unknown | Size::Plausible => String::new(),
        Size::Gravity { length } => {
            format!(", because the length of their mean, {}, is gravity's in that unit", significant(*length, 3))
        }
        Size::NotGravity { length } => {
            format!(", although the length of their mean, {}, is gravity's in no unit", significant(*length, 3))
        }
        Size::Noisy { ratio } => format!(
            ", although at rest they would then be {} times as noisy as any gyro is (0.1 °/s/√Hz): are they in deg/s?",
            significant(*ratio, 2)
        ),
    }
}

/// "1 row", "2 rows".
fn in_gaps(samples: usize, gaps: usize) -> String {
    let gaps = if gaps == 1 { "a short gap".into() } else { format!("{gaps} short gaps") };
    format!("{} in {gaps} {}", count(samples, "missing sample"), if samples == 1 { "was" } else { "were" })
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
