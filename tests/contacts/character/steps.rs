//! Steps.

use super::*;

#[test]
fn a_character_climbs_steps_up_to_its_step_height_and_no_higher_ones() {
    let heights = [fx!(0.01), fx!(0.02), fx!(0.1), fx!(0.24), fx!(0.25)];
    let more = Fx::from_bits(16);
    for speed in [fx!(0.003), fx!(0.02), fx!(0.1), fx!(0.4)] {
        for height in heights {
            let world = stairs(height, 5);
            let mut walk = Walk::new(hero(), vec2(-1, 1));
            walk.land(&world);
            let mut ticks = 0;
            while walk.position.x < fx!(12) {
                let before = walk.position;
                walk.go(&world, vec2(speed, fx!(-0.001)));
                assert!(walk.ground.is_some(), "{speed} {height}: {before} {}", walk.position);
                assert!(walk.position.x > before.x, "{speed} {height}: {before}");
                ticks += 1;
                assert!(ticks < 10_000);
            }
            assert!((walk.position.y - fx!(0.5) - SKIN - height * 5).abs() <= NEAR, "{}", walk.position);
            // And down again, without a moment in the air.
            while walk.position.x > fx!(-1) {
                let before = walk.position;
                walk.go(&world, vec2(-speed, fx!(-0.001)));
                assert!(walk.ground.is_some(), "{speed} {height}: {before} {}", walk.position);
                assert!(walk.position.x < before.x, "{speed} {height}: {before}");
            }
            assert!((walk.position.y - fx!(0.5) - SKIN).abs() <= NEAR, "{}", walk.position);
        }
        let world = stairs(fx!(0.25) + more, 1);
        let mut walk = Walk::new(hero(), vec2(-1, 1));
        walk.land(&world);
        for _ in 0..600 {
            walk.go(&world, vec2(speed, fx!(-0.001)));
        }
        assert!((walk.position.x + fx!(0.25) + SKIN).abs() <= NEAR, "{speed}: {}", walk.position);
    }
}

#[test]
fn a_capsule_climbs_steps_too() {
    let capsule = Character::new(Shape::capsule(fx!(1), fx!(0.3)).unwrap());
    for (speed, height) in [(fx!(0.02), fx!(0.25)), (fx!(0.1), fx!(0.2)), (fx!(0.1), fx!(0.25)), (fx!(0.3), fx!(0.1))] {
        let world = stairs(height, 4);
        // A capsule lies along x; this one is 1.6 m wide.
        let mut walk = Walk::new(capsule.clone(), vec2(-2, 1));
        walk.land(&world);
        for _ in 0..2_000 {
            walk.go(&world, vec2(speed, fx!(-0.001)));
        }
        assert!(walk.position.x > fx!(12), "{speed} {height}: {}", walk.position);
    }
}

#[test]
fn round_shapes_climb_steps_up_to_the_step_height_and_no_higher_ones() {
    let capsule = Shape::capsule(fx!(1), fx!(0.3)).unwrap();
    let upright = Shape::compound(&[Part {
        shape: capsule.clone(),
        position: vec2(0, 0),
        angle: Fx::FRAC_PI_2,
        density: fx!(1),
    }])
    .unwrap();
    for shape in [capsule, upright, Shape::circle(fx!(0.8)).unwrap()] {
        for (height, climbs) in
            [(fx!(0.25), true), (fx!(0.2501), false), (fx!(0.28), false), (fx!(0.31), false), (fx!(0.4), false)]
        {
            for speed in [fx!(0.02), fx!(0.1), fx!(0.4)] {
                let world = stairs(height, 1);
                let mut walk = Walk::new(Character::new(shape.clone()), vec2(-2, 2));
                walk.land(&world);
                (0..400).for_each(|_| _ = walk.go(&world, Vec2::new(speed, fx!(-0.001))));
                assert_eq!(walk.position.x > fx!(3), climbs, "{height} {speed}: {}", walk.position);
            }
        }
    }
}

#[test]
fn a_step_that_is_too_narrow_is_a_wall() {
    for (width, climbs) in [(fx!(0.01), false), (fx!(0.5), true)] {
        let mut world = world();
        add(&mut world, BodyDef::fixed(), vec2(0, -5), bar(fx!(40), fx!(10)));
        add(&mut world, BodyDef::fixed(), vec2(2, 0), bar(width, fx!(0.4)));
        // Behind a narrow ledge stands a wall.
        add(&mut world, BodyDef::fixed(), vec2(fx!(3) + width / 2, 0), bar(fx!(2), fx!(4)));
        let mut walk = Walk::new(Character { step_width: fx!(0.125), ..hero() }, vec2(0, 1));
        walk.land(&world);
        for _ in 0..100 {
            walk.go(&world, vec2(fx!(0.05), fx!(-0.01)));
        }
        assert_eq!(walk.position.y > fx!(0.6), climbs, "{}", walk.position);
    }
}

