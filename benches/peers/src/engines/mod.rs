//! The peers. A further engine: add its file here and one line in `all`.

mod box2d;
mod contacts;
mod rapier_f32;
// The file that both share casts for f32.
#[allow(clippy::unnecessary_cast)]
mod rapier_f64;
mod umbra;

use crate::engine::Engine;

pub fn all() -> Vec<Box<dyn Engine>> {
    vec![
        Box::new(umbra::Build::<umbra_physics::Fx>::new()),
        Box::new(contacts::Contacts::new()),
        Box::new(umbra::Build::<f64>::new()),
        Box::new(umbra::Build::<f32>::new()),
        Box::new(rapier_f32::Rapier),
        Box::new(rapier_f64::Rapier),
        Box::new(box2d::Box2d),
    ]
}

/// An engine with options, by its id.
pub fn with_options(id: &str) -> Option<Box<dyn Engine>> {
    if let Some(engine) = umbra::Build::with_options(id) {
        return Some(Box::new(engine));
    }
    Some(Box::new(contacts::Contacts::with_options(id)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    /// Scenes in which moments of inertia come out alike to the last bit, from shapes and from colliders.
    #[test]
    fn the_world_has_the_bits_of_its_parts_joined_by_hand() {
        let scenes = [
            scene::tower(10, 100.0),
            scene::tower(5, 1000.0),
            scene::flat_drop(),
            scene::bounce(),
            scene::pyramid_on_grid(10),
            scene::cards(3),
            scene::arch(15, 5.0, 6.0),
            scene::billiards(0.0),
            scene::billiards(0.002),
            scene::slope(1e-3),
            scene::rain(200),
        ];
        for s in scenes {
            let mut world = umbra::Build::<umbra_physics::Fx>::new().build(&s);
            let mut parts = contacts::Contacts::new().build(&s);
            for tick in 0..300 {
                for i in 0..s.bodies.len() {
                    assert_eq!(world.state(i), parts.state(i), "{}, tick {tick}, body {i}", s.name);
                }
                world.step();
                parts.step();
            }
        }
    }
}
