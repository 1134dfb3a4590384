//! The kit of oracles: scripts, games that break what each oracle knows, and the example.

#[path = "../support/commands.rs"]
mod commands;
#[path = "../support/example.rs"]
mod example;
#[path = "../support/random.rs"]
mod random;
mod scripts;
mod tow;
mod twins;
