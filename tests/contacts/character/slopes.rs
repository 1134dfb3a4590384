//! Slopes, seams of tiles and chains, and what counts as ground.

use super::*;

/// A slope up to the right from the origin, of an angle in degrees.
fn slope(degrees: i32) -> (World, Vec2) {
    let mut world = world();
    let angle = Fx::PI * Fx::from(degrees) / Fx::from(180);
    let (sine, cosine) = angle.sin_cos();
    // Its surface goes through the origin.
    let at = vec2(sine * 2, -cosine * 2);
    let def = BodyDef { angle, ..BodyDef::fixed() };
    add(&mut world, def, at, bar(fx!(100), fx!(4)));
    (world, vec2(cosine, sine))
}

#[test]
fn a_character_stands_on_slopes_up_to_the_limit_and_slides_on_steeper_ones() {
    for degrees in [0, 10, 30, 44, 45, 46, 60, 80] {
        let (world, along) = slope(degrees);
        for shape in
            [bar(fx!(0.5), fx!(1)), Shape::capsule(fx!(0.5), fx!(0.25)).unwrap(), Shape::circle(fx!(0.5)).unwrap()]
        {
            let mut walk = Walk::new(Character::new(shape), vec2(0, 2));
            for _ in 0..60 {
                walk.go(&world, vec2(0, fx!(-0.05)));
            }
            let stood = walk.position;
            assert_eq!(walk.ground.is_some(), degrees <= 45, "{degrees}");
            for _ in 0..60 {
                walk.go(&world, vec2(0, fx!(-0.05)));
            }
            if degrees <= 45 {
                assert_eq!(walk.position, stood, "{degrees}");
                let ground = walk.go(&world, vec2(0, 0)).ground_normal;
                assert!((ground - along.perp()).length() < fx!(0.00001), "{ground}");
            } else {
                // Down along the slope, as far as its translation goes along it: sin² of the way.
                let (way, down) = (stood - walk.position, Fx::from(3) * along.y);
                assert!((way - along * down).length() < fx!(0.0001), "{degrees}: {way}");
            }
        }
    }
}

#[test]
fn a_character_slides_on_a_slope_that_it_climbs_but_does_not_rest_on() {
    let (world, along) = slope(30);
    let mut walk = Walk::new(Character { max_rest_slope: fx!(0.35), ..hero() }, vec2(0, 2));
    walk.go(&world, vec2(0, -3));
    assert!(walk.ground.is_some());
    let before = walk.position;
    walk.go(&world, vec2(0, -1));
    assert!((before - walk.position - along * along.y).length() < fx!(0.0001));
    assert!(walk.ground.is_some(), "it stands while it slides");
    let before = walk.position;
    walk.go(&world, vec2(1, 0));
    assert!((walk.position - before - along * along.x).length() < fx!(0.0001), "and climbs");
}

#[test]
fn a_character_climbs_no_slope_that_is_too_steep_and_jumps_up_along_it() {
    for degrees in [50, 70, 89] {
        let (world, _) = slope(degrees);
        let mut walk = Walk::new(Character { step_height: fx!(0.5), ..hero() }, vec2(-6, 0));
        let mut floor = world.clone();
        add(&mut floor, BodyDef::fixed(), vec2(-10, fx!(-3)), bar(fx!(40), fx!(1)));
        walk.land(&floor);
        let height = walk.position.y;
        for _ in 0..200 {
            walk.go(&floor, vec2(fx!(0.1), fx!(-0.01)));
            assert_eq!(walk.position.y, height, "{degrees}");
        }
        let before = walk.position;
        walk.go(&floor, vec2(fx!(0.1), fx!(0.5)));
        assert_eq!(walk.position, before + vec2(0, fx!(0.5)), "{degrees}");
    }
}

