//! Distances and overlaps of two shapes.

use super::exact::{Gap, Point, corners, gap, is_root, on_grid, point, square_from_rim};
use crate::seeds::{run_seed, times};
use dashu_int::IBig;
use umbra_physics::{Error, Fx, Part, Quantity, Random, Shape, ShapeDistance, Vec2, fx, limits, vec2};

fn shape(random: &mut Random, steps: i64, step: Fx) -> Shape {
    let radius = |random: &mut Random| step * random.integer(1..=steps) as i32;
    let shape = match random.below(6) {
        0 => Shape::circle(radius(random)),
        1 => Shape::capsule(radius(random), radius(random)),
        2 => Shape::segment(on_grid(random, steps, step), on_grid(random, steps, step)),
        3 => Shape::rectangle(radius(random), radius(random)),
        kind => {
            let points: Vec<Vec2> = (0..3 + random.below(9)).map(|_| on_grid(random, steps, step)).collect();
            Shape::hull(&points).and_then(|hull| {
                let corners: Vec<Vec2> = hull.outlines()[0].corners().to_vec();
                if kind == 4 { Ok(hull) } else { Shape::rounded_polygon(&corners, radius(random)) }
            })
        }
    };
    shape.unwrap_or_else(|_| Shape::rectangle(1, fx!(0.5)).expect("a rectangle"))
}

/// The mirror image at the line x = 0.
fn across(v: Vec2) -> Vec2 {
    Vec2::new(-v.x, v.y)
}

fn image(shape: &Shape) -> Shape {
    let outline = &shape.outlines()[0];
    let corners: Vec<Vec2> = outline.corners().iter().map(|&corner| across(corner)).collect();
    match (corners.len(), outline.radius() > fx!(0)) {
        (1, _) | (2, true) => shape.clone(),
        (2, false) => Shape::segment(corners[0], corners[1]).expect("a segment"),
        (_, false) => Shape::polygon(&corners).expect("a polygon"),
        (_, true) => Shape::rounded_polygon(&corners, outline.radius()).expect("a polygon"),
    }
}

fn between(a: &Shape, at_a: Vec2, b: &Shape, at_b: Vec2) -> ShapeDistance {
    a.distance_to((at_a, fx!(0)), b, (at_b, fx!(0))).expect("in range")
}

/// Checks that a point is on the surface of a core with a radius, within so many ulps.
fn assert_on_surface(p: Vec2, corners: &[Point], radius: Fx, slack: i64, case: &str) {
    let is_on = is_root(&IBig::from(radius.to_bits()), &square_from_rim(&point(p), corners), slack << 16);
    assert!(is_on, "{case}: {p} is not on the surface");
}

#[test]
fn distances_and_depths_are_the_exact_ones_rounded_once() {
    let mut random = Random::seeded(run_seed(31));
    let mut counts = [0; 3];
    for i in 0..times(6_000) {
        let (steps, step) = [(3, fx!(0.5)), (6, fx!(0.25)), (1 << 20, Fx::from_bits(1 << 13))][i as usize % 3];
        let (a, b) = (shape(&mut random, steps, step), shape(&mut random, steps, step));
        let (at_a, at_b) = (on_grid(&mut random, 2 * steps, step), on_grid(&mut random, 2 * steps, step));
        let said = between(&a, at_a, &b, at_b);
        let case = format!("{i}: {a:?} at {at_a}, {b:?} at {at_b}: {said:?}");
        let cores = [corners(&a.outlines()[0], at_a), corners(&b.outlines()[0], at_b)];
        let [radius_a, radius_b] = [&a, &b].map(|shape| shape.outlines()[0].radius());
        let radius = IBig::from((radius_a + radius_b).to_bits());
        let (is_apart, ties, square) = match gap(&cores[0], &cores[1]) {
            Gap::Apart(square) => (true, false, square),
            Gap::Overlap(square, ties) => (false, ties, square),
        };
        // Half an ulp and a little.
        let separation = IBig::from(said.separation.to_bits());
        let of_cores = if is_apart { separation + &radius } else { -(separation + &radius) };
        assert!(is_root(&of_cores, &square, 32_770), "{case}");
        counts[usize::from(said.separation > fx!(0)) + 2 * usize::from(said.separation == fx!(0))] += 1;
        // The points are on both surfaces, and the way between them is the separation along the normal.
        assert!((said.normal.length() - fx!(1)).abs() <= Fx::from_bits(2), "{case}");
        let way = said.points[1] - said.points[0];
        let along = said.normal * said.separation;
        assert!((way - along).length() <= Fx::from_bits(8), "{case}");
        if is_apart {
            assert_on_surface(said.points[0], &cores[0], radius_a, 6, &case);
            assert_on_surface(said.points[1], &cores[1], radius_b, 6, &case);
        }
        // Moved apart by the depth the second shape touches, or is an ulp or so off.
        let moved = between(&a, at_a, &b, at_b - along);
        let slack = Fx::from_bits(6) + said.separation.abs() / (1 << 30);
        assert!(moved.separation.abs() <= slack, "{case} {moved:?}");
        // Swapped.
        let swapped = between(&b, at_b, &a, at_a);
        assert_eq!(swapped.separation, said.separation, "{case}");
        // Mirrored.
        let mirrored = between(&image(&a), across(at_a), &image(&b), across(at_b));
        assert_eq!(mirrored.separation, said.separation, "{case}");
        if !ties {
            assert_eq!((-swapped.normal, [swapped.points[1], swapped.points[0]]), (said.normal, said.points), "{case}");
            assert_eq!((across(mirrored.normal), mirrored.points.map(across)), (said.normal, said.points), "{case}");
        }
    }
    assert!(counts.iter().all(|count| *count > 10), "{counts:?}");
}

