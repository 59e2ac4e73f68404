//! How much has been computed on a recording: integration steps, counted, so that a search ends at the same place on every
//! machine. Not a clock.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples that a search may always take for granted: shorter recordings get the work of this many.
const LEAST_SAMPLES: usize = 20_000;
/// Integration steps, eight parameter sets side by side counted as one, that a search may spend per sample.
const STEPS_PER_SAMPLE: u64 = 5_000;

/// A counter that all copies of a recording share.
#[derive(Debug, Clone, Default)]
pub struct Work(Arc<AtomicU64>);

impl Work {
    /// Counts steps.
    pub fn add(&self, steps: usize) {
        self.0.fetch_add(steps as u64, Ordering::Relaxed);
    }

    /// Steps so far. The same for every number of threads wherever all fits begun have ended.
    pub fn spent(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    /// Whether a search over this many samples should come to an end.
    pub fn is_spent(&self, samples: usize) -> bool {
        self.spent() > STEPS_PER_SAMPLE * samples.max(LEAST_SAMPLES) as u64
    }
}
