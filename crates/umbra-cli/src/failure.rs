//! Errors that end a task: one line of text, and an exit status.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use umbra_physics::{ReplayError, SnapshotError};
use umbra_scene::SceneErrors;

use crate::load::Kind;
use crate::text;

/// The number of a file that cannot be read or written.
pub(crate) const UNREADABLE: u16 = 801;
/// And of one to verify that has more bytes than the limit.
pub(crate) const TOO_LARGE: u16 = 806;
/// And of a replay that begins with another world.
pub(crate) const OTHER_START: u16 = 807;
/// And of a line that is no job.
pub(crate) const BAD_JOB: u16 = 808;

/// A number as messages have it.
pub(crate) fn tag(code: u16) -> String {
    format!("E{code}")
}

#[derive(Debug)]
pub enum Failure {
    /// A scene is wrong, or goes wrong on the way.
    Scene { file: PathBuf, errors: SceneErrors },
    /// A file is no replay that can be played.
    Replay { file: PathBuf, error: ReplayError },
    /// A file is no snapshot that can be read.
    Snapshot { file: PathBuf, error: SnapshotError },
    /// A file cannot be read or written.
    File { file: PathBuf, doing: &'static str, error: io::Error },
    /// An option does not go with the scene.
    Option { what: String },
    /// `bad` files of `files` are not as recorded.
    Verify { bad: usize, files: usize, status: u8 },
    /// A file is of another kind than a command takes.
    Foreign { file: PathBuf, expected: &'static str, kind: Option<Kind> },
    /// An output would go over an input or another output, which `with` says.
    Clash { file: PathBuf, with: &'static str },
    /// The name of an output ends as those of another format do.
    Format { file: PathBuf, objection: String },
    /// The arguments are wrong.
    Usage { what: String },
    /// A check failed.
    Check { what: String },
}

impl Failure {
    pub fn scene<E: Into<SceneErrors>>(file: &Path) -> impl Fn(E) -> Self + '_ {
        |errors| Self::Scene { file: file.into(), errors: errors.into() }
    }

    pub fn file<'a>(file: &'a Path, doing: &'static str) -> impl Fn(io::Error) -> Self + 'a {
        move |error| Self::File { file: file.into(), doing, error }
    }

    /// The number by which `docs/errors.md` has it; none for what is no error but a result, and for a scene, where each error has
    /// its own.
    pub(crate) const fn code(&self) -> Option<u16> {
        Some(match self {
            Self::Replay { error, .. } => error.code(),
            Self::Snapshot { error, .. } => error.code(),
            Self::File { .. } => UNREADABLE,
            Self::Option { .. } => 802,
            Self::Foreign { .. } => 804,
            Self::Clash { .. } => 805,
            Self::Format { .. } => 809,
            Self::Scene { .. } | Self::Usage { .. } | Self::Verify { .. } | Self::Check { .. } => return None,
        })
    }

    /// 1 for a check that failed, 2 for bad usage, bad input, and what cannot be written.
    const fn status(&self) -> u8 {
        match self {
            Self::Check { .. } => 1,
            Self::Verify { status, .. } => *status,
            Self::Scene { .. }
            | Self::Replay { .. }
            | Self::Snapshot { .. }
            | Self::File { .. }
            | Self::Option { .. }
            | Self::Foreign { .. }
            | Self::Clash { .. }
            | Self::Format { .. }
            | Self::Usage { .. } => 2,
        }
    }
}

/// The exit status of a task. The error of a task that failed is printed.
pub fn exit_code(result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            text::warn(&failure);
            ExitCode::from(failure.status())
        }
    }
}

impl fmt::Display for Failure {
    /// The number last: a line begins with file and line, for editors to go there.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.describe(f)?;
        self.code().map_or(Ok(()), |code| write!(f, " [{}]", tag(code)))
    }
}

impl Failure {
    fn describe(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene { file, errors } => {
                let lines = errors.errors().iter();
                let mut lines: Vec<String> =
                    lines.map(|error| format!("{}:{error} [{}]", text::path(file), tag(error.code()))).collect();
                if errors.more() > 0 {
                    lines.push(format!("{}: and {} more", text::path(file), errors.more()));
                }
                f.write_str(&lines.join("\n"))
            }
            // Where more is whole it is read.
            Self::Replay { file, error: ReplayError::CutOff { .. } } => {
                write!(f, "{}: cut off: too little of it is whole to be read", text::path(file))
            }
            Self::Replay { file, error } => write!(f, "{}: {error}", text::path(file)),
            Self::Snapshot { file, error } => write!(f, "{}: {error}", text::path(file)),
            Self::File { file, doing, error } => write!(f, "{}: cannot {doing}: {error}", text::path(file)),
            Self::Option { what } | Self::Usage { what } | Self::Check { what } => f.write_str(what),
            Self::Verify { bad, files, .. } => {
                let (noun, verb) = (["file", "files"][usize::from(*files != 1)], ["is", "are"][usize::from(*bad != 1)]);
                write!(f, "{bad} of {files} {noun} {verb} not verified")
            }
            Self::Foreign { file, expected, kind } => {
                write!(f, "{}: expected {expected}", text::path(file))?;
                kind.map_or(Ok(()), |kind| write!(f, ", found {}", kind.advice(&text::argument(file))))
            }
            Self::Format { file, objection } => write!(f, "{}: cannot write: {objection}", text::path(file)),
            Self::Clash { file, with } => {
                write!(f, "{}: cannot write: this is {with}; choose another path", text::path(file))
            }
        }
    }
}
