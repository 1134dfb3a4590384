//! Fairness: mirror images, order of insertion.

use super::scenes::{def, ground, material, pyramid, square, world};
use crate::seeds::run_seed;
use umbra_physics::{BodyDef, BodyKind, ColliderDef, Fx, Locks, MixRule, Shape, Symmetry, Vec2, WorldDef, fx, vec2};

/// The body at the mirror image of each body's place.
fn partners(bodies: &[BodyDef]) -> Vec<usize> {
    let image = |at: Vec2| vec2(-at.x, at.y);
    let partner = |def: &BodyDef| bodies.iter().position(|candidate| candidate.position == image(def.position));
    bodies.iter().map(|def| partner(def).expect("a symmetric scene")).collect()
}

/// Steps a scene that is its own mirror image, and compares each body with its partner.
fn stays_symmetric(bodies: Vec<BodyDef>, steps: usize) {
    let partners = partners(&bodies);
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    for step in 0..steps {
        world.step();
        for (&id, &partner) in ids.iter().zip(&partners) {
            let [body, partner_body] = [id, ids[partner]].map(|id| world.body(id).expect("a body"));
            let at = body.position_exact();
            let partner_at = partner_body.position_exact();
            assert_eq!((at.x.negated(), at.y), (partner_at.x, partner_at.y), "{id} after {step} steps");
            assert_eq!(body.angle_exact().to_bits().wrapping_neg(), partner_body.angle_exact().to_bits(), "{id}");
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
    let mut random = umbra_physics::Random::seeded(run_seed(7));
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, random.below(i as u64 + 1) as usize);
    }
    let (mut here, _) = world(def(), bodies).expect("a scene");
    let (mut twin, _) = world(def(), shuffled).expect("a scene");
    for _ in 0..300 {
        here.step();
        twin.step();
        assert_eq!(here.physics_hash(), twin.physics_hash());
    }
    assert_ne!(here.state_hash(), twin.state_hash());
}

#[test]
fn a_mirrored_world_stays_the_mirror_image() {
    let mut bodies = pyramid(6).expect("a pyramid");
    bodies.iter_mut().skip(1).for_each(|def| def.position += vec2(fx!(0.25), fx!(1)));
    let (mut here, _) = world(def(), bodies).expect("a scene");
    let mut twin = Symmetry::MIRROR.world(&here).expect("an image");
    for _ in 0..300 {
        here.step();
        twin.step();
        let image = Symmetry::MIRROR.world(&here).expect("an image");
        assert_eq!(image.first_difference(&twin), None);
    }
}

/// Bodies over a chain with hills, which are pushed down so hard that contacts with its segments have impulses in several units: where
/// one goes over seams, it takes them over in an order that the image turns round.
#[test]
fn impulses_of_several_units_that_go_over_a_seam_keep_their_image() {
    let hill = |i: i32| Vec2::new(fx!(8) - Fx::from_ratio(i.into(), 4), Fx::from_ratio(i64::from(i * i % 5), 16));
    let chain = Shape::chain(&(0..50).map(hill).collect::<Vec<_>>(), false).expect("a chain");
    let disc = || ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc"));
    let surface = |friction, restitution, friction_rule, restitution_rule| umbra_physics::Material {
        friction_rule,
        restitution_rule,
        ..material(friction, restitution)
    };
    let (standard, product) = (MixRule::Standard, MixRule::Product);
    let bouncing = ColliderDef { material: surface(fx!(1), fx!(1), standard, product), ..disc() };
    let smooth = ColliderDef { material: surface(fx!(0), fx!(0), MixRule::GeometricMean, standard), ..disc() };
    let turning = ColliderDef { material: surface(fx!(0), fx!(1), standard, MixRule::Mean), ..disc() };
    let half = |x| ColliderDef {
        position: Vec2::new(x, fx!(0)),
        material: surface(fx!(0), fx!(0), MixRule::Mean, standard),
        ..ColliderDef::new(Shape::rectangle(fx!(0.5), fx!(0.5)).expect("a box"))
    };
    let body =
        |x: Fx, y: Fx, key, colliders| BodyDef { position: Vec2::new(x, y), key, colliders, ..BodyDef::dynamic() };
    let bodies = [
        BodyDef::fixed().with_collider(chain),
        BodyDef { locks: Locks { rotation: true, ..Locks::NONE }, ..body(fx!(1.5625), fx!(0.8125), 4, vec![bouncing]) },
        body(fx!(2.375), fx!(0.75), 3, vec![smooth]),
        BodyDef { angle: fx!(0.125), ..body(fx!(3.1875), fx!(0.875), 4, vec![half(fx!(0)), half(fx!(0.5))]) },
        BodyDef {
            kind: BodyKind::Kinematic,
            angle: fx!(0.125),
            angular_velocity: fx!(3),
            ..body(fx!(0.9375), fx!(1.5625), 9, vec![turning])
        },
    ];
    for symmetry in [Symmetry::FLIP, Symmetry::MIRROR, Symmetry::DIAGONAL, Symmetry::TURN] {
        let still = WorldDef { gravity: vec2(0, 0), ..def() };
        let (mut here, _) = world(still, bodies.clone()).expect("a scene");
        let mut twin = symmetry.world(&here).expect("an image");
        for step in 0..24 {
            if step == 2 {
                here.set_gravity(vec2(0, -65_536)).expect("strong, and within the limit");
                twin = symmetry.world(&here).expect("an image");
            }
            here.step();
            twin.step();
            let image = symmetry.world(&here).expect("an image");
            assert_eq!(image.first_difference(&twin), None, "{symmetry:?} after {step} steps");
        }
    }
}
