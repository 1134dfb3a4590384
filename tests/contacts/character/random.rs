//! Walks among obstacles at random: never into a wall, alike in a mirror and in worlds built in another order.

use super::*;
use crate::seeds::run_seed;

/// Boxes, discs, turned bars and rounded polygons at random.
fn clutter(random: &mut Random, turned: bool) -> Vec<BodyDef> {
    let mut obstacle = |key| {
        let size = |random: &mut Random| random.number(fx!(0.25)..=fx!(2));
        let shape = match random.below(5) {
            0 => Shape::circle(size(random)),
            1 => Shape::rounded_polygon(&[vec2(0, 0), vec2(2, 0), vec2(1, 2)], fx!(0.2)),
            2 => Shape::polygon(&[vec2(0, 0), vec2(3, 0), vec2(2, 2), vec2(0, 1)]),
            _ => Shape::rectangle(size(random), size(random)),
        };
        let mut number = |max: i32| random.number(-Fx::from(max)..=Fx::from(max));
        let (position, angle) = (Vec2::new(number(6), number(6)), if turned { number(3) } else { fx!(0) });
        let collider = ColliderDef { key, ..ColliderDef::new(shape.expect("a shape")) };
        BodyDef { position, angle, ..BodyDef::fixed().with_collider(collider) }
    };
    (0..24).map(&mut obstacle).collect()
}

fn world_of(bodies: impl IntoIterator<Item = BodyDef>) -> World {
    let mut world = world();
    for def in bodies {
        world.add_body(def).expect("a body");
    }
    world
}

fn any_hero(random: &mut Random) -> Character {
    let shape = match random.below(4) {
        0 => bar(fx!(0.5), fx!(1)),
        1 => Shape::circle(fx!(0.4)).unwrap(),
        2 => Shape::capsule(fx!(0.5), fx!(0.3)).unwrap(),
        _ => Shape::polygon(&[vec2(0, 0), vec2(1, 0), vec2(fx!(0.6), 1), vec2(0, 1)]).unwrap(),
    };
    Character::new(shape)
}

/// A place for it, if there is one.
fn free_place(random: &mut Random, world: &World, hero: &Character) -> Option<Vec2> {
    let queries = world.queries();
    (0..50).find_map(|_| {
        let place = Vec2::new(random.number(fx!(-7)..=fx!(7)), random.number(fx!(-7)..=fx!(7)));
        queries.overlap_shape(&hero.shape, (place, fx!(0)), &ALL).unwrap().is_empty().then_some(place)
    })
}

#[test]
fn a_character_never_ends_in_a_wall() {
    let (mut moves, mut hits) = (0, 0);
    for seed in 0..200 {
        let random = &mut Random::seeded(run_seed(seed));
        let world = world_of(clutter(random, seed % 4 > 0));
        let hero = any_hero(random);
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let (queries, mut walk) = (world.queries(), Walk::new(hero, place));
        let mut goal = vec2(0, 0);
        for i in 0..60 {
            // To places among the obstacles, at a jump now and then.
            if i % 10 == 0 {
                goal = Vec2::new(random.number(fx!(-6)..=fx!(6)), random.number(fx!(-6)..=fx!(6)));
            }
            let way = (goal - walk.position) * if i % 10 == 0 { fx!(0.9) } else { fx!(0.15) };
            let moved = walk.hero.translate(&queries, walk.position, walk.ground, way, &ALL).unwrap();
            let inside = queries.overlap_shape(&walk.hero.shape, (moved.position, fx!(0)), &ALL).unwrap();
            assert_eq!(inside, [], "seed {seed}, move {i}: {walk:?} by {way} to {moved:?}");
            assert!(!moved.is_overlapping);
            let parts: BTreeSet<_> = moved.hits.iter().map(|hit| (hit.collider, hit.part)).collect();
            assert_eq!(parts.len(), moved.hits.len(), "each once");
            hits += moved.hits.len();
            moves += 1;
            (walk.position, walk.ground) = (moved.position, moved.ground);
        }
    }
    assert!(moves >= 10_000 && hits > 5_000, "{moves} moves, {hits} hits");
}

#[test]
fn a_mirror_image_moves_to_the_mirror_image() {
    let (mirror, mut moves, mut met) = (Symmetry::MIRROR, 0, 0);
    for seed in 0..120 {
        let random = &mut Random::seeded(run_seed(1_000 + seed));
        let world = world_of(clutter(random, seed % 4 > 0));
        let image = mirror.world(&world).expect("an image");
        let hero = any_hero(random);
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let mirrored = Character { shape: mirror.shape(&hero.shape).unwrap(), ..hero.clone() };
        let at = mirror.point(place).unwrap();
        let (mut walk, mut image_walk) = (Walk::new(hero, place), Walk::new(mirrored, at));
        for i in 0..60 {
            let way = Vec2::new(random.number(fx!(-0.4)..=fx!(0.4)), random.number(fx!(-0.4)..=fx!(0.3)));
            let moved = walk.go(&world, way);
            let image_moved = image_walk.go(&image, mirror.vector(way).unwrap());
            assert_eq!(mirror.point(moved.position), Some(image_moved.position), "seed {seed}, move {i}: {way}");
            assert_eq!(moved.ground_collider, image_moved.ground_collider);
            assert_eq!(mirror.vector(moved.ground_normal), Some(image_moved.ground_normal));
            let hits = moved
                .hits
                .iter()
                .map(|hit| (hit.collider, mirror.point(hit.point).unwrap(), mirror.vector(hit.normal).unwrap()));
            assert!(
                hits.eq(image_moved.hits.iter().map(|hit| (hit.collider, hit.point, hit.normal))),
                "seed {seed}, move {i}"
            );
            met += moved.hits.len();
            moves += 1;
        }
    }
    assert!(moves >= 6_000 && met > 700, "{moves} moves, {met} hits");
}

