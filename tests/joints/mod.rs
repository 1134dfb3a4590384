//! Joints of worlds.

mod scenes;

mod axes;
mod bounces;
mod breaking;
mod calls;
mod complaints;
mod crowds;
mod energy;
mod floats;
mod gears;
mod impacts;
mod motion;
mod motors;
mod pairs;
mod pulleys;
mod ratchets;
mod sleep;
mod sliders;
mod springs;
mod state;
mod stops;
