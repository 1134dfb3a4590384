//! Queries find what looking at each collider finds.
//!
//! An input is bodies and queries. Every query is asked of a world with all bodies, of worlds with one of them each, of the shapes
//! themselves where a body is not turned, of a restored world, and of the mirror image.

use arbitrary::{Arbitrary, Result, Unstructured};
use umbra_physics::{
    Aabb, BodyDef, BodyKind, ColliderDef, ColliderId, Filter, Fx, Geometry, Part, Queries, QueryFilter, Shape,
    Snapshot, Symmetry, Vec2, World, WorldDef, fx, vec2,
};

use super::{number as few_or_many, tally};

/// The target.
pub fn run(data: &[u8]) {
    _ = play(&mut Unstructured::new(data));
}

/// The most bodies and queries of an input, and of one in 16.
const BODIES: [u8; 2] = [6, 24];
const QUERIES: [u8; 2] = [8, 32];
/// The bodies in a row of a pile, and the most steps that it has to fall together.
const ROW: i32 = 3;
const TICKS: [u8; 2] = [6, 20];

/// A number within so many metres: a multiple of ½ m, where ties and grazes are, or any.
fn number(input: &mut Unstructured<'_>, bound: i32) -> Result<Fx> {
    if bool::arbitrary(input)? {
        return Ok(Fx::from_bits(i64::from(i16::arbitrary(input)?).rem_euclid(4 * i64::from(bound) + 1) << 31)
            - Fx::from(bound));
    }
    let whole = i64::from(bound) << 33;
    Ok(Fx::from_bits(i64::arbitrary(input)?.rem_euclid(whole + 1)) - Fx::from(bound))
}

fn vector(input: &mut Unstructured<'_>, bound: i32) -> Result<Vec2> {
    Ok(Vec2::new(number(input, bound)?, number(input, bound)?))
}

/// No turn, or any.
fn angle(input: &mut Unstructured<'_>) -> Result<Fx> {
    if bool::arbitrary(input)? { Ok(fx!(0)) } else { number(input, 4) }
}

/// A shape of any kind; no chain for one that moves.
fn shape(input: &mut Unstructured<'_>, moves: bool) -> Result<Shape> {
    let size = number(input, 2)?.abs() + fx!(0.125);
    let second_size = number(input, 2)?.abs() + fx!(0.125);
    let corners = [vec2(0, 0), Vec2::new(size * 2, fx!(0.5)), Vec2::new(size, second_size + fx!(1)), vec2(0, 1)];
    let shape = match u8::arbitrary(input)? % if moves { 7 } else { 9 } {
        0 => Shape::circle(size),
        1 => Shape::capsule(size, second_size),
        2 => Shape::polygon(&corners),
        3 => Shape::rounded_polygon(&corners[..3], second_size),
        4 => Shape::segment(vec2(0, 0), Vec2::new(size, second_size)),
        5 => {
            let wheel = Shape::circle(second_size).expect("a radius within the limits");
            let part =
                |x: Fx| Part { shape: wheel.clone(), position: Vec2::new(x, fx!(0)), angle: fx!(0), density: fx!(1) };
            Shape::compound(&[part(-size), part(size)])
        }
        6 => Shape::rectangle(size, second_size),
        7 => Shape::chain(
            &[Vec2::new(size, second_size), vec2(0, 0), vec2(-1, 0), Vec2::new(-size - fx!(1), second_size)],
            false,
        ),
        _ => Shape::chain(&[vec2(-2, 0), vec2(0, 2), Vec2::new(size + fx!(1), fx!(0)), vec2(0, -2)], true),
    };
    Ok(shape.unwrap_or_else(|_| Shape::circle(1).expect("a disc")))
}

