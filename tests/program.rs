//! The tests of the program `umbra`, a file a task, as one program.

mod cli;
mod compare;
mod outputs;
mod replays;
mod report;
mod view;
