//! The kit of oracles: scripts, games that break what each oracle knows, and the example.

#[path = "../../../../tests/support/commands.rs"]
mod commands;
mod energy;
#[path = "../../../../tests/support/example.rs"]
mod example;
#[path = "../../../../tests/support/random.rs"]
mod random;
mod scripts;
mod tow;
mod twins;
