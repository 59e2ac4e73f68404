//! States where each row belongs by its stamp: kept, how many samples are missing before it, or
//! dropped and why.

use super::stamp::Stamp;
use super::survey::advance;
use super::timeline::{SetBack, Timeline};
use super::{Clock, Kind};
use crate::dropped::Reason;

/// Ticks after which a step of an uneven clock is a gap.
const UNEVEN_GAP: f64 = 3.0;

/// Holds what becomes of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// A sample, this many samples after the one before it without a row, at this time since the
    /// first stamp, s.
    Kept {
        /// Samples without a row before it.
        missing: usize,
        /// Time since the first stamp.
        elapsed_s: f64,
    },
    /// Row not used, with the reason.
    Dropped(Reason),
}

/// Places rows in the order of the file.
#[derive(Debug, Clone)]
pub struct Placer {
    kind: Kind,
    tick: f64,
    seconds: f64,
    timeline: Timeline,
    run: usize,
}

impl Placer {
    /// By this clock, before its first row.
    pub fn new(clock: &Clock) -> Self {
        let seconds = clock.unit.seconds();
        Self { kind: clock.kind, tick: clock.tick, seconds, timeline: Timeline::default(), run: 0 }
    }

    /// The next row; `alike` where all its other cells repeat the row before.
    ///
    /// # Errors
    /// Time that runs backwards.
    pub fn place(&mut self, row: usize, stamp: Stamp, alike: bool) -> Result<Place, SetBack> {
        if stamp.is_missing() {
            return Ok(Place::Dropped(Reason::NoStamp));
        }
        let Some(step) = self.timeline.advance(row, stamp)? else {
            self.run = 1;
            return Ok(Place::Kept { missing: 0, elapsed_s: 0.0 });
        };
        let elapsed_s = self.timeline.elapsed() * self.seconds;
        if step > 0.0 {
            let missing = self.missing(step);
            self.run = 1;
            return Ok(Place::Kept { missing, elapsed_s });
        }
        self.run += 1;
        Ok(match self.kind {
            Kind::Rounded { longest_run, .. } if self.run > longest_run => Place::Dropped(Reason::StoppedClock),
            Kind::Rounded { drop_alike: true, .. } if alike => Place::Dropped(Reason::WrittenTwice),
            Kind::Rounded { .. } => Place::Kept { missing: 0, elapsed_s },
            _ if alike => Place::Dropped(Reason::WrittenTwice),
            _ => Place::Dropped(Reason::SameStamp),
        })
    }

    /// Samples without a row within a step.
    fn missing(&self, step: f64) -> usize {
        let ticks = match self.kind {
            Kind::Even => advance(step, self.tick) - 1.0,
            // Where a step between stamps is longer than rounding makes it, by as much as it is.
            Kind::Rounded { quantum, .. } => {
                let usual = quantum.max(self.tick);
                if step > usual + quantum.min(self.tick) + 0.75 * usual {
                    ((step - usual) / self.tick).round()
                } else {
                    0.0
                }
            }
            Kind::Uneven { .. } if step > UNEVEN_GAP * self.tick => (step / self.tick).round() - 1.0,
            Kind::Uneven { .. } => 0.0,
        };
        // A float becomes the nearest whole number there is.
        ticks.max(0.0) as usize
    }
}
