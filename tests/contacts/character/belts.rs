//! Conveyor belts under a character.

use umbra_physics::{ColliderId, Material};

use super::*;

const TICK: Fx = fx!(0.015625);

/// A static belt of 40 m with its top at y = 0, and its collider.
fn belt(surface_speed: Fx) -> (World, ColliderId) {
    let mut world = world();
    let surface = Material { surface_speed, ..Material::default() };
    let collider = ColliderDef { material: surface, ..ColliderDef::new(bar(fx!(40), fx!(1))) };
    let body =
        world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..BodyDef::fixed().with_collider(collider) }).unwrap();
    let collider = world.colliders_of(body).unwrap().next().unwrap();
    (world, collider)
}

#[test]
fn a_character_rides_a_belt_as_a_crate_does() {
    for (surface_speed, velocity) in [(fx!(-3), vec2(3, 0)), (fx!(2), vec2(-2, 0))] {
        let (mut world, collider) = belt(surface_speed);
        let crate_ = add(&mut world, BodyDef::dynamic(), vec2(6, fx!(0.5)), bar(fx!(1), fx!(1)));
        let mut walk = Walk::new(hero(), vec2(0, 1));
        let landed = walk.go(&world, vec2(0, -2));
        assert_eq!((landed.ground_collider, landed.ground_velocity), (Some(collider), velocity));
        let start = walk.position;
        for _ in 0..128 {
            world.step();
            assert_eq!(walk.go(&world, vec2(0, fx!(-0.01))).ground_velocity, velocity);
        }
        assert_eq!(walk.position, start + velocity * 2);
        assert!((world.body(crate_).unwrap().velocity() - velocity).length() < fx!(0.0001), "as a crate is carried");
        // It walks against it, and stands where the two are alike.
        let before = walk.position;
        (0..64).for_each(|_| _ = walk.go(&world, -velocity * TICK));
        assert_eq!(walk.position, before);
        // In the air it is not carried.
        let jump = walk.go(&world, vec2(0, fx!(0.5))).position;
        assert_eq!(walk.go(&world, vec2(0, fx!(0.25))).position, jump + vec2(0, fx!(0.25)));
    }
}

#[test]
fn a_belt_carries_a_character_up_a_slope_off_its_end_and_against_a_wall() {
    // Up a slope of 0.5 rad at the speed of the belt.
    let mut world = world();
    let surface = Material { surface_speed: fx!(-4), ..Material::default() };
    let collider = ColliderDef { material: surface, ..ColliderDef::new(bar(fx!(40), fx!(1))) };
    world.add_body(BodyDef { angle: fx!(0.5), ..BodyDef::fixed().with_collider(collider) }).unwrap();
    let mut walk = Walk::new(Character::new(Shape::circle(fx!(0.5)).unwrap()), vec2(0, 3));
    walk.land(&world);
    let start = walk.position;
    (0..64).for_each(|_| _ = walk.go(&world, vec2(0, fx!(-0.01))));
    let way = walk.position - start;
    assert!((way - vec2(fx!(0.5).cos(), fx!(0.5).sin()) * 4).length() < fx!(0.000001), "{way}");
    // Against a wall, and no further; off the end it falls.
    let (mut world, _) = belt(fx!(-3));
    add(&mut world, BodyDef::fixed(), vec2(2, 1), bar(fx!(1), fx!(2)));
    let mut walk = Walk::new(hero(), vec2(0, 1));
    walk.land(&world);
    (0..256).for_each(|_| _ = walk.go(&world, vec2(0, fx!(-0.01))));
    assert!((walk.position.x - fx!(1.25) + SKIN).abs() <= NEAR, "{}", walk.position);
    let (world, _) = belt(fx!(3));
    let mut walk = Walk::new(hero(), vec2(-18, 1));
    assert!(walk.go(&world, vec2(0, -1)).ground.is_some());
    (0..128).for_each(|_| _ = walk.go(&world, vec2(0, fx!(-0.25))));
    assert!(walk.ground.is_none() && walk.position.x < fx!(-20), "{}", walk.position);
}

#[test]
fn a_belt_on_a_platform_adds_to_the_way_of_the_platform() {
    let mut world = world();
    let surface = Material { surface_speed: fx!(-1), ..Material::default() };
    let collider = ColliderDef { material: surface, ..ColliderDef::new(bar(fx!(20), fx!(1))) };
    let lift = BodyDef { velocity: vec2(2, 1), ..BodyDef::kinematic() };
    world.add_body(lift.with_collider(collider)).unwrap();
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.land(&world);
    let start = walk.position;
    for _ in 0..64 {
        world.step();
        assert_eq!(walk.go(&world, vec2(0, fx!(-0.01))).ground_velocity, vec2(3, 1));
    }
    assert_eq!(walk.position, start + vec2(3, 1));
}
