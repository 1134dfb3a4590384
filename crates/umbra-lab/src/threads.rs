//! Jobs on all processors at once.

use std::panic::resume_unwind;
use std::thread;

/// Does a job for each item, each on a thread of its own, and returns the results in the order of the items.
pub(crate) fn at_once<T: Sync, R: Send>(items: &[T], job: impl Fn(&T) -> R + Sync) -> Vec<R> {
    thread::scope(|scope| {
        let threads: Vec<_> = items.iter().map(|item| scope.spawn(|| job(item))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}
