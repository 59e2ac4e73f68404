//! What is wrong with a column before any physics: missing values, a dead channel, touched rails, a stuck stretch, and the
//! step its numbers are rounded to.

use std::ops::Range;
use std::path::Path;

use super::FILL_LIMIT;
use crate::error::{Error, Result};

/// Replaces missing values by straight lines between their neighbours, and says so.
///
/// # Errors
/// When more than 5 % of the values are missing.
pub fn fill(path: &Path, name: &str, values: &mut [f64]) -> Result<Option<String>> {
    let missing = values.iter().filter(|v| v.is_nan()).count();
    if missing == 0 {
        return Ok(None);
    }
    let share = missing as f64 / values.len() as f64;
    if share > FILL_LIMIT {
        return Err(Error::new(
            format!("could not use column `{name}` of {}", path.display()),
            format!("{missing} of {} values are missing", values.len()),
            "leave the column out, or cut the recording to a stretch where it was logged",
        ));
    }
    let mut longest = 0;
    let mut row = 0;
    while row < values.len() {
        if !values[row].is_nan() {
            row += 1;
            continue;
        }
        let end = (row..values.len()).find(|r| !values[*r].is_nan()).unwrap_or(values.len());
        let before = row.checked_sub(1).map(|r| values[r]);
        let after = values.get(end).copied();
        let (left, right) = (before.or(after).unwrap_or(0.0), after.or(before).unwrap_or(0.0));
        let count = end - row;
        for k in 0..count {
            values[row + k] = left + (right - left) * (k + 1) as f64 / (count + 1) as f64;
        }
        longest = longest.max(count);
        row = end;
    }
    Ok(Some(format!("`{name}`: {missing} missing values were filled by straight lines, at most {longest} in a row")))
}

/// Runs of missing values.
pub fn holes(values: &[f64]) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for row in (0..values.len()).filter(|row| values[*row].is_nan()) {
        match all.last_mut() {
            Some(last) if last.end == row => last.end += 1,
            _ => all.push(row..row + 1),
        }
    }
    all
}

/// Values that lie off whole steps by less than this are whole multiples, rounded in print.
const ON_GRID: f64 = 0.05;

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
    /// Smallest change between neighbours.
    step: f64,
    origin: f64,
    /// How far values lie off the grid of the smallest change, in steps: at most, or one value found off it.
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

    fn push(&mut self, value: f64) {
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

    /// Far too many for an unclipped reading: more than three times those at the next value inwards. (A quantised sine has
    /// at most 2.4 times.)
    fn touched(&self) -> bool {
        self.count >= 10 && self.count > 3 * self.next_count
    }
}

impl Watch {
    /// Nothing seen yet.
    pub fn new(name: &str) -> Self {
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
            step: f64::INFINITY,
            origin: f64::NAN,
            off_grid: 0.0,
        }
    }

    /// All of a column.
    pub fn of(name: &str, values: &[f64]) -> Self {
        let mut watch = Self::new(name);
        values.iter().for_each(|v| watch.push(*v));
        watch
    }

    /// The next value.
    pub fn push(&mut self, value: f64) {
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
        if self.run > self.longest.1 {
            self.longest = (self.count + 1 - self.run, self.run, value);
        }
        if self.off_grid < ON_GRID {
            let steps = (value - self.origin) / self.step;
            self.off_grid = self.off_grid.max((steps - steps.round()).abs());
        }
        self.before = value;
        self.count += 1;
    }

    /// The step that all values since it was first seen are whole multiples of, if values repeat so often that it is no
    /// accident of printing.
    pub fn step(&self) -> Option<f64> {
        let span = (self.high.value + self.low.value) / self.step;
        (self.step.is_finite() && self.off_grid < ON_GRID && 20.0 * span < self.count as f64).then_some(self.step)
    }

    /// Whether all values are the same.
    pub fn constant(&self) -> bool {
        self.levels.len() < 2
    }

    /// What a person should know of the column.
    pub fn findings(&self) -> Vec<String> {
        let name = &self.name;
        if self.constant() {
            return vec![format!("`{name}` is constant ({}): a dead channel?", self.before)];
        }
        let mut out = Vec::new();
        // An input of a few levels (a square wave) is not a clipped one.
        for (rail, value, side) in [(self.high, self.high.value, "above"), (self.low, -self.low.value, "below")] {
            if self.levels.len() > 8 && rail.touched() {
                out.push(format!("`{name}` stays at {value} in {} rows and never goes {side}: clipped?", rail.count));
            }
        }
        let (start, rows, value) = self.longest;
        if self.frozen() && value != self.high.value && value != -self.low.value {
            out.push(format!("`{name}` does not change for {rows} rows from row {start}: stuck?"));
        }
        out
    }

    /// Whether the longest run of one value is longer than chance would make it: near ln n / ln(1/p) in n draws that repeat
    /// with probability p.
    fn frozen(&self) -> bool {
        let others = self.repeats.saturating_sub(self.longest.1) as f64;
        let chance = ((others + 1.0) / self.count as f64).min(0.999);
        self.longest.1 as f64 > 20.0 - 4.0 * (self.count as f64).ln() / chance.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(values: Vec<f64>) -> Vec<String> {
        Watch::of("x", &values).findings()
    }

    fn sine(amplitude: f64) -> Vec<f64> {
        (0..5000).map(|i| amplitude * (f64::from(i) * 0.0123).sin()).collect()
    }

    #[test]
    fn holes_are_bridged_and_too_many_refused() {
        let nan = f64::NAN;
        let mut values = [vec![nan, 1.0, nan, nan, 4.0], vec![5.0; 95]].concat();
        let finding = fill(Path::new("log.csv"), "x", &mut values).expect("few").expect("said");
        assert_eq!(values[..5], [1.0, 1.0, 2.0, 3.0, 4.0]);
        assert!(finding.contains("3 missing"), "{finding}");
        assert!(fill(Path::new("log.csv"), "x", &mut [nan, 1.0, 2.0]).is_err());
    }

    #[test]
    fn dead_clipped_and_stuck_channels_are_told_and_healthy_ones_left_alone() {
        assert!(judge(vec![3.0; 100])[0].contains("dead"));
        assert_eq!(judge(sine(1.0).iter().map(|v| v.clamp(-0.8, 0.8)).collect()).len(), 2);
        let mut frozen = sine(1.0);
        frozen[1000..1400].fill(0.5);
        assert!(judge(frozen)[0].contains("stuck"));
        assert!(judge(sine(1.0)).is_empty());
        assert!(judge(sine(6.3).iter().map(|v| v.round()).collect()).is_empty(), "a coarse reading is not clipped");
        let square = (0..5000).map(|i| if i / 50 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(judge(square).is_empty(), "a two-level input is not clipped");
    }

    #[test]
    fn the_step_of_a_rounded_reading_is_found_and_none_in_a_smooth_one() {
        let rounded: Vec<f64> = sine(20.0).iter().map(|v| (v / 0.25).round() * 0.25).collect();
        assert_eq!(Watch::of("x", &rounded).step(), Some(0.25));
        assert_eq!(Watch::of("x", &sine(20.0)).step(), None);
    }
}
