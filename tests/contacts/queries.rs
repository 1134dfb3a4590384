//! Queries on worlds: against each collider in a world of its own, in restored, copied and shuffled worlds, mirrored, and between changes.

use super::scenes::through_bytes;
use crate::seeds::run_seed;
use umbra_physics::{
    Aabb, BodyDef, BodyId, BodyKind, CastHit, ClosestPoint, ColliderDef, ColliderId, Error, Filter, Fx, Part, Quantity,
    Queries, QueryFilter, Random, Shape, Symmetry, Vec2, World, WorldDef, fx, limits, vec2,
};

const ALL: QueryFilter<'_> = QueryFilter { filter: None, without_bodies: &[], without_colliders: &[], predicate: None };

/// A multiple of ½ m or any number up to `most` m either way.
fn length(random: &mut Random, max: i64) -> Fx {
    if random.below(2) == 0 {
        Fx::from_bits(random.integer(-2 * max..=2 * max) << 31)
    } else {
        random.number(-Fx::from(max as i32)..=Fx::from(max as i32))
    }
}

fn point(random: &mut Random, max: i64) -> Vec2 {
    Vec2::new(length(random, max), length(random, max))
}

fn angle(random: &mut Random) -> Fx {
    if random.below(2) == 0 { fx!(0) } else { random.number(fx!(-4)..=fx!(4)) }
}

/// A shape of any kind but a chain.
fn shape(random: &mut Random) -> Shape {
    let size = |random: &mut Random| length(random, 2).abs() + fx!(0.25);
    let corners = [vec2(0, 0), vec2(3, fx!(0.5)), vec2(2, 2), vec2(0, 1)];
    match random.below(7) {
        0 => Shape::circle(size(random)),
        1 => Shape::capsule(size(random), size(random)),
        2 => Shape::polygon(&corners),
        3 => Shape::rounded_polygon(&corners[..3], size(random)),
        4 => Shape::segment(vec2(0, 0), Vec2::new(size(random), size(random))),
        5 => {
            let part = |shape: Shape, x: i32, angle: Fx| Part { shape, position: vec2(x, 0), angle, density: fx!(1) };
            let wheel = Shape::circle(fx!(0.5)).expect("a disc");
            let bar = Shape::rectangle(2, fx!(0.5)).expect("a bar");
            Shape::compound(&[part(wheel.clone(), -1, fx!(0)), part(bar, 0, fx!(0.5)), part(wheel, 1, fx!(0))])
        }
        _ => Shape::rectangle(size(random), size(random)),
    }
    .expect("a shape")
}

/// Bodies of all kinds with one collider or two; keys tell all colliders apart.
fn scene(random: &mut Random, count: u64) -> Vec<BodyDef> {
    let mut key = 0;
    let mut collider = |random: &mut Random, shape: Shape| {
        key += 1;
        ColliderDef {
            key: key * 7919 % 1009,
            position: if random.below(2) == 0 { vec2(0, 0) } else { point(random, 1) },
            angle: angle(random),
            filter: Filter { category: 1 << random.below(3), ..Filter::default() },
            ..ColliderDef::new(shape)
        }
    };
    let mut body = |random: &mut Random| {
        let kind =
            [BodyKind::Static, BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][random.below(4) as usize];
        let body_shape = if kind == BodyKind::Static && random.below(4) == 0 {
            let points = [vec2(4, 1), vec2(1, 0), vec2(-1, 0), vec2(-4, 2)];
            Shape::chain(&points, random.below(2) == 0).expect("a chain")
        } else {
            shape(random)
        };
        let mut colliders = vec![collider(random, body_shape)];
        if random.below(3) == 0 {
            let more = shape(random);
            colliders.push(collider(random, more));
        }
        BodyDef { kind, position: point(random, 12), angle: angle(random), colliders, ..BodyDef::dynamic() }
    };
    (0..count).map(|_| body(random)).collect()
}

fn build(bodies: &[BodyDef]) -> World {
    let mut world = World::new(WorldDef::default()).expect("a world");
    for body in bodies {
        world.add_body(body.clone()).expect("a body");
    }
    world
}

