//! States what is wrong with a column before any physics: a dead channel, touched rails, a stuck
//! stretch, and the step its numbers are rounded to.

use std::ops::Range;

use super::finding::Finding;

/// Values that lie off whole steps by less than this are whole multiples, rounded in print.
const ON_GRID: f64 = 0.05;

/// Times that a run must be longer than the next one in a column that rests anyway: two plateaus of
/// one course differ by less, unless it moves but once.
const PLATEAU: usize = 4;

/// Looks at the values of a channel as they pass.
#[derive(Debug, Clone)]
pub struct Watch {
    name: String,
    count: usize,
    high: Rail,
    low: Rail,
    /// Distinct values, up to nine.
    levels: Vec<f64>,
    before: f64,
    run: usize,
    repeats: usize,
    longest: (usize, usize, f64),
    /// Length of the longest run but that one.
    second: usize,
    /// Smallest change between neighbours.
    step: f64,
    origin: f64,
    /// States how far values lie off the grid of the smallest change, in steps: at most, or one
    /// value found off it.
    off_grid: f64,
}

/// An extreme value, the next one inwards, and how often each was met.
#[derive(Debug, Clone, Copy)]
struct Rail {
    value: f64,
    count: usize,
    next_count: usize,
    next: f64,
}

impl Rail {
    const NONE: Rail = Rail { value: f64::NEG_INFINITY, count: 0, next_count: 0, next: f64::NEG_INFINITY };

    #[inline]
    fn push(&mut self, value: f64) {
        if value < self.next {
            return;
        }
        if value > self.value {
            *self = Rail { value, count: 1, next: self.value, next_count: self.count };
        } else if value == self.value {
            self.count += 1;
        } else if value > self.next {
            (self.next, self.next_count) = (value, 1);
        } else if value == self.next {
            self.next_count += 1;
        }
    }

    /// Far too many for an unclipped reading: more than three times those at the next value
    /// inwards. (A quantised sine has at most 2.4 times.)
    fn touched(&self) -> bool {
        self.count >= 10 && self.count > 3 * self.next_count
    }
}

impl Watch {
    pub(crate) fn new(name: &str) -> Self {
        Self {
            name: name.into(),
            count: 0,
            high: Rail::NONE,
            low: Rail::NONE,
            levels: Vec::new(),
            before: f64::NAN,
            run: 0,
            repeats: 0,
            longest: (0, 0, f64::NAN),
            second: 0,
            step: f64::INFINITY,
            origin: f64::NAN,
            off_grid: 0.0,
        }
    }

    /// All of a column but the samples in these ranges, which were filled in.
    pub fn of(name: &str, values: &[f64], filled: &[Range<usize>]) -> Self {
        let mut watch = Self::new(name);
        let mut filled = filled.iter().flat_map(Clone::clone).peekable();
        for (at, value) in values.iter().enumerate() {
            match filled.next_if_eq(&at) {
                Some(_) => watch.skip(),
                None => watch.push(*value),
            }
        }
        watch
    }

    #[inline]
    pub(crate) fn push(&mut self, value: f64) {
        self.high.push(value);
        self.low.push(-value);
        if self.levels.len() <= 8 && !self.levels.contains(&value) {
            self.levels.push(value);
        }
        if self.count == 0 {
            self.origin = value;
        }
        if value == self.before {
            self.run += 1;
            self.repeats += 1;
        } else {
            self.run = 1;
            let change = (value - self.before).abs();
            if change < self.step * (1.0 - 1e-6) {
                (self.step, self.off_grid) = (change, 0.0);
            }
        }
        let first = self.count + 1 - self.run;
        if first != self.longest.0 {
            self.second = self.second.max(self.run.min(self.longest.1));
        }
        if self.run > self.longest.1 {
            self.longest = (first, self.run, value);
        }
        if self.off_grid < ON_GRID {
            self.off_grid = self.off_grid.max(from_whole((value - self.origin) / self.step));
        }
        self.before = value;
        self.count += 1;
    }

    /// Passes over a sample that was filled in: a straight line is on no grid.
    #[inline]
    pub(crate) fn skip(&mut self) {
        self.before = f64::NAN;
        self.count += 1;
    }

    /// The step that all values since it was first seen are whole multiples of, if values repeat so
    /// often that it is no accident of printing.
    pub fn step(&self) -> Option<f64> {
        let span = (self.high.value + self.low.value) / self.step;
        (self.step.is_finite() && self.off_grid < ON_GRID && 20.0 * span < self.count as f64).then_some(self.step)
    }

    /// Returns whether all values are the same.
    pub(crate) fn constant(&self) -> bool {
        self.levels.len() < 2
    }

