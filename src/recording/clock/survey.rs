//! The first pass over a clock: what all its stamps say, in bounded memory, before any row is
//! placed by it.
//!
//! Steps are gathered in stretches of some rows, each judged by its own usual step, so that a gap
//! or a change of rate somewhere leaves the others alone. Not for decisions: see `rate`.

use super::stamp::Stamp;
use super::timeline::{SetBack, Timeline};

/// Rows of the shortest stretch.
const SHORTEST: usize = 32;
/// Stretches kept; beyond, neighbours are joined.
const MOST: usize = 1 << 14;
/// A step of more than this many usual ones is a break.
pub const BREAK: f64 = 10.0;
/// Breaks that are remembered.
const MOST_BREAKS: usize = 1 << 20;
/// Share of a tick by which a step may be off.
pub const UNEVEN: f64 = 0.25;

/// Ticks that a step lasts.
#[inline]
pub fn advance(step: f64, tick: f64) -> f64 {
    let ticks = step / tick + UNEVEN;
    // A call of the library's is spared where it would be the same.
    let whole = if (0.0..1e15).contains(&ticks) { ticks as i64 as f64 } else { ticks.floor() };
    whole.max(1.0)
}

/// Some rows in a row; times in the file's unit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stretch {
    /// Row of its first step's end.
    pub first_row: usize,
    /// Time of that row since the first stamp.
    pub from: f64,
    /// Steps that are no breaks.
    pub steps: f64,
    /// Sum of the steps.
    pub span: f64,
    /// Ticks of the stretch's own clock that they last.
    pub ticks: f64,
    /// Those that are off by more than a quarter of a tick.
    pub uneven: f64,
    /// Sum of the squares by which they differ from whole ticks.
    pub squares: f64,
}

impl Stretch {
    /// Joins two neighbouring stretches.
    pub fn joined(self, next: Self) -> Self {
        Self {
            first_row: self.first_row,
            from: self.from,
            steps: self.steps + next.steps,
            span: self.span + next.span,
            ticks: self.ticks + next.ticks,
            uneven: self.uneven + next.uneven,
            squares: self.squares + next.squares,
        }
    }
}

/// A step far longer than its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Break {
    /// The row behind it.
    pub row: usize,
    /// Time of the row before it since the first stamp, file's unit.
    pub after: f64,
    /// Its length, file's unit.
    pub step: f64,
    /// Rows with a stamp before it.
    pub stamped: usize,
}

/// One value that many steps have, and how regularly it comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Step between stamps, in the clock's unit.
    pub step: f64,
    /// Number of such steps.
    pub count: f64,
    last: f64,
    spacing: f64,
    squares: f64,
}

impl Value {
    /// Returns whether it comes at nearly equal distances, as rounding of an even clock makes it;
    /// at random they would scatter by about their mean.
    pub fn is_regular(&self) -> bool {
        let n = self.count - 1.0;
        let mean = self.spacing / n;
        n >= 4.0 && (self.squares / n - mean * mean).max(0.0).sqrt() < 0.3 * mean + 0.3
    }
}

/// Holds what is gathered of a clock.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    /// The stamps in order.
    pub timeline: Timeline,
    /// Rows seen so far.
    pub rows: usize,
    /// Rows without a stamp, and the first of them.
    pub unknown: (usize, usize),
    /// Number of steps between stamps.
    pub steps: usize,
    /// Number of steps of zero: repeated stamps.
    pub zero: usize,
    /// Steps of zero whose row repeats the one before in all other cells too.
    pub zero_alike: usize,
    /// Longer steps whose row does so.
    pub other_alike: usize,
    /// The longest run of one stamp: rows, its first row, its time.
    pub longest_run: (usize, usize, f64),
    /// Stretches between breaks, in the order of time.
    pub stretches: Vec<Stretch>,
    /// Breaks, in the order of time.
    pub breaks: Vec<Break>,
    /// Up to four values that steps have, the first met.
    pub values: Vec<Value>,
    /// The last digit printed, file's unit; none where some stamp has none.
    pub last_digit: Option<f64>,
    /// Stamps and row numbers as a straight line, apart between breaks: sums of squares and
    /// products.
    pub line: Line,
    /// The same of stamps and ticks.
    pub by_tick: Line,
    /// Ticks so far, breaks apart.
    ticks: f64,
    /// Runs by size, in powers of two: how many, and their rows.
    runs: [(usize, usize); 32],
    run: (usize, usize, f64),
    /// Stretches that make one.
    joined: usize,
    /// Steps of the stretch that is gathered: end row, step, elapsed.
    open: Vec<(usize, f64, f64)>,
    /// Room for its steps forward.
    forward: Vec<f64>,
    /// Usual step of the last stretch that had any.
    usual: f64,
    part: Stretch,
    parts: usize,
}

