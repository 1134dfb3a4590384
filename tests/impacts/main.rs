//! Contacts as physics has them: each subject has its cases, with the values that they should have, and a search of its own against
//! closed forms, energy, momentum or mirror images.
//!
//! `UMBRA_TIMES=10 cargo test --release --all-features --test impacts` makes the searches ten times as long; `-- --ignored` runs the
//! long forms.

mod bounces;
mod continuous;
mod events;
mod flights;
mod flush;
mod gases;
mod ghosts;
mod line;
mod overlaps;
mod rest;
mod rolling;
mod rows;
mod scenes;
mod thin;
