//! Values by their length, made once and kept as long as they are among those used last: a search transforms
//! many sequences of few lengths.

use std::sync::{Mutex, PoisonError};

/// The values used last, the latest first, of at most so much length together.
pub(super) struct Recent<T> {
    most: usize,
    kept: Mutex<Vec<(usize, T)>>,
}

impl<T: Clone> Recent<T> {
    /// Keeps nothing yet; later at most `most` of length.
    pub(super) const fn new(most: usize) -> Self {
        Self { most, kept: Mutex::new(Vec::new()) }
    }

    /// Returns the value of a length, made where it is not kept. Two threads may make the same one at once.
    pub(super) fn of(&self, length: usize, make: impl FnOnce() -> T) -> T {
        let known = |kept: &[(usize, T)]| kept.iter().position(|(l, _)| *l == length);
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = known(&kept) {
            kept[..=place].rotate_right(1);
            return kept[0].1.clone();
        }
        // To make one takes long: others need not wait for it.
        drop(kept);
        let made = make();
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if known(&kept).is_none() {
            kept.insert(0, (length, made.clone()));
            let mut together = 0;
            kept.retain(|(length, _)| {
                let fits = together + length <= self.most;
                together += if fits { *length } else { 0 };
                fits
            });
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_made_once_while_it_is_among_those_used_last() {
        let recent = Recent::new(10);
        let made = std::cell::Cell::new(0);
        let of = |length| {
            recent.of(length, || {
                made.set(made.get() + 1);
                made.get()
            })
        };
        assert_eq!([of(4), of(3), of(4), of(3)], [1, 2, 1, 2]);
        // A third one of 4 is too much together: the one that was used longest ago goes.
        assert_eq!([of(5), of(3), of(4)], [3, 2, 4]);
        // Too long to be kept at all.
        assert_eq!([of(11), of(11)], [5, 6]);
    }
}
