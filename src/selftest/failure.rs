//! Reasons why a scene failed.

use core::fmt;

use crate::codes::codes;
use crate::error::Error;

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
    /// Name of the scene.
    pub scene: &'static str,
    /// The number of ticks made before the failure.
    pub tick: u64,
    /// The reason.
    pub problem: Problem,
}

/// Reason why a scene failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Problem {
    /// A valid call was refused.
    Refused(Error),
    /// The event that the scene is meant for did not happen.
    DidNotHappen {
        /// Name of the event.
        what: &'static str,
    },
    /// Two values that must have the same bits differ.
    Differs {
        /// Name of the values.
        what: &'static str,
    },
    /// A value is farther from the expected one than the bound allows.
    Wrong {
        /// Name of the value.
        what: &'static str,
        /// The value, in units of its last place.
        found: i128,
        /// The expected value.
        expected: i128,
        /// The largest allowed difference.
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
    /// The error number of the problem.
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
