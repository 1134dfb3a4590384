//! The peers. A further engine: add its file here and one line in `all`.

mod box2d;
mod rapier_f32;
// The file that both share casts for f32.
#[allow(clippy::unnecessary_cast)]
mod rapier_f64;
pub mod umbra;

use crate::engine::Engine;

pub fn all() -> Vec<Box<dyn Engine>> {
    vec![
        Box::new(umbra::Build::<umbra_physics::Fx>::new()),
        Box::new(umbra::Build::<f64>::new()),
        Box::new(umbra::Build::<f32>::new()),
        Box::new(rapier_f32::Rapier),
        Box::new(rapier_f64::Rapier),
        Box::new(box2d::Box2d::new()),
    ]
}

/// An engine with options, by its id.
pub fn with_options(id: &str) -> Option<Box<dyn Engine>> {
    if let Some(build) = umbra::Build::with_options(id) {
        return Some(Box::new(build));
    }
    Some(Box::new(box2d::Box2d::with_options(id)?))
}
