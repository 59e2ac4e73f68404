//! The length of submissions: near 80 ms, so that no driver loses patience and Ctrl-C is heard,
//! while the next one is prepared.

use std::time::Instant;

use super::{Gpu, Submission};
use crate::backend::tile;
use crate::error::Result;

/// Seconds a submission should take.
const TARGET_S: f64 = 0.08;
/// Member-steps of a first submission: a tenth of a second on the slowest adapters.
const FIRST: u64 = 1 << 22;
/// Fewest samples of a first submission.
const FEWEST: u64 = 16;

/// The submissions of a batch, of which one is under way while the next is prepared.
pub(super) struct Pace {
    /// Samples of the next submission.
    pub samples: u64,
    most: u64,
    under_way: Option<(Submission, u64)>,
    begun: Instant,
}

impl Pace {
    /// Begins with as many samples as their steps allow, and never takes more than `most`.
    pub(super) fn of(steps_per_sample: u64, most: u64) -> Self {
        let samples = (FIRST / steps_per_sample.max(1)).clamp(FEWEST, most) & !3;
        Self { samples, most, under_way: None, begun: Instant::now() }
    }

    /// Notes a submission of that many samples, and waits for the one before, whose time sizes the
    /// next.
    ///
    /// # Errors
    /// It hangs, or the device was lost.
    pub(super) fn follow(&mut self, gpu: &Gpu, submission: Submission, samples: u64) -> Result<()> {
        if let Some((before, length)) = self.under_way.replace((submission, samples)) {
            gpu.wait(&before)?;
            self.samples = tile::adapt(length, self.begun.elapsed().as_secs_f64(), TARGET_S).min(self.most);
            self.begun = Instant::now();
        }
        Ok(())
    }

    /// Waits for the last.
    ///
    /// # Errors
    /// It hangs, or the device was lost.
    pub(super) fn finish(&mut self, gpu: &Gpu) -> Result<()> {
        self.under_way.take().map_or(Ok(()), |(last, _)| gpu.wait(&last))
    }
}
