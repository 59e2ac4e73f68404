//! Changes between neighbours in a log at rest: the largest, which leaps away from the usual ones,
//! and how heavy their tails are. One pass, no memory of the readings.
//!
//! Not for single stray readings, which `disturbance` has taken out before.

use super::finding::Finding;

/// A change this many times the usual one is no noise: of normal noise, one in 10¹⁰⁰.
const LEAP: f64 = 21.0;
/// Fewer changes than this tell nothing of what is usual.
const LEAST: usize = 100;

/// If readings are coarse, a change of this many steps is no leap, however seldom the
/// reading changes at all.
const STEPS: f64 = 10.0;

/// Looks at the changes between neighbours as they pass.
#[derive(Debug, Clone, Default)]
pub(super) struct Glitch {
    before: Option<f64>,
    row: usize,
    count: usize,
    squares: f64,
    fourths: f64,
    /// Smallest change that is one.
    step: Option<f64>,
    /// The largest change and its row, then the second largest: one stray reading makes two.
    largest: [(f64, usize); 2],
}

impl Glitch {
    pub(super) fn push(&mut self, value: f64) {
        if let Some(before) = self.before {
            self.count += 1;
            let change = (value - before).abs();
            self.squares += change * change;
            self.fourths += change.powi(4);
            if change > 0.0 {
                self.step = Some(self.step.map_or(change, |s| s.min(change)));
            }
            if change > self.largest[0].0 {
                self.largest = [(change, self.row), self.largest[0]];
            } else if change > self.largest[1].0 {
                self.largest[1] = (change, self.row);
            }
        }
        self.row += 1;
        self.before = Some(value);
    }

    /// The next reading does not follow the one before.
    pub(super) fn interrupt(&mut self) {
        self.before = None;
    }

    /// Relative variance of the realised square of white noise beyond that of normal noise: its excess kurtosis,
    /// twice that of its changes, over their number; never below zero.
    pub(super) fn tails(&self) -> f64 {
        let of_changes = self.fourths / (self.squares * self.squares) - 3.0 / self.count as f64;
        if of_changes.is_finite() { (2.0 * of_changes).max(0.0) } else { 0.0 }
    }

    /// Returns what a person should know, if there is such a change.
    pub(super) fn finding(&self, name: &str) -> Option<Finding> {
        if self.count < LEAST {
            return None;
        }
        let [(largest, row), (second, _)] = self.largest;
        let rest = (self.squares - largest * largest - second * second).max(0.0);
        let usual = (rest / (self.count - 2) as f64).sqrt();
        let coarse = self.step.is_none_or(|step| largest < STEPS * step);
        let leaps = usual > 0.0 && largest > LEAP * usual && !coarse;
        leaps.then(|| Finding::Leap { column: name.into(), near_row: row, ratio: largest / usual })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(values: impl IntoIterator<Item = f64>) -> Option<Finding> {
        let mut glitch = Glitch::default();
        values.into_iter().for_each(|v| glitch.push(v));
        glitch.finding("x")
    }

    #[test]
    fn a_stray_reading_is_told_and_plain_noise_is_not() {
        let noise = |k: usize| (k * 7919 % 101) as f64;
        assert_eq!(judge((0..5000).map(noise)), None);
        let said = judge((0..5000).map(|k| if k == 700 { 2000.0 } else { noise(k) })).expect("a stray reading");
        assert!(matches!(said, Finding::Leap { near_row: 700 | 701, .. }), "{said}");
        let seldom = |k: usize| if k % 1000 == 7 { 1.0 } else { 0.0 };
        assert_eq!(judge((0..5000).map(seldom)), None, "a coarse reading that seldom changes");
        assert_eq!(judge((0..50).map(|k| if k == 7 { 2000.0 } else { noise(k) })), None, "too short to tell");
    }
}
