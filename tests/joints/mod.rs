//! Joints of worlds.

mod scenes;

mod breaking;
mod calls;
mod motion;
mod pairs;
mod sleep;
mod state;
