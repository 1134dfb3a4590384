//! Untrusted files: whatever is in them, they are refused with a typed error or are what they say, nothing panics, and
//! reading one takes a small multiple of its size.
//!
//! What is named of a file that was changed, and what worlds out of forged files go on to do, the tests beside `replay` look
//! at; `tests/formats.rs` has the files of other formats and laws.

#[allow(dead_code, reason = "shared with other tests")]
#[path = "../support/everything.rs"]
mod everything;

mod forgeries;
mod memory;
mod seals;