/// Regression of stamps on row numbers, pooled over parts between breaks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Line {
    n: f64,
    mean: [f64; 2],
    /// Of the open part, then of those before.
    xx: [f64; 2],
    xy: [f64; 2],
}

impl Line {
    fn push(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        let (dx, dy) = (x - self.mean[0], y - self.mean[1]);
        self.mean[0] += dx / self.n;
        self.mean[1] += dy / self.n;
        self.xx[0] += dx * (x - self.mean[0]);
        self.xy[0] += dx * (y - self.mean[1]);
    }

    fn cut(&mut self) {
        let (xx, xy) = (self.xx[0] + self.xx[1], self.xy[0] + self.xy[1]);
        *self = Self { xx: [0.0, xx], xy: [0.0, xy], ..Self::default() };
    }

    /// Time per row.
    pub fn slope(&self) -> f64 {
        (self.xy[0] + self.xy[1]) / (self.xx[0] + self.xx[1])
    }
}

impl Survey {
    /// The next row; `alike` where all its other cells repeat the row before.
    ///
    /// # Errors
    /// Time that runs backwards.
    pub fn push(&mut self, row: usize, stamp: Stamp, alike: bool) -> Result<(), SetBack> {
        self.rows += 1;
        if stamp.is_missing() {
            if self.unknown.0 == 0 {
                self.unknown.1 = row;
            }
            self.unknown.0 += 1;
            return Ok(());
        }
        self.last_digit = match (self.run.0, self.last_digit, stamp.last_digit()) {
            (0, _, digit) => digit,
            (_, Some(a), Some(b)) => Some(a.min(b)),
            _ => None,
        };
        let Some(step) = self.timeline.advance(row, stamp)? else {
            self.run = (1, row, 0.0);
            self.line.push(0.0, 0.0);
            self.by_tick.push(0.0, 0.0);
            return Ok(());
        };
        self.steps += 1;
        let elapsed = self.timeline.elapsed();
        if step == 0.0 {
            self.zero += 1;
            self.zero_alike += usize::from(alike);
            self.run.0 += 1;
        } else {
            self.other_alike += usize::from(alike);
            self.close_run();
            self.run = (1, row, elapsed);
        }
        self.note(step);
        self.open.push((row, step, elapsed));
        if self.open.len() == SHORTEST {
            self.close_stretch();
        }
        Ok(())
    }

    /// Ends the survey.
    pub fn finish(&mut self) {
        self.close_run();
        if !self.open.is_empty() {
            self.close_stretch();
        }
        if self.parts > 0 {
            self.stretches.push(self.part);
            self.parts = 0;
        }
        // A usual step of a stretch without any comes from the next one that has some.
        self.line.cut();
        self.by_tick.cut();
    }

    fn close_run(&mut self) {
        let class = (usize::BITS - self.run.0.leading_zeros()) as usize;
        let (runs, rows) = &mut self.runs[class.min(31)];
        *runs += 1;
        *rows += self.run.0;
        if self.run.0 > self.longest_run.0 {
            self.longest_run = self.run;
        }
    }

    /// Runs of one stamp that are far longer than the usual ones: the shortest such run, and rows
    /// in them beyond one each.
    pub fn stuck(&self) -> (usize, usize) {
        let total: usize = self.runs.iter().map(|r| r.0).sum();
        let mut below = 0;
        let usual = self.runs.iter().position(|r| {
            below += r.0;
            2 * below >= total
        });
        let from = usual.unwrap_or(0) + 4;
        let rows = self.runs.iter().skip(from).map(|r| r.1 - r.0).sum();
        (1 << (from - 1).min(60), rows)
    }