fn body(input: &mut Unstructured<'_>, key: u64) -> Result<BodyDef> {
    let kind = [BodyKind::Static, BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic]
        [usize::from(u8::arbitrary(input)? % 4)];
    let filter = Filter { category: 1 << (u8::arbitrary(input)? % 3), ..Filter::default() };
    let collider = ColliderDef { key, filter, ..ColliderDef::new(shape(input, kind == BodyKind::Dynamic)?) };
    let (position, angle) = (vector(input, 12)?, angle(input)?);
    Ok(BodyDef { kind, position, angle, colliders: vec![collider], ..BodyDef::dynamic() })
}

enum Query {
    Ray(Vec2, Vec2),
    Cast(Shape, (Vec2, Fx), Vec2),
    Overlap(Shape, (Vec2, Fx)),
    Box(Aabb),
    Point(Vec2),
    Near(Vec2, Fx),
}

impl Query {
    fn of(input: &mut Unstructured<'_>) -> Result<Self> {
        let (kind, from, path) = (u8::arbitrary(input)? % 8, vector(input, 16)?, vector(input, 24)?);
        Ok(match kind {
            0..3 => Self::Ray(from, path),
            3 => Self::Cast(shape(input, true)?, (from, angle(input)?), path),
            4 => Self::Overlap(shape(input, true)?, (from, angle(input)?)),
            5 => Self::Box(Aabb { min: from.min(from + path), max: from.max(from + path) }),
            6 => Self::Point(from),
            _ => Self::Near(from, path.x.abs()),
        })
    }

    /// The mirror image at the line x = 0, of a query whose own image is a query of the same kind.
    fn image(&self) -> Option<Self> {
        let across = |v: Vec2| Vec2::new(-v.x, v.y);
        match *self {
            Self::Ray(from, path) => Some(Self::Ray(across(from), across(path))),
            Self::Point(from) => Some(Self::Point(across(from))),
            Self::Near(from, reach) => Some(Self::Near(across(from), reach)),
            Self::Box(Aabb { min, max }) => {
                Some(Self::Box(Aabb { min: Vec2::new(-max.x, min.y), max: Vec2::new(-min.x, max.y) }))
            }
            Self::Cast(..) | Self::Overlap(..) => None,
        }
    }
}

/// A result: the key, the fraction or the distance, the point, the normal, the part.
type Row = (u64, Fx, Vec2, Vec2, u32);

/// The answer to a query, once the calls for the first results agree with it.
fn ask(world: &World, queries: &Queries<'_>, query: &Query, filter: &QueryFilter<'_>) -> Vec<Row> {
    let key = |collider: ColliderId| world.collider(collider).expect("a collider that was found").key;
    let only = |collider: ColliderId| (key(collider), fx!(0), vec2(0, 0), vec2(0, 0), 0);
    let casts = |all: Vec<umbra_physics::CastHit>, ties: Vec<umbra_physics::CastHit>, first| {
        assert_eq!(first, all.first().copied(), "the first of all");
        assert!(all.starts_with(&ties) && ties.is_empty() == all.is_empty(), "ties come first");
        assert!(ties.is_sorted_by_key(|hit| key(hit.collider)), "ties are sorted by key");
        assert!(all.is_sorted_by_key(|hit| hit.fraction), "hits are sorted");
        all.into_iter().map(|hit| (key(hit.collider), hit.fraction, hit.point, hit.normal, hit.part)).collect()
    };
    let fair = "a query within the limits";
    match query {
        Query::Ray(from, path) => {
            let all = queries.cast_ray_all(*from, *path, filter).expect(fair);
            assert_eq!(queries.cast_ray_any(*from, *path, filter), Ok(!all.is_empty()));
            let ties = queries.cast_ray_ties(*from, *path, filter).expect(fair);
            casts(all, ties, queries.cast_ray(*from, *path, filter).expect(fair))
        }
        Query::Cast(shape, pose, path) => {
            let all = queries.cast_shape_all(shape, *pose, *path, filter).expect(fair);
            let ties = queries.cast_shape_ties(shape, *pose, *path, filter).expect(fair);
            casts(all, ties, queries.cast_shape(shape, *pose, *path, filter).expect(fair))
        }
        Query::Overlap(shape, pose) => {
            queries.overlap_shape(shape, *pose, filter).expect(fair).into_iter().map(only).collect()
        }
        Query::Box(bounds) => queries.overlap_box(*bounds, filter).expect(fair).into_iter().map(only).collect(),
        Query::Point(from) => queries.overlap_point(*from, filter).expect(fair).into_iter().map(only).collect(),
        Query::Near(from, reach) => {
            let all = queries.closest_points(*from, *reach, filter).expect(fair);
            assert_eq!(queries.closest_point(*from, *reach, filter), Ok(all.first().copied()));
            assert!(all.is_sorted_by_key(|closest| closest.distance), "points are sorted");
            all.iter()
                .map(|closest| (key(closest.collider), closest.distance, closest.point, vec2(0, 0), closest.part))
                .collect()
        }
    }
}