#[test]
fn overlaps_that_tie_are_left_towards_the_centre_of_the_other_shape_then_upwards() {
    let square = Shape::rectangle(2, 2).expect("a square");
    let disc = Shape::circle(1).expect("a disc");
    // The square around one centre may go any of four ways: up. The disc may go anywhere: up.
    for shape in [&square, &disc] {
        let said = between(shape, vec2(5, 3), shape, vec2(5, 3));
        assert_eq!((said.separation, said.normal), (fx!(-2), vec2(0, 1)), "{shape:?}");
        for (x, y) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let said = between(shape, vec2(5, 3), shape, vec2(5 + x, 3 + y));
            assert_eq!((said.separation, said.normal), (fx!(-1), vec2(x, y)), "{shape:?}");
        }
    }
    // On the diagonal two ways tie: up.
    let said = between(&square, vec2(0, 0), &square, vec2(1, 1));
    assert_eq!((said.separation, said.normal), (fx!(-1), vec2(0, 1)));
    let said = between(&square, vec2(0, 0), &square, vec2(1, -1));
    assert_eq!((said.separation, said.normal), (fx!(-1), vec2(1, 0)));
    // A bar in a bar: across, away from the middle.
    let bar = Shape::capsule(4, fx!(0.5)).expect("a bar");
    let said = between(&bar, vec2(0, 0), &bar, vec2(1, fx!(-0.25)));
    assert_eq!((said.separation, said.normal), (fx!(-0.75), vec2(0, -1)));
}

#[test]
fn turned_shapes_and_parts_are_where_their_poses_put_them() {
    let quarter = Fx::FRAC_PI_2;
    let bar = Shape::rectangle(4, 1).expect("a bar");
    let said = bar.distance_to((vec2(0, 0), quarter), &bar, (vec2(5, 0), fx!(0))).expect("in range");
    assert_eq!((said.separation, said.normal, said.parts), (fx!(2.5), vec2(1, 0), [0, 0]));
    // Two discs in a compound, and the corner of a chain.
    let part = |x: i32| Part {
        shape: Shape::circle(1).expect("a disc"),
        position: vec2(x, 0),
        angle: fx!(0),
        density: fx!(1),
    };
    let pair = Shape::compound(&[part(-3), part(3)]).expect("two discs");
    let chain = Shape::chain(&[vec2(8, 8), vec2(8, 0), vec2(20, 0)], false).expect("a chain");
    let said = pair.distance_to((vec2(0, 0), fx!(0)), &chain, (vec2(0, 0), fx!(0))).expect("in range");
    assert_eq!((said.separation, said.parts, said.points), (fx!(4), [1, 0], [vec2(4, 0), vec2(8, 0)]));
    // Of two parts that overlap the deeper one.
    let square = Shape::rectangle(2, 2).expect("a square");
    let said = pair.distance_to((vec2(0, 0), fx!(0)), &square, (vec2(fx!(2.5), 0), fx!(0))).expect("in range");
    assert_eq!((said.parts, said.separation, said.normal), ([1, 0], fx!(-1.5), vec2(-1, 0)));
}

#[test]
fn shapes_out_of_range_are_refused() {
    let disc = Shape::circle(1).expect("a disc");
    let away = |x: Fx| disc.distance_to((vec2(0, 0), fx!(0)), &disc, (vec2(x, 0), fx!(0)));
    let out_of = |quantity| Error::OutOfRange { quantity };
    let far = fx!(2_000_000);
    assert_eq!(away(far).map(|said| said.separation), Ok(far - fx!(2)));
    assert_eq!(away(fx!(2_097_152)), Err(out_of(Quantity::Query)));
    assert_eq!(away(limits::POSITION + Fx::DELTA), Err(out_of(Quantity::Position)));
    #[cfg(feature = "float")]
    {
        let disc = Shape::<f64>::new(umbra_physics::Geometry::Circle { radius: 1.0 }).expect("a disc");
        let at = |x: f64, angle: f64| (Vec2::new(x, 0.0), angle);
        let away = |x, angle| disc.distance_to(at(0.0, 0.0), &disc, at(x, angle));
        assert_eq!(away(5.0, 1.0).map(|said| said.separation), Ok(3.0));
        assert_eq!(away(5.0, f64::NAN), Err(out_of(Quantity::Angle)));
        assert_eq!(away(f64::NAN, 0.0), Err(out_of(Quantity::Position)));
    }
}
