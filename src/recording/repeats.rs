//! Rows that repeat the one before them exactly, where no clock tells: samples written twice, or
//! lost ones replaced by the last.
//!
//! Only where the columns hardly ever repeat a value otherwise. With a time column the time stamps
//! decide (`clock`). One pass, no memory of the rows.

/// Share of its rows that a column may repeat a value in, before repeating says nothing.
const SELDOM: f64 = 0.01;
/// Fewer rows than this tell nothing.
const FEWEST: usize = 100;
/// Rows that are looked at together.
const WINDOW: usize = 5;

/// Holds what repeating rows stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// The sample before once more.
    WrittenTwice,
    /// Each repeat stands for a lost sample.
    Lost,
}

/// Holds what was found of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Repeated {
    /// Holds what they stand for.
    pub meaning: Meaning,
    /// Number of repeated rows.
    pub rows: usize,
    /// The first, counted from the first row seen.
    pub first: usize,
}

/// Looks for them as rows pass.
#[derive(Debug, Clone, Default)]
pub(super) struct Repeats {
    rows: usize,
    /// The last rows, the latest last.
    last: Vec<Vec<f64>>,
    /// Per column, rows that repeat its value.
    repeats: Vec<usize>,
    count: usize,
    first: usize,
    /// The row before repeats the one before it.
    pending: bool,
    /// States how badly the rows around fit either meaning.
    twice: f64,
    lost: f64,
}

impl Repeats {
    /// The next row. Whether it repeats the one before in every column.
    pub(super) fn push(&mut self, row: &[f64]) -> bool {
        let mut all = false;
        if let Some(before) = self.last.last() {
            self.repeats.resize(row.len(), 0);
            all = true;
            for ((value, before), count) in row.iter().zip(before).zip(&mut self.repeats) {
                let same = value == before;
                *count += usize::from(same);
                all &= same;
            }
        }
        if std::mem::take(&mut self.pending) {
            let last = std::mem::take(&mut self.last);
            self.weigh([&last[0], &last[1], &last[2]], row);
            self.last = last;
        }
        if all {
            self.first = if self.count == 0 { self.rows } else { self.first };
            self.count += 1;
            self.pending = self.rows + 2 >= WINDOW;
        }
        let mut room = if self.last.len() == WINDOW - 1 { self.last.remove(0) } else { Vec::new() };
        room.clear();
        room.extend_from_slice(row);
        self.last.push(room);
        self.rows += 1;
        all
    }

    /// z, a, b, b, c: where c is the next sample, z, a, b, c lie on a parabola; where one was lost,
    /// z, a, b, (?), c do. Either misfit is over what unit noise would make of it.
    fn weigh(&mut self, [z, a, b]: [&Vec<f64>; 3], next: &[f64]) {
        for (((z, a), b), next) in z.iter().zip(a).zip(b).zip(next) {
            let size = (a - z).abs() + (b - a).abs() + (next - b).abs();
            if size.is_finite() && size > 0.0 {
                self.twice += ((next - 3.0 * b + 3.0 * a - z) / size).abs() / 20f64.sqrt();
                self.lost += ((next - 6.0 * b + 8.0 * a - 3.0 * z) / size).abs() / 110f64.sqrt();
            }
        }
    }

    /// Returns what the repeating rows stand for; `None` where there are none, or too many for them
    /// to say anything.
    pub(super) fn judge(&self) -> Option<Repeated> {
        let seldom = self.repeats.iter().all(|count| *count as f64 <= SELDOM * self.rows as f64);
        (self.repeats.len() >= 2 && self.rows >= FEWEST && seldom && self.count > 0).then_some(Repeated {
            meaning: if self.twice <= self.lost { Meaning::WrittenTwice } else { Meaning::Lost },
            rows: self.count,
            first: self.first,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<[f64; 2]> {
        (0..1000).map(|k| [0.11, 0.07].map(|rate| (rate * f64::from(k)).sin())).collect()
    }

    fn judge(rows: &[[f64; 2]]) -> Option<Repeated> {
        let mut repeats = Repeats::default();
        rows.iter().for_each(|row| {
            repeats.push(row);
        });
        repeats.judge()
    }

    #[test]
    fn rows_written_twice_are_told_from_lost_ones() {
        let good = rows();
        assert_eq!(judge(&good), None);
        let mut twice = good.clone();
        twice.insert(300, good[299]);
        assert_eq!(judge(&twice), Some(Repeated { meaning: Meaning::WrittenTwice, rows: 1, first: 300 }));
        let mut held = good.clone();
        held[300] = held[299];
        assert_eq!(judge(&held), Some(Repeated { meaning: Meaning::Lost, rows: 1, first: 300 }));
        let coarse: Vec<[f64; 2]> = good.iter().map(|row| row.map(|v| (v * 4.0).round())).collect();
        assert_eq!(judge(&coarse), None, "a coarse reading repeats");
    }
}
