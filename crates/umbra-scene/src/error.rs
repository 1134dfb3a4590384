//! Errors in scenes: the reason, the line and the field.

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::cell::{Cell, RefCell};
use core::fmt;
use umbra_physics::{Error, ParseFxError};

/// A place in the text of a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1.
    pub line: usize,
    /// The field, as in `bodies[3].mass`; empty for the text as a whole. What a repetition made says which it was:
    /// `bodies[3](i=7, j=0).mass`.
    pub field: String,
}

/// A reason to refuse a scene: one line of text, and its number in `docs/errors.md`.
pub(super) trait Reason: fmt::Display {
    fn code(&self) -> u16 {
        UNFIT
    }
}

/// The number of reasons that have none of their own.
const UNFIT: u16 = 500;

impl<T: Reason + ?Sized> Reason for &T {
    fn code(&self) -> u16 {
        (**self).code()
    }
}

impl Reason for str {}
impl Reason for String {}
impl Reason for fmt::Arguments<'_> {}

impl Reason for Error {
    fn code(&self) -> u16 {
        Self::code(self)
    }
}

impl Reason for ParseFxError {
    fn code(&self) -> u16 {
        Self::code(self)
    }
}

/// A reason with a number.
pub(super) struct Coded<T>(pub(super) u16, pub(super) T);

/// Errors that a scene can have by itself, before the engine sees it, each with its number. A number never changes.
#[derive(Clone, Copy, Debug)]
#[repr(u16)]
pub(super) enum Flaw {
    NotJson = 501,
    WrongKind = 502,
    Unknown = 503,
    Doubled = 504,
    Missing = 505,
    Taken = 506,
    NoSuchName = 507,
    OutOfRange = 508,
    Text = 509,
    TooMany = 510,
}

impl Flaw {
    /// The error with a message.
    pub(super) const fn of<T>(self, words: T) -> Coded<T> {
        Coded(self as u16, words)
    }
}

impl<T: fmt::Display> fmt::Display for Coded<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.1.fmt(f)
    }
}

impl<T: fmt::Display> Reason for Coded<T> {
    fn code(&self) -> u16 {
        self.0
    }
}

impl Place {
    pub(super) fn fault(&self, reason: impl Reason) -> SceneError {
        SceneError { place: self.clone(), message: reason.to_string(), code: reason.code() }
    }
}

/// An error in a scene: the text is no scene, or the world refuses one of its inputs.
///
/// ```
/// use umbra_scene::{Place, Scene, SceneError};
///
/// let errors = Scene::parse("{\n \"bodies\": [{\"name\": \"a\", \"mass\": -1}]}").unwrap_err();
/// let error: &SceneError = errors.first();
/// assert_eq!((error.place.line, &error.place.field[..], error.code()), (2, "bodies[0].mass", 101));
/// // An error of a program's own, in the same form.
/// let own = SceneError::new(Place { line: 3, field: "plot".into() }, "nothing to draw".into());
/// assert_eq!((own.to_string(), own.code()), ("3: plot: nothing to draw".into(), 500));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SceneError {
    /// The place in the text.
    pub place: Place,
    /// The message, one line.
    pub message: String,
    code: u16,
}

impl SceneError {
    /// An error of the caller's own.
    #[must_use]
    pub const fn new(place: Place, message: String) -> Self {
        Self { place, message, code: UNFIT }
    }

    /// The number by which `docs/errors.md` lists it, the same in every version: one of a scene's own, or that of the
    /// [`Error`] with which the engine refuses what the scene asks for.
    #[must_use]
    pub const fn code(&self) -> u16 {
        self.code
    }
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

/// All errors in the text of a scene, in the order of its lines; the first [`LISTED`](Self::LISTED) that were found are listed.
///
/// An error that follows from another one is left out where that is known: a field that is missing because its name has a typing
/// error, or the name of a body that could not be read. Inputs are tried on a world once all of the text reads well.
///
/// ```
/// use umbra_scene::{Scene, SceneErrors};
///
/// let errors: SceneErrors = Scene::parse(
///     r#"{"gravity": -10,
/// "bodies": [{"name": "ball", "colliders": [{"shape": {"circle": {"raduis": 0.5}}}], "mass": 0}]}"#,
/// )
/// .unwrap_err();
/// let texts: Vec<String> = errors.errors().iter().map(ToString::to_string).collect();
/// assert_eq!(texts[0], "1: gravity: expected [x, y] or {\"x\": …, \"y\": …}, found a number");
/// assert_eq!(texts[1], "2: bodies[0].colliders[0].shape.circle.raduis: unknown field: did you mean `radius`?");
/// assert_eq!((errors.errors().len(), errors.more(), errors.code()), (2, 0, 502));
/// assert_eq!(SceneErrors::LISTED, 20);
/// assert_eq!(errors.to_string(), texts.join("\n"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneErrors {
    /// At least one.
    errors: Vec<SceneError>,
    more: u64,
}