/// The answer of the shape alone for a body that is not turned, where there is such a call.
fn of_shape(body: &BodyDef, query: &Query) -> Option<Option<Row>> {
    let ColliderDef { shape, key, .. } = &body.colliders[0];
    let at = body.position;
    if body.angle != fx!(0) {
        return None;
    }
    let fair = "a query within the limits";
    match query {
        Query::Ray(from, path) => {
            let hit = shape.cast_ray(*from - at, *path).expect(fair);
            Some(hit.map(|hit| (*key, hit.fraction, hit.point + at, hit.normal, hit.part)))
        }
        Query::Point(from) => Some(shape.contains(*from - at).then_some((*key, fx!(0), vec2(0, 0), vec2(0, 0), 0))),
        Query::Near(from, reach) => {
            let away = shape.distance(*from - at).expect(fair);
            let point = shape.closest_point(*from - at).expect(fair) + at;
            // Of parts at one distance each call may name another; rounding may be to the limit.
            (away != *reach && shape.outlines().len() == 1)
                .then(|| (away < *reach).then_some((*key, away, point, vec2(0, 0), 0)))
        }
        _ => None,
    }
}

/// Puts the bodies into a pile: those that are not static into rows near each other, on the others or a slab.
fn pile_up(bodies: &mut [BodyDef]) {
    for (i, def) in bodies.iter_mut().enumerate() {
        let place = vec2(i as i32 % ROW - ROW / 2, i as i32 / ROW);
        let offset = def.position.map(|x| x / 32);
        def.position = Vec2::new(place.x + offset.x, place.y + offset.y);
        let is_floor = i == 0;
        if is_floor {
            let slab = Shape::rectangle(24, 2).expect("a slab");
            let collider = ColliderDef { shape: slab, ..def.colliders[0].clone() };
            (def.kind, def.position, def.angle) = (BodyKind::Static, vec2(0, -2), fx!(0));
            def.colliders = vec![collider];
        } else if !matches!(def.colliders[0].shape.geometry(), Geometry::Chain { .. }) {
            def.kind = BodyKind::Dynamic;
        }
    }
}

