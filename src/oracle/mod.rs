//! What judges runs, as a kit: for a world and the commands carried out on it.

mod handles;
mod script;

pub use handles::Handles;
pub use script::Script;