    /// Returns what a person should know of the column.
    pub(crate) fn findings(&self) -> Vec<Finding> {
        let column = || self.name.clone();
        if self.constant() {
            return vec![Finding::Constant {
                column: column(),
                value: self.levels.first().copied().unwrap_or(f64::NAN),
            }];
        }
        let mut out = Vec::new();
        // An input of a few levels (a square wave) is not a clipped one.
        for (rail, value, highest) in [(self.high, self.high.value, true), (self.low, -self.low.value, false)] {
            if self.levels.len() > 8 && rail.touched() {
                out.push(Finding::Clipped { column: column(), value, highest, rows: rail.count });
            }
        }
        let (first_row, rows, value) = self.longest;
        if self.frozen() && value != self.high.value && value != -self.low.value {
            out.push(Finding::Stuck { column: column(), first_row, rows });
        }
        out
    }

    /// Returns whether the longest run of one value is longer than chance would make it: near ln n
    /// / ln(1/p) in n draws that repeat with probability p.
    fn frozen(&self) -> bool {
        let others = self.repeats.saturating_sub(self.longest.1) as f64;
        // A column that rests more often than it changes has plateaus: a thermometer's steps. One as
        // long as others is none the worse.
        let rests = 2.0 * others > self.count.saturating_sub(self.longest.1) as f64;
        if rests && self.longest.1 < PLATEAU * self.second {
            return false;
        }
        let chance = ((others + 1.0) / self.count as f64).min(0.999);
        self.longest.1 as f64 > 20.0 - 4.0 * (self.count as f64).ln() / chance.ln()
    }
}

/// Returns how far a number is from the nearest whole one.
#[inline]
fn from_whole(number: f64) -> f64 {
    // Above it doubles are whole, so that adding it rounds; what it rounds to at a half is as far
    // off either way.
    const WHOLE: f64 = 1.5 * (1u64 << 52) as f64;
    let whole = if number.abs() < (1u64 << 51) as f64 { (number + WHOLE) - WHOLE } else { number.round() };
    (number - whole).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_whole_number_is_the_librarys() {
        let mut number: f64 = 1e-9;
        while number < 1e19 {
            for n in [number, -number, number.floor() + 0.5, -number.floor() - 0.5] {
                assert_eq!(from_whole(n), (n - n.round()).abs(), "{n}");
            }
            number *= 1.37;
        }
        assert_ne!(from_whole(2.25), (2.25f64 - 2.25f64.ceil()).abs(), "another whole number is told from it");
        assert!(from_whole(f64::NAN).is_nan());
    }

    fn judge(values: Vec<f64>) -> Vec<Finding> {
        Watch::of("x", &values, &[]).findings()
    }

    fn sine(amplitude: f64) -> Vec<f64> {
        (0..5000).map(|i| amplitude * (f64::from(i) * 0.0123).sin()).collect()
    }

    #[test]
    fn dead_clipped_and_stuck_channels_are_told_and_healthy_ones_left_alone() {
        assert!(matches!(judge(vec![3.0; 100])[0], Finding::Constant { value: 3.0, .. }));
        assert_eq!(judge(sine(1.0).iter().map(|v| v.clamp(-0.8, 0.8)).collect()).len(), 2);
        let mut frozen = sine(1.0);
        frozen[1000..1400].fill(0.5);
        assert!(matches!(judge(frozen)[0], Finding::Stuck { rows: 400, .. }));
        assert!(judge(sine(1.0)).is_empty());
        assert!(judge(sine(6.3).iter().map(|v| v.round()).collect()).is_empty(), "a coarse reading is not clipped");
        let plateaus = sine(6.3).iter().map(|v| v.round()).collect::<Vec<f64>>();
        assert!(judge(plateaus.iter().flat_map(|v| [*v; 40]).collect()).is_empty(), "steps of a thermometer");
        let square = (0..5000).map(|i| if i / 50 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(judge(square).is_empty(), "a two-level input is not clipped");
    }

    #[test]
    fn the_step_of_a_rounded_reading_is_found_and_none_in_a_smooth_one() {
        let rounded: Vec<f64> = sine(20.0).iter().map(|v| (v / 0.25).round() * 0.25).collect();
        assert_eq!(Watch::of("x", &rounded, &[]).step(), Some(0.25));
        assert_eq!(Watch::of("x", &sine(20.0), &[]).step(), None);
        // A straight line over a gap is on no grid.
        let mut bridged = rounded;
        bridged[500] += 0.1;
        assert_eq!(Watch::of("x", &bridged, std::slice::from_ref(&(500..501))).step(), Some(0.25));
        assert_eq!(Watch::of("x", &bridged, &[]).step(), None);
    }
}