/// A collider as each query reports it, by its key.
#[derive(Clone, Debug, PartialEq)]
enum Said {
    Cast(u64, Fx, Vec2, Vec2, u32),
    Near(u64, Fx, Vec2, u32),
    Overlaps(u64),
}

fn key(world: &World, collider: ColliderId) -> u64 {
    world.collider(collider).expect("a collider").key
}

fn casts(world: &World, hits: &[CastHit]) -> Vec<Said> {
    hits.iter()
        .inspect(|hit| assert_eq!(world.collider_body(hit.collider), Ok(hit.body)))
        .map(|hit| Said::Cast(key(world, hit.collider), hit.fraction, hit.point, hit.normal, hit.part))
        .collect()
}

fn nears(world: &World, all: &[ClosestPoint]) -> Vec<Said> {
    all.iter()
        .map(|closest| Said::Near(key(world, closest.collider), closest.distance, closest.point, closest.part))
        .collect()
}

fn overlaps(world: &World, all: &[ColliderId]) -> Vec<Said> {
    all.iter().map(|&id| Said::Overlaps(key(world, id))).collect()
}

/// A query of any kind.
#[derive(Clone, Debug)]
enum Query {
    Ray(Vec2, Vec2),
    Cast(Shape, Vec2, Fx, Vec2),
    Near(Vec2, Fx),
    Overlap(Shape, Vec2, Fx),
    Box(Aabb),
    Point(Vec2),
}

fn query(random: &mut Random) -> Query {
    let from = point(random, 15);
    let translation = match random.below(3) {
        0 => vec2(length(random, 20), 0),
        _ => point(random, 20),
    };
    match random.below(8) {
        0..3 => Query::Ray(from, translation),
        3 => Query::Cast(shape(random), from, angle(random), translation),
        4 => Query::Near(from, length(random, 8).abs()),
        5 => Query::Overlap(shape(random), from, angle(random)),
        6 => Query::Box(Aabb { min: from.min(from + translation), max: from.max(from + translation) }),
        _ => Query::Point(from),
    }
}

/// The answer to a query, sorted, once it is found that calls for the first ones agree with it.
fn ask(world: &World, queries: &Queries<'_>, query: &Query, filter: &QueryFilter<'_>) -> Vec<Said> {
    match query {
        Query::Ray(from, translation) => {
            let all = queries.cast_ray_all(*from, *translation, filter).expect("in range");
            assert_eq!(queries.cast_ray(*from, *translation, filter), Ok(all.first().copied()));
            assert_eq!(queries.cast_ray_any(*from, *translation, filter), Ok(!all.is_empty()));
            let ties = queries.cast_ray_ties(*from, *translation, filter).expect("in range");
            assert!(all.starts_with(&ties) && ties.is_empty() == all.is_empty());
            assert!(ties.is_sorted_by_key(|hit| key(world, hit.collider)));
            assert!(all.is_sorted_by_key(|hit| hit.fraction));
            casts(world, &all)
        }
        Query::Cast(shape, from, angle, translation) => {
            let pose = (*from, *angle);
            let all = queries.cast_shape_all(shape, pose, *translation, filter).expect("in range");
            assert_eq!(queries.cast_shape(shape, pose, *translation, filter), Ok(all.first().copied()));
            let ties = queries.cast_shape_ties(shape, pose, *translation, filter).expect("in range");
            assert!(all.starts_with(&ties) && ties.is_empty() == all.is_empty());
            assert!(all.is_sorted_by_key(|hit| hit.fraction));
            casts(world, &all)
        }
        Query::Near(from, reach) => {
            let all = queries.closest_points(*from, *reach, filter).expect("in range");
            assert_eq!(queries.closest_point(*from, *reach, filter), Ok(all.first().copied()));
            assert!(all.is_sorted_by_key(|closest| closest.distance));
            nears(world, &all)
        }
        Query::Overlap(shape, from, angle) => {
            overlaps(world, &queries.overlap_shape(shape, (*from, *angle), filter).expect("in range"))
        }
        Query::Box(bounds) => overlaps(world, &queries.overlap_box(*bounds, filter).expect("in range")),
        Query::Point(from) => overlaps(world, &queries.overlap_point(*from, filter).expect("in range")),
    }
}

