//! Independent cases side by side, each on one thread from beginning to end.
//!
//! A diagnosis is parallel inside. Nested in a parallel loop, a thread that waits for its own parts
//! would begin another case meanwhile: many stand half done, their times mean nothing, and a stop
//! loses them all. Here each worker's inner loops run on the worker itself.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::ThreadPoolBuilder;

use proofmass_base::error::{Error, Result};
use proofmass_base::parallel;

/// Does `work` for every item in their order, as many at a time as there are threads; the first
/// error ends it.
///
/// # Errors
/// The first of `work`, or that no thread can be started.
pub(crate) fn side_by_side<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> Result<R> + Sync) -> Result<Vec<R>> {
    let next = AtomicUsize::new(0);
    let places: Vec<Option<R>> = items.iter().map(|_| None).collect();
    let done: Mutex<Result<Vec<Option<R>>>> = Mutex::new(Ok(places));
    let note = |result: Result<(usize, R)>| -> bool {
        let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        match (result, done.as_mut()) {
            (Ok((n, result)), Ok(places)) => places[n] = Some(result),
            (Err(error), Ok(_)) => *done = Err(error),
            (_, Err(_)) => {}
        }
        done.is_ok()
    };
    let worker = || {
        let pool = match ThreadPoolBuilder::new().num_threads(1).build() {
            Ok(pool) => pool,
            Err(e) => {
                note(Err(no_thread(&e.to_string())));
                return;
            }
        };
        pool.install(|| {
            loop {
                let n = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(n) else { break };
                if !note(work(item).map(|result| (n, result))) {
                    break;
                }
            }
        });
    };
    std::thread::scope(|scope| {
        for _ in 0..parallel::threads().min(items.len()) {
            if let Err(e) = std::thread::Builder::new().spawn_scoped(scope, worker) {
                note(Err(no_thread(&e.to_string())));
            }
        }
    });
    let done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)?;
    Ok(done.into_iter().flatten().collect())
}

/// Does all of `work` on one thread, inner loops included.
///
/// # Errors
/// No thread can be started.
pub(crate) fn alone<R: Send>(work: impl FnOnce() -> R + Send) -> Result<R> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| no_thread(&e.to_string()))?;
    Ok(pool.install(work))
}

fn no_thread(cause: &str) -> Error {
    Error::new("could not start a worker", cause, "free memory, or allow more threads to this user")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_their_order_and_inner_loops_stay_on_their_worker() {
        let items: Vec<usize> = (0..40).collect();
        let found = side_by_side(&items, |n| {
            let own = std::thread::current().id();
            let threads = parallel::map_indices(64, |_| std::thread::current().id());
            let elsewhere = threads.iter().filter(|thread| **thread != own).count();
            Ok((*n, elsewhere))
        });
        assert_eq!(found.expect("no error"), items.iter().map(|n| (*n, 0)).collect::<Vec<_>>());
    }

    #[test]
    fn an_error_ends_it() {
        let failed = side_by_side(&[1, 2, 3], |n| if *n == 2 { Err(no_thread("none")) } else { Ok(*n) });
        assert!(failed.is_err());
    }
}
