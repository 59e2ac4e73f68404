//! Takes the columns that a model names from a recording at rest: which rows, which channels, and what
//! surrounds them.

use std::collections::HashMap;
use std::ops::Range;

use crate::error::{Error, Result};
use crate::model;
use crate::recording::Recording;
use crate::recording::finding::{self, Finding};
use crate::stated_units;

use super::plausible;

/// Fewer samples cannot tell one law from another.
const FEWEST: usize = 256;

/// The columns of a recording over the rows that are used.
#[derive(Debug)]
pub(super) struct Columns<'a> {
    recording: &'a Recording,
    /// A linear search for each of many thousand channels would take minutes.
    places: HashMap<&'a str, usize>,
    pub rows: Range<usize>,
}

impl<'a> Columns<'a> {
    /// Looks the columns up, over the rows of the model's split.
    ///
    /// # Errors
    /// Ranges outside the recording, or samples that are to be fitted and to judge.
    pub(super) fn of(recording: &'a Recording, model: &model::Static) -> Result<Self> {
        let places = recording.columns.iter().enumerate().map(|(i, c)| (c.name.as_str(), i)).collect();
        Ok(Self { recording, places, rows: rows(recording, model)? })
    }

    /// Values of the column with this heading.
    ///
    /// # Errors
    /// A column that was not read.
    pub(super) fn values(&self, name: &str) -> Result<&'a [f64]> {
        let place = self.places.get(name);
        place.and_then(|i| self.recording.columns[*i].values.get(self.rows.clone())).ok_or_else(|| {
            Error::new("could not diagnose the recording", format!("column `{name}` was not read"), "check [columns]")
        })
    }

    /// Says what was found in the file, and that gaps are drawn from the noise about them where they are.
    pub(super) fn sentences(&self) -> Vec<String> {
        let mut findings = self.recording.findings.clone();
        if self.recording.averaged.is_none() {
            finding::drawn(&mut findings);
        }
        finding::sentences(&findings)
    }

    /// Samples of the rows used that were not recorded of a column, from the first row used.
    pub(super) fn filled(&self, name: &str) -> Vec<Range<usize>> {
        let Range { start, end } = self.rows;
        let own = self.places.get(name).and_then(|place| self.recording.filled_by_column.get(*place));
        // Means of neighbours are as noisy as what is in them.
        let filled = own.unwrap_or(&self.recording.filled).iter().filter(|_| self.recording.averaged.is_none());
        filled.filter(|gap| start < gap.start && gap.end < end).map(|gap| gap.start - start..gap.end - start).collect()
    }

    /// Stretches of the rows used, in rows of the file.
    pub(super) fn in_file(&self, stretches: Vec<Range<usize>>) -> Vec<Range<usize>> {
        let before = self.recording.first_sample + self.rows.start;
        // A mean stands for as many rows.
        let together = self.recording.averaged.as_ref().map_or(1, |a| a.together);
        stretches.into_iter().map(|s| before + s.start * together..before + s.end * together).collect()
    }

    /// The step that a column was rounded to before neighbours were averaged.
    pub(super) fn step_before(&self, name: &str) -> Option<f64> {
        let steps = &self.recording.averaged.as_ref()?.steps;
        steps.get(*self.places.get(name)?).copied().flatten()
    }

    /// The channels that are not constant.
    ///
    /// # Errors
    /// Fewer than 256 samples, columns that are not there, nothing but constants, or a gyro that is turned.
    pub(super) fn live(&self, model: &'a model::Static) -> Result<Vec<(&'a String, &'a [f64])>> {
        let named: Vec<(&String, &[f64])> =
            model.columns.channels.iter().map(|n| Ok((n, self.values(n)?))).collect::<Result<_>>()?;
        let live: Vec<_> = named.into_iter().filter(|(_, v)| v.windows(2).any(|w| w[0] != w[1])).collect();
        if live.is_empty() {
            let rounded = self.recording.findings.iter().any(|f| matches!(f, Finding::BeyondDouble { .. }));
            return Err(Error::new(
                "could not diagnose the recording",
                if rounded { "every channel is constant in double precision" } else { "every channel is constant" },
                "a sensor at rest still has noise: is it connected, and is the resolution high enough?",
            ));
        }
        if self.rows.len() < FEWEST {
            return Err(Error::new(
                "could not diagnose the recording",
                format!("{} samples", self.rows.len()),
                format!("need at least {FEWEST}; thousands are better"),
            ));
        }
        let rate_hz = self.recording.rate_hz / self.recording.averaged.as_ref().map_or(1, |a| a.together) as f64;
        for (name, values) in &live {
            plausible::turns(name, values, rate_hz, &stated_units::of(self.recording, name, model))?;
        }
        Ok(live)
    }
}

/// Values from the first to the last sample that the model's split names; all where it names none.
///
/// # Errors
/// Ranges outside the recording, or samples that are to be fitted and to judge.
fn rows(recording: &Recording, model: &model::Static) -> Result<Range<usize>> {
    let total = recording.first_sample + recording.samples();
    model.split.check(total).map_err(|(cause, hint)| {
        Error::new(format!("could not use [split] for {}", recording.path.display()), cause, hint)
    })?;
    let values = recording.columns.first().map_or(0, |c| c.values.len());
    Ok(match model.split.hull() {
        // The reader has cut it out where it averaged, or where the recording begins with it.
        Some(hull) if recording.averaged.is_none() => {
            let from = hull.start.saturating_sub(recording.first_sample);
            from..(hull.end - recording.first_sample.min(hull.end)).min(values)
        }
        _ => 0..values,
    })
}
