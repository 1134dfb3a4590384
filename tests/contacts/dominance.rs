//! Dominance: of two bodies the one with the higher number is not moved by the other.

use super::scenes::{def, ground, square, through_bytes, world};
use umbra_physics::{
    BodyDef, BodyId, BodyKind, ColliderDef, Fx, Geometry, Locks, Scalar, Shape, Symmetry, Vec2, World, WorldDef, fx,
    vec2,
};

/// The position and the velocities of a body, with all their bits.
fn bits(world: &World, id: BodyId) -> [i128; 7] {
    let body = world.body(id).expect("it");
    let (at, velocity) = (body.position_exact(), body.velocity_exact());
    let words = [at.x, at.y, velocity.x, velocity.y, body.angular_velocity_exact()].map(|word| word.to_bits());
    let [a, b, c, d, e] = words;
    [a, b, c, d, e, body.angle_exact().to_bits().into(), 0]
}

fn with(mut body: BodyDef, dominance: i32) -> BodyDef {
    body.dominance = dominance;
    body
}

/// A stack, and a box of dominance 1 that is thrown into it and lands on the ground.
fn thrown(others: bool) -> (World, BodyId, Vec<BodyId>) {
    let thrower = square(vec2(-6, 2), 1).expect("a square");
    let thrower = BodyDef { velocity: vec2(8, 1), angular_velocity: fx!(1.5), ..thrower };
    let stack = (0..6_i32).map(|i| square(Vec2::new(fx!(0), fx!(0.5) + Fx::from(i)), 10 + i as u64).expect("a square"));
    // Fast ones, whose unit of velocity is coarser.
    let shots = (0..4_i32)
        .map(|i| BodyDef { velocity: vec2(-60, 0), ..square(vec2(20 + 9 * i, 1), 50 + i as u64).expect("a square") });
    let bodies = [ground().expect("a ground"), with(thrower, 1)];
    let bodies = bodies.into_iter().chain(stack.chain(shots).filter(|_| others));
    let (world, ids) = world(def(), bodies).expect("a scene");
    (world, ids[1], ids[2..].to_vec())
}

#[test]
fn a_dominant_body_has_the_bits_of_a_world_without_the_others() {
    let ((mut world, id, others), (mut alone, same, _)) = (thrown(true), thrown(false));
    let (mut touched, mut moved) = (0, 0);
    for step in 0..300 {
        world.step();
        alone.step();
        assert_eq!(bits(&world, id), bits(&alone, same), "step {step}");
        let contacts = world
            .contacts_of(id)
            .expect("it")
            .filter(|contact| contact.bodies.iter().any(|body| others.contains(body)));
        touched += contacts.count();
        moved += usize::from(alone.contacts_of(same).expect("it").next().is_some());
    }
    // It hits the others, and lies on the ground for most of the time.
    assert!(touched > 5 && moved > 100, "{touched} {moved}");
    let pushed = others[..6].iter().map(|&id| world.body(id).expect("it").position().x).max();
    assert!(pushed > Some(fx!(0.5)), "{pushed:?}");
    // In the other order of numbers it is moved.
    let (mut world, id, others) = thrown(true);
    others.iter().for_each(|&body| world.set_dominance(body, 1).expect("a body"));
    (0..300).for_each(|_| _ = world.step());
    assert_ne!(bits(&world, id), bits(&alone, same));
}

/// A dominant body in free flight moves others as a kinematic body of the same motion does.
#[test]
fn others_meet_it_as_a_kinematic_body() {
    let space = WorldDef { gravity: vec2(0, 0), ..def() };
    let pile = || {
        (0..12_i32).map(|i| square(Vec2::new(fx!(1.1) * (i % 4), fx!(1.2) * (i / 4)), 10 + i as u64).expect("a square"))
    };
    let ram = BodyDef { velocity: vec2(6, 1), angular_velocity: fx!(0.5), ..square(vec2(-4, 0), 1).expect("a square") };
    let dominant = with(ram.clone(), 3);
    let kinematic = BodyDef { kind: BodyKind::Kinematic, ..ram };
    let (mut here, ids) = world(space, [dominant].into_iter().chain(pile())).expect("a scene");
    let (mut twin, same) = world(space, [kinematic].into_iter().chain(pile())).expect("a scene");
    for step in 0..200 {
        here.step();
        twin.step();
        for (&id, &same) in ids.iter().zip(&same) {
            assert_eq!(bits(&here, id), bits(&twin, same), "step {step}");
        }
    }
    assert!(here.body(ids[12]).expect("it").velocity() != vec2(0, 0));
}

/// Three boxes on each other, each of which is not moved by what is above it; the one above is held all the same.
#[test]
fn a_stack_of_unlike_ones_stands() {
    for sign in [1, -1] {
        let stack = (0..5_i32).map(|i| {
            with(square(Vec2::new(fx!(0), fx!(0.5) + Fx::from(i)), 10 + i as u64).expect("a square"), sign * i)
        });
        let (mut world, ids) = world(def(), [ground().expect("a ground")].into_iter().chain(stack)).expect("a scene");
        (0..300).for_each(|_| _ = world.step());
        // The lower ones hold the upper ones; where the upper ones dominate, each is held by nothing but the ground.
        let top = world.body(ids[5]).expect("it").position();
        assert_eq!(top.x, fx!(0));
        let expected = if sign < 0 { fx!(4.45)..fx!(4.51) } else { fx!(-1)..fx!(4) };
        assert!(expected.contains(&top.y), "{sign}: {top:?}");
    }
}

