//! Work spread over the processor's threads, results in the order of their items whatever the
//! threads.
//!
//! Sums belong to the caller, who folds the results in their order. The loop itself is compiled
//! once for all callers: it costs a lock and an indirect call per item, so an item is best
//! microseconds of work or more.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

pub use rayon::join;

/// Returns the number of items that are worked on at a time.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// `work` of every item.
pub fn map<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    gather(items.len(), &|i| Some(work(&items[i])))
}

/// `work` of every item, where there is a result.
pub fn filter_map<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> Option<R> + Sync) -> Vec<R> {
    gather(items.len(), &|i| work(&items[i]))
}

/// `work` of 0, 1, … `count` − 1.
pub fn map_indices<R: Send>(count: usize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
    gather(count, &|i| Some(work(i)))
}

/// `work` of every member of an ensemble.
pub fn map_members<R: Send>(members: Range<u64>, work: impl Fn(u64) -> R + Sync) -> Vec<R> {
    let count = members.end.saturating_sub(members.start) as usize;
    gather(count, &|i| Some(work(members.start + i as u64)))
}

/// `work` of every stretch of `size` items, the last one maybe shorter, with its number.
pub fn map_chunks<T: Sync, R: Send>(items: &[T], size: usize, work: impl Fn(usize, &[T]) -> R + Sync) -> Vec<R> {
    let count = items.len().div_ceil(size);
    gather(count, &|i| Some(work(i, &items[i * size..items.len().min((i + 1) * size)])))
}

/// Does `work` on every item in its place, with its index.
pub fn for_each_mut<T: Send>(items: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    let places: Vec<Mutex<&mut T>> = items.iter_mut().map(Mutex::new).collect();
    each(places.len(), &|i| work(i, &mut places[i].lock().unwrap_or_else(PoisonError::into_inner)));
}

fn gather<R: Send>(count: usize, work: &(dyn Fn(usize) -> Option<R> + Sync)) -> Vec<R> {
    let mut places: Vec<Option<R>> = Vec::new();
    places.resize_with(count, || None);
    for_each_mut(&mut places, |i, place| *place = work(i));
    places.into_iter().flatten().collect()
}

/// The only loop over threads: compiled once.
fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once_and_keeps_its_place() {
        let items: Vec<usize> = (0..1000).collect();
        let squares: Vec<usize> = items.iter().map(|i| i * i).collect();
        assert_eq!(map(&items, |i| i * i), squares);
        assert_eq!(map_indices(1000, |i| i * i), squares);
        assert_eq!(map_chunks(&items, 7, |n, chunk| (n, chunk.to_vec())).len(), 143);
        assert_eq!(map_chunks(&items, 7, |n, chunk| chunk.iter().all(|i| i / 7 == n)), vec![true; 143]);
        let mut places = vec![0; 1000];
        for_each_mut(&mut places, |i, place| *place += i * i);
        assert_eq!(places, squares);
        assert_eq!(map_members(5..8, |m| m), [5, 6, 7]);
        assert_eq!(filter_map(&items, |i| (i % 400 == 1).then_some(*i)), [1, 401, 801]);
        assert!(map(&[] as &[usize], |i| *i).is_empty());
    }
}