fn name(said: &Said) -> u64 {
    match said {
        Said::Cast(key, ..) | Said::Near(key, ..) | Said::Overlaps(key) => *key,
    }
}

#[test]
fn a_world_finds_what_worlds_with_one_collider_each_find() {
    let mut random = Random::seeded(run_seed(1));
    let mut counts = [0; 2];
    for round in 0..60 {
        let mut bodies = scene(&mut random, 40);
        // Each in a group of its own, so that none has a surface with others.
        for collider in bodies.iter_mut().flat_map(|body| &mut body.colliders) {
            collider.filter.group = 1 + collider.key as i32;
        }
        let world = build(&bodies);
        let single = |body: &BodyDef| -> Vec<World> {
            let world_of =
                |collider: &ColliderDef| build(&[BodyDef { colliders: vec![collider.clone()], ..body.clone() }]);
            body.colliders.iter().map(world_of).collect()
        };
        let singles: Vec<World> = bodies.iter().flat_map(single).collect();
        let queries = world.queries();
        for _ in 0..60 {
            let query = query(&mut random);
            let filter = match random.below(3) {
                0 => QueryFilter { filter: Some(Filter { mask: 3, ..Filter::default() }), ..ALL },
                _ => ALL,
            };
            let mut actual = ask(&world, &queries, &query, &filter);
            let mut expected: Vec<Said> =
                singles.iter().flat_map(|single| ask(single, &single.queries(), &query, &filter)).collect();
            counts[usize::from(expected.len() > 1)] += 1;
            actual.sort_by_key(name);
            expected.sort_by_key(name);
            assert_eq!(actual, expected, "{round}: {query:?}");
        }
    }
    assert!(counts[1] > 1000, "{counts:?}");
}

#[test]
fn restored_copied_and_shuffled_worlds_give_the_same_answers() {
    let mut random = Random::seeded(run_seed(2));
    for _ in 0..20 {
        let mut bodies = scene(&mut random, 50);
        let mut world = build(&bodies);
        random.shuffle(&mut bodies);
        let mut shuffled = build(&bodies);
        for steps in [0, 1, 3] {
            for _ in 0..steps {
                world.step();
                shuffled.step();
            }
            let restored = through_bytes(&world);
            let mut copy = World::new(WorldDef::default()).expect("a world");
            copy.clone_from(&world);
            let [queries_here, back, copied, others] = [&world, &restored, &copy, &shuffled].map(World::queries);
            for _ in 0..40 {
                let query = query(&mut random);
                let expected = ask(&world, &queries_here, &query, &ALL);
                assert_eq!(ask(&restored, &back, &query, &ALL), expected, "restored: {query:?}");
                assert_eq!(ask(&copy, &copied, &query, &ALL), expected, "copied: {query:?}");
                assert_eq!(ask(&shuffled, &others, &query, &ALL), expected, "shuffled: {query:?}");
            }
        }
    }
}

/// The mirror image of an answer at the line x = 0; without the part, as the segments of a mirrored chain run the other way.
fn image(said: Said, is_mirrored: bool) -> Said {
    let image = |v: Vec2| if is_mirrored { Vec2::new(-v.x, v.y) } else { v };
    match said {
        Said::Cast(key, fraction, point, normal, _) => Said::Cast(key, fraction, image(point), image(normal), 0),
        Said::Near(key, distance, point, _) => Said::Near(key, distance, image(point), 0),
        Said::Overlaps(key) => Said::Overlaps(key),
    }
}

