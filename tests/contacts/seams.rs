//! Normals of rays and casts that end exactly on a seam: the normal of the surface that goes on over it.

use umbra_physics::{
    BodyDef, BodyKind, CastHit, ColliderDef, Filter, Fx, Part, QueryFilter, Shape, Vec2, World, WorldDef, fx, vec2,
};

const ALL: QueryFilter<'_> = QueryFilter { filter: None, without_bodies: &[], without_colliders: &[], predicate: None };

/// The ways in which a row of tiles is made.
const ROWS: [&str; 6] = ["static bodies", "one static body", "one moving body", "a compound", "a chain", "backwards"];

/// A row of so many square tiles with centres at (0, −½), (1, −½) and so on: its top is the line y = 0.
fn row(way: &str, count: i32) -> World {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let tile = Shape::rectangle(1, 1).expect("a tile");
    let place = |x: i32| Vec2::new(x.into(), fx!(-0.5));
    let mut add = |def: BodyDef| _ = world.add_body(def).expect("a body");
    let colliders =
        || (0..count).map(|x| ColliderDef { position: place(x), ..ColliderDef::new(tile.clone()) }).collect();
    match way {
        "static bodies" => {
            (0..count)
                .for_each(|x| add(BodyDef { position: place(x), ..BodyDef::fixed().with_collider(tile.clone()) }));
        }
        "backwards" => {
            let body = BodyDef::fixed().with_collider(tile.clone());
            (0..count).rev().for_each(|x| add(BodyDef { position: place(x), ..body.clone() }));
        }
        "one static body" => add(BodyDef { colliders: colliders(), ..BodyDef::fixed() }),
        "one moving body" => add(BodyDef { kind: BodyKind::Kinematic, colliders: colliders(), ..BodyDef::default() }),
        "a compound" => {
            let part = |x| Part { shape: tile.clone(), position: place(x), angle: fx!(0), density: fx!(1) };
            let shape = Shape::compound(&(0..count).map(part).collect::<Vec<_>>()).expect("a row");
            let position = shape.shift();
            add(BodyDef { position, ..BodyDef::fixed().with_collider(shape) });
        }
        _ => {
            let end = |x: i32| Vec2::new(Fx::from(x) - fx!(0.5), fx!(0));
            let points: Vec<Vec2> = (0..=count).rev().map(end).collect();
            add(BodyDef::fixed().with_collider(Shape::chain(&points, false).expect("a chain")));
        }
    }
    world
}

fn eighths(n: i64) -> Fx {
    Fx::from_bits(n << 29)
}

fn normals(hits: Vec<CastHit>) -> Vec<Vec2> {
    hits.into_iter().map(|hit| hit.normal).collect()
}

#[test]
fn rays_from_the_grid_meet_the_row_and_not_its_tiles() {
    for way in ROWS {
        let world = row(way, 12);
        let queries = world.queries();
        let mut seams = 0;
        for x in 16..=64 {
            for k in -16..=16 {
                let (from, translation) = (Vec2::new(eighths(x), fx!(1)), Vec2::new(eighths(2 * k), fx!(-2)));
                let ties = queries.cast_ray_ties(from, translation, &ALL).expect("in range");
                seams += usize::from(ties.len() > 1);
                assert!(!ties.is_empty());
                assert!(normals(ties).iter().all(|normal| *normal == vec2(0, 1)), "{way}: {from} {translation}");
            }
        }
        assert!(seams > 50 || way == "a compound" || way == "a chain" || way.starts_with("one"), "{way} {seams}");
    }
}

#[test]
fn a_ray_meets_a_compound_by_itself_as_it_meets_it_in_a_world() {
    let part = |x: i32| Part {
        shape: Shape::rectangle(1, 1).expect("a tile"),
        position: vec2(x, 0),
        angle: fx!(0),
        density: fx!(1),
    };
    let shape = Shape::compound(&[part(-1), part(0), part(1)]).expect("three tiles");
    for k in -4..=4 {
        let hit = shape.cast_ray(Vec2::new(fx!(0.5) - eighths(k), fx!(1.5)), Vec2::new(eighths(2 * k), fx!(-2)));
        let hit = hit.expect("in range").expect("a tile");
        assert_eq!((hit.point, hit.normal), (Vec2::new(fx!(0.5), fx!(0.5)), vec2(0, 1)), "{k}");
    }
    // The corner of the whole is one.
    let hit = shape.cast_ray(vec2(2, 1), vec2(-1, -1)).expect("in range").expect("a corner");
    let diagonal = vec2(1, 1).normalize().expect("a direction");
    assert_eq!((hit.point, hit.normal), (vec2(fx!(1.5), fx!(0.5)), diagonal));
}

