//! Processes that play one side of a match, started and read by another process: for the examples and their tests.

use std::ffi::OsStr;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// A process under a time limit. It is ended when this value is dropped.
pub(crate) struct Peer {
    child: Child,
    input: Option<ChildStdin>,
    lines: Receiver<io::Result<String>>,
    said: Vec<String>,
    deadline: Instant,
}

/// End of a process.
pub(crate) struct Ended {
    /// Exit status; `None` if a signal ended the process.
    pub(crate) status: Option<i32>,
    /// The lines it printed.
    pub(crate) said: Vec<String>,
}

impl Peer {
    /// Starts a program.
    ///
    /// # Errors
    /// If it cannot be started.
    pub(crate) fn start(program: &Path, arguments: &[impl AsRef<OsStr>], limit: Duration) -> io::Result<Self> {
        let mut child = Command::new(program).args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let (sender, lines) = channel();
        thread::spawn(move || {
            // The thread ends with the process's output, or when nobody reads any more.
            output.map(|output| BufReader::new(output).lines().try_for_each(|line| sender.send(line)))
        });
        Ok(Self { child, input, lines, said: Vec::new(), deadline: Instant::now() + limit })
    }

    /// The rest of the next line that begins with this word.
    ///
    /// # Errors
    /// `TimedOut`; `UnexpectedEof` if it ends without such a line.
    pub(crate) fn hear(&mut self, word: &str) -> io::Result<String> {
        while let Some(line) = self.line()? {
            let rest = line.strip_prefix(word).map(|rest| rest.trim().to_owned());
            self.said.push(line);
            if let Some(rest) = rest {
                return Ok(rest);
            }
        }
        Err(io::Error::new(io::ErrorKind::UnexpectedEof, format!("the process ended without saying {word:?}")))
    }

    /// Writes a line to its standard input.
    ///
    /// # Errors
    /// If it no longer reads.
    pub(crate) fn tell(&mut self, line: &str) -> io::Result<()> {
        self.input.as_mut().map_or(Ok(()), |input| writeln!(input, "{line}"))
    }

    /// Closes its standard input, and waits for its end.
    ///
    /// # Errors
    /// `TimedOut`, or that its output is not UTF-8.
    pub(crate) fn end(mut self) -> io::Result<Ended> {
        drop(self.input.take());
        while let Some(line) = self.line()? {
            self.said.push(line);
        }
        loop {
            if let Some(status) = self.child.try_wait()? {
                return Ok(Ended { status: status.code(), said: std::mem::take(&mut self.said) });
            }
            if Instant::now() > self.deadline {
                return Err(timed_out());
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    fn line(&mut self) -> io::Result<Option<String>> {
        match self.lines.recv_timeout(self.deadline.saturating_duration_since(Instant::now())) {
            Ok(line) => line.map(Some),
            Err(RecvTimeoutError::Disconnected) => Ok(None),
            Err(RecvTimeoutError::Timeout) => Err(timed_out()),
        }
    }
}

fn timed_out() -> io::Error {
    io::Error::new(io::ErrorKind::TimedOut, "the process takes too long")
}

impl Drop for Peer {
    fn drop(&mut self) {
        // Nothing to do about a failure: either it has ended already, or it ends by its own limit.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