#[test]
fn a_mirrored_world_has_the_mirrored_answers() {
    let mut random = Random::seeded(run_seed(3));
    let mut count = 0;
    for _ in 0..20 {
        let world = build(&scene(&mut random, 50));
        let mirrored = Symmetry::MIRROR.world(&world).expect("a mirror image");
        let [queries_here, others] = [&world, &mirrored].map(World::queries);
        let across = |v: Vec2| Vec2::new(-v.x, v.y);
        for _ in 0..60 {
            let (from, translation) = (point(&mut random, 15), point(&mut random, 20));
            let reach = length(&mut random, 8).abs();
            let queries = [
                [Query::Ray(from, translation), Query::Ray(across(from), across(translation))],
                [Query::Near(from, reach), Query::Near(across(from), reach)],
                [Query::Point(from), Query::Point(across(from))],
            ];
            for [query, mirror] in queries {
                let answer = ask(&world, &queries_here, &query, &ALL);
                let expected: Vec<Said> = answer.into_iter().map(|said| image(said, true)).collect();
                let actual: Vec<Said> =
                    ask(&mirrored, &others, &mirror, &ALL).into_iter().map(|said| image(said, false)).collect();
                assert_eq!(actual, expected, "{query:?}");
                count += expected.len();
            }
        }
    }
    assert!(count > 1000, "{count}");
}

#[test]
fn answers_follow_every_change_between_steps() {
    let mut random = Random::seeded(run_seed(4));
    let mut world = build(&scene(&mut random, 30));
    for round in 0..400 {
        let bodies: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
        let body = bodies[random.below(bodies.len() as u64) as usize];
        let colliders: Vec<ColliderId> = world.colliders().map(|(id, _)| id).collect();
        // Calls that are refused change nothing.
        _ = match random.below(12) {
            0 | 1 => world.set_position(body, point(&mut random, 12)),
            2 => world.set_angle(body, angle(&mut random)),
            3 => world.disable(body),
            4 => world.enable(body),
            5 => world.set_kind(body, [BodyKind::Static, BodyKind::Dynamic][random.below(2) as usize]),
            6 => world.add_collider(body, shape(&mut random)).map(|_| ()),
            7 if colliders.len() > 20 => {
                world.remove_collider(colliders[random.below(colliders.len() as u64) as usize])
            }
            8 => world.add_body(scene(&mut random, 1).remove(0)).map(|_| ()),
            9 if bodies.len() > 20 => world.remove_body(body).map(|_| ()),
            _ => Ok(()),
        };
        if random.below(3) == 0 {
            world.step();
        }
        let fresh = through_bytes(&world);
        let [queries_here, others] = [&world, &fresh].map(World::queries);
        for _ in 0..6 {
            let query = query(&mut random);
            assert_eq!(
                ask(&world, &queries_here, &query, &ALL),
                ask(&fresh, &others, &query, &ALL),
                "{round}: {query:?}"
            );
        }
    }
}

fn three_discs() -> (World, [BodyId; 3]) {
    let disc = |x: i32| BodyDef {
        position: vec2(x, 0),
        ..BodyDef::dynamic().with_collider(Shape::circle(1).expect("a disc"))
    };
    let mut world = World::new(WorldDef::default()).expect("a world");
    let ids = [3, 6, 9].map(|x| world.add_body(disc(x)).expect("a disc"));
    (world, ids)
}

fn bodies_on_ray(world: &World, filter: &QueryFilter<'_>) -> Vec<BodyId> {
    let hits = world.queries().cast_ray_all(vec2(0, 0), vec2(20, 0), filter).expect("in range");
    hits.iter().map(|hit| hit.body).collect()
}

#[test]
fn sleeping_bodies_are_found_and_disabled_ones_are_not() {
    let (mut world, [first, second, third]) = three_discs();
    (0..60).for_each(|_| _ = world.step());
    assert_eq!((world.moving_count(), bodies_on_ray(&world, &ALL)), (0, vec![first, second, third]));
    world.disable(second).expect("a body");
    assert_eq!(bodies_on_ray(&world, &ALL), [first, third]);
    world.enable(second).expect("a body");
    assert_eq!(bodies_on_ray(&world, &ALL), [first, second, third]);
}

