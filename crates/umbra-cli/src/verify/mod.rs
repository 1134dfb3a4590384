//! `umbra verify`: replays run again, many at once; a list of files, or a service that takes jobs.

mod check;
mod limits;
mod stream;
mod verdict;

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use clap::Args;
use indicatif::ProgressBar;

use crate::failure::Failure;
use crate::load;
use crate::output::Destinations;
use crate::progress::progress;
use crate::text;
use check::Terms;
use limits::{Limits, Setting};
use verdict::{Status, Verdict};

const STATUSES: &str = "\
A line for each file, in the order given: what it is, its name, and why.
  ok               every hash is the one recorded
  tampered         the file was changed after it was recorded
  diverged         the run differs from the recorded one
  cut_off          the file ends before the recording did; as far as it goes it is ok
  over_limits      it asks for more than a limit allows
  other_start      it does not begin with the world of --start
  too_large        it has more bytes than the limit, and was not read
  physics_version  it was recorded under another physics version
  malformed        no replay that this program can play
  unreadable       no file that can be read
  failed           a defect of this program

What is not ok has the number of its error at the end, as [E405]: docs/errors.md has them all.

Limits hold for each file, also for the search of the value in which a run diverges. The CPU time is looked at before each
command and each step: a file takes at most one of them more. A limit of --limit goes before one of the file of --limits.";

const SERVICE: &str = "\
With --stream each line of the standard input is a job, and each job gets one line in answer as soon as it is done. A job has
an `id`, any JSON value, which the answer repeats; a `file` to read, a regular one, or its `bytes` in base64; and maybe `limits`,
which can only lower those of the service:
  {\"id\": \"m-81\", \"file\": \"season/81.umbrarep\"}
  {\"id\": \"m-82\", \"bytes\": \"<base64>\", \"limits\": {\"ticks\": 216000}}
  {\"id\":\"m-81\",\"line\":1,\"status\":\"ok\",\"ticks\":3600,\"hashes\":3600,…,\"end_hash\":\"0da54c7d3cce521d\",…}
An answer has the keys of --json, with `id` and `line`, the number of the line from 1, in place of `file`. A line that is no job
is answered by the status bad_job, with the `id` if there is one. Empty lines are no jobs. No more lines are read than jobs run
at once. At the end of the input, and on SIGTERM, what has begun is finished and answered.

Exit status: 0 if all are ok; 1 for tampered, diverged, cut_off, over_limits, other_start, too_large; 2 for physics_version,
malformed, unreadable, failed, and for bad usage. Of several files the highest counts. With --stream: 0 if every job was
answered, whatever the answers are, else 2.";

fn help() -> String {
    format!("{STATUSES}\n{}\n{SERVICE}", limits::help())
}

#[derive(Args)]
#[command(after_help = help())]
pub(crate) struct Options {
    /// The replays; - is the standard input.
    #[arg(required_unless_present = "stream", conflicts_with = "stream", value_name = "REPLAY")]
    replays: Vec<PathBuf>,
    /// Takes jobs from the standard input, a JSON object a line, and answers each as it is done.
    #[arg(long)]
    stream: bool,
    /// Prints a JSON object a line, one for each file.
    #[arg(long, conflicts_with = "stream")]
    json: bool,
    /// Prints all digits of the values, which JSON always has.
    #[arg(long, conflicts_with = "stream")]
    exact: bool,
    /// Number of files to verify at once [default: the number of processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Sets a limit; several are parted by commas.
    #[arg(long, value_name = "NAME=N", value_delimiter = ',', value_parser = Setting::parse)]
    limit: Vec<Setting>,
    /// Limits from a JSON object with their names as keys.
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Refuses replays that begin with another world than this scene, this other replay or this snapshot.
    #[arg(long, value_name = "FILE")]
    start: Option<PathBuf>,
}

pub(crate) fn verify(options: &Options) -> Result<(), Failure> {
    let files = &options.replays;
    // The standard output goes over none of them.
    Destinations::beside(files.iter().chain(&options.limits).chain(&options.start))?;
    let jobs = options.jobs.map(usize::from).or_else(|| thread::available_parallelism().ok().map(usize::from));
    let jobs = jobs.unwrap_or(1);
    if options.stream && [&options.limits, &options.start].into_iter().flatten().any(|file| load::is_dash(file)) {
        return Err(Failure::Usage { what: "--stream takes its jobs from the standard input: give a file".to_owned() });
    }
    let limits = Limits::new(options.limits.as_deref(), &options.limit)?;
    let terms = Terms::new(limits, options.start.as_deref())?;
    if options.stream {
        return stream::serve(terms, jobs);
    }
    let bar = progress(0, "tick");
    let (mut bad, mut status) = (0, 0);
    in_order(
        files,
        jobs,
        |file| verdict_on(file, &terms, &bar),
        |file, verdict| {
            let line = if options.json { verdict.json(file) } else { verdict.line(file, options.exact) };
            bad += usize::from(verdict.status != Status::Ok);
            status = status.max(verdict.status.exit());
            bar.suspend(|| text::print(line))
        },
    )?;
    bar.finish_and_clear();
    if status == 0 { Ok(()) } else { Err(Failure::Verify { bad, files: files.len(), status }) }
}

fn verdict_on(file: &Path, terms: &Terms, bar: &ProgressBar) -> Verdict {
    let read = || {
        if load::is_dash(file) {
            return check::read(io::stdin(), &terms.limits);
        }
        let opened = File::open(file).map_err(|error| Box::new(Verdict::unreadable(&error)))?;
        check::read(opened, &terms.limits)
    };
    check::verdict(read, terms, bar)
}

/// Does a job for each file, so many at once, and hands on what comes of it in the order of the files, as long as it is
/// taken.
fn in_order<T: Send>(
    files: &[PathBuf],
    jobs: usize,
    job: impl Fn(&Path) -> T + Sync,
    mut done: impl FnMut(&Path, T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..jobs.min(files.len()) {
            let (sender, next, job) = (sender.clone(), &next, &job);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(file) = files.get(index) else { break };
                    if sender.send((index, job(file))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let (mut early, mut due) = (BTreeMap::new(), files.iter().enumerate());
        let mut awaited = due.next();
        for (index, result) in receiver {
            early.insert(index, result);
            while let Some((result, file)) = awaited.and_then(|(index, file)| Some((early.remove(&index)?, file))) {
                done(file, result)?;
                awaited = due.next();
            }
        }
        Ok(())
    })
}
