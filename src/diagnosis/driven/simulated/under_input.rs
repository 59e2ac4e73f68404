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

/// Selects the rows of a recording. `cycle`: samples per cycle of its resonance. `segment`: rows after which
/// a simulation restarts; `None` runs to the end. A chaotic response restarts in each of its windows.
pub(in crate::driven) fn rows(data: &Data, cycle: f64, segment: Option<usize>) -> Rows {
    let mut data = loudest_of(data, MOST, MOST).unwrap_or_else(|| data.clone());
    let hull = data.hull.clone();
    let parts = data.windows.take().map_or_else(|| data.recordings(), |w| w.parts(&hull));
    let own_offsets = !data.breaks.is_empty();
    let parts: Vec<Range<usize>> = parts.into_iter().flat_map(|part| divided(part, segment)).collect();
    data.breaks = parts.iter().skip(1).map(|p| p.start).collect();
    let segments: Vec<_> = parts.iter().map(|p| p.start - hull.start..p.end - hull.start).collect();
    let mut counts = vec![false; hull.len()];
    for part in data.train.iter().chain(&data.validation) {
        counts[part.start - hull.start..part.end - hull.start].fill(true);
    }
    let block = (hull.len() / BLOCKS).max(cycle as usize).max(LEAST_BLOCK);
    let layout = Layout::new(segments, block, counts);
    Rows { layout, own_offsets, at: hull.collect(), step: 1, of: 1, noise_gain: 1.0, samples: None, data }
}

/// Divides a part into pieces of about `segment` rows.
fn divided(part: Range<usize>, segment: Option<usize>) -> impl Iterator<Item = Range<usize>> {
    let count = segment.map_or(1, |rows| (part.len() / rows.max(1)).max(1));
    let length = part.len();
    (0..count).map(move |i| part.start + length * i / count..part.start + length * (i + 1) / count)
}
