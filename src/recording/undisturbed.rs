//! Hands the samples of a recording at rest on without bad readings and knocks, however long it is:
//! piece by piece, each looked at as a whole by [`disturbance`](super::disturbance).
//!
//! A recording of up to two pieces is one piece, so that what the diagnosis leaves out of it is
//! left out here. Not for what is a property of the noise, such as heavy tails: that stays.

use std::ops::Range;

use super::disturbance::take_out;
use super::finding::{Finding, Stray};
use super::lost;
use super::stream::Block;

/// Samples of a piece: half a megabyte a channel.
const PIECE: usize = 1 << 16;
/// Readings that are named one by one, at most.
const NAMED: usize = 3;

/// Gathers the rows of samples that wait to be looked at.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    rows: Vec<Option<usize>>,
}

impl Waiting {
    /// Adds the samples of a block.
    pub(super) fn add(&mut self, block: &Block) {
        self.rows.extend_from_slice(&block.rows);
    }

    /// Returns the rows of the next piece: the first of more than two, or all that wait where no
    /// sample follows on them.
    pub(super) fn piece(&mut self, is_end: bool) -> Option<Vec<Option<usize>>> {
        let count = match self.rows.len() {
            waiting if waiting > 2 * PIECE => PIECE,
            waiting if is_end && waiting > 0 => waiting,
            _ => return None,
        };
        Some(self.rows.drain(..count).collect())
    }
}

/// Stretches of samples that are no readings.
fn gaps(rows: &[Option<usize>]) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = Vec::new();
    for at in (0..rows.len()).filter(|at| rows[*at].is_none()) {
        match out.last_mut() {
            Some(gap) if gap.end == at => gap.end += 1,
            _ => out.push(at..at + 1),
        }
    }
    out
}

/// One channel: its samples that wait, and what was left out of those before.
#[derive(Debug, Default)]
pub(super) struct Undisturbed {
    values: Vec<f64>,
    strays: usize,
    /// The first of them.
    named: Vec<Stray>,
    /// Standard deviations by which the farthest one is off.
    farthest: f64,
    knocks: usize,
    /// Readings within knocks.
    knocked: usize,
    /// First row of the first knock.
    first_row: Option<usize>,
}

impl Undisturbed {
    /// Adds samples of a block.
    pub(super) fn add(&mut self, values: &[f64]) {
        self.values.extend_from_slice(values);
    }

    /// Samples of the piece with these rows as they wait.
    pub(super) fn waiting(&self, rows: &[Option<usize>]) -> &[f64] {
        &self.values[..rows.len()]
    }

    /// Takes the samples of the piece with these rows: as they waited, but for what was left out.
    pub(super) fn piece(&mut self, rows: &[Option<usize>]) -> Vec<f64> {
        let mut values: Vec<f64> = self.values.drain(..rows.len()).collect();
        lost::draw(&mut values, &gaps(rows));
        let found = take_out(&mut values);
        for bad in found.bad {
            // A sample that a straight line towards a bad reading stood in for is no reading.
            let Some(row) = rows[bad.at] else { continue };
            self.strays += 1;
            self.farthest = self.farthest.max(bad.deviations);
            if self.named.len() < NAMED {
                self.named.push(Stray { row, value: bad.value, deviations: bad.deviations });
            }
        }
        for knock in found.knocks {
            let rows = &rows[knock.from..knock.to];
            self.knocks += 1;
            self.knocked += rows.iter().flatten().count();
            self.first_row = self.first_row.or_else(|| rows.iter().flatten().next().copied());
        }
        values
    }

    /// Returns what was left out of the column of this heading.
    pub(super) fn findings(&self, column: &str) -> Vec<Finding> {
        let mut out = Vec::new();
        if self.strays > 0 {
            out.push(Finding::StraysLeftOut {
                column: column.into(),
                readings: self.strays,
                named: self.named.clone(),
                farthest: self.farthest,
            });
        }
        if let Some(first_row) = self.first_row {
            let (column, knocks, readings) = (column.into(), self.knocks, self.knocked);
            out.push(Finding::KnocksLeftOut { column, knocks, readings, first_row });
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Philox, Stream};

    /// Values handed on in blocks of 8192, and what was left out of them.
    fn handed_on(values: &[f64]) -> (Vec<f64>, Vec<Finding>) {
        let (mut waiting, mut channel, mut out) = (Waiting::default(), Undisturbed::default(), Vec::new());
        let mut most = 0;
        for (n, values) in values.chunks(8192).enumerate() {
            let rows = (8192 * n..).take(values.len()).map(Some).collect();
            waiting.add(&Block { columns: Vec::new(), rows, broken_off: false });
            channel.add(values);
            most = most.max(channel.values.len());
            while let Some(rows) = waiting.piece(false) {
                out.extend(channel.piece(&rows));
            }
        }
        while let Some(rows) = waiting.piece(true) {
            out.extend(channel.piece(&rows));
        }
        assert!(most <= 2 * PIECE + 8192, "{most} samples wait");
        (out, channel.findings("x"))
    }

    fn noise(count: usize) -> Vec<f64> {
        let mut rng = Philox::new(19, 0, Stream::Host);
        (0..count).map(|_| rng.normal()).collect()
    }

    #[test]
    fn noise_of_any_length_is_handed_on_as_it_is_and_nothing_is_said() {
        for count in [1, 255, 14_460, 2 * PIECE, 5 * PIECE + 77] {
            let values = noise(count);
            assert_eq!(handed_on(&values), (values, Vec::new()));
        }
    }

    #[test]
    fn a_stray_reading_of_any_piece_is_left_out_with_its_row_and_value() {
        let clean = noise(5 * PIECE + 77);
        for row in [0, PIECE - 1, PIECE, 4 * PIECE + 100, clean.len() - 1] {
            let mut values = clean.clone();
            values[row] = 1e4;
            let (out, findings) = handed_on(&values);
            let [Finding::StraysLeftOut { readings: 1, named, .. }] = &findings[..] else { panic!("{findings:?}") };
            assert_eq!((named[0].row, named[0].value), (row, 1e4));
            let changed: Vec<usize> = (0..out.len()).filter(|n| out[*n] != values[*n]).collect();
            assert!(changed == [row] && out[row].abs() < 1.0);
        }
    }
}
