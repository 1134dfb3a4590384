//! Contacts as physics has them: each subject has its cases, with the values that they should have, and a search of its own against
//! closed forms, energy, momentum or mirror images.

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
