//! `umbra verify --stream`: a job a line in, an answer a line out.
//!
//! Threads take turns at the standard input: whoever has read a line does that job and answers it before the next one, so that no line
//! waits in memory, and a long job holds up nobody else. A thread that waits for input has not begun anything: the process may end.

use std::io::{self, BufRead, Read, Stdin};
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use indicatif::ProgressBar;
use serde::Deserialize;
use serde_json::value::RawValue;

use super::check::{self, Terms};
use super::limits::{Changes, Limits};
use super::verdict::Verdict;
use crate::failure::Failure;
use crate::text;

/// A line may have this many bytes beside those of its replay.
const LINE: u64 = 64 << 10;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Job {
    id: Box<RawValue>,
    file: Option<PathBuf>,
    bytes: Option<String>,
    #[serde(default)]
    limits: Changes,
}

/// The name of a line that is no job.
#[derive(Deserialize)]
struct Named<'a> {
    #[serde(borrow)]
    id: Option<&'a RawValue>,
}

/// The state that the threads share.
struct Service {
    terms: Terms,
    input: Mutex<Input>,
    state: Mutex<State>,
    changed: Condvar,
}

struct Input {
    stream: Stdin,
    /// The number of lines read.
    lines: u64,
    is_over: bool,
}

#[derive(Default)]
struct State {
    /// The number of threads.
    threads: usize,
    /// The number of jobs that have begun and are not answered.
    begun: usize,
    /// No further job is to begin.
    is_ending: bool,
    failure: Option<Failure>,
}

/// A line of the input.
enum Line {
    Whole(Vec<u8>),
    /// One with more bytes than a job may have: they were passed over.
    TooLong,
}

/// Answers jobs until the input ends, the process is told to end, or nobody takes the answers.
pub(super) fn serve(terms: Terms, jobs: usize) -> Result<(), Failure> {
    let input = Mutex::new(Input { stream: io::stdin(), lines: 0, is_over: false });
    let state = Mutex::new(State { threads: jobs, ..State::default() });
    let service = Arc::new(Service { terms, input, state, changed: Condvar::new() });
    service.heed_signals()?;
    for _ in 0..jobs {
        let service = Arc::clone(&service);
        thread::spawn(move || {
            service.work();
            locked(&service.state).threads -= 1;
            service.changed.notify_all();
        });
    }
    let goes_on = |state: &mut State| state.begun > 0 || (state.threads > 0 && !state.is_ending);
    let mut state = service.changed.wait_while(locked(&service.state), goes_on).unwrap_or_else(PoisonError::into_inner);
    state.failure.take().map_or(Ok(()), Err)
}

