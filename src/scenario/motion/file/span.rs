//! Who asks for poses, and for which stretch of the file: what is wrong is said in the asker's own
//! keys.

use crate::recording::clock::instant::Instant;

/// A stretch of a file of poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Span {
    /// The trajectory of a study.
    Study {
        /// Beginning, s after the first pose.
        from_s: f64,
        /// Length, s.
        duration_s: f64,
    },
    /// A file of poses next to a log.
    Log {
        /// The zero of the log's times, where its stamps say it; none: the file's first pose.
        start: Option<Instant>,
        /// First and last reading, s.
        ends_s: [f64; 2],
    },
}

/// Poses are read this long beyond the ends, s, so that a spline does not end there.
const BEYOND_S: f64 = 1.0;

impl Span {
    /// Returns where the poses' own time begins, s after the first pose.
    pub(super) fn zero_s(&self) -> f64 {
        match self {
            Self::Study { from_s, .. } => *from_s,
            Self::Log { .. } => 0.0,
        }
    }

    /// From where to where poses are wanted, s after the first of them, which is of this instant;
    /// everything where log and file do not meet, so that it can be said by how much.
    pub(super) fn ends_s(&self, first: Option<Instant>, last_s: f64) -> [f64; 2] {
        match *self {
            Self::Study { from_s, duration_s } => [from_s - BEYOND_S, from_s + duration_s + BEYOND_S],
            Self::Log { start, ends_s } => {
                let shift_s = start.zip(first).map_or(0.0, |(start, first)| start.since(&first));
                let [from, to] = [ends_s[0] + shift_s, ends_s[1] + shift_s];
                if to < 0.0 || from > last_s {
                    return [f64::NEG_INFINITY, f64::INFINITY];
                }
                [from - BEYOND_S, to + BEYOND_S]
            }
        }
    }

    /// A key as the asker's file has it.
    pub(super) fn key(&self, name: &str) -> String {
        match self {
            Self::Study { .. } => format!("trajectory.{name}"),
            Self::Log { .. } => format!("reference.{name}"),
        }
    }

    /// Names the moment that time counts from.
    pub(super) fn of_what(&self) -> &'static str {
        match self {
            Self::Study { .. } => "of the study",
            Self::Log { .. } => "after the first pose",
        }
    }

    /// Says whether the asker finds for itself what of the poses is no motion, and leaves it out.
    pub(super) fn leaves_out(&self) -> bool {
        matches!(self, Self::Log { .. })
    }

    /// Names what becomes of the time in which poses are missing.
    pub(super) fn of_holes(&self) -> &'static str {
        match self {
            Self::Study { .. } => "the motion there is only interpolated",
            Self::Log { .. } => "that time is left out",
        }
    }

    /// Says how a stretch without a fault is chosen.
    pub(super) fn choose(&self) -> &'static str {
        match self {
            Self::Study { .. } => "choose a stretch without it: trajectory.from_s, and a shorter duration_s",
            Self::Log { .. } => "choose a stretch without it: the IMU's rows, as rows = [[from, to]] in the model",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::clock::stamp::Stamp;
    use crate::recording::time_unit::TimeUnit;

    #[test]
    fn a_log_takes_what_lies_beside_it_and_all_where_nothing_does() {
        let at = |s: i64| Some(Instant::new(Stamp::of_integer(s), TimeUnit::Second));
        let span = |start: i64| Span::Log { start: at(start), ends_s: [0.0, 20.0] };
        assert_eq!(span(130).ends_s(at(100), 90.0), [29.0, 51.0]);
        assert_eq!(span(500).ends_s(at(100), 90.0), [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(Span::Study { from_s: 2.0, duration_s: 5.0 }.ends_s(at(100), 90.0), [1.0, 8.0]);
    }
}
