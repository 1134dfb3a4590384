//! The heap that steps of worlds with collisions take.

use allocation_counter::measure;
use umbra_physics::{BodyDef, BodyId, ColliderDef, Error, Shape, World, WorldDef, fx, vec2};

/// A heap of boxes and discs that falls to the ground.
fn heap() -> World {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(100, 2).expect("a ground"));
    world.add_body(BodyDef { position: vec2(0, -1), ..ground }).expect("a body");
    for i in 0..120 {
        let shape = if i % 2 == 0 { Shape::rectangle(fx!(0.5), fx!(0.5)) } else { Shape::circle(fx!(0.25)) };
        let body = BodyDef::dynamic().with_collider(shape.expect("a shape"));
        let position = vec2(fx!(0.3) * (i % 11) - fx!(1.5), fx!(0.5) + fx!(0.125) * i);
        world.add_body(BodyDef { position, velocity: vec2(0, -3), ..body }).expect("a body");
    }
    world
}

fn unit() -> Shape {
    Shape::rectangle(1, 1).expect("a square")
}

#[test]
fn a_step_takes_nothing_from_the_heap_once_there_were_as_many_contacts() {
    let mut world = heap();
    let start = world.snapshot();
    let mut max_contacts = 0;
    for _ in 0..240 {
        world.step();
        max_contacts = max_contacts.max(world.contacts().count());
    }
    assert!(max_contacts > 150, "{max_contacts}");
    world.restore(&start);
    // The first step after a restore builds the tree of static colliders.
    world.step();
    for step in 1..240 {
        let taken = measure(|| _ = world.step());
        assert_eq!(taken.count_total, 0, "step {step} of {max_contacts} contacts");
    }
}

/// Allocations of 30 ticks that a world goes over a second time. The tick before takes in the calls.
fn taken_again(world: &mut World) -> u64 {
    world.step();
    let start = world.clone();
    (0..30).for_each(|_| _ = world.step());
    let again = measure(|| {
        world.clone_from(&start);
        (0..30).for_each(|_| _ = world.step());
    });
    again.count_total
}

/// A box comes near the surface of a floor of tiles, which is found then.
#[test]
fn a_surface_of_tiles_that_is_found_again_takes_nothing_from_the_heap() {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    let tile = |x: i32| BodyDef { position: vec2(x, 0), ..BodyDef::fixed().with_collider(unit()) };
    (-2..3).for_each(|x| _ = world.add_body(tile(x)).expect("a tile"));
    let body = BodyDef { position: vec2(0, fx!(1)), ..BodyDef::dynamic().with_collider(unit()) };
    world.add_body(body).expect("a box");
    assert_eq!(taken_again(&mut world), 0);
    assert!(world.contacts().count() > 0);
}

#[test]
fn many_bodies_that_fall_asleep_again_take_nothing_from_the_heap() {
    let mut world = World::new(WorldDef { sleep_after: Some(5), ..WorldDef::default() }).expect("a world");
    for i in 0..600 {
        let body = BodyDef { position: vec2(3 * i, 0), ..BodyDef::dynamic().with_collider(unit()) };
        world.add_body(body).expect("a box");
    }
    // One goes on, so that steps look for contacts.
    let body = BodyDef { position: vec2(0, 9), velocity: vec2(1, 0), ..BodyDef::dynamic().with_collider(unit()) };
    world.add_body(body).expect("a box");
    assert_eq!(taken_again(&mut world), 0);
    assert_eq!(world.moving_count(), 1);
}

#[test]
fn many_faults_that_are_found_again_take_nothing_from_the_heap() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    for i in 0..2_000 {
        let position = vec2(fx!(1_073_741_800), i);
        world.add_body(BodyDef { position, velocity: vec2(1_000, 0), ..BodyDef::dynamic() }).expect("a body");
    }
    assert_eq!(taken_again(&mut world), 0);
    assert_eq!(world.moving_count(), 0);
}

/// Nothing moves, so that no step looks at what has changed.
#[test]
fn changes_that_no_step_looks_at_are_not_kept_for_ever() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let wall = world.add_body(BodyDef::fixed().with_collider(Shape::circle(1).expect("a disc"))).expect("a body");
    let disc = world.colliders_of(wall).expect("it").next().expect("a disc");
    let mut change = |count: i32| {
        for i in 0..count {
            world.set_collider(disc, Shape::circle(1 + i % 2).expect("a disc")).expect("it is there");
            world.step();
        }
    };
    change(10_000);
    let taken = measure(|| change(20_000));
    assert!(taken.bytes_current <= 0, "{} bytes", taken.bytes_current);
}

