//! Places the windows: stretches of readings that do not overlap, spread over what is there.

use std::ops::Range;

/// Windows of `steps` intervals in stretches of readings, each given by its first reading: as many
/// as fit, with equal gaps before, between and after them. Two neighbours may share the reading
/// between them.
pub(super) fn windows(pieces: &[Range<usize>], steps: usize) -> Vec<usize> {
    let mut all = Vec::new();
    for piece in pieces {
        let intervals = piece.len().saturating_sub(1);
        let count = intervals / steps.max(1);
        let slack = intervals - count * steps;
        all.extend((0..count).map(|k| piece.start + k * steps + slack * (k + 1) / (count + 1)));
    }
    all
}

/// The stretches without one that is taken for something else.
pub(super) fn without(pieces: &[Range<usize>], taken: &Range<usize>) -> Vec<Range<usize>> {
    let parts = |piece: &Range<usize>| {
        [piece.start..taken.start.clamp(piece.start, piece.end), taken.end.clamp(piece.start, piece.end)..piece.end]
    };
    pieces.iter().flat_map(parts).filter(|piece| !piece.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use super::*;

    #[test]
    fn windows_fill_what_is_there_without_overlap() {
        let whole = from_ref(&(0..101)).to_vec();
        assert_eq!(windows(&whole, 10), (0..10).map(|k| k * 10).collect::<Vec<_>>());
        // 108 intervals hold ten windows, and eight intervals lie between them.
        let spread = windows(from_ref(&(5..114)), 10);
        assert_eq!((spread.len(), spread[0] >= 5, spread[9] + 10 <= 113), (10, true, true));
        assert!(spread.windows(2).all(|w| w[1] >= w[0] + 10 && w[1] <= w[0] + 11));
        assert!(windows(from_ref(&(0..10)), 10).is_empty() && windows(&[], 10).is_empty());
        assert_eq!(without(&[0..50, 60..90], &(40..70)), [0..40, 70..90]);
        assert_eq!(without(&whole, &(160..170)), whole);
    }
}
