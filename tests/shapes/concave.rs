//! Concave polygons in convex parts.

use super::exact::{Point, cross, edges, minus, on_grid, point, twice_area};
use crate::seeds::{run_seed, times};
use dashu_int::IBig;
use umbra_physics::{
    BodyDef, Error, Fx, Geometry, Quantity, QueryFilter, Random, Shape, Vec2, World, WorldDef, fx, limits, vec2,
};

/// The corners of the parts in the coordinates of the polygon, ulps.
fn parts(shape: &Shape) -> Vec<Vec<Point>> {
    let corners =
        |outline: &umbra_physics::Outline| outline.corners().iter().map(|&c| point(c + shape.shift())).collect();
    shape.outlines().iter().map(corners).collect()
}

/// The number of corners that turn inwards.
fn reflex_count(corners: &[Point]) -> usize {
    let sign = twice_area(corners);
    let count = corners.len();
    let turn = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| &corners[(i + k) % count]);
        cross(&minus(b, a), &minus(c, b)) * &sign
    };
    (0..count).filter(|&i| turn(i) < IBig::ZERO).count()
}

/// A simple polygon, made from a triangle by corners that are put into its edges wherever the polygon stays simple.
fn simple_polygon(random: &mut Random, count: usize, steps: i64, step: Fx) -> Vec<Vec2> {
    let mut polygon = Vec::new();
    for _ in 0..20 * count {
        if polygon.len() >= count {
            break;
        }
        let corner = on_grid(random, steps, step);
        let place = random.below(polygon.len() as u64 + 1) as usize;
        polygon.insert(place, corner);
        if polygon.len() > 2 && Shape::chain(&polygon, true).is_err() || polygon.len() == 2 && polygon[0] == polygon[1]
        {
            polygon.remove(place);
        }
    }
    polygon
}

#[test]
fn parts_are_convex_cover_the_polygon_exactly_and_are_few() {
    let (mut random, mut most, mut counts) = (Random::seeded(run_seed(22)), 0, [0; 2]);
    for i in 0..times(1_500) {
        let (steps, step) = [(4, fx!(1)), (8, fx!(0.5)), (1 << 20, Fx::from_bits(1 << 20))][i as usize % 3];
        let count = 3 + random.below(30) as usize;
        let polygon = simple_polygon(&mut random, count, steps, step);
        if polygon.len() < 3 {
            continue;
        }
        let shape = Shape::concave_polygon(&polygon).unwrap_or_else(|error| panic!("{error}: {polygon:?}"));
        let corners: Vec<Point> = polygon.iter().map(|&corner| point(corner)).collect();
        let parts = parts(&shape);
        let total = twice_area(&corners);
        let whole = if total < IBig::ZERO { -&total } else { total };
        assert_eq!(parts.iter().map(|part| twice_area(part)).sum::<IBig>(), whole, "{polygon:?}");
        for (number, part) in parts.iter().enumerate() {
            let strict = |(k, (a, b)): (usize, (&Point, &Point))| {
                cross(&minus(b, a), &minus(&part[(k + 2) % part.len()], b)) > IBig::ZERO
            };
            assert!(edges(part).into_iter().enumerate().all(strict), "{polygon:?}");
            assert!(part.iter().all(|corner| corners.contains(corner)), "{polygon:?}");
            // No two parts overlap: an edge of one of them separates them.
            for other in &parts[number + 1..] {
                let separates = |(a, b): &(&Point, &Point), other: &[Point]| {
                    other.iter().all(|corner| cross(&minus(b, a), &minus(corner, a)) <= IBig::ZERO)
                };
                let is_apart = edges(part).iter().any(|edge| separates(edge, other))
                    || edges(other).iter().any(|edge| separates(edge, part));
                assert!(is_apart, "{polygon:?}");
            }
        }
        // Within the polygon: with the area, the same set.
        let reflex = reflex_count(&corners);
        assert!(parts.len() <= 2 * reflex + 1, "{} parts of {reflex}: {polygon:?}", parts.len());
        assert!(parts.len() > reflex.div_ceil(2), "{polygon:?}");
        most = most.max(parts.len());
        counts[usize::from(parts.len() > 1)] += 1;
        // From another corner on, the other way round, and with a corner within a side.
        let mut image = polygon.clone();
        let count = image.len();
        image.rotate_left(random.below(count as u64) as usize);
        if random.below(2) == 0 {
            image.reverse();
        }
        assert_eq!(Shape::concave_polygon(&image).as_ref(), Ok(&shape), "{polygon:?}");
        let middle = (image[0] + image[1]) / 2;
        if middle * 2 == image[0] + image[1] && ![image[0], image[1]].contains(&middle) {
            image.insert(1, middle);
            assert_eq!(Shape::concave_polygon(&image).as_ref(), Ok(&shape), "{polygon:?}");
        }
        // The centre of mass is that of the polygon: a ray from far away meets what the polygon has there.
        assert_eq!(shape.contains(vec2(0, 0)), is_in(&corners, &point(shape.shift())), "{polygon:?}");
    }
    assert!(most > 8 && counts[0] > 20 && counts[1] > 500, "{most} {counts:?}");
}