#[test]
fn shapes_that_land_flat_from_the_grid_meet_the_row_and_not_its_tiles() {
    let square = Shape::rectangle(1, 1).expect("a square");
    let tip = Shape::polygon(&[vec2(0, 0), vec2(1, 1), vec2(-1, 1)]).expect("a triangle on its tip");
    let base = Shape::polygon(&[vec2(-1, 0), vec2(1, 0), vec2(0, 1)]).expect("a triangle on its base");
    let pair = [-1, 1].map(|x| Part {
        shape: square.clone(),
        position: Vec2::new(eighths(4 * x), fx!(0)),
        angle: fx!(0),
        density: fx!(1),
    });
    let shapes = [
        square.clone(),
        Shape::rectangle(3, fx!(0.5)).expect("a plank"),
        Shape::compound(&pair).expect("two squares"),
        tip,
        base,
        Shape::circle(fx!(0.5)).expect("a ball"),
        Shape::capsule(1, fx!(0.25)).expect("a pill"),
    ];
    for way in ROWS {
        let world = row(way, 16);
        let queries = world.queries();
        for shape in &shapes {
            // The tips of the triangles are a third of a metre off the grid: down to where the lowest corner is on it.
            let low = -shape.bounds().min.y;
            for x in 48..=64 {
                for k in -8..=8 {
                    for height in 1..=3 {
                        // They arrive at one half of the way, on the grid of eighths.
                        let from = Vec2::new(eighths(x), low + eighths(2 * height));
                        let translation = Vec2::new(eighths(2 * k), eighths(-4 * height));
                        let hits = queries.cast_shape_ties(shape, (from, fx!(0)), translation, &ALL).expect("in range");
                        assert!(!hits.is_empty(), "{way} {shape:?} {from} {translation}");
                        let met = (hits[0].fraction, normals(hits));
                        assert!(
                            met.0 <= fx!(0.5) && met.0 >= fx!(0.5) - Fx::from_bits(4),
                            "{way} {shape:?} {from} {met:?}"
                        );
                        let is_up = |normal: &Vec2| *normal == vec2(0, 1);
                        assert!(met.1.iter().all(is_up), "{way} {shape:?} {from} {translation} {met:?}");
                    }
                }
            }
        }
    }
}

/// The only hit, or the first of several, of a ray.
fn ray(world: &World, from: Vec2, translation: Vec2) -> Vec<Vec2> {
    normals(world.queries().cast_ray_ties(from, translation, &ALL).expect("in range"))
}

/// A static polygon or several.
fn polygons(all: &[&[Vec2]]) -> World {
    let mut world = World::new(WorldDef::default()).expect("a world");
    for corners in all {
        let shape = Shape::polygon(corners).expect("a polygon");
        world.add_body(BodyDef { position: shape.shift(), ..BodyDef::fixed().with_collider(shape) }).expect("a body");
    }
    world
}

#[test]
fn corners_of_the_surface_are_corners() {
    let diagonal = |x: i32, y: i32| vec2(x, y).normalize().expect("a direction");
    for way in &ROWS[..4] {
        let world = row(way, 4);
        // The ends of the row.
        assert_eq!(ray(&world, vec2(4, fx!(0.5)), vec2(-1, -1)), [diagonal(1, 1)], "{way}");
        assert_eq!(ray(&world, vec2(-1, fx!(0.5)), vec2(1, -1)), [diagonal(-1, 1)], "{way}");
    }
    // A stair: the edge of a step is a corner, though another tile stands below and one beside.
    let tile = Shape::rectangle(1, 1).expect("a tile");
    let mut world = World::new(WorldDef::default()).expect("a world");
    for position in [vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(-1, 1), vec2(-1, 0)] {
        world.add_body(BodyDef { position, ..BodyDef::fixed().with_collider(tile.clone()) }).expect("a tile");
    }
    assert_eq!(ray(&world, vec2(2, 3), vec2(-2, -2)), [diagonal(1, 1)]);
    // The inner corner of the stair: the tiles that are met with their faces have the normals of these, and the tile behind has the mean.
    assert_eq!(ray(&world, vec2(2, 2), vec2(-3, -3)), [diagonal(1, 1), vec2(0, 1), vec2(1, 0)]);
    // One tile alone.
    let world = polygons(&[&[vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)]]);
    assert_eq!(ray(&world, vec2(2, 2), vec2(-2, -2)), [diagonal(1, 1)]);
}

