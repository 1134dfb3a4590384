//! Bodies that collide: symmetric scenes, order of insertion, closed forms.

mod chains;
mod compounds;
mod extremes;
mod fair;
#[cfg(feature = "float")]
mod floats;
mod forms;
mod games;
mod materials;
mod momentum;
mod scenes;
mod sleep;
mod state;
