//! What is wrong with a scene, and where.

use alloc::string::{String, ToString};
use core::fmt;

use crate::error::Error;

/// Where something stands in a scene's text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1.
    pub line: usize,
    /// The field, as in `bodies[3].mass`; empty for the text as a whole. What a repetition made says which it was:
    /// `bodies[3](i=7, j=0).mass`.
    pub field: String,
}

impl Place {
    pub(super) fn fault(&self, message: impl fmt::Display) -> SceneError {
        SceneError { place: self.clone(), message: message.to_string() }
    }
}

/// Why a text is not a scene, or a scene cannot go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// Where in the text.
    pub place: Place,
    /// One line for a person.
    pub message: String,
}

impl fmt::Display for SceneError {
    /// `line: field: message`, in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.place.line)?;
        if !self.place.field.is_empty() {
            write!(f, "{}: ", self.place.field)?;
        }
        f.write_str(&self.message)
    }
}

impl core::error::Error for SceneError {}

/// Why there is no scene of some commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Unsayable {
    /// No world can be made from the definition.
    World(Error),
    /// A command has a force field with a law of the user's own, which the world of a scene does not have.
    Law {
        /// The index of the command.
        command: usize,
        /// The law's id.
        id: u64,
    },
    /// A command has an attractor so weak that no text is read as it: mu above 0 and below 10^-60 m³/s².
    Mu {
        /// The index of the command.
        command: usize,
    },
    /// The world carries out more commands than a scene has inputs: 2^20, and as many bodies and force fields at the start.
    Many {
        /// The index of the first that is one too many.
        command: usize,
    },
}

impl fmt::Display for Unsayable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::World(error) => write!(f, "the world: {error}"),
            Self::Law { command, id } => {
                write!(f, "command {command}: the world of a scene has no law of force with the id {id}")
            }
            Self::Mu { command } => write!(f, "command {command}: a scene has no mu above 0 and below 10^-60 m³/s²"),
            Self::Many { command } => write!(f, "command {command} is more than a scene can hold"),
        }
    }
}

impl core::error::Error for Unsayable {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::World(error) => Some(error),
            _ => None,
        }
    }
}