#[test]
fn a_character_walks_over_a_thousand_seams_at_one_height_and_to_the_exact_distance() {
    let mut world = world();
    for x in 0..1_000 {
        add(&mut world, BodyDef::fixed(), vec2(x, fx!(-0.5)), bar(fx!(1), fx!(1)));
    }
    let (queries, step) = (world.queries(), vec2(fx!(0.1), fx!(-0.02)));
    for shape in [bar(fx!(0.5), fx!(1)), Shape::capsule(fx!(0.5), fx!(0.25)).unwrap(), Shape::circle(fx!(0.3)).unwrap()]
    {
        let mut walk = Walk::new(Character::new(shape), vec2(1, 1));
        walk.land(&world);
        let start = walk.position;
        for i in 1..=9_900 {
            let moved = walk.hero.translate(&queries, walk.position, walk.ground, step, &ALL).unwrap();
            (walk.position, walk.ground) = (moved.position, moved.ground);
            assert_eq!(walk.position, start + vec2(fx!(0.1) * i, 0), "step {i}");
            assert!(walk.ground.is_some(), "step {i}");
        }
    }
}

#[test]
fn tiles_that_are_off_by_an_ulp_are_one_floor() {
    let mut world = world();
    for x in 0..100 {
        let height = fx!(-0.5) + Fx::DELTA * (x * 7 % 3 - 1);
        add(&mut world, BodyDef::fixed(), Vec2::new(x.into(), height), bar(fx!(1), fx!(1)));
    }
    for shape in [bar(fx!(0.5), fx!(1)), Shape::capsule(fx!(0.5), fx!(0.25)).unwrap()] {
        let mut walk = Walk::new(Character::new(shape), vec2(1, 1));
        walk.land(&world);
        let start = walk.position;
        for i in 1..=900 {
            let moved = walk.go(&world, vec2(fx!(0.1), fx!(-0.02)));
            let off = walk.position - start - vec2(fx!(0.1) * i, 0);
            assert!(off.x.abs() < fx!(0.000001) && off.y.abs() <= NEAR && walk.ground.is_some(), "{i}: {off}");
            assert!(moved.hits.iter().all(|hit| hit.normal.y > fx!(0.999)), "{i}: {:?}", moved.hits);
        }
    }
}

#[test]
fn a_character_follows_a_slope_down_only_if_it_snaps() {
    for (snap, follows) in [(fx!(0.25), true), (fx!(0), false)] {
        let (world, along) = slope(-30);
        let mut walk = Walk::new(Character { snap, ..hero() }, vec2(0, 2));
        walk.land(&world);
        let mut in_air = 0;
        for _ in 0..100 {
            let before = walk.position;
            walk.go(&world, vec2(fx!(0.1), 0));
            in_air += i32::from(walk.ground.is_none());
            if follows {
                let expected = fx!(0.1) * along.y / along.x;
                assert!((walk.position.y - before.y - expected).abs() < fx!(0.0001), "{}", walk.position);
            }
        }
        assert_eq!(in_air, if follows { 0 } else { 100 });
    }
}

#[test]
fn a_character_does_not_snap_when_it_jumps() {
    let world = stairs(fx!(0.25), 1);
    let mut walk = Walk::new(hero(), vec2(-1, 1));
    walk.land(&world);
    let before = walk.position;
    walk.go(&world, vec2(0, fx!(0.01)));
    assert_eq!((walk.position, walk.ground), (before + vec2(0, fx!(0.01)), None));
}

#[test]
fn a_slope_that_is_a_little_too_steep_is_no_ground() {
    for (angle, stands) in [(fx!(0.7853), true), (fx!(0.7856), false)] {
        let mut world = world();
        let def = BodyDef { angle, ..BodyDef::fixed() };
        add(&mut world, def, vec2(0, 0), bar(fx!(40), fx!(1)));
        let mut walk = Walk::new(hero(), vec2(0, 2));
        assert_eq!(walk.go(&world, vec2(0, -2)).ground.is_some(), stands, "{angle}");
    }
}

#[test]
fn a_character_leaves_a_chain_to_its_outer_side_and_passes_from_behind() {
    let chain = || {
        let mut world = world();
        let floor = Shape::chain(&[vec2(2, 0), vec2(-2, 0)], false).unwrap();
        world.add_body(BodyDef::fixed().with_collider(floor)).unwrap();
        world
    };
    // Near the end of it the shortest way out is sideways.
    let mut walk = Walk::new(hero(), vec2(fx!(2.2), fx!(0.1)));
    walk.go(&chain(), vec2(0, 0));
    assert!((walk.position - vec2(fx!(2.2), fx!(0.5) + SKIN)).length() <= NEAR, "{}", walk.position);
    // With its middle below, it falls on.
    let mut walk = Walk::new(hero(), vec2(0, fx!(-0.1)));
    for way in [vec2(0, fx!(-0.1)), vec2(0, fx!(0.15)), vec2(fx!(0.5), fx!(-1))] {
        let before = walk.position;
        assert!(!walk.go(&chain(), way).is_overlapping);
        assert_eq!(walk.position, before + way);
    }
}