/// Jobs catch their own panics, and nothing else is done under a lock that could leave it half done.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Service {
    /// Ends the service on SIGTERM.
    #[cfg(unix)]
    fn heed_signals(self: &Arc<Self>) -> Result<(), Failure> {
        use signal_hook::consts::SIGTERM;
        use signal_hook::iterator::Signals;
        let mut signals = Signals::new([SIGTERM])
            .map_err(|error| Failure::Usage { what: format!("signals cannot be heeded: {error}") })?;
        let service = Arc::clone(self);
        thread::spawn(move || signals.forever().for_each(|_| service.end(None)));
        Ok(())
    }

    /// There is no such signal.
    #[cfg(not(unix))]
    fn heed_signals(self: &Arc<Self>) -> Result<(), Failure> {
        Ok(())
    }

    /// Lets no further job begin.
    fn end(&self, failure: Option<Failure>) {
        let mut state = locked(&self.state);
        state.is_ending = true;
        if state.failure.is_none() {
            state.failure = failure;
        }
        self.changed.notify_all();
    }

    /// Does jobs as long as there are any.
    fn work(&self) {
        while let Some((number, line)) = self.next() {
            let answer = match line {
                Line::Whole(line) => self.answer(number, line),
                Line::TooLong => Some(Verdict::too_large(self.terms.limits.bytes()).answer(None, number)),
            };
            if let Err(failure) = answer.map_or(Ok(()), |answer| text::answer(&answer)) {
                self.end(Some(failure));
            }
            locked(&self.state).begun -= 1;
            self.changed.notify_all();
        }
    }

    /// The next line, which has begun with that, and its number.
    fn next(&self) -> Option<(u64, Line)> {
        let mut input = locked(&self.input);
        let line = input.next(longest(&self.terms.limits)).unwrap_or_else(|error| {
            self.end(Some(Failure::file("-".as_ref(), "read")(error)));
            None
        })?;
        let mut state = locked(&self.state);
        state.begun += usize::from(!state.is_ending);
        (!state.is_ending).then_some((input.lines, line))
    }

    /// Does the job of a line; `None` for an empty one, which is no job.
    fn answer(&self, number: u64, line: Vec<u8>) -> Option<String> {
        // A list would be taken as well, by the order of the fields.
        match line.trim_ascii_start().first() {
            None => return None,
            Some(b'{') => {}
            Some(_) => {
                return Some(Verdict::bad_job("no job: expected a JSON object".to_owned()).answer(None, number));
            }
        }
        let Job { id, file, bytes, limits } = match serde_json::from_slice(&line) {
            Ok(job) => job,
            Err(error) => {
                let id = serde_json::from_slice(&line).ok().and_then(|Named { id }| id);
                return Some(Verdict::bad_job(no_job(&error)).answer(id, number));
            }
        };
        drop(line);
        let limits = match self.terms.limits.lowered(&limits) {
            Ok(limits) => limits,
            Err(reason) => return Some(Verdict::bad_job(reason).answer(Some(&id), number)),
        };
        let terms = Terms { limits, ..self.terms.clone() };
        let verdict = match (file, bytes) {
            (Some(file), None) => {
                check::verdict(|| check::read_regular(&file, &limits), &terms, &ProgressBar::hidden())
            }
            (None, Some(text)) => check::verdict(|| decoded(text, &limits), &terms, &ProgressBar::hidden()),
            _ => Verdict::bad_job("no job: expected one of `file` and `bytes`".to_owned()),
        };
        Some(verdict.answer(Some(&id), number))
    }
}

/// The most bytes of a line.
fn longest(limits: &Limits) -> u64 {
    limits.bytes().div_ceil(3).saturating_mul(4).saturating_add(LINE)
}

/// Says why a line is no job, and where in it.
fn no_job(error: &serde_json::Error) -> String {
    format!("no job: {error}").replace(" at line 1 column ", " at column ")
}

/// The bytes of a replay that stand in a job.
fn decoded(text: String, limits: &Limits) -> Result<Vec<u8>, Box<Verdict>> {
    let bad = |error| Box::new(Verdict::bad_job(format!("bytes: no base64: {error}")));
    let bytes = STANDARD.decode(&text).map_err(bad)?;
    if bytes.len() as u64 > limits.bytes() { Err(Box::new(Verdict::too_large(limits.bytes()))) } else { Ok(bytes) }
}

impl Input {
    /// The next line; `None` at the end.
    fn next(&mut self, longest: u64) -> io::Result<Option<Line>> {
        if self.is_over {
            return Ok(None);
        }
        let mut stream = self.stream.lock();
        let mut line = Vec::new();
        // The end of the line is a byte as well.
        (&mut stream).take(longest.saturating_add(1)).read_until(b'\n', &mut line)?;
        self.lines += 1;
        if line.is_empty() {
            self.is_over = true;
            return Ok(None);
        }
        if line.last() == Some(&b'\n') || line.len() as u64 <= longest {
            return Ok(Some(Line::Whole(line)));
        }
        drop(line);
        stream.skip_until(b'\n')?;
        Ok(Some(Line::TooLong))
    }
}
