//! The tests that count what is taken from the heap, by an allocator of their own.
#![allow(clippy::duplicate_mod, reason = "each file takes in what it needs of `support` by itself")]

#[path = "support/seeds.rs"]
mod seeds;

mod memory;
mod soak;
mod untrusted;
