//! Joined bodies do not touch each other, unless they are told to.

use super::scenes::steps;
use umbra_physics::{BodyDef, BodyId, ColliderDef, Event, JointDef, JointId, Shape, Vec2, World, WorldDef, fx, vec2};

/// Two squares of 1 m that overlap by half, joined in the middle, without gravity.
fn overlapping(collide_connected: bool) -> (World, [BodyId; 2], JointId) {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let square = |x| {
        let collider = ColliderDef::new(Shape::rectangle(1, 1).expect("a square"));
        let collider = ColliderDef { contact_events: true, ..collider };
        BodyDef { position: Vec2::new(x, fx!(0)), ..BodyDef::dynamic().with_collider(collider) }
    };
    let bodies = [fx!(-0.25), fx!(0.25)].map(|x| world.add_body(square(x)).expect("a body"));
    let joint = JointDef::at(&world, bodies[0], bodies[1], vec2(0, 0)).expect("a joint");
    let joint = world.add_joint(JointDef { collide_connected, ..joint }).expect("a joint");
    (world, bodies, joint)
}

fn touch(world: &World, bodies: [BodyId; 2]) -> bool {
    world.contacts_of(bodies[0]).expect("a body").any(|contact| contact.bodies.contains(&bodies[1]))
}

#[test]
fn joined_bodies_touch_only_if_told_to() {
    let (mut world, bodies, _) = overlapping(false);
    for _ in 0..60 {
        world.step();
        assert!(!touch(&world, bodies));
    }
    let at = bodies.map(|body| world.body(body).expect("a body").position());
    assert_eq!(at, [Vec2::new(fx!(-0.25), fx!(0)), Vec2::new(fx!(0.25), fx!(0))], "nothing pushes them");
    let (mut world, bodies, _) = overlapping(true);
    world.step();
    assert!(touch(&world, bodies));
}

/// The bodies touch as soon as their joint is disabled or removed, and their contact ends at once when it is enabled or added.
#[test]
fn contacts_follow_the_joint() {
    let (mut world, bodies, joint) = overlapping(false);
    world.enable_joint(joint, false).expect("a joint");
    let began = world.step().into_iter().any(|event| matches!(event, Event::ContactBegan(_)));
    assert!(began && touch(&world, bodies));
    world.enable_joint(joint, true).expect("a joint");
    assert!(!touch(&world, bodies), "at once");
    let ended = world.step().into_iter().filter(|event| matches!(event, Event::ContactEnded(_))).count();
    assert_eq!((ended, touch(&world, bodies)), (1, false));
    world.remove_joint(joint).expect("a joint");
    world.step();
    assert!(touch(&world, bodies));
    let again = JointDef::at(&world, bodies[0], bodies[1], vec2(0, 0)).expect("a joint");
    world.add_joint(again).expect("a joint");
    assert!(!touch(&world, bodies));
}

/// The first and the third link of three in a row do touch. Nothing presses them together, so that they part without an impulse in the end:
/// a contact with events is listed all the same.
#[test]
fn the_next_but_one_touches() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let disc = ColliderDef::new(Shape::circle(fx!(0.6)).expect("a disc"));
    let disc = ColliderDef { contact_events: true, ..disc };
    let def = |x: i32| BodyDef { position: vec2(x, 0), ..BodyDef::dynamic().with_collider(disc.clone()) };
    let bodies = [0, 1, 1].map(|x| world.add_body(def(x)).expect("a body"));
    for pair in [[0, 1], [1, 2]] {
        let joint = JointDef::at(&world, bodies[pair[0]], bodies[pair[1]], vec2(pair[1] as i32, 1));
        world.add_joint(joint.expect("a joint")).expect("a joint");
    }
    steps(&mut world, 1);
    assert!(!touch(&world, [bodies[0], bodies[1]]) && !touch(&world, [bodies[1], bodies[2]]));
    assert!(touch(&world, [bodies[0], bodies[2]]));
}

/// A bullet on a rod flies in a circle around a point of a thin wall, a metre in a step: it passes the wall, and a bullet that may touch the wall
/// does not.
#[test]
fn continuous_collision_knows_joined_bodies() {
    for collide_connected in [false, true] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let wall = Shape::rectangle(fx!(0.1), 10).expect("a wall");
        let wall = world.add_body(BodyDef::fixed().with_collider(wall)).expect("a body");
        let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.1)).expect("a disc"));
        let ball = BodyDef { position: vec2(-4, 2), velocity: vec2(0, -60), bullet: true, ..ball };
        let ball = world.add_body(ball).expect("a body");
        let rod = JointDef::between(&world, wall, vec2(0, 2), ball, vec2(-4, 2)).expect("a rod");
        world.add_joint(JointDef { collide_connected, ..rod }).expect("a rod");
        // 3 rad
        steps(&mut world, 12);
        let ball = world.body(ball).expect("a body");
        if collide_connected {
            assert!(ball.position().x < fx!(0), "{}", ball.position());
        } else {
            assert!(ball.position().x > fx!(3.9), "{}", ball.position());
            assert!((ball.velocity().length() - fx!(60)).abs() < fx!(0.6), "{}", ball.velocity());
        }
    }
}
