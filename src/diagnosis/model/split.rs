//! Which samples of a recording are fitted and which judge.

use std::ops::Range;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

/// Half-open ranges of samples.
pub type Ranges = Vec<[usize; 2]>;

/// Which samples are fitted and which judge; absent means interleaved blocks.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// Ranges that are fitted, half-open, samples.
    #[serde(default)]
    pub train: Ranges,
    /// Ranges that are held out and validate, half-open, samples.
    #[serde(default)]
    pub test: Ranges,
}

impl Split {
    /// From the first sample named to the last; `None` where none is, or only empty ranges.
    pub fn hull(&self) -> Option<Range<usize>> {
        let all = || self.train.iter().chain(&self.test);
        let hull = all().map(|r| r[0]).min()?..all().map(|r| r[1]).max()?;
        (hull.start < hull.end).then_some(hull)
    }

    /// Checks whether the ranges lie within `samples` samples and none is both fitted and held out.
    ///
    /// # Errors
    /// What is wrong with them, and what to write.
    pub fn check(&self, samples: usize) -> Result<(), (String, &'static str)> {
        if let Some([from, to]) = self.train.iter().chain(&self.test).find(|r| r[0] >= r[1] || r[1] > samples) {
            return Err((
                format!("the range [{from}, {to}) does not lie in the {samples} samples"),
                "ranges are half-open, counted from zero: [[0, 10000]]",
            ));
        }
        let pairs = self
            .train
            .iter()
            .flat_map(|a| self.test.iter().map(move |b| a[1].min(b[1]).saturating_sub(a[0].max(b[0]))));
        match pairs.sum() {
            0usize => Ok(()),
            lost => Err((
                format!("[split] train and test overlap in {lost} samples"),
                "training samples cannot validate: make the ranges disjoint",
            )),
        }
    }
}
