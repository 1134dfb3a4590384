//! The tests of scenes, as one program.
#![allow(clippy::module_inception, reason = "a module is named after what it tests")]

mod contacts;
mod damping;
mod errors;
mod scenes;
mod text;
