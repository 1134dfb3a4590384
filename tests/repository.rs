//! The tests of the repository: its sources, documents, examples, files of older versions, and messages of the compiler.

mod diagnostics;
mod examples;
mod formats;
mod layers;
mod shown;
