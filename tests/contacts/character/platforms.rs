//! Platforms: one-way ones, and riding on those that move.

use super::*;

/// A world with a plank from y = -0.125 to 0.125 that is solid from above.
fn plank(def: BodyDef) -> (World, BodyId) {
    let mut world = world();
    let one_way = Some(OneWay::default());
    let plank = ColliderDef { one_way, ..ColliderDef::new(bar(fx!(4), fx!(0.25))) };
    let plank = world.add_body(def.with_collider(plank)).expect("a plank");
    (world, plank)
}

#[test]
fn a_one_way_platform_holds_from_above_alone() {
    let (world, plank) = plank(BodyDef::fixed());
    // From above.
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.go(&world, vec2(0, -3));
    assert!((walk.position.y - fx!(0.625) - SKIN).abs() <= NEAR);
    assert_eq!(walk.ground.map(|ground| ground.body), Some(plank));
    // From below, fast and slowly, and then it stands on it.
    for speed in [fx!(3), fx!(0.3), fx!(0.01)] {
        let mut walk = Walk::new(hero(), vec2(0, -1));
        while walk.position.y < fx!(1) {
            let before = walk.position;
            walk.go(&world, vec2(0, speed));
            assert_eq!(walk.position, before + vec2(0, speed));
        }
        walk.go(&world, vec2(0, -3));
        assert_eq!(walk.ground.map(|ground| ground.body), Some(plank));
    }
    // From the side, and down again if it did not get out of it.
    let mut walk = Walk::new(hero(), vec2(-3, 0));
    for way in [vec2(3, 0), vec2(0, fx!(0.3)), vec2(0, -2)] {
        let before = walk.position;
        walk.go(&world, way);
        assert_eq!(walk.position, before + way);
    }
    // It drops through when the platform is left out for one call.
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.land(&world);
    let before = walk.position;
    walk.go_past(&world, vec2(0, fx!(-0.01)), &QueryFilter { without_bodies: &[plank], ..ALL });
    for _ in 0..30 {
        walk.go(&world, vec2(0, fx!(-0.01)));
    }
    assert_eq!(walk.position, before - vec2(0, fx!(0.01) * 31));
    assert_eq!(walk.ground, None);
}

#[test]
fn a_character_rides_platforms_without_slipping_and_without_gaps() {
    for velocity in [vec2(3, 0), vec2(0, 2), vec2(0, -7), vec2(-2, fx!(1.3))] {
        let mut world = world();
        let lift = add(&mut world, BodyDef { velocity, ..BodyDef::kinematic() }, vec2(0, 0), bar(fx!(4), fx!(1)));
        let mut walk = Walk::new(hero(), vec2(fx!(0.5), 2));
        walk.land(&world);
        let beside = walk.position - world.body(lift).unwrap().position();
        for _ in 0..640 {
            world.step();
            let moved = walk.go(&world, vec2(0, fx!(-0.01)));
            assert_eq!(walk.position - world.body(lift).unwrap().position(), beside, "{velocity}");
            assert_eq!((moved.ground.map(|ground| ground.body), moved.ground_velocity), (Some(lift), velocity));
        }
        // It walks on it as if it stood still.
        world.step();
        walk.go(&world, vec2(fx!(0.25), 0));
        assert_eq!(walk.position - world.body(lift).unwrap().position(), beside + vec2(fx!(0.25), 0));
    }
}

#[test]
fn a_character_rides_a_one_way_platform_up_and_a_tipping_one_until_it_is_too_steep() {
    let (mut world, plank) = plank(BodyDef { velocity: vec2(1, 2), ..BodyDef::kinematic() });
    let mut walk = Walk::new(hero(), vec2(0, 2));
    walk.land(&world);
    walk.ride(&mut world, plank, 640);
    // A platform that tips: it stays on until the slope is too steep.
    let mut world = self::world();
    let tip = add(
        &mut world,
        BodyDef { angular_velocity: fx!(0.25), ..BodyDef::kinematic() },
        vec2(0, 0),
        bar(fx!(8), fx!(1)),
    );
    let mut walk = Walk::new(hero(), vec2(1, 2));
    walk.land(&world);
    walk.ride(&mut world, tip, 192);
    for _ in 0..64 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
    }
    assert_eq!(walk.ground, None, "at more than 45° it slides");
}

