//! Findings on the poses of a file that were survived: typed; the sentence stands next to it.

use std::fmt;

use super::format::{Format, Up};
use crate::motion::earth::Place;
use crate::number::rounded;

/// One thing that a person should know. Rows are counted from zero after the header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finding {
    /// Layout that was recognised.
    Recognised {
        /// Format of the file.
        format: Format,
        /// Says whether the scalar of its quaternions comes first; none: it has none.
        scalar_first: Option<bool>,
    },
    /// Axes that were turned to north, east and down.
    Turned {
        /// The axis that points up in the file.
        up: Up,
    },
    /// Its axes are called north, east and down, or east, north and up.
    NamedAxes,
    /// Its positions are latitudes, longitudes and heights.
    Geodetic {
        /// Place of the first pose.
        place: Place,
        /// Says whether attitudes count from east, with up up, rather than from north, with down down.
        is_east_first: bool,
    },
    /// Rows without a pose were left out.
    Dropped {
        /// Number of rows left out.
        rows: usize,
        /// First row left out.
        first_row: usize,
    },
    /// Rows that repeat the stamp before were left out.
    Repeated {
        /// Number of rows left out.
        rows: usize,
        /// First row left out.
        first_row: usize,
    },
    /// Poses are missing, and what becomes of that time.
    Bridged {
        /// Number of holes in the poses.
        holes: usize,
        /// The longest, s.
        longest_s: f64,
        /// The last row before the longest.
        after_row: usize,
        /// Says what becomes of the time without poses.
        so: &'static str,
    },
    /// Poses come so rarely that little of the motion is in them.
    Slow {
        /// Poses per second.
        rate_hz: f64,
    },
    /// The poses jump as no body does.
    Jumps {
        /// Number of jumps in the poses.
        jumps: usize,
        /// Size of the widest jump.
        largest: Leap,
        /// The row before it.
        first_row: usize,
        /// Its time, s.
        at_s: f64,
        /// Moment that this time counts from.
        since: &'static str,
    },
    /// Spline that smooths the poses.
    Knots {
        /// From one knot of the spline to the next, s.
        knot_s: f64,
        /// Root mean square of the departure, m.
        rms_m: f64,
        /// Largest departure, m.
        largest_m: f64,
        /// Root mean square of the departure, rad.
        rms_rad: f64,
        /// Largest departure, rad.
        largest_rad: f64,
    },
}

/// Size of a jump between poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Leap {
    /// In position, m.
    Metres(f64),
    /// In attitude, rad.
    Radians(f64),
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Recognised { format, scalar_first } => {
                write!(f, "the trajectory is read as a {} file", format.name())?;
                match scalar_first {
                    Some(true) => write!(f, "; its quaternions have the scalar first"),
                    Some(false) => write!(f, "; its quaternions have the scalar last"),
                    None => Ok(()),
                }
            }
            Self::Turned { up } => write!(
                f,
                "the trajectory's reference has {} up: {} here (trajectory.up = \"{}\")",
                up.axis(),
                up.in_words(),
                up.name()
            ),
            Self::Geodetic { place, is_east_first } => {
                let (axes, other) =
                    if is_east_first { ("east, north and up", "-z") } else { ("north, east and down", "z") };
                write!(
                    f,
                    "positions are latitudes and longitudes, from {}° and a height of {} m on, which also give gravity \
                     where the model states none; attitudes are taken as against {axes} (up = \"{other}\" for the other \
                     way)",
                    rounded(place.latitude_rad.to_degrees(), 6),
                    rounded(place.height_m, 4)
                )
            }
            Self::NamedAxes => write!(f, "the trajectory's columns name their axes, north and east, themselves"),
            Self::Dropped { rows, first_row } => {
                write!(f, "{rows} rows of the trajectory hold no pose and were left out, the first is row {first_row}")
            }
            Self::Repeated { rows, first_row } => {
                write!(f, "{rows} rows repeat the stamp before them and were left out, the first is row {first_row}")
            }
            Self::Bridged { holes, longest_s, after_row, so } => {
                let s = if holes == 1 { "" } else { "s" };
                let length = rounded(longest_s, 3);
                write!(f, "poses are missing in {holes} place{s}, up to {length} s long (after row {after_row}): {so}")
            }
            Self::Slow { rate_hz } => write!(
                f,
                "the poses come at {} Hz: motion faster than {} Hz is neither in them nor in the simulated readings",
                rounded(rate_hz, 3),
                rounded(0.5 * rate_hz, 3)
            ),
            Self::Jumps { jumps, largest, first_row, at_s, since } => {
                match largest {
                    Leap::Metres(metres) => write!(f, "position jumps by {} m", rounded(metres, 3))?,
                    Leap::Radians(angle) => write!(f, "attitude jumps by {}°", rounded(angle.to_degrees(), 3))?,
                }
                write!(f, " behind row {first_row} (at {} s {since})", rounded(at_s, 4))?;
                if jumps > 1 {
                    write!(f, ", the widest of {jumps} jumps")?;
                }
                Ok(())
            }
            Self::Knots { knot_s, rms_m, largest_m, rms_rad, largest_rad } => write!(
                f,
                "a spline with a knot every {} s follows the poses within {} mm and {} mrad (rms), {} mm and {} mrad \
                 at most",
                rounded(knot_s, 3),
                rounded(rms_m * 1e3, 3),
                rounded(rms_rad * 1e3, 3),
                rounded(largest_m * 1e3, 3),
                rounded(largest_rad * 1e3, 3)
            ),
        }
    }
}