#[test]
fn a_ridge_of_two_pieces_is_that_of_one() {
    // A roof in one piece, and cut below the ridge: slopes of 3 : 4.
    let whole = polygons(&[&[vec2(-4, 0), vec2(4, 0), vec2(0, 3)]]);
    let cut = polygons(&[&[vec2(-4, 0), vec2(0, 0), vec2(0, 3)], &[vec2(0, 0), vec2(4, 0), vec2(0, 3)]]);
    for x in -1..=1 {
        let (from, way) = (vec2(-x, 5), vec2(2 * x, -4));
        assert_eq!(ray(&whole, from, way), [vec2(0, 1)], "{x}");
        for normal in ray(&cut, from, way) {
            assert!(normal.distance(vec2(0, 1)) < Fx::from_bits(8), "{x} {normal}");
        }
    }
    // From the left the left slope is met, and the right one is turned away.
    let left = vec2(-3, 4).normalize().expect("a direction");
    for normal in ray(&cut, vec2(-2, 3), vec2(4, 0)) {
        assert!(normal.distance(left) < Fx::from_bits(8), "{normal}");
    }
    assert_eq!(ray(&whole, vec2(-2, 3), vec2(4, 0)), [left]);
}

#[test]
fn tiles_with_other_filters_or_left_out_of_the_query_have_corners_of_their_own() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let tile = Shape::rectangle(1, 1).expect("a tile");
    let bodies = [(0, 1), (1, 2)].map(|(x, category)| {
        let filter = Filter { category, ..Filter::default() };
        let collider = ColliderDef { filter, ..ColliderDef::new(tile.clone()) };
        world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::fixed().with_collider(collider) }).expect("a tile")
    });
    let diagonal = vec2(1, 1).normalize().expect("a direction");
    assert_eq!(ray(&world, vec2(1, 1), vec2(-1, -1)), [diagonal, vec2(0, 1)]);
    let joined = row("static bodies", 2);
    let second = joined.bodies().nth(1).expect("a body").id();
    let without = QueryFilter { without_bodies: &[second], ..ALL };
    let hit = |filter| joined.queries().cast_ray(Vec2::new(fx!(1), fx!(0.5)), vec2(-1, -1), filter);
    assert_eq!(hit(&ALL).expect("in range").expect("a tile").normal, vec2(0, 1));
    assert_eq!(hit(&without).expect("in range").expect("a tile").normal, diagonal);
    // Bodies that move have no surface with each other.
    for (index, body) in bodies.into_iter().enumerate() {
        world.set_kind(body, [BodyKind::Kinematic, BodyKind::Static][index]).expect("a body");
    }
    assert_eq!(ray(&world, vec2(1, 1), vec2(-1, -1))[0], diagonal);
}

#[test]
fn seams_that_rounding_opens_are_seams() {
    // Tiles of 0.1 m, and a row that is turned: gaps and steps of an ulp.
    let side = fx!(0.1);
    for angle in [fx!(0), fx!(0.3), fx!(-1.1), fx!(2.5)] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let tile = Shape::rectangle(side, side).expect("a tile");
        let (sin, cos) = angle.sin_cos();
        let at = |x: Fx, y: Fx| Vec2::new(x * cos - y * sin, x * sin + y * cos);
        for i in 0..40 {
            let position = at(side * i, -side / 2);
            let body = BodyDef { position, angle, ..BodyDef::fixed().with_collider(tile.clone()) };
            world.add_body(body).expect("a tile");
        }
        let up = at(fx!(0), fx!(1));
        let queries = world.queries();
        let plank = Shape::rectangle(side * 3, side).expect("a plank");
        for i in 10..30 {
            for k in -8..=8 {
                // To the seams, as exactly as rounding lets them be met.
                let seam = at(side * i + side / 2, fx!(0));
                let way = at(eighths(k), fx!(-1));
                let hit = queries.cast_ray(seam - way, way * 2, &ALL).expect("in range").expect("a tile");
                assert!(hit.normal.distance(up) < Fx::from_bits(64), "{angle} {i} {k} {}", hit.normal);
                // A plank of the same angle, with its ends at seams.
                let start = at(side * i, side / 2) - way;
                let hit = queries.cast_shape(&plank, (start, angle), way * 2, &ALL).expect("in range").expect("a tile");
                assert!(hit.normal.distance(up) < Fx::from_bits(64), "{angle} {i} {k} {}", hit.normal);
            }
        }
    }
}