#[test]
fn a_platform_that_rises_against_a_ceiling_crushes_it_and_a_wall_that_comes_pushes_it() {
    let mut world = world();
    add(&mut world, BodyDef { velocity: vec2(0, fx!(0.25)), ..BodyDef::kinematic() }, vec2(0, 0), bar(fx!(4), fx!(1)));
    add(&mut world, BodyDef::fixed(), vec2(0, 3), bar(fx!(4), fx!(1)));
    let mut walk = Walk::new(hero(), vec2(0, fx!(1.2)));
    walk.land(&world);
    let mut crushed = None;
    for tick in 0..300 {
        world.step();
        let moved = walk.go(&world, vec2(0, fx!(-0.01)));
        assert!(moved.position.y < 2.into(), "never into the ceiling: {}", moved.position);
        crushed = crushed.or(moved.is_overlapping.then_some(tick));
    }
    // 1 m of it between surfaces 2 m apart, and one of its skins: 252 ticks of 2^-8 m.
    assert!(crushed.is_some_and(|tick| (250..254).contains(&tick)), "{crushed:?}");

    let mut world = self::world();
    add(&mut world, BodyDef::fixed(), vec2(0, fx!(-0.5)), bar(fx!(20), fx!(1)));
    add(&mut world, BodyDef { velocity: vec2(2, 0), ..BodyDef::kinematic() }, vec2(-2, 1), bar(fx!(1), fx!(2)));
    let mut walk = Walk::new(hero(), vec2(0, 1));
    walk.land(&world);
    for _ in 0..128 {
        world.step();
        assert!(!walk.go(&world, vec2(0, fx!(-0.01))).is_overlapping);
    }
    assert!((walk.position.x - fx!(2.75) - SKIN).abs() < fx!(0.001), "{}", walk.position);
}

#[test]
fn a_character_rides_in_a_fast_cabin_and_not_with_a_disabled_or_teleported_one() {
    let mut world = world();
    let wall = |x: i32| ColliderDef { position: vec2(x, 1), ..ColliderDef::new(bar(fx!(0.25), fx!(2))) };
    let cabin = BodyDef { velocity: vec2(128, 0), ..BodyDef::kinematic().with_collider(bar(fx!(4), fx!(0.5))) };
    let cabin = world.add_body(cabin.with_collider(wall(-1)).with_collider(wall(1))).unwrap();
    let mut walk = Walk::new(hero(), vec2(0, 1));
    walk.land(&world);
    let beside = walk.position;
    for tick in 1..=64 {
        world.step();
        walk.go(&world, vec2(0, fx!(-0.01)));
        assert_eq!(walk.position, beside + vec2(2 * tick, 0));
    }
    let (stays, at) = (walk.clone(), world.body(cabin).unwrap().position());
    world.set_position(cabin, at + vec2(300, 0)).unwrap();
    assert_eq!(walk.go(&world, vec2(0, 0)).position, stays.position);
    let mut walk = stays.clone();
    world.disable(cabin).unwrap();
    world.set_position(cabin, at + vec2(0, -3)).unwrap();
    assert_eq!(walk.go(&world, vec2(0, 0)).position, stays.position);
}

#[test]
fn a_one_way_platform_that_tips_holds_who_stands_on_it() {
    let (mut world, plank) = plank(BodyDef { angular_velocity: fx!(0.25), ..BodyDef::kinematic() });
    let mut walk = Walk::new(hero(), vec2(1, 2));
    walk.land(&world);
    walk.ride(&mut world, plank, 150);
}

#[test]
fn it_rides_a_platform_that_turns_and_one_that_is_moved_by_forces() {
    // As far from the surface as before; a bar stays upright, and stands on a corner.
    for (shape, bound) in [(Shape::circle(fx!(0.5)).unwrap(), NEAR), (bar(fx!(0.5), fx!(1)), fx!(0.0625))] {
        for kind in [BodyDef::kinematic(), BodyDef { gravity_scale: fx!(0), ..BodyDef::dynamic() }] {
            let mut world = world();
            let def = BodyDef { velocity: vec2(fx!(0.5), fx!(0.25)), angular_velocity: fx!(0.25), ..kind };
            let platform = add(&mut world, def, vec2(0, 0), bar(fx!(8), fx!(1)));
            let mut walk = Walk::new(Character::new(shape.clone()), vec2(1, 2));
            walk.land(&world);
            let start = walk.ground.unwrap().local;
            for tick in 0..180 {
                walk.ride(&mut world, platform, 1);
                let way = walk.ground.unwrap().local - start;
                assert!(way.length() <= bound, "tick {tick}: {way}");
            }
        }
    }
}