impl SceneErrors {
    /// The most errors that are listed: 20.
    pub const LISTED: usize = 20;

    /// The listed errors, at least one.
    #[must_use]
    pub fn errors(&self) -> &[SceneError] {
        &self.errors
    }

    /// The first error.
    #[must_use]
    pub fn first(&self) -> &SceneError {
        &self.errors[0]
    }

    /// The number of errors that are not listed.
    #[must_use]
    pub const fn more(&self) -> u64 {
        self.more
    }

    /// The number of the first error, as [`SceneError::code`].
    #[must_use]
    pub fn code(&self) -> u16 {
        self.first().code()
    }
}

impl From<SceneError> for SceneErrors {
    fn from(error: SceneError) -> Self {
        Self { errors: alloc::vec![error], more: 0 }
    }
}

impl fmt::Display for SceneErrors {
    /// A line for each error, and `and 7 more` if not all are listed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.errors.iter().enumerate() {
            write!(f, "{}{error}", if index == 0 { "" } else { "\n" })?;
        }
        if self.more == 0 { Ok(()) } else { write!(f, "\nand {} more", self.more) }
    }
}

impl core::error::Error for SceneErrors {}

/// The mark of a value that was refused; the error is among those [`Found`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Refused {
    /// True if the reader skips the rest of the list that the value is in.
    pub(super) ends_list: bool,
}

impl Refused {
    /// Leaves the rest of the list unread.
    pub(super) const fn ending_list(self) -> Self {
        Self { ends_list: true }
    }
}

/// The errors of a text that were found so far. Those beyond the most that are listed are counted, and take no memory.
#[derive(Default)]
pub(super) struct Found {
    errors: RefCell<Vec<SceneError>>,
    count: Cell<u64>,
}

impl Found {
    /// Adds an error, which is made only if it is to be listed.
    pub(super) fn add(&self, error: impl FnOnce() -> SceneError) -> Refused {
        self.count.set(self.count.get() + 1);
        if self.errors.borrow().len() < SceneErrors::LISTED {
            let error = error();
            self.errors.borrow_mut().push(error);
        }
        Refused::default()
    }

    /// The number of errors so far.
    pub(super) fn count(&self) -> u64 {
        self.count.get()
    }

    /// All errors by line, or nothing if there are none.
    pub(super) fn finish(self) -> Result<(), SceneErrors> {
        let mut errors = self.errors.into_inner();
        if errors.is_empty() {
            return Ok(());
        }
        errors.sort_by_key(|error| error.place.line);
        let more = self.count.get() - errors.len() as u64;
        Err(SceneErrors { errors, more })
    }
}

/// The reason why some commands cannot be written as a scene.
///
/// ```
/// use umbra_scene::{Scene, ExportError};
/// use umbra_physics::{Error, TimeStep, WorldDef};
///
/// let def = WorldDef { time_step: TimeStep::hz(0), ..WorldDef::default() };
/// assert_eq!(Scene::from_commands(def, &[], 1), Err(ExportError::World(Error::TimeStep)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ExportError {
    /// The definition of the world is invalid.
    World(Error),
    /// A command adds a custom force, which no scene file can hold.
    CustomForce {
        /// The index of the command.
        command: usize,
        /// The id of the custom force.
        id: u64,
    },
    /// A command has an attractor so weak that no text is read as it: mu above 0 and below 10^-60 m³/s².
    Mu {
        /// The index of the command.
        command: usize,
    },
    /// The world carries out more commands than a scene has inputs ([`Scene::MOST`](super::Scene::MOST)), and as many bodies,
    /// force fields and joints at the start.
    Many {
        /// The index of the first that is one too many.
        command: usize,
    },
}

impl fmt::Display for ExportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::World(error) => write!(f, "the world: {error}"),
            Self::CustomForce { command, id } => {
                write!(f, "command {command}: a scene cannot hold a custom force (here the one with the id {id})")
            }
            Self::Mu { command } => write!(
                f,
                "command {command}: a scene cannot hold a mu above 0 and below 10^-60 m³/s²: use 0 or a larger one"
            ),
            Self::Many { command } => {
                write!(f, "command {command}: a scene holds at most 131072 bodies, force fields, joints and inputs")
            }
        }
    }
}

impl ExportError {
    /// The number by which `docs/errors.md` lists it. It is the same in every version, and no other error has it.
    #[must_use]
    pub const fn code(&self) -> u16 {
        match self {
            Self::World(_) => 521,
            Self::CustomForce { .. } => 522,
            Self::Mu { .. } => 523,
            Self::Many { .. } => 524,
        }
    }
}

impl core::error::Error for ExportError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::World(error) => Some(error),
            _ => None,
        }
    }
}