/// The clutter with belts, and with bodies that move and turn.
fn moving_clutter(random: &mut Random) -> Vec<BodyDef> {
    let mut bodies = clutter(random, true);
    for (i, def) in bodies.iter_mut().enumerate() {
        def.colliders[0].material.surface_speed = random.number(fx!(-4)..=fx!(4));
        def.kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][i % 3];
        def.gravity_scale = fx!(0);
        if def.kind != BodyKind::Static {
            let mut number = |max: Fx| random.number(-max..=max);
            def.velocity = Vec2::new(number(fx!(3)), number(fx!(3)));
            def.angular_velocity = number(fx!(1));
        }
    }
    bodies
}

#[test]
fn a_mirror_image_rides_and_pushes_before_a_step_as_the_mirror_image_does() {
    let (mirror, mut rides, mut pushed, mut held_back) = (Symmetry::MIRROR, 0, 0, 0);
    for seed in 0..24 {
        let random = &mut Random::seeded(run_seed(2_000 + seed));
        let mut world = world_of(moving_clutter(random));
        let mut image = mirror.world(&world).expect("an image");
        let hero = Character { push_mass: fx!(2), ..any_hero(random) };
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let image_hero = Character { shape: mirror.shape(&hero.shape).unwrap(), ..hero.clone() };
        let (mut walk, mut image_walk) = (Walk::new(hero, place), Walk::new(image_hero, mirror.point(place).unwrap()));
        for i in 0..60 {
            let way = Vec2::new(random.number(fx!(-0.4)..=fx!(0.4)), random.number(fx!(-0.4)..=fx!(0.1)));
            let go = |world: &mut World, walk: &mut Walk, way: Vec2| {
                let queries = world.queries_after_step();
                let moved = walk.hero.translate(&queries, walk.position, walk.ground, way, &ALL).expect("a movement");
                let pushes = walk.hero.push(world, &moved);
                pushes.iter().for_each(|push| _ = world.execute(push).expect("an impulse"));
                world.step();
                (walk.position, walk.ground) = (moved.position, moved.ground);
                (moved, pushes)
            };
            let (moved, pushes) = go(&mut world, &mut walk, way);
            let (image_moved, image_pushes) = go(&mut image, &mut image_walk, mirror.vector(way).unwrap());
            assert_eq!(mirror.point(moved.position), Some(image_moved.position), "seed {seed}, move {i}: {way}");
            let vectors = [moved.ground_velocity, moved.held_back].map(|vector| mirror.vector(vector).unwrap());
            assert_eq!(vectors, [image_moved.ground_velocity, image_moved.held_back], "seed {seed}, move {i}");
            let pushes: Vec<_> = pushes.iter().map(|push| mirror.command(push).expect("an image")).collect();
            assert_eq!(pushes, image_pushes, "seed {seed}, move {i}");
            rides += usize::from(moved.ground_velocity != vec2(0, 0));
            pushed += pushes.len();
            held_back += usize::from(moved.held_back != vec2(0, 0));
        }
    }
    assert!(rides > 60 && pushed > 40 && held_back > 40, "{rides} rides, {pushed} pushes, {held_back} held back");
}

#[test]
fn the_order_in_which_a_world_was_built_makes_no_difference() {
    let mut hits = 0;
    for seed in 0..60 {
        let random = &mut Random::seeded(run_seed(seed));
        let bodies = clutter(random, true);
        let (world, reordered) = (world_of(bodies.clone()), world_of(bodies.into_iter().rev()));
        let hero = any_hero(random);
        let Some(place) = free_place(random, &world, &hero) else { continue };
        let (mut a, mut b) = (Walk::new(hero.clone(), place), Walk::new(hero, place));
        for _ in 0..60 {
            let way = Vec2::new(random.number(fx!(-0.4)..=fx!(0.4)), random.number(fx!(-0.4)..=fx!(0.3)));
            let [a, b] = [a.go(&world, way), b.go(&reordered, way)];
            assert_eq!(a.position, b.position);
            let keys = |world: &World, moved: &Movement| -> Vec<u64> {
                moved.hits.iter().map(|hit| world.collider(hit.collider).unwrap().key).collect()
            };
            assert_eq!(keys(&world, &a), keys(&reordered, &b));
            hits += a.hits.len();
        }
    }
    assert!(hits > 200, "{hits} hits");
}
