//! A column on its way into memory: missing readings become straight lines, and neighbours are
//! averaged where a reader asks for it.

use std::ops::Range;
use std::path::Path;

use super::finding::Finding;
use super::health::Watch;
use super::limits::FILL_LIMIT;
use crate::error::{Error, Result};

/// Which samples are kept, and how many of them become one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Keep {
    /// Samples kept; all others pass.
    pub window: Range<usize>,
    /// Neighbours that are averaged.
    pub together: usize,
    /// About how many values will come of it.
    pub expected: usize,
}

#[derive(Debug)]
pub(crate) struct Series {
    keep: Keep,
    pub values: Vec<f64>,
    /// Looks at every sample kept, before it is averaged; of a slow column, at what was written.
    pub watch: Watch,
    /// Runs of samples that were not recorded, counted from the first sample; not where neighbours
    /// are averaged.
    pub filled: Vec<Range<usize>>,
    name: String,
    /// Written in a few rows only: what stands between was not lost.
    is_slow: bool,
    samples: usize,
    sum: f64,
    summed: usize,
    last: Option<f64>,
    pending: usize,
    readings: usize,
    missing: usize,
    run: usize,
    longest: usize,
}

impl Series {
    /// A series without samples.
    pub(crate) fn new(name: &str, keep: &Keep) -> Self {
        Self {
            keep: keep.clone(),
            values: Vec::with_capacity(keep.expected),
            watch: Watch::new(name),
            filled: Vec::new(),
            name: name.into(),
            is_slow: false,
            samples: 0,
            sum: 0.0,
            summed: 0,
            last: None,
            pending: 0,
            readings: 0,
            missing: 0,
            run: 0,
            longest: 0,
        }
    }

    /// The same of a column that may be written in a few rows only.
    pub(crate) fn slow(self, is_slow: bool) -> Self {
        Self { is_slow, ..self }
    }

    /// The next reading; NaN where it is missing.
    pub(crate) fn push(&mut self, value: f64) {
        self.readings += 1;
        if value.is_nan() {
            self.missing += 1;
            self.run += 1;
            self.longest = self.longest.max(self.run);
            self.pending += 1;
            return;
        }
        self.run = 0;
        if self.pending > 0 {
            self.fill(Some(value));
        }
        self.last = Some(value);
        if self.is_slow && self.keep.window.contains(&self.samples) {
            self.watch.push(value);
        }
        self.emit(value, true);
    }

    /// A sample that has no row.
    pub(crate) fn push_hole(&mut self) {
        self.pending += 1;
    }

    fn fill(&mut self, next: Option<f64>) {
        let count = std::mem::take(&mut self.pending);
        if self.keep.together == 1 && !self.is_slow {
            self.filled.push(self.samples..self.samples + count);
        }
        let left = self.last.or(next).unwrap_or(0.0);
        let right = next.or(self.last).unwrap_or(0.0);
        for k in 1..=count {
            self.emit(left + (right - left) * k as f64 / (count + 1) as f64, false);
        }
    }

    fn emit(&mut self, value: f64, is_reading: bool) {
        self.samples += 1;
        if !self.keep.window.contains(&(self.samples - 1)) {
            return;
        }
        match (self.is_slow, is_reading) {
            (true, _) => {}
            (false, true) => self.watch.push(value),
            (false, false) => self.watch.skip(),
        }
        if self.keep.together == 1 {
            self.values.push(value);
            return;
        }
        self.sum += value;
        self.summed += 1;
        if self.summed == self.keep.together {
            self.values.push(self.sum / self.keep.together as f64);
            (self.sum, self.summed) = (0.0, 0);
        }
    }

    /// Samples that become one.
    pub(crate) fn together(&self) -> usize {
        self.keep.together
    }

    /// Samples that passed.
    pub(crate) fn total(&self) -> usize {
        self.samples
    }

    /// Samples kept, before any were averaged.
    pub(crate) fn kept(&self) -> usize {
        self.samples.min(self.keep.window.end).saturating_sub(self.keep.window.start)
    }