#[test]
fn a_predicate_is_asked_in_the_order_of_the_results_and_no_further_than_needed() {
    let (world, [first, second, third]) = three_discs();
    let asked = core::cell::RefCell::new(Vec::new());
    let is_third = |id, _: &ColliderDef| {
        let body = world.collider_body(id).expect("a collider");
        asked.borrow_mut().push(body);
        body != first
    };
    let filter = QueryFilter { predicate: Some(&is_third), ..ALL };
    let hit = world.queries().cast_ray(vec2(0, 0), vec2(20, 0), &filter).expect("in range").expect("a hit");
    assert_eq!((hit.body, asked.take()), (second, vec![first, second]));
    assert_eq!(world.queries().cast_ray_any(vec2(0, 0), vec2(20, 0), &filter), Ok(true));
    assert_eq!(asked.take(), [first, second]);
    assert_eq!((bodies_on_ray(&world, &filter), asked.take()), (vec![second, third], vec![first, second, third]));
    let without = QueryFilter { without_bodies: &[second], ..filter };
    assert_eq!((bodies_on_ray(&world, &without), asked.take()), (vec![third], vec![first, third]));
}

#[test]
fn a_predicate_leaves_colliders_out_of_ties_overlaps_and_closest_points() {
    // Two pairs of tiles: a ray into the seam of a pair meets both tiles at once.
    let mut world = World::new(WorldDef::default()).expect("a world");
    for (key, y) in [(0, 1), (1, -1), (2, 1), (3, -1)] {
        let tile = ColliderDef { key, ..Shape::rectangle(2, 2).expect("a tile").into() };
        let x = if key < 2 { 4 } else { 9 };
        world.add_body(BodyDef { position: vec2(x, y), ..BodyDef::fixed().with_collider(tile) }).expect("a tile");
    }
    let queries = world.queries();
    let keys = |ids: Vec<ColliderId>| ids.into_iter().map(|id| key(&world, id)).collect::<Vec<_>>();
    let ball = Shape::circle(fx!(0.5)).expect("a ball");
    let first: &dyn Fn(ColliderId, &ColliderDef) -> bool = &|_, def| def.key != 0;
    let second: &dyn Fn(ColliderId, &ColliderDef) -> bool = &|_, def| def.key > 1;
    for (predicate, ties) in [(None, vec![0, 1]), (Some(first), vec![1]), (Some(second), vec![2, 3])] {
        let filter = QueryFilter { predicate, ..ALL };
        let colliders = |hits: Vec<CastHit>| keys(hits.into_iter().map(|hit| hit.collider).collect());
        let hits = queries.cast_ray_ties(vec2(0, 0), vec2(20, 0), &filter).expect("in range");
        assert_eq!(colliders(hits), ties);
        let hits = queries.cast_shape_ties(&ball, (vec2(0, 0), fx!(0)), vec2(20, 0), &filter).expect("in range");
        assert_eq!(colliders(hits), ties);
        let nearest = queries.closest_points(vec2(4, 0), fx!(1), &filter).expect("in range");
        let nearest_keys = keys(nearest.into_iter().map(|point| point.collider).collect());
        assert_eq!(nearest_keys, ties.iter().copied().filter(|key| *key < 2).collect::<Vec<_>>());
        assert_eq!(keys(queries.overlap_point(vec2(4, 0), &filter).expect("in range")), nearest_keys);
    }
    let named = keys(queries.overlap_point(vec2(4, 0), &ALL).expect("in range"));
    let without = queries.overlap_point(vec2(4, 0), &ALL).expect("in range");
    let filter = QueryFilter { without_colliders: &without[..1], ..ALL };
    assert_eq!((named, keys(queries.overlap_point(vec2(4, 0), &filter).expect("in range"))), (vec![0, 1], vec![1]));
}

#[test]
fn a_compound_that_is_cast_stops_where_its_first_part_does() {
    let part = |y: i32, x: Fx| Part {
        shape: Shape::circle(fx!(0.5)).expect("a disc"),
        position: Vec2::new(x, y.into()),
        angle: fx!(0),
        density: fx!(1),
    };
    let mut world = World::new(WorldDef::default()).expect("a world");
    let wall = BodyDef { position: vec2(10, 0), ..BodyDef::fixed() };
    world.add_body(wall.with_collider(Shape::rectangle(2, 20).expect("a wall"))).expect("a body");
    // The centre of mass is in the middle: parts that are 1 m before or behind it. Of two that arrive at once the first one counts.
    for (offsets, fraction, y) in
        [([fx!(1), fx!(-1)], fx!(0.75), 3), ([fx!(-1), fx!(1)], fx!(0.75), -3), ([fx!(0), fx!(0)], fx!(0.85), 3)]
    {
        let shape = Shape::compound(&[part(3, offsets[0]), part(-3, offsets[1])]).expect("two discs");
        let hit = world.queries().cast_shape(&shape, (vec2(0, 0), fx!(0)), vec2(10, 0), &ALL).expect("in range");
        let hit = hit.expect("the wall");
        assert!((hit.fraction - fraction).abs() <= Fx::from_bits(2), "{}", hit.fraction);
        assert_eq!(hit.point, vec2(9, y));
    }
}