/// Returns true if a point is in a simple polygon, or on its edges.
fn is_in(corners: &[Point], p: &Point) -> bool {
    let mut is_inside = false;
    for (a, b) in edges(corners) {
        let side = cross(&minus(b, a), &minus(p, a));
        let is_between = (0..2).all(|k| (&p[k] - &a[k]) * (&p[k] - &b[k]) <= IBig::ZERO);
        if side.is_zero() && is_between {
            return true;
        }
        if (a[1] > p[1]) != (b[1] > p[1]) && (side > IBig::ZERO) == (b[1] > a[1]) {
            is_inside = !is_inside;
        }
    }
    is_inside
}

#[test]
fn known_polygons_have_the_fewest_parts() {
    let count = |corners: &[(i32, i32)]| {
        let polygon: Vec<Vec2> = corners.iter().map(|&(x, y)| vec2(x, y)).collect();
        Shape::concave_polygon(&polygon).map(|shape| shape.outlines().len())
    };
    assert_eq!(count(&[(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]), Ok(2)); // L
    assert_eq!(count(&[(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]), Ok(3)); // U
    assert_eq!(count(&[(0, 0), (4, 0), (2, 1), (2, 5)]), Ok(2)); // dart
    assert_eq!(
        count(&[(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)]),
        Ok(3)
    ); // plus
    assert_eq!(count(&[(0, 0), (4, 0), (4, 4), (0, 4)]), Ok(1)); // square
    // A convex polygon is a polygon.
    let square =
        Shape::concave_polygon(&[vec2(0, 0), vec2(1, 0), vec2(2, 0), vec2(2, 2), vec2(0, 2)]).expect("a square");
    assert!(matches!(square.geometry(), Geometry::Polygon { .. }));
    assert_eq!(square, Shape::polygon(&[vec2(0, 0), vec2(2, 0), vec2(2, 2), vec2(0, 2)]).expect("a square"));
    // More corners than a polygon may have.
    let circle: Vec<Vec2> = (0..200)
        .map(|i| {
            let (sin, cos) = (Fx::TAU / 200 * i).sin_cos();
            Vec2::new(cos * 50, sin * 50)
        })
        .collect();
    let shape = Shape::concave_polygon(&circle).expect("a disc of 200 corners");
    assert!(shape.outlines().len() == 4, "{}", shape.outlines().len());
    assert_eq!(shape.outlines().iter().map(|outline| outline.corners().len()).max().map(|most| most <= 64), Some(true));
}

#[test]
fn polygons_that_are_not_simple_are_refused() {
    let refused = |corners: &[Vec2]| Shape::concave_polygon(corners).expect_err("a polygon that is not simple");
    let out_of = |quantity| Error::OutOfRange { quantity };
    // A bow tie, a corner twice, a corner on an edge, a spike, all on one line.
    assert_eq!(refused(&[vec2(0, 0), vec2(2, 2), vec2(2, 0), vec2(0, 2)]), Error::ChainCrosses { segments: [0, 2] });
    assert_eq!(refused(&[vec2(0, 0), vec2(2, 0), vec2(2, 0), vec2(0, 2)]), Error::ChainCrosses { segments: [1, 2] });
    let touching = [vec2(0, 0), vec2(4, 0), vec2(4, 4), vec2(2, 0), vec2(0, 4)];
    assert!(matches!(refused(&touching), Error::ChainCrosses { segments: [0, 2 | 3] }));
    for corners in [
        &[vec2(0, 0), vec2(2, 0), vec2(2, 2), vec2(2, 3), vec2(2, 2)][..],
        &[vec2(0, 0), vec2(1, 1), vec2(2, 2)],
        &[vec2(0, 0), vec2(2, 0), vec2(1, 0), vec2(1, 1)],
    ] {
        assert!(matches!(refused(corners), Error::ChainCrosses { .. }), "{corners:?}");
    }
    assert_eq!(refused(&[vec2(0, 0), vec2(1, 0)]), out_of(Quantity::Count));
    // A comb of so many teeth takes a part for each of them.
    let comb = |teeth: i32| -> Vec<Vec2> {
        let tooth = |i: i32| [vec2(2 * i, 1), vec2(2 * i, 2), vec2(2 * i + 1, 2), vec2(2 * i + 1, 1)];
        let base = [vec2(2 * teeth, 0), vec2(0, 0)];
        (0..teeth).flat_map(tooth).chain(base).collect()
    };
    assert_eq!(Shape::concave_polygon(&comb(100)).map(|shape| shape.outlines().len() > 100), Ok(true));
    assert_eq!(Shape::concave_polygon(&comb(255)).map(|shape| shape.outlines().len()), Ok(limits::PARTS));
    assert_eq!(comb(256).len(), limits::CONCAVE_CORNERS + 2);
    assert_eq!(refused(&comb(256)), out_of(Quantity::Count));
    let far = refused(&[vec2(0, 0), vec2(1, 0), Vec2::new(fx!(0), limits::SIZE_MAX + Fx::DELTA)]);
    assert!(matches!(far, Error::OutOfRange { quantity: Quantity::Size { .. } }), "{far:?}");
}

/// A bowl on the ground: a ball in it is above the bottom, and casts meet the seams of its parts as one surface.
#[test]
fn a_bowl_is_hollow_and_has_no_seams() {
    let polygon = [vec2(-3, 0), vec2(3, 0), vec2(3, 3), vec2(2, 3), vec2(2, 1), vec2(-2, 1), vec2(-2, 3), vec2(-3, 3)];
    let shape = Shape::concave_polygon(&polygon).expect("a bowl");
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    world
        .add_body(BodyDef { position: shape.shift(), ..BodyDef::fixed().with_collider(shape.clone()) })
        .expect("a bowl");
    let queries = world.queries();
    for x in -11..=11 {
        for k in -4..=4 {
            let way = Vec2::new(Fx::from_bits(k << 29), fx!(-1));
            let end = Vec2::new(Fx::from_bits(x << 29), fx!(1));
            let hit =
                queries.cast_ray(end - way, way * 2, &QueryFilter::default()).expect("in range").expect("the bottom");
            assert_eq!((hit.point, hit.normal), (end, vec2(0, 1)), "{x} {k}");
        }
    }
    drop(queries);
    let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5)).expect("a ball"));
    let ball = world.add_body(BodyDef { position: vec2(1, 4), velocity: vec2(-2, 0), ..ball }).expect("a ball");
    (0..600).for_each(|_| _ = world.step());
    let y = world.body(ball).expect("a ball").position().y;
    assert!((y - fx!(1.5)).abs() < fx!(0.01), "{y}");
}
