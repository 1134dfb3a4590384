//! The verification of a file, within its limits.

use std::fs::File;
use std::io::{self, Read};
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use indicatif::ProgressBar;
use umbra_physics::{Replay, ReplayError, VerifyError, World};

use super::limits::Limits;
use super::verdict::{Played, Verdict};
use crate::failure::Failure;
use crate::load::{self, Kind};

/// The terms that a file has to keep to.
#[derive(Clone)]
pub(super) struct Terms {
    pub(super) limits: Limits,
    /// The world that a replay has to begin with.
    pub(super) start: Option<Arc<World>>,
}

impl Terms {
    /// Takes the start from a file.
    pub(super) fn new(limits: Limits, start: Option<&Path>) -> Result<Self, Failure> {
        Ok(Self { limits, start: start.map(load::start).transpose()?.map(Arc::new) })
    }
}

/// The bytes of a file, if they are within the limit.
pub(super) fn read(source: impl Read, limits: &Limits) -> Result<Vec<u8>, Box<Verdict>> {
    let mut bytes = Vec::new();
    // A byte more than is allowed shows that there is more; a device may have no end.
    let read = source.take(limits.bytes().saturating_add(1)).read_to_end(&mut bytes);
    read.map_err(|error| Box::new(Verdict::unreadable(&error)))?;
    if bytes.len() as u64 > limits.bytes() { Err(Box::new(Verdict::too_large(limits.bytes()))) } else { Ok(bytes) }
}

/// The bytes of a regular file: to open a pipe would wait for whoever writes to it.
pub(super) fn read_regular(file: &Path, limits: &Limits) -> Result<Vec<u8>, Box<Verdict>> {
    let open = || {
        if !file.metadata()?.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
        }
        File::open(file)
    };
    read(open().map_err(|error| Box::new(Verdict::unreadable(&error)))?, limits)
}

/// Verifies the bytes of a source. Whatever happens there is a verdict.
pub(super) fn verdict(
    source: impl FnOnce() -> Result<Vec<u8>, Box<Verdict>> + Send,
    terms: &Terms,
    bar: &ProgressBar,
) -> Verdict {
    let work = || {
        let began = thread_time();
        let checked = panic::catch_unwind(AssertUnwindSafe(|| match source() {
            Ok(bytes) => check(bytes, terms, began, bar),
            Err(verdict) => *verdict,
        }));
        let mut verdict = checked.unwrap_or_else(|_| Verdict::failed());
        verdict.cpu = thread_time() - began;
        verdict
    };
    on_one_thread(work)
}

/// The CPU time of this thread so far.
fn thread_time() -> Duration {
    ThreadTime::now().as_duration()
}

/// Does work whose CPU time is that of the thread, also where steps use all cores: here files do.
fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    #[cfg(feature = "parallel")]
    if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        return pool.install(work);
    }
    work()
}

/// Runs a replay again; what is whole of it, if it is cut off. `began` is the CPU time of this thread from which the one of the file
/// is counted.
fn check(bytes: Vec<u8>, terms: &Terms, began: Duration, bar: &ProgressBar) -> Verdict {
    let (replay, flaw) = match Replay::from_bytes(&bytes, &[]) {
        Ok(replay) => (replay, None),
        Err(flaw @ ReplayError::CutOff { .. }) => match Replay::recovered(&bytes, &[]) {
            Ok(replay) => (replay, Some(flaw)),
            Err(_) => return Verdict::flawed(flaw, Played::default()),
        },
        Err(flaw) => {
            let verdict = Verdict::flawed(flaw, Played::default());
            return match Kind::of(&bytes) {
                Some(kind) if kind != Kind::Replay => verdict.foreign(kind),
                _ => verdict,
            };
        }
    };
    drop(bytes);
    let start = replay.start();
    if let Some(level) = terms.start.as_ref().filter(|level| level.state_hash() != start.state_hash()) {
        return Verdict::other_start(level.first_difference(start));
    }
    play(&replay, flaw, &terms.limits, began, bar)
}

fn play(replay: &Replay, flaw: Option<ReplayError>, limits: &Limits, began: Duration, bar: &ProgressBar) -> Verdict {
    let start = replay.start();
    bar.inc_length(replay.ticks().min(limits.replay().ticks));
    let allowed = limits.cpu_time();
    let is_over = || thread_time() - began >= allowed;
    let mut playback = replay.play_within(limits.replay()).stop_when(&is_over);
    let (started, mut ticks, mut hashes) = (Instant::now(), 0, 0);
    let end = loop {
        let stepped = playback.step();
        ticks += u64::from(!matches!(stepped, Ok(false)));
        match stepped {
            Ok(true) => hashes += u64::from(playback.recorded_hash().is_some()),
            Ok(false) => break Ok(()),
            Err(divergence) => break Err(divergence),
        }
        bar.inc(1);
    };
    let (wall, world) = (started.elapsed(), playback.world());
    let seconds = |world: &World| world.elapsed().num as f64 / world.elapsed().den as f64;
    let played = Played { ticks, hashes, seconds: seconds(world) - seconds(start), wall, end_hash: None };
    match (end, playback.exceeded(), flaw) {
        (Err(divergence), _, _) => Verdict::diverged(*divergence, played),
        (Ok(()), Some(error), _) => {
            let reason = match error {
                VerifyError::Stopped { tick } => {
                    format!("more than {} s of CPU time at tick {tick}", allowed.as_secs())
                }
                error => error.to_string(),
            };
            Verdict::over_limits(error.code(), reason, played)
        }
        (Ok(()), None, flaw) => {
            let played = Played { end_hash: Some(world.state_hash()), ..played };
            flaw.map_or_else(|| Verdict::ok(played), |flaw| Verdict::flawed(flaw, played))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::verdict::Status;

    #[test]
    fn a_panic_is_a_verdict() {
        let terms = Terms::new(Limits::default(), None).expect("no start");
        let verdict = verdict(|| panic!("a defect, which this test makes"), &terms, &ProgressBar::hidden());
        assert_eq!((verdict.status, verdict.status.exit()), (Status::Failed, 2));
    }
}
