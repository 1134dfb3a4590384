//! What is wrong with a scene, and where.

use alloc::string::{String, ToString};
use core::fmt;

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