    /// Puts straight lines where a column that may be written in a few rows holds nothing, and counts
    /// them: on an uneven clock, samples are made of rows.
    pub(crate) fn bridge(&mut self, rows: &mut [f64]) {
        if !self.is_slow {
            return;
        }
        let mut lines = Self::new(&self.name, &Keep { window: 0..usize::MAX, together: 1, expected: rows.len() });
        rows.iter().for_each(|value| lines.push(*value));
        if lines.pending > 0 {
            lines.fill(None);
        }
        rows.copy_from_slice(&lines.values);
        (self.missing, self.longest) = (lines.missing, lines.longest);
        self.readings = 0;
    }

    /// Nothing follows. What a person should know of the missing readings.
    ///
    /// # Errors
    /// When more than 5 % of the readings are missing; of a slow column, where it was not written for as
    /// long, and for more than twice as long as it usually is not.
    pub(crate) fn finish(&mut self, path: &Path) -> Result<Option<Finding>> {
        if self.pending > 0 {
            self.fill(None);
        }
        let (readings, missing, longest) = (self.readings, self.missing, self.longest);
        let most = FILL_LIMIT * readings as f64;
        let there = readings.saturating_sub(missing);
        let is_lost = if self.is_slow {
            there == 0 || longest as f64 > most && longest > 2 * readings / there
        } else {
            missing as f64 > most
        };
        if is_lost {
            return Err(Error::new(
                format!("could not use column `{}` of {}", self.name, path.display()),
                format!("{missing} of {readings} values are missing"),
                "leave the column out, or cut the recording to a stretch where it was logged",
            ));
        }
        let column = self.name.clone();
        Ok(match missing {
            0 => None,
            _ if self.is_slow => Some(Finding::WrittenInFew { column, readings: there, rows: readings }),
            _ => Some(Finding::MissingReadings { column, readings: missing, longest }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(values: &[f64], together: usize) -> (Series, Result<Option<Finding>>) {
        let keep = Keep { window: 0..usize::MAX, together, expected: 0 };
        let mut series = Series::new("x", &keep);
        values.iter().for_each(|v| series.push(*v));
        let said = series.finish(Path::new("log.csv"));
        (series, said)
    }

    #[test]
    fn holes_are_bridged_and_too_many_refused() {
        let nan = f64::NAN;
        let (bridged, said) = series(&[vec![nan, 1.0, nan, nan, 4.0], vec![5.0; 95]].concat(), 1);
        assert_eq!(bridged.values[..5], [1.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(bridged.filled, [0..1, 2..4]);
        let column = "x".to_owned();
        assert_eq!(said, Ok(Some(Finding::MissingReadings { column, readings: 3, longest: 2 })));
        assert!(series(&[nan, 1.0, 2.0], 1).1.is_err());
    }

    #[test]
    fn a_slow_column_goes_straight_between_its_rows_and_one_that_ends_midway_is_refused() {
        let keep = Keep { window: 0..usize::MAX, together: 1, expected: 0 };
        let read = |written: &dyn Fn(usize) -> bool, is_slow: bool| {
            let mut series = Series::new("x", &keep).slow(is_slow);
            (0..1000).for_each(|k| series.push(if written(k) { k as f64 } else { f64::NAN }));
            let said = series.finish(Path::new("log.csv"));
            (series, said)
        };
        let (series, said) = read(&|k| k % 100 == 0, true);
        assert_eq!(said, Ok(Some(Finding::WrittenInFew { column: "x".into(), readings: 10, rows: 1000 })));
        assert!(series.filled.is_empty(), "nothing was lost");
        assert!(series.values[..=900].iter().enumerate().all(|(k, v)| (v - k as f64).abs() < 1e-9));
        assert!(read(&|k| k % 10 == 0 && k < 500, true).1.is_err() && read(&|_| false, true).1.is_err());
        assert!(read(&|k| k % 100 == 0, false).1.is_err(), "control: a reading is no slow column");
    }

    #[test]
    fn neighbours_are_averaged_and_a_window_is_kept() {
        assert_eq!(series(&[1.0, 3.0, 5.0, 7.0, 9.0], 2).0.values, [2.0, 6.0]);
        let mut part = Series::new("x", &Keep { window: 1..3, together: 1, expected: 0 });
        (0..5).for_each(|k| part.push(f64::from(k)));
        assert_eq!(part.values, [1.0, 2.0]);
    }
}
