//! The CPU time of a task, however busy the machine is with others.

use std::time::Duration;

use cpu_time::ThreadTime;

/// A batch takes at least this long: a hundred times the tick of the clock and more.
const LEAST: Duration = Duration::from_millis(1);

/// The CPU time of a job, s, from a batch of as many as are long enough to measure; `batch` is where to start, and where
/// the next time may.
pub(crate) fn cpu_seconds(batch: &mut u32, mut job: impl FnMut()) -> f64 {
    loop {
        let began = ThreadTime::now();
        (0..*batch).for_each(|_| job());
        let spent = began.elapsed();
        if spent >= LEAST {
            return spent.as_secs_f64() / f64::from(*batch);
        }
        *batch *= 2;
    }
}