#[test]
fn contacts_of_a_body_are_those_on_either_side_and_no_others() {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    let square = || Shape::rectangle(1, 1).expect("a square");
    let ground = BodyDef { position: vec2(0, -1), ..BodyDef::fixed() };
    let ground = world.add_body(ground.with_collider(Shape::rectangle(20, 2).expect("a ground"))).expect("a body");
    let at = |x: i32, y: Fx| BodyDef { position: Vec2::new(x.into(), y), ..BodyDef::dynamic().with_collider(square()) };
    let [low, high, alone] =
        [at(0, fx!(0.5)), at(0, fx!(1.5)), at(4, fx!(0.5))].map(|def| world.add_body(def).expect("a body"));
    (0..30).for_each(|_| _ = world.step());
    let others = |body: BodyId| -> Vec<BodyId> {
        let contacts = world.contacts_of(body).expect("a body");
        let mut all: Vec<_> = contacts.flat_map(|contact| contact.bodies).filter(|id| *id != body).collect();
        all.sort_unstable();
        all
    };
    assert_eq!([low, high, alone, ground].map(others), [vec![ground, high], vec![low], vec![ground], vec![low, alone]]);
}

#[test]
fn arguments_out_of_range_are_refused() {
    let (world, _) = three_discs();
    let queries = world.queries();
    let out = |quantity| Some(Error::OutOfRange { quantity });
    let limit = limits::QUERY;
    let ray = |from: Vec2, translation: Vec2| queries.cast_ray(from, translation, &ALL).err();
    assert_eq!(ray(vec2(0, 0), Vec2::new(limit, -limit)), None);
    assert_eq!(ray(vec2(0, 0), Vec2::new(limit + Fx::DELTA, fx!(0))), out(Quantity::Query));
    assert_eq!(ray(Vec2::new(limits::POSITION, fx!(0)), vec2(0, 0)), None);
    assert_eq!(ray(Vec2::new(limits::POSITION + Fx::DELTA, fx!(0)), vec2(0, 0)), out(Quantity::Position));
    assert_eq!(queries.closest_point(vec2(0, 0), limit, &ALL).map(|closest| closest.is_some()), Ok(true));
    assert_eq!(queries.closest_point(vec2(0, 0), limit + Fx::DELTA, &ALL).err(), out(Quantity::Query));
    assert_eq!(queries.closest_point(vec2(0, 0), -Fx::DELTA, &ALL).err(), out(Quantity::Query));
    // A disc that is as far away as it may be.
    assert_eq!(queries.closest_point(vec2(3, 5), fx!(4), &ALL).map(|closest| closest.is_some()), Ok(true));
    assert_eq!(queries.closest_point(vec2(3, 5), fx!(4) - Fx::DELTA, &ALL), Ok(None));
    for backwards in [Aabb { min: vec2(1, 0), max: vec2(0, 1) }, Aabb { min: vec2(0, 1), max: vec2(1, 0) }] {
        assert_eq!(queries.overlap_box(backwards, &ALL).err(), out(Quantity::Query));
    }
    let chain = Shape::chain(&[vec2(1, 0), vec2(0, 0)], false).expect("a chain");
    assert_eq!(queries.overlap_shape(&chain, (vec2(0, 0), fx!(0)), &ALL), Err(Error::DynamicChain));
    assert_eq!(queries.cast_shape(&chain, (vec2(0, 0), fx!(0)), vec2(1, 0), &ALL), Err(Error::DynamicChain));
    // At the ends of the range of positions.
    let mut world = World::new(WorldDef::default()).expect("a world");
    let disc = BodyDef::fixed().with_collider(Shape::circle(limits::SIZE_MAX).expect("a disc"));
    for x in [-limits::POSITION, limits::POSITION] {
        world.add_body(BodyDef { position: vec2(x, 0), ..disc.clone() }).expect("a disc");
    }
    for sign in [1, -1] {
        let end = limits::POSITION * sign;
        let from = vec2(end - limit * sign, 0);
        let hit = world.queries().cast_ray(from, vec2(limit * sign, 0), &ALL).expect("in range").expect("a hit");
        assert_eq!((hit.point, hit.normal), (vec2(end - limits::SIZE_MAX * sign, 0), vec2(-sign, 0)));
        let closest = world.queries().closest_point(from, limit, &ALL).expect("in range").expect("a disc");
        assert_eq!((closest.point, closest.distance), (hit.point, limit - limits::SIZE_MAX));
    }
}