    fn note(&mut self, step: f64) {
        let at = self.steps as f64;
        let same = |v: &&mut Value| (v.step - step).abs() <= 1e-6 * step.max(v.step);
        if let Some(value) = self.values.iter_mut().find(same) {
            let gap = at - value.last;
            value.count += 1.0;
            value.spacing += gap;
            value.squares += gap * gap;
            value.last = at;
        } else if self.values.len() < 4 {
            self.values.push(Value { step, count: 1.0, last: at, spacing: 0.0, squares: 0.0 });
        }
    }

    fn close_stretch(&mut self) {
        let mut forward = std::mem::take(&mut self.forward);
        forward.clear();
        forward.extend(self.open.iter().map(|s| s.1).filter(|s| *s > 0.0));
        if let Some(last) = forward.len().checked_sub(1) {
            self.usual = *forward.select_nth_unstable_by(last / 2, f64::total_cmp).1;
        }
        self.forward = forward;
        let usual = self.usual;
        let open = std::mem::take(&mut self.open);
        let mut stretch = Stretch { first_row: open[0].0, from: open[0].2, ..Stretch::default() };
        let long = |step: f64| usual > 0.0 && step > BREAK * usual;
        let regular = || open.iter().map(|s| s.1).filter(|s| !long(*s));
        for step in regular() {
            stretch.steps += 1.0;
            stretch.span += step;
            stretch.ticks += if step > 0.0 { advance(step, usual) } else { 0.0 };
        }
        let tick = stretch.span / stretch.ticks.max(1.0);
        for step in regular().filter(|s| *s > 0.0) {
            let off = step - advance(step, tick) * tick;
            stretch.uneven += f64::from(u8::from(off.abs() > UNEVEN * tick));
            stretch.squares += off * off;
        }
        let before = self.steps + 1 - open.len();
        for (k, (row, step, elapsed)) in open.iter().enumerate() {
            if long(*step) {
                self.line.cut();
                self.by_tick.cut();
                if self.breaks.len() < MOST_BREAKS {
                    let stamped = before + k;
                    self.breaks.push(Break { row: *row, after: elapsed - step, step: *step, stamped });
                }
            }
            self.line.push((before + k) as f64, *elapsed);
            self.ticks += if *step > 0.0 { advance(*step, tick) } else { 0.0 };
            self.by_tick.push(self.ticks, *elapsed);
        }
        self.part = if self.parts == 0 { stretch } else { self.part.joined(stretch) };
        self.parts += 1;
        self.open = open;
        self.open.clear();
        if self.parts >= self.joined.max(1) {
            self.stretches.push(self.part);
            self.parts = 0;
            if self.stretches.len() == MOST {
                self.stretches = self.stretches.chunks(2).map(|pair| pair[0].joined(pair[pair.len() - 1])).collect();
                self.joined = 2 * self.joined.max(1);
            }
        }
    }

    /// All stretches as one.
    pub fn whole(&self) -> Stretch {
        self.stretches.iter().copied().reduce(Stretch::joined).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    // Stamps that err by 0.1 of a step: σ √12 / n^1.5 of the slope (least squares), held to five; their ends err by
    // σ √2 / n, 26 times as much.
    #[test]
    fn a_line_through_noisy_stamps_errs_less_than_their_ends() {
        let (count, sigma) = (4000, 0.1);
        let most = 5.0 * sigma * 12f64.sqrt() / f64::from(count).powf(1.5);
        let mut by_ends = 0.0;
        for seed in 0..20 {
            let mut random = Philox::new(seed, 0, Stream::Host);
            let stamps: Vec<f64> = (0..count).map(|k| f64::from(k) + sigma * random.normal()).collect();
            let mut line = Line::default();
            stamps.iter().enumerate().for_each(|(k, stamp)| line.push(k as f64, *stamp));
            assert!((line.slope() - 1.0).abs() < most, "{seed}: {}", line.slope());
            let ends = (stamps[stamps.len() - 1] - stamps[0]) / f64::from(count - 1);
            by_ends = f64::max(by_ends, (ends - 1.0).abs());
        }
        assert!(by_ends > 3.0 * most, "the ends would pass: {by_ends}");
    }
}
