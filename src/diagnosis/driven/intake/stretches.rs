//! Ranges of samples: which are fitted, which judge, and which stretch of a long recording is
//! searched.
//!
//! Not for finding defects (`prepare`) and not for changing roles once they are given (`folds`).

use std::ops::Range;

use crate::numerics::moments::mean_sd;
use crate::numerics::order;

use super::data::Data;

/// Half-open ranges of samples, ascending.
pub(crate) type Stretches = Vec<Range<usize>>;

/// Blocks that a stretch is cut into when the model does not state which samples judge; every third
/// one judges. Many, so that what happens once is seen by both kinds.
const BLOCKS: usize = 72;
/// Recordings longer than this are searched on a stretch only.
const LONG: usize = 40_000;
/// Samples of that stretch.
const STRETCH: usize = 12_288;

/// Ranges as a model file states them, ascending.
pub(crate) fn sorted(ranges: &[[usize; 2]]) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = ranges.iter().map(|[a, b]| *a..*b).collect();
    order::sort_by_key(&mut all, |r| r.start as f64);
    all
}

/// Ascending ranges, those that touch joined.
pub(crate) fn merged(sorted: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for r in sorted {
        match all.last_mut() {
            Some(last) if r.start <= last.end => last.end = last.end.max(r.end),
            _ => all.push(r),
        }
    }
    all
}

/// Returns the part of `from` that lies outside `take`.
pub(crate) fn minus(from: &[Range<usize>], take: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut remaining = from.to_vec();
    for t in take {
        remaining = remaining
            .into_iter()
            .flat_map(|r| [r.start..r.end.min(t.start.max(r.start)), r.start.max(t.end.min(r.end))..r.end])
            .filter(|r| r.start < r.end)
            .collect();
    }
    remaining
}

/// The loudest stretch of a long recording, to choose terms on; the terms chosen are fitted to
/// everything afterwards. `None` where the recording is short enough to be used whole.
pub(crate) fn loudest(data: &Data) -> Option<Data> {
    loudest_of(data, LONG, STRETCH)
}

/// The loudest stretch of so many samples of a recording longer than this.
pub(crate) fn loudest_of(data: &Data, longest: usize, stretch: usize) -> Option<Data> {
    if data.hull.len() <= longest {
        return None;
    }
    let power = |r: &Range<usize>| mean_sd(&data.reading[r.clone()]).1;
    let mut spans = data.recordings();
    spans.retain(|r| r.len() >= stretch);
    // Across several recordings only where each of them is short.
    if spans.is_empty() {
        spans.push(data.hull.clone());
    }
    let windows = spans.iter().flat_map(|r| (0..=8).map(move |i| r.start + (r.len() - stretch) * i / 8));
    let hull = windows.map(|a| a..a + stretch).max_by(|a, b| power(a).total_cmp(&power(b)))?;
    let breaks = data.breaks.iter().copied().filter(|b| hull.start < *b && *b < hull.end).collect();
    let known = merged({
        let mut all: Vec<Range<usize>> = data.train.iter().chain(&data.validation).cloned().collect();
        order::sort_by_key(&mut all, |r| r.start as f64);
        all
    });
    let missing = minus(std::slice::from_ref(&hull), &known);
    let (fitted, validation) = interleaved(std::slice::from_ref(&hull));
    let (fitted, validation) = (minus(&fitted, &missing), minus(&validation, &missing));
    Some(Data { hull, breaks, train: fitted, test: validation.clone(), validation, ..data.clone() })
}

/// Every third block apart.
pub(crate) fn interleaved(train: &[Range<usize>]) -> (Vec<Range<usize>>, Vec<Range<usize>>) {
    let total: usize = train.iter().map(Range::len).sum();
    let block = (total / BLOCKS).max(1);
    let (mut fitted, mut validation) = (Vec::new(), Vec::new());
    let mut index = 0;
    for range in train {
        let count = (range.len() / block).max(1);
        for b in 0..count {
            let r = range.start + range.len() * b / count..range.start + range.len() * (b + 1) / count;
            if index % 3 == 1 {
                validation.push(r)
            } else {
                fitted.push(r)
            }
            index += 1;
        }
    }
    (merged(fitted), validation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_taken_apart_without_loss() {
        let one = |r: Range<usize>| std::slice::from_ref(Box::leak(Box::new(r)));
        assert_eq!(minus(&[0..10, 20..30], one(5..25)), vec![0..5, 25..30]);
        assert_eq!(minus(one(0..10), one(20..25)), one(0..10));
        let (fitted, validation) = interleaved(one(0..7200));
        assert_eq!(fitted.iter().chain(&validation).map(Range::len).sum::<usize>(), 7200);
        assert_eq!(validation.len(), BLOCKS / 3);
    }
}
