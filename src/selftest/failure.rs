//! Why a scene failed.

use core::fmt;

use crate::error::{Error, codes};

/// A scene that failed, where, and why.
///
/// ```
/// use umbra_physics::selftest::{Failure, Problem, Scene, scenes};
///
/// let some: &[Scene] = &scenes()[..3];
/// for scene in some {
///     match scene.run() {
///         Ok(outcome) => println!("{}: {:016x}, {}", scene.name(), outcome.digest, scene.about()),
///         Err(failure @ Failure { problem: Problem::Differs { .. }, .. }) => panic!("this machine: {failure}"),
///         Err(failure) => panic!("{failure} [E{}]", failure.code()),
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Failure {
    /// Its name.
    pub scene: &'static str,
    /// The number of ticks it made.
    pub tick: u64,
    /// What went wrong.
    pub problem: Problem,
}

/// What went wrong in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Problem {
    /// A call was refused that is in order.
    Refused(Error),
    /// What the scene is for did not happen.
    DidNotHappen {
        /// What should have.
        what: &'static str,
    },
    /// Two things that are to have the same bits have not.
    Differs {
        /// What they are.
        what: &'static str,
    },
    /// A value is farther from what it is to be than the bound.
    Wrong {
        /// What it is.
        what: &'static str,
        /// The value, in units of its last place.
        found: i128,
        /// What it is to be.
        expected: i128,
        /// How far it may be from that.
        bound: u128,
    },
}

impl From<Error> for Problem {
    fn from(error: Error) -> Self {
        Self::Refused(error)
    }
}

codes!(Problem { Refused = 601, DidNotHappen = 602, Differs = 603, Wrong = 604 });

impl core::error::Error for Problem {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Refused(error) => Some(error),
            _ => None,
        }
    }
}

impl Failure {
    /// That of its problem.
    #[must_use]
    pub const fn code(&self) -> u16 {
        self.problem.code()
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(error) => write!(f, "refused: {error}"),
            Self::DidNotHappen { what } => write!(f, "did not happen: {what}"),
            Self::Differs { what } => write!(f, "differs: {what}"),
            Self::Wrong { what, found, expected, bound } => {
                write!(f, "wrong: {what} is {found}, expected {expected} within {bound}")
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} after {} ticks: {}", self.scene, self.tick, self.problem)
    }
}

impl core::error::Error for Failure {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        Some(&self.problem)
    }
}
