//! The tests of scenes, as one program.
#![allow(clippy::duplicate_mod, reason = "two files of `support` take in a third one")]
#![allow(clippy::module_inception, reason = "a module is named after what it tests")]

#[path = "../../../../tests/support/cases.rs"]
mod cases;
mod contacts;
mod damping;
mod errors;
mod joints;
mod scenes;
mod text;
