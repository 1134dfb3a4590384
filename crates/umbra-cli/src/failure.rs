//! Errors that end a task: one line of text, and an exit status.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use umbra_physics::ReplayError;
use umbra_scene::SceneErrors;

use crate::text;

/// The number of a file that cannot be read or written.
pub(crate) const UNREADABLE: u16 = 801;

/// A number as messages have it.
pub(crate) fn tag(code: u16) -> String {
    format!("E{code}")
}

#[derive(Debug)]
pub(crate) enum Failure {
    /// A scene is wrong, or goes wrong on the way.
    Scene { file: PathBuf, errors: SceneErrors },
    /// A file is no replay that can be played.
    Replay { file: PathBuf, error: ReplayError },
    /// A file cannot be read or written.
    File { file: PathBuf, doing: &'static str, error: io::Error },
    /// An option does not go with the scene.
    Option { what: String },
    /// The picture cannot be drawn.
    Picture { file: PathBuf, what: String },
    /// `bad` files of `of` are not as recorded.
    Verify { bad: usize, of: usize, status: u8 },
    /// Two recordings are not the same.
    Differ { files: [PathBuf; 2] },
    /// A file is nothing that can be compared.
    Foreign { file: PathBuf, is_scene: bool },
    /// An output would go over an input or another output, which `with` says.
    Clash { file: PathBuf, with: &'static str },
    /// The arguments are wrong.
    Usage { what: String },
    /// This machine does not give the golden digests.
    Selftest,
    /// Promises about contacts that are broken, of so many; each as a line of text.
    Quality { broken: Vec<String>, promised: usize },
}

impl Failure {
    pub(crate) fn scene<E: Into<SceneErrors>>(file: &Path) -> impl Fn(E) -> Self + '_ {
        |errors| Self::Scene { file: file.into(), errors: errors.into() }
    }

    pub(crate) fn file<'a>(file: &'a Path, doing: &'static str) -> impl Fn(io::Error) -> Self + 'a {
        move |error| Self::File { file: file.into(), doing, error }
    }

    /// The number by which `docs/errors.md` has it; none for what is no error but a result, and for a scene, where each error has
    /// its own.
    pub(crate) const fn code(&self) -> Option<u16> {
        Some(match self {
            Self::Replay { error, .. } => error.code(),
            Self::File { .. } => UNREADABLE,
            Self::Option { .. } => 802,
            Self::Picture { .. } => 803,
            Self::Foreign { .. } => 804,
            Self::Clash { .. } => 805,
            Self::Scene { .. }
            | Self::Usage { .. }
            | Self::Verify { .. }
            | Self::Differ { .. }
            | Self::Selftest
            | Self::Quality { .. } => return None,
        })
    }

    /// 1 for a check that failed, 2 for bad usage, bad input, and what cannot be written.
    pub(crate) const fn status(&self) -> u8 {
        match self {
            Self::Selftest | Self::Differ { .. } | Self::Quality { .. } => 1,
            Self::Verify { status, .. } => *status,
            Self::Scene { .. }
            | Self::Replay { .. }
            | Self::File { .. }
            | Self::Option { .. }
            | Self::Foreign { .. }
            | Self::Clash { .. }
            | Self::Usage { .. }
            | Self::Picture { .. } => 2,
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
            Self::Replay { file, error } => write!(f, "{}: {error}", text::path(file)),
            Self::File { file, doing, error } => write!(f, "{}: cannot {doing}: {error}", text::path(file)),
            Self::Option { what } | Self::Usage { what } => f.write_str(what),
            Self::Verify { bad, of, .. } => write!(f, "{bad} of {of} files are not as recorded"),
            Self::Differ { files: [a, b] } => write!(f, "{} and {} are not the same", text::path(a), text::path(b)),
            Self::Foreign { file, is_scene } => {
                let file = text::path(file);
                write!(f, "{file}: expected a replay or a desync dump of umbra-physics")?;
                if *is_scene {
                    write!(
                        f,
                        ", found a scene: record it with `umbra run {file} --record FILE` and compare the replays"
                    )?;
                }
                Ok(())
            }
            Self::Clash { file, with } => {
                write!(f, "{}: cannot write: this is {with}; choose another path", text::path(file))
            }
            Self::Selftest => {
                f.write_str("the self-test does not give the golden digests, which every machine must give")
            }
            Self::Quality { broken, promised } => {
                write!(f, "{} of {promised} promises are not kept:\n{}", broken.len(), broken.join("\n"))
            }
            Self::Picture { file, what } => write!(f, "{}: cannot draw: {what}", text::path(file)),
        }
    }
}
