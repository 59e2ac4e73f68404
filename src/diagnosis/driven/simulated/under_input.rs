//! The rows of a recording under an input: every sample, as the input is known at no others, of its
//! loudest stretch where it is long; in the segments that a simulation can follow.

use std::ops::Range;

use crate::driven::intake::data::Data;
use crate::driven::intake::stretches::loudest_of;
use crate::engine::kind::Layout;

use super::rows::{LEAST_BLOCK, Rows};

/// Rows in all at most.
const MOST: usize = 8192;
/// Blocks in all at most.
const BLOCKS: usize = 40;
/// Cycles of the resonance after which a simulation begins anew that would lose the motion.
const RESTARTED: f64 = 4.0;
/// Rows between two beginnings at least.
const LEAST_SEGMENT: f64 = 24.0;

/// How far a simulation goes before it begins anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::driven) enum Reaches {
    /// To the end of its recording.
    End,
    /// A few cycles: what is slow or linear hides in the beginnings, and what turns the phase does not
    /// hide the laws.
    FewCycles,
}

impl Reaches {
    /// Parts of these that are simulated in one piece, with a cycle of so many samples.
    fn parts(self, whole: &[Range<usize>], cycle: f64) -> Vec<Range<usize>> {
        let length = match self {
            Self::End => usize::MAX,
            Self::FewCycles => (RESTARTED * cycle).max(LEAST_SEGMENT) as usize,
        };
        let divided = |part: &Range<usize>| {
            let (part, count) = (part.clone(), (part.len() / length).max(1));
            (0..count).map(move |i| part.start + part.len() * i / count..part.start + part.len() * (i + 1) / count)
        };
        whole.iter().flat_map(divided).collect()
    }
}

/// Rows of a recording whose resonance has a cycle of so many samples. One whose response is chaotic
/// begins anew in each of its windows.
pub(super) fn rows(data: &Data, cycle: f64, reaches: Reaches) -> Rows {
    let mut data = loudest_of(data, MOST, MOST).unwrap_or_else(|| data.clone());
    let hull = data.hull.clone();
    let parts = data.windows.take().map_or_else(|| data.recordings(), |w| w.parts(&hull));
    let own_offsets = !data.breaks.is_empty();
    let parts = reaches.parts(&parts, cycle);
    data.breaks = parts.iter().skip(1).map(|p| p.start).collect();
    let segments: Vec<_> = parts.iter().map(|p| p.start - hull.start..p.end - hull.start).collect();
    let mut counts = vec![false; hull.len()];
    for part in data.train.iter().chain(&data.validation) {
        counts[part.start - hull.start..part.end - hull.start].fill(true);
    }
    let block = (hull.len() / BLOCKS).max(cycle as usize).max(LEAST_BLOCK);
    let layout = Layout::new(segments, block, counts);
    Rows { layout, own_offsets, at: hull.collect(), step: 1, of: 1, noise_gain: 1.0, data }
}
