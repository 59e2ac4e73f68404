//! A study of one axis divided among machines: its ensembles, and the answer from the files of all
//! shards.

use std::ops::Range;
use std::path::Path;

use super::carried::{self, Line, refuse};
use super::{Drift, answer, jobs};
use crate::control::Control;
use crate::ensemble::divided::{merge, parts};
use crate::error::Result;
use crate::kernel::job::Job;
use crate::shard::Shard;
use crate::shard::file::Header;
use crate::shard::gather::Found;
use crate::study::Study;

/// A study and its ensembles.
pub struct Divided {
    /// The ensembles: the parts that are divided.
    pub jobs: Vec<Job>,
    line: Line,
}

impl Divided {
    /// A study that was read from `input`, or the default one.
    ///
    /// # Errors
    /// As [`jobs`].
    pub fn of(study: &Study, input: Option<&Path>, control: &Control) -> Result<Self> {
        let jobs = jobs(study, control)?;
        Ok(Self { line: Line::of(study, parts(&jobs), input)?, jobs })
    }

    /// The head of a shard's file before anything is done.
    pub fn header(&self, shard: Shard) -> Header {
        self.line.header(shard)
    }

    /// The same of a shard that takes its share of what is left of a run.
    pub fn rest(&self, shard: Shard, gaps: &[(usize, Range<u64>)]) -> Header {
        self.line.rest(shard, gaps)
    }
}

/// The answer to a study from the files of all its shards.
///
/// # Errors
/// A file that is damaged; a recording of the study that has changed or is not there.
pub fn merged(study: &Study, found: &[Found], control: &Control) -> Result<Drift> {
    let jobs = jobs(study, control)?;
    let identity = carried::identity(study, &parts(&jobs), found)?;
    let mut statistics = merge(found, &identity, &jobs, control)?.into_iter();
    answer(study, control, |_, name| {
        statistics.next().ok_or_else(|| refuse(format!("nothing was summed for: {name}"), "report this as a defect"))
    })
}