#[test]
fn a_character_stands_on_the_most_level_ground_and_then_on_the_least_key() {
    for order in [[1, 2], [2, 1]] {
        let (mut world, key) = (world(), |world: &World, id| world.collider(id).unwrap().key);
        for key in order {
            let tile = ColliderDef { key, ..ColliderDef::new(bar(fx!(4), fx!(2))) };
            let at = vec2(if key == 1 { -2 } else { 2 }, -1);
            world.add_body(BodyDef { position: at, ..BodyDef::fixed().with_collider(tile) }).unwrap();
        }
        let mut walk = Walk::new(hero(), vec2(0, 1));
        let moved = walk.go(&world, vec2(0, -1));
        let hits: Vec<u64> = moved.hits.iter().map(|hit| key(&world, hit.collider)).collect();
        assert_eq!((moved.ground_collider.map(|id| key(&world, id)), hits), (Some(1), vec![1, 2]));
        // A predicate leaves one of them out.
        let only: &dyn Fn(_, &ColliderDef) -> bool = &|_, def| def.key == 2;
        let mut walk = Walk::new(hero(), vec2(0, 1));
        let moved = walk.go_past(&world, vec2(0, -1), &QueryFilter { predicate: Some(only), ..ALL });
        assert_eq!(moved.ground_collider.map(|id| key(&world, id)), Some(2));
    }
    // Between two slopes, where it slides down to and rests on neither.
    let mut world = world();
    for (x, angle) in [(3, fx!(0.6)), (-3, fx!(-0.3))] {
        add(&mut world, BodyDef { angle, ..BodyDef::fixed() }, vec2(x, 0), bar(fx!(12), fx!(1)));
    }
    let mut walk = Walk::new(Character { max_rest_slope: fx!(0), ..hero() }, vec2(0, 4));
    (0..40).for_each(|_| _ = walk.go(&world, vec2(0, fx!(-0.5))));
    let moved = walk.go(&world, vec2(0, fx!(-0.5)));
    let colliders: BTreeSet<_> = moved.hits.iter().map(|hit| hit.collider).collect();
    assert_eq!((moved.hits.len(), colliders.len()), (2, 2));
    assert!((moved.ground_normal.x - fx!(0.3).sin()).abs() < fx!(0.00001), "{}", moved.ground_normal);
}

#[test]
fn a_character_walks_over_the_joints_of_a_chain_and_with_any_side_up() {
    let mut world = world();
    let points: Vec<Vec2> = (0..=60).rev().map(|i| vec2(i - 30, 0)).collect();
    world.add_body(BodyDef::fixed().with_collider(Shape::chain(&points, false).unwrap())).unwrap();
    let mut walk = Walk::new(hero(), vec2(-20, 2));
    walk.land(&world);
    let start = walk.position;
    for i in 1..=400 {
        walk.go(&world, vec2(fx!(0.1), fx!(-0.02)));
        assert_eq!(walk.position, start + vec2(fx!(0.1) * i, 0));
    }
    // From behind it passes.
    let mut walk = Walk::new(hero(), vec2(0, -2));
    walk.go(&world, vec2(0, 3));
    assert_eq!(walk.position, vec2(0, 1));

    // Turned by a quarter, all of it.
    let turn = Symmetry::TURN;
    let world = stairs(fx!(0.25), 3);
    let image = turn.world(&world).unwrap();
    let hero = Character::new(Shape::circle(fx!(0.5)).unwrap());
    let side = Character { up: turn.vector(vec2(0, 1)).unwrap(), ..hero.clone() };
    let at = vec2(-2, 1);
    let (mut walk, mut turned_walk) = (Walk::new(hero, at), Walk::new(side, turn.point(at).unwrap()));
    for _ in 0..200 {
        let way = vec2(fx!(0.07), fx!(-0.05));
        walk.go(&world, way);
        turned_walk.go(&image, turn.vector(way).unwrap());
        assert_eq!(turn.point(walk.position), Some(turned_walk.position));
    }
    assert!(walk.position.x > fx!(6));
}