/// Calls that change a body which is not static leave the tree of static colliders that queries share as it is.
#[test]
fn queries_after_a_change_of_a_moving_body_build_no_tree_of_static_ones() {
    type Change = fn(&mut World, BodyId) -> Result<(), Error>;
    let changes: [Change; 6] = [
        |world, ball| world.set_user_data(ball, 5),
        |world, ball| world.set_position(ball, vec2(0, 50)),
        |world, ball| world.set_gravity_scale(ball, fx!(0)),
        |world, ball| world.disable(ball),
        |world, ball| world.enable(ball),
        // It falls asleep in the step after that.
        |world, ball| world.set_velocity(ball, vec2(0, 0)),
    ];
    let mut world = World::new(WorldDef { sleep_after: Some(1), ..WorldDef::default() }).expect("a world");
    for x in 0..2_000 {
        let tile = BodyDef::fixed().with_collider(Shape::rectangle(1, 1).expect("a tile"));
        world.add_body(BodyDef { position: vec2(x, 0), ..tile }).expect("a body");
    }
    let ball = BodyDef::dynamic().with_collider(Shape::circle(1).expect("a disc"));
    let ball = world.add_body(BodyDef { position: vec2(0, 100), velocity: vec2(0, 1), ..ball }).expect("a body");
    let anew = measure(|| _ = world.queries()).bytes_max;
    world.step();
    _ = world.queries();
    for (which, change) in changes.into_iter().enumerate() {
        change(&mut world, ball).expect("a fair change");
        let before = measure(|| _ = world.queries()).bytes_max;
        world.step();
        let after = measure(|| _ = world.queries()).bytes_max;
        assert!(before.max(after) < anew / 10, "{which}: {before} and {after} bytes, {anew} anew");
    }
    assert_eq!(world.moving_count(), 0, "asleep");
}

/// A box comes near the surface of a raft of boxes, which is found then; a collider of the raft changes in between.
#[test]
fn a_surface_of_a_raft_that_is_found_again_takes_nothing_from_the_heap() {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    let colliders = (-20..20).map(|x| ColliderDef { position: vec2(x, 0), ..ColliderDef::new(unit()) }).collect();
    let raft = world.add_body(BodyDef { colliders, ..BodyDef::kinematic() }).expect("a raft");
    let body = BodyDef { position: vec2(0, 1), ..BodyDef::dynamic().with_collider(unit()) };
    world.add_body(body).expect("a box");
    assert_eq!(taken_again(&mut world), 0);
    assert!(world.contacts().count() > 0);
    let end = world.colliders_of(raft).expect("a raft").next().expect("a collider");
    let def = world.collider(end).expect("a collider").clone();
    let changed = ColliderDef { user_data: 1, ..def };
    world.step();
    let start = world.clone();
    // A call may take memory; the steps after it do not.
    let steps = |world: &mut World| {
        world.clone_from(&start);
        world.set_collider(end, changed.clone()).expect("a collider");
        measure(|| (0..30).for_each(|_| _ = world.step())).count_total
    };
    steps(&mut world);
    assert_eq!(steps(&mut world), 0);
}

/// A box flies through thin sensors, several in each step, which it meets within the step alone.
#[test]
fn sensors_that_a_fast_body_crosses_take_nothing_from_the_heap() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let thin = Shape::rectangle(fx!(0.1), 4).expect("a thin box");
    for i in 0..160 {
        let sensor = ColliderDef { sensor: true, ..ColliderDef::new(thin.clone()) };
        let def = BodyDef { position: vec2(3 * i, 0), ..BodyDef::fixed().with_collider(sensor) };
        world.add_body(def).expect("a sensor");
    }
    let body = BodyDef { position: vec2(-20, 0), velocity: vec2(600, 0), ..BodyDef::dynamic().with_collider(unit()) };
    world.add_body(body).expect("a box");
    (0..4).for_each(|_| _ = world.step());
    assert!(world.last_report().sensors_crossed.len() > 1, "{:?}", world.last_report().sensors_crossed);
    assert_eq!(taken_again(&mut world), 0);
}