#[test]
fn a_character_climbs_steps_only_from_the_ground() {
    let step = |world: &mut World| _ = add(world, BodyDef::fixed(), vec2(2, 0), bar(fx!(2), fx!(0.4)));
    // A jump leads up the step's side, and not onto it.
    let (world, mut walk) = on_floor(hero(), 0, step);
    walk.go(&world, vec2(fx!(0.7), 0));
    let before = walk.position;
    let (_, mut jump) = (walk.go(&world, vec2(fx!(0.1), 0)), walk.clone());
    assert!((walk.position.y - before.y - fx!(0.2)).abs() <= NEAR, "{}", walk.position);
    (jump.position, jump.ground) = (before, walk.ground);
    let moved = jump.go(&world, vec2(fx!(0.1), fx!(0.01)));
    assert!(moved.position.y == before.y + fx!(0.01) && moved.ground.is_none(), "{}", moved.position);
    // One in the air stops at the side, and is not moved down to ground that is near.
    let mut fall = Walk::new(hero(), before + vec2(0, fx!(0.1)));
    let moved = fall.go(&world, vec2(fx!(0.1), 0));
    assert_eq!((moved.position.y, moved.ground), (before.y + fx!(0.1), None));
    // On the first call, without a ground, one that stands climbs.
    let mut first = Walk::new(hero(), before);
    assert!(first.go(&world, vec2(fx!(0.1), 0)).position.y > before.y + fx!(0.19));
    // The least way up leaves the ground.
    let mut least = Walk { position: before, ..first };
    assert_eq!(least.go(&world, Vec2::new(fx!(0), Fx::DELTA)).ground, None);
}

#[test]
fn a_character_climbs_no_step_under_a_low_ceiling() {
    let (world, mut walk) = on_floor(hero(), 0, |world| {
        add(world, BodyDef::fixed(), vec2(2, 0), bar(fx!(2), fx!(0.4)));
        add(world, BodyDef::fixed(), vec2(0, fx!(1) + SKIN * 2 + fx!(0.5)), bar(fx!(2), fx!(1)));
    });
    let height = walk.position.y;
    for _ in 0..30 {
        let moved = walk.go(&world, vec2(fx!(0.1), fx!(-0.01)));
        assert!(moved.position.y == height && !moved.is_overlapping, "{}", moved.position);
    }
    assert!((walk.position.x - fx!(0.75) + SKIN).abs() <= NEAR, "{}", walk.position);
}

#[test]
fn dynamic_bodies_are_neither_steps_nor_on_them() {
    let low = |world: &mut World, def: BodyDef, x: Fx, height: Fx| {
        add(world, def, Vec2::new(x, height / 2), bar(fx!(0.5), height));
    };
    // A crate alone; one before a step; one on the far side of a sill; and a step that stays climbable.
    type Bars<'a> = &'a [(bool, Fx, Fx)];
    let cases: [(Bars<'_>, bool); 4] = [
        (&[(true, fx!(1), fx!(0.2))], false),
        (&[(true, fx!(1), fx!(0.1)), (false, fx!(1.05), fx!(0.2))], false),
        (&[(false, fx!(1), fx!(0.1)), (true, fx!(1.05), fx!(0.2))], false),
        (&[(false, fx!(1), fx!(0.2))], true),
    ];
    for (bars, climbs) in cases {
        let (world, mut walk) = on_floor(hero(), 0, |world| {
            for &(is_dynamic, x, height) in bars {
                low(world, if is_dynamic { BodyDef::dynamic() } else { BodyDef::fixed() }, x, height);
            }
        });
        let height = walk.position.y;
        for _ in 0..6 {
            walk.go(&world, vec2(fx!(0.1), fx!(-0.01)));
        }
        assert_eq!(walk.position.y > height + fx!(0.05), climbs, "{bars:?}: {}", walk.position);
    }
}

#[test]
fn a_character_steps_and_snaps_as_far_as_its_settings_say() {
    let far = Character { step_height: fx!(3), snap: fx!(3), ..hero() };
    let (world, mut walk) = on_floor(far, 0, |world| _ = add(world, BodyDef::fixed(), vec2(2, 0), bar(fx!(2), fx!(5))));
    let height = walk.position.y;
    (0..20).for_each(|_| _ = walk.go(&world, vec2(fx!(0.1), fx!(-0.01))));
    assert!((walk.position.y - height - fx!(2.5)).abs() <= NEAR, "{}", walk.position);
    (0..20).for_each(|_| _ = walk.go(&world, vec2(fx!(0.1), fx!(-0.01))));
    assert!((walk.position.y - height).abs() <= NEAR && walk.ground.is_some(), "{}", walk.position);
}

#[test]
fn a_disc_walks_down_steps_without_a_moment_in_the_air_or_in_a_step() {
    let world = stairs(fx!(0.25), 5);
    let disc = Shape::circle(fx!(0.5)).unwrap();
    let mut walk = Walk::new(Character::new(disc.clone()), vec2(14, 3));
    walk.land(&world);
    while walk.position.x > fx!(-1) {
        walk.go(&world, vec2(fx!(-0.02), fx!(-0.01)));
        let inside = world.queries().overlap_shape(&disc, (walk.position, fx!(0)), &ALL).unwrap();
        assert!(walk.ground.is_some() && inside.is_empty(), "{}", walk.position);
    }
}
