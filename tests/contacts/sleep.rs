//! Sleeping bodies that are touched, and bystanders.

use super::scenes::{def, square, world};
use umbra_physics::{Activity, BodyDef, ColliderDef, Shape, Vec2, World, WorldDef, fx, vec2};

fn disc(position: Vec2, velocity: Vec2) -> BodyDef {
    let shape = Shape::circle(fx!(0.5)).expect("a disc");
    BodyDef { position, velocity, ..BodyDef::dynamic().with_collider(shape) }
}

/// Discs at rest in a row, next to each other, and one that flies at them.
fn row() -> Vec<BodyDef> {
    let mut bodies: Vec<BodyDef> = (0..5).map(|x| disc(vec2(x, 0), vec2(0, 0))).collect();
    bodies.push(disc(vec2(-9, fx!(0.1)), vec2(4, 0)));
    bodies
}

fn motion(world: &World) -> Vec<[i128; 5]> {
    let of = |body: umbra_physics::BodyRef<'_>| {
        let (x, v) = (body.position_exact(), body.velocity_exact());
        [x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(umbra_physics::FxAccumulator::to_bits)
    };
    world.bodies().map(of).collect()
}

#[test]
fn whether_bodies_slept_before_a_touch_changes_no_bit() {
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let (mut awake, _) = world(still, row()).expect("a scene");
    let (mut sleeping, ids) = world(WorldDef { sleep_after: Some(10), ..still }, row()).expect("a scene");
    let (mut slept, mut woke) = (Vec::new(), Vec::new());
    for _ in 0..300 {
        awake.step();
        let report = sleeping.step();
        slept.extend_from_slice(report.fell_asleep);
        woke.extend_from_slice(report.woke);
        assert_eq!(motion(&sleeping), motion(&awake));
    }
    assert_eq!(slept[..5], ids[..5]);
    assert_eq!(woke[..5], ids[..5], "one wakes the next in the same step");
}

#[test]
fn a_sleeping_body_wakes_where_a_static_one_is_put_into_it() {
    let def = WorldDef { gravity: vec2(0, 0), sleep_after: Some(5), ..def() };
    let (mut world, ids) = world(def, [disc(vec2(0, 0), vec2(0, 0)), disc(vec2(50, 0), vec2(1, 0))]).expect("a scene");
    (0..10).for_each(|_| _ = world.step());
    assert_eq!(world.body(ids[0]).expect("it").activity(), Activity::Asleep);
    let wall = BodyDef::fixed().with_collider(Shape::rectangle(fx!(1), fx!(1)).expect("a wall"));
    world.add_body(BodyDef { position: vec2(fx!(0.9), 0), ..wall }).expect("a wall");
    let report = world.step();
    assert_eq!(report.woke, [ids[0]]);
    assert!(world.body(ids[0]).expect("it").velocity().x < fx!(0));
}

#[test]
fn bystanders_change_no_bit() {
    let near = |i: i32| square(Vec2::new(fx!(0.3) * i, fx!(2) * i), i as u64).expect("a square");
    let ground = || super::scenes::ground().expect("a ground");
    let own: Vec<BodyDef> = [ground()].into_iter().chain((1..8).map(near)).collect();
    let others = (1..8).map(|i| {
        let def = near(i);
        BodyDef { position: def.position + vec2(1_000, 0), ..def }
    });
    let far_ground = BodyDef { position: vec2(1_000, -1), ..ground() };
    let (mut alone, _) = world(def(), own.clone()).expect("a scene");
    let (mut crowd, _) = world(def(), own.into_iter().chain([far_ground]).chain(others)).expect("a scene");
    for _ in 0..300 {
        alone.step();
        crowd.step();
        assert_eq!(motion(&crowd)[..8], motion(&alone)[..]);
    }
}

#[test]
fn filters_and_bodies_of_one_kind_pass_each_other() {
    let ghost = |x: i32, vx: i32| {
        let filter = umbra_physics::Filter { category: 4, mask: 2, ..Default::default() };
        let collider = ColliderDef { filter, ..ColliderDef::new(Shape::circle(fx!(0.5)).expect("a disc")) };
        BodyDef { position: vec2(x, 0), velocity: vec2(vx, 0), ..BodyDef::dynamic().with_collider(collider) }
    };
    let still = WorldDef { gravity: vec2(0, 0), ..def() };
    let lift = |x: i32, vx: i32| BodyDef {
        position: vec2(x, 9),
        velocity: vec2(vx, 0),
        ..BodyDef::kinematic().with_collider(Shape::circle(fx!(0.5)).expect("a disc"))
    };
    let (mut world, ids) = world(still, [ghost(-1, 1), ghost(1, -1), lift(-1, 1), lift(1, -1)]).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    let x: Vec<_> = ids.iter().map(|&id| world.body(id).expect("it").position().x).collect();
    assert_eq!(x, [fx!(0); 4]);
    assert_eq!(world.contacts().count(), 0);
}
