//! Fairness: mirror images, order of insertion.

use super::scenes::{def, ground, pyramid, square, world};
use umbra_physics::{BodyDef, Fx, Symmetry, Vec2, fx, vec2};

/// The body at the mirror image of each body's place.
fn partners(bodies: &[BodyDef]) -> Vec<usize> {
    let image = |at: Vec2| vec2(-at.x, at.y);
    let partner = |def: &BodyDef| bodies.iter().position(|other| other.position == image(def.position));
    bodies.iter().map(|def| partner(def).expect("a symmetric scene")).collect()
}

/// Steps a scene that is its own mirror image, and compares each body with its partner.
fn stays_symmetric(bodies: Vec<BodyDef>, steps: usize) {
    let partners = partners(&bodies);
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    for step in 0..steps {
        world.step();
        for (&id, &partner) in ids.iter().zip(&partners) {
            let [own, other] = [id, ids[partner]].map(|id| world.body(id).expect("a body"));
            let at = own.position_exact();
            let there = other.position_exact();
            assert_eq!((at.x.negated(), at.y), (there.x, there.y), "{id} after {step} steps");
            assert_eq!(own.angle_exact().to_bits().wrapping_neg(), other.angle_exact().to_bits(), "{id}");
        }
    }
}

#[test]
fn a_mirrored_stack_stays_its_own_mirror_image() {
    let mut bodies = vec![ground().expect("a ground")];
    for row in 0..8 {
        bodies.push(square(Vec2::new(fx!(0), fx!(0.5) + row.into()), row as u64).expect("a square"));
    }
    // Two stacks that lean on each other.
    for row in 0..4 {
        for side in [-1, 1] {
            let x = Fx::from(3 * side);
            let def = square(Vec2::new(x, fx!(0.75) + row.into()), 100 + row as u64).expect("a square");
            bodies.push(BodyDef { angular_velocity: Fx::from_ratio(side.into(), 2), ..def });
        }
    }
    stays_symmetric(bodies, 600);
}

#[test]
fn a_pyramid_stays_its_own_mirror_image() {
    stays_symmetric(pyramid(10).expect("a pyramid"), 600);
}

#[test]
fn the_order_of_insertion_changes_no_bit() {
    let bodies = pyramid(10).expect("a pyramid");
    let mut shuffled = bodies.clone();
    let mut random = umbra_physics::Random::seeded(7);
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, random.below(i as u64 + 1) as usize);
    }
    let (mut here, _) = world(def(), bodies).expect("a scene");
    let (mut there, _) = world(def(), shuffled).expect("a scene");
    for _ in 0..300 {
        here.step();
        there.step();
        assert_eq!(here.physics_hash(), there.physics_hash());
    }
    assert_ne!(here.state_hash(), there.state_hash());
}

#[test]
fn a_mirrored_world_stays_the_mirror_image() {
    let mut bodies = pyramid(6).expect("a pyramid");
    bodies.iter_mut().skip(1).for_each(|def| def.position += vec2(fx!(0.25), fx!(1)));
    let (mut here, _) = world(def(), bodies).expect("a scene");
    let mut there = Symmetry::MIRROR.world(&here).expect("an image");
    for _ in 0..300 {
        here.step();
        there.step();
        let image = Symmetry::MIRROR.world(&here).expect("an image");
        assert_eq!(image.first_difference(&there), None);
    }
}