/// A row of static tiles and a ball far above them, after a step: steps keep the tree of what stands.
fn tiles() -> (World, Vec<ColliderId>) {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let tile = BodyDef::fixed().with_collider(Shape::rectangle(2, 2).expect("a tile"));
    for x in 0..8 {
        world.add_body(BodyDef { position: vec2(4 * x, 0), ..tile.clone() }).expect("a tile");
    }
    let ball = BodyDef::dynamic().with_collider(Shape::circle(1).expect("a ball"));
    world.add_body(BodyDef { position: vec2(0, 100), ..ball }).expect("a ball");
    world.step();
    let ids = world.colliders().map(|(id, _)| id).take(8).collect();
    (world, ids)
}

/// The height at which a ray from above, beside the middle of the first tile, ends.
fn height(world: &World) -> Option<Fx> {
    let from = Vec2::new(fx!(0.75), fx!(9));
    world.queries().cast_ray(from, vec2(0, -10), &ALL).expect("in range").map(|hit| hit.point.y)
}

#[test]
fn another_shape_of_the_same_box_is_the_one_that_is_hit() {
    let (mut world, ids) = tiles();
    assert_eq!(height(&world), Some(fx!(1)));
    world.set_collider(ids[0], Shape::circle(1).expect("a disc")).expect("a collider");
    world.step();
    assert!(height(&world).is_some_and(|y| y < fx!(0.67) && y > fx!(0.66)));
    world.set_collider(ids[0], Shape::rectangle(2, 2).expect("a tile")).expect("a collider");
    world.step();
    assert_eq!(height(&world), Some(fx!(1)));
}

#[test]
fn copies_that_share_a_tree_find_what_the_others_have_lost() {
    let (mut world, ids) = tiles();
    let mut copy = World::new(WorldDef::default()).expect("a world");
    copy.clone_from(&world);
    world.remove_collider(ids[0]).expect("a collider");
    world.step();
    // The first query makes the tree that both share.
    assert_eq!(height(&world), None);
    copy.step();
    assert_eq!(height(&copy), Some(fx!(1)));
    assert_eq!(height(&world), None);
}

#[test]
fn a_tile_that_begins_or_ends_to_move_is_where_it_is() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let tile = BodyDef::fixed().with_collider(Shape::rectangle(2, 2).expect("a tile"));
    // Without other static bodies, which change their places among bodies.
    let tile = world.add_body(tile).expect("a tile");
    let ball = BodyDef::dynamic().with_collider(Shape::circle(1).expect("a ball"));
    world.add_body(BodyDef { position: vec2(0, 100), ..ball }).expect("a ball");
    world.step();
    assert_eq!(height(&world), Some(fx!(1)));
    world.set_kind(tile, BodyKind::Kinematic).expect("a tile");
    // Lower, so that it would be hit in its old place first.
    world.set_position(tile, vec2(0, -1)).expect("a tile");
    assert_eq!(height(&world), Some(fx!(0)));
    world.step();
    world.set_kind(tile, BodyKind::Static).expect("a tile");
    assert_eq!(height(&world), Some(fx!(0)));
    world.set_position(tile, vec2(0, 1)).expect("a tile");
    assert_eq!(height(&world), Some(fx!(2)));
}
