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
    /// Looks at every sample kept, before it is averaged.
    pub watch: Watch,
    /// Runs of samples that were not recorded, counted from the first sample; not where neighbours
    /// are averaged.
    pub filled: Vec<Range<usize>>,
    name: String,
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
        self.emit(value);
    }

    /// A sample that has no row.
    pub(crate) fn push_hole(&mut self) {
        self.pending += 1;
    }

    fn fill(&mut self, next: Option<f64>) {
        let count = std::mem::take(&mut self.pending);
        if self.keep.together == 1 {
            self.filled.push(self.samples..self.samples + count);
        }
        let left = self.last.or(next).unwrap_or(0.0);
        let right = next.or(self.last).unwrap_or(0.0);
        for k in 1..=count {
            self.emit(left + (right - left) * k as f64 / (count + 1) as f64);
        }
    }

    fn emit(&mut self, value: f64) {
        self.samples += 1;
        if !self.keep.window.contains(&(self.samples - 1)) {
            return;
        }
        self.watch.push(value);
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

    /// Nothing follows. What a person should know of the missing readings.
    ///
    /// # Errors
    /// When more than 5 % of the readings are missing.
    pub(crate) fn finish(&mut self, path: &Path) -> Result<Option<Finding>> {
        if self.pending > 0 {
            self.fill(None);
        }
        if self.missing as f64 > FILL_LIMIT * self.readings as f64 {
            return Err(Error::new(
                format!("could not use column `{}` of {}", self.name, path.display()),
                format!("{} of {} values are missing", self.missing, self.readings),
                "leave the column out, or cut the recording to a stretch where it was logged",
            ));
        }
        let (readings, longest) = (self.missing, self.longest);
        Ok((readings > 0).then(|| Finding::MissingReadings { column: self.name.clone(), readings, longest }))
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
    fn neighbours_are_averaged_and_a_window_is_kept() {
        assert_eq!(series(&[1.0, 3.0, 5.0, 7.0, 9.0], 2).0.values, [2.0, 6.0]);
        let mut part = Series::new("x", &Keep { window: 1..3, together: 1, expected: 0 });
        (0..5).for_each(|k| part.push(f64::from(k)));
        assert_eq!(part.values, [1.0, 2.0]);
    }
}