#[test]
fn a_dominant_body_that_others_press_turns_them_and_does_not_sleep() {
    // A disc of dominance 1 turns in front of a smooth wall, and another one is pressed against it.
    let disc = |x: i32, key, friction| {
        let mut body = square(vec2(x, 0), key).expect("a square");
        body.colliders = vec![ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc"))];
        body.colliders[0].material.friction = friction;
        body
    };
    let wall = BodyDef { kind: BodyKind::Static, ..disc(-1, 3, fx!(0)) };
    let pressed = BodyDef { locks: Locks { y: true, ..Locks::NONE }, ..disc(1, 2, fx!(1)) };
    for spin in [6, 0] {
        let turning = BodyDef { angular_velocity: spin.into(), ..with(disc(0, 1, fx!(1)), 1) };
        let space = WorldDef { gravity: vec2(0, 0), sleep_after: Some(5), ..def() };
        let (mut world, ids) = world(space, [wall.clone(), turning, pressed.clone()]).expect("a scene");
        for _ in 0..60 {
            // With its own contact while it turns, and without one.
            if spin != 0 {
                world.apply_force(ids[1], vec2(-10, 0)).expect("a body");
            }
            world.apply_force(ids[2], vec2(-10, 0)).expect("a body");
            assert!(world.step().fell_asleep.is_empty());
        }
        let [turning, pressed] = [1, 2].map(|i| world.body(ids[i]).expect("it").angular_velocity());
        assert!(turning == fx!(1) * spin && (pressed + fx!(1) * spin).abs() < fx!(0.1), "{turning} {pressed}");
    }
}

#[test]
fn images_and_bytes_and_order_change_no_bit() {
    let scene = || -> Vec<BodyDef> {
        let falling = (0..24).map(|i: i32| {
            let at = Vec2::new(fx!(1.3) * (i % 5) - fx!(2.5), fx!(1.4) * (i / 5) + fx!(0.6));
            let mut body = square(at, 10 + i as u64).expect("a square");
            if i % 3 == 0 {
                let disc = Shape::circle(fx!(0.5)).expect("a disc");
                body.colliders = vec![ColliderDef { key: 10 + i as u64, ..ColliderDef::new(disc) }];
            }
            with(BodyDef { angular_velocity: fx!(0.5) * (i % 3), ..body }, i % 4 - 1)
        });
        [ground().expect("a ground")].into_iter().chain(falling).collect()
    };
    let (mut here, _) = world(def(), scene()).expect("a scene");
    let (mut twin, _) = world(def(), scene().into_iter().rev()).expect("a scene");
    let image = |world: &World| Symmetry::MIRROR.world(world).expect("an image");
    let mut mirrored = image(&here);
    for step in 0..150 {
        here.step();
        twin.step();
        mirrored.step();
        assert_eq!(here.physics_hash(), twin.physics_hash(), "{step}");
        assert_eq!(image(&here).state_hash(), mirrored.state_hash(), "{step}");
        here = through_bytes(&here);
    }
    assert!(here.contacts().count() > 20);
}

/// A heavy ball that flies into a box of a dominance above, in any scalar: the velocities of both after it.
fn hit<S: Scalar>(dominance: i32) -> [S; 2] {
    let scalar = |value| S::from_fx(value);
    let def = WorldDef { sleep_after: None, ..WorldDef::default() };
    let mut world = World::with_scalar(def).expect("a world");
    let body = |x, speed, geometry, dominance| {
        let shape = Shape::new(geometry).expect("a shape");
        let mut collider = ColliderDef::new(shape);
        collider.material.restitution = S::ONE;
        BodyDef {
            position: Vec2::new(scalar(x), S::ZERO),
            velocity: Vec2::new(scalar(speed), S::ZERO),
            colliders: vec![collider],
            dominance,
            ..BodyDef::dynamic()
        }
    };
    let unit = scalar(fx!(1));
    let target = body(fx!(0), fx!(1), Geometry::Rectangle { width: unit, height: unit }, dominance);
    let ball = body(fx!(4), fx!(-5), Geometry::Circle { radius: unit }, 0);
    let ids = [target, ball].map(|def| world.add_body(def).expect("a body"));
    (0..60).for_each(|_| _ = world.step());
    ids.map(|id| world.body(id).expect("it").velocity().x)
}

#[test]
fn a_ball_bounces_off_it_as_off_a_wall_that_moves() {
    // At 5 m/s against 1 m/s: back at 5 + 2 · 1 m/s.
    let [target, ball] = hit::<umbra_physics::Fx>(1);
    assert_eq!(target, fx!(1));
    assert!((ball - fx!(7)).abs() < fx!(0.001), "{ball}");
    // The other way round the box is thrown back, and the ball goes on.
    let [target, ball] = hit::<umbra_physics::Fx>(-1);
    assert_eq!(ball, fx!(-5));
    assert!((target + fx!(11)).abs() < fx!(0.001), "{target}");
}

#[cfg(feature = "float")]
#[test]
fn floats_know_it_too() {
    let [target, ball] = hit::<f64>(1);
    assert!(target == 1.0 && (ball - 7.0).abs() < 1e-6, "{target} {ball}");
    let [target, ball] = hit::<f32>(-1);
    assert!(ball == -5.0 && (target + 11.0).abs() < 1e-4, "{target} {ball}");
}
