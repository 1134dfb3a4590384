//! Bodies that collide: symmetric scenes, order of insertion, closed forms.

mod fair;
#[cfg(feature = "float")]
mod floats;
mod forms;
mod games;
mod momentum;
mod scenes;
mod sleep;
mod state;
