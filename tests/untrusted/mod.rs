//! Untrusted files: whatever is in them, they are refused with a typed error or are what they say, nothing panics, and
//! reading one takes a small multiple of its size.
//!
//! The tests beside `replay` look at the errors that name a changed value, and at the future of worlds from forged files;
//! `tests/formats.rs` has files of other formats and physics versions.

#[allow(dead_code, reason = "shared with other tests")]
#[path = "../support/everything.rs"]
mod everything;

mod forgeries;
mod hostile;
mod memory;
mod seals;