fn play(input: &mut Unstructured<'_>) -> Result<()> {
    let [is_piled, bodies, queries, ticks]: [u8; 4] = input.arbitrary()?;
    let (is_seamed, is_piled) = (is_piled, is_piled >= 128);
    let [count, queries] = [few_or_many(bodies, BODIES[0], BODIES[1]), few_or_many(queries, QUERIES[0], QUERIES[1])];
    let steps = if is_piled { few_or_many(ticks, TICKS[0], TICKS[1]) } else { usize::from(ticks % 3) };
    let mut bodies = (0..count as u64).map(|i| body(input, i * 5 % 31)).collect::<Result<Vec<_>>>()?;
    if is_piled {
        pile_up(&mut bodies);
    }
    // In groups of their own none has a surface with others, so that normals are compared as well.
    let have_groups = is_seamed % 2 == 0;
    if have_groups {
        bodies.iter_mut().flat_map(|def| &mut def.colliders).for_each(|def| def.filter.group = 1 + def.key as i32);
    }
    let gravity = if is_piled { vec2(0, -10) } else { vec2(0, 0) };
    let mut world = World::new(WorldDef { gravity, ..WorldDef::default() }).expect("a world");
    bodies.retain(|def| world.add_body(def.clone()).is_ok());
    let single = |def: &BodyDef| {
        let mut world = World::new(WorldDef::default()).expect("a world");
        world.add_body(def.clone()).map(|_| world).expect("a body that was added before")
    };
    let singles: Vec<World> = bodies.iter().map(single).collect();
    let mut stepped = world.clone();
    for _ in 0..steps {
        stepped.step();
        tally::count(&stepped);
    }
    let restored = Snapshot::from_bytes(&stepped.snapshot().to_bytes(), &[]).expect("its own bytes").into_world();
    let mirrored = Symmetry::MIRROR.world(&world);
    let (present, after, back) = (world.queries(), stepped.queries(), restored.queries());
    let of_singles: Vec<Queries<'_>> = singles.iter().map(World::queries).collect();
    let of_mirrored = mirrored.as_ref().map(World::queries);
    let mut asked = 0;
    while !input.is_empty() && asked < queries {
        asked += 1;
        let query = Query::of(input)?;
        let mask = if bool::arbitrary(input)? { 3 } else { !0 };
        let filter = QueryFilter { filter: Some(Filter { mask, ..Filter::default() }), ..QueryFilter::default() };
        let all_rows = ask(&world, &present, &query, &filter);
        let mut by_key = all_rows.clone();
        by_key.sort_by_key(|row| row.0);
        let each = |((world, queries), def): ((&World, &Queries<'_>), &BodyDef)| {
            let rows = ask(world, queries, &query, &filter);
            if let (Some(row), true) = (of_shape(def, &query), def.colliders[0].filter.category & mask != 0) {
                assert_eq!(rows.first(), row.as_ref(), "the shape by itself");
            }
            rows
        };
        let mut expected: Vec<Row> = singles.iter().zip(&of_singles).zip(&bodies).flat_map(each).collect();
        expected.sort_by_key(|row| row.0);
        if !have_groups {
            by_key.iter_mut().chain(&mut expected).for_each(|row| row.3 = vec2(0, 0));
        }
        assert_eq!(by_key, expected, "each by itself");
        assert_eq!(ask(&stepped, &after, &query, &filter), ask(&restored, &back, &query, &filter), "restored");
        let (Some(mirrored), Some(of_mirrored), Some(image)) = (&mirrored, &of_mirrored, query.image()) else {
            continue;
        };
        let image_rows = ask(mirrored, of_mirrored, &image, &filter);
        let across = |v: Vec2| if matches!(query, Query::Ray(..) | Query::Near(..)) { Vec2::new(-v.x, v.y) } else { v };
        // Segments of a chain run the other way there: of two at one distance the other one has the lower number.
        let is_chain = |key: u64| {
            let definition = bodies.iter().find(|def| def.colliders[0].key == key);
            definition.is_some_and(|def| matches!(def.colliders[0].shape.geometry(), Geometry::Chain { .. }))
        };
        let may_tie = |key: u64| matches!(query, Query::Near(..)) && is_chain(key);
        let without_part = |row: Row| (row.0, row.1, if may_tie(row.0) { vec2(0, 0) } else { row.2 }, row.3, 0);
        let image_rows: Vec<Row> =
            image_rows.into_iter().map(|row| without_part((row.0, row.1, across(row.2), across(row.3), 0))).collect();
        let here: Vec<Row> = all_rows.into_iter().map(without_part).collect();
        assert_eq!(image_rows, here, "mirrored");
    }
    Ok(())
}
