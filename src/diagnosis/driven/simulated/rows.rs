//! The rows that a set of laws is fitted to, as simulations see them, in segments and blocks.

use std::ops::Range;
use std::sync::Arc;

use crate::driven::intake::data::Data;
use crate::engine::kind::Layout;

/// Rows of a block at least.
pub(in crate::driven) const LEAST_BLOCK: usize = 6;

/// Rows that are fitted: segments one after the other, each of which begins anew.
#[derive(Debug, Clone)]
pub(in crate::driven) struct Rows {
    /// The recording in the form that simulations see.
    pub data: Data,
    /// Segments and blocks.
    pub layout: Layout,
    /// States whether each segment is a recording with an offset of its own.
    pub own_offsets: bool,
    /// Row of the recording of each row here.
    pub at: Vec<usize>,
    /// Rows of the recording from one row to the next.
    pub step: usize,
    /// One segment of so many is fitted.
    pub of: usize,
    /// Standard deviation of white noise of unit size after the parabolas.
    pub noise_gain: f64,
    /// Every sample of the segments, where not every one is a row.
    pub samples: Option<Arc<Rows>>,
}

impl Rows {
    /// Reading of each row.
    pub(in crate::driven) fn readings(&self) -> &[f64] {
        &self.data.reading[self.data.hull.clone()]
    }

    /// Returns whether one segment goes on where another one ends.
    pub(in crate::driven) fn follows(&self, before: &Range<usize>, after: &Range<usize>) -> bool {
        self.at[after.start] == self.at[before.end - 1] + self.step
    }

    /// The same rows with each two segments that follow one another as one; `None` where none do.
    pub(in crate::driven) fn joined(&self) -> Option<Self> {
        let mut segments: Vec<Range<usize>> = Vec::new();
        let mut is_pair = true;
        for segment in &self.layout.segments {
            match segments.last_mut().filter(|last| !is_pair && self.follows(last, segment)) {
                Some(last) => (last.end, is_pair) = (segment.end, true),
                None => {
                    segments.push(segment.clone());
                    is_pair = false;
                }
            }
        }
        if segments.len() == self.layout.segments.len() {
            return None;
        }
        let block = self.layout.blocks.iter().map(Range::len).max().unwrap_or(LEAST_BLOCK);
        let mut joined = Self { samples: None, ..self.clone() };
        let first = self.data.hull.start;
        joined.data.breaks = segments.iter().skip(1).map(|s| first + s.start).collect();
        joined.data.train = segments.iter().map(|s| first + s.start..first + s.end).collect();
        joined.layout = Layout::new(segments, block, self.layout.counts.clone());
        Some(joined)
    }
}
