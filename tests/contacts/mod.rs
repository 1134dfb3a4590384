//! Bodies that collide: symmetric scenes, order of insertion, closed forms.

mod buoyancy;
mod cases;
mod chains;
mod character;
mod compounds;
mod dominance;
mod events;
mod excluded;
mod explosions;
mod extremes;
mod fair;
#[cfg(feature = "float")]
mod floats;
mod forms;
mod games;
mod ghosts;
mod loads;
mod materials;
mod momentum;
mod one_way;
mod pairs;
mod put_to_sleep;
mod queries;
mod restored;
mod rolling;
mod scenes;
mod seams;
mod sensors;
mod sleep;
mod state;
#[cfg(all(feature = "parallel", feature = "selftest"))]
mod threads;
mod tiles;
mod touches;
