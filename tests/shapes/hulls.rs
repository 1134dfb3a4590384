//! Convex hulls.

use super::exact::{cross, edges, minus, on_grid, point};
use crate::seeds::{run_seed, times};
use dashu_int::IBig;
use umbra_physics::{Error, Fx, Quantity, Random, Shape, Vec2, fx, limits, vec2};

#[test]
fn a_hull_has_all_points_in_it_and_only_points_as_corners() {
    let (mut random, mut shapes, mut flat) = (Random::seeded(run_seed(21)), 0, 0);
    for i in 0..times(4_000) {
        // A coarse grid, with many points on lines and in one place; and any points.
        let (steps, step) = [(2, fx!(1)), (6, fx!(0.5)), (1 << 20, Fx::from_bits(1 << 20))][i as usize % 3];
        let count = 1 + random.below(40);
        let mut points: Vec<Vec2> = (0..count).map(|_| on_grid(&mut random, steps, step)).collect();
        let shape = match Shape::hull(&points) {
            Ok(shape) => shape,
            Err(error) => {
                // All of them are on one line.
                assert_eq!(error, Error::OutOfRange { quantity: Quantity::Count }, "{points:?}");
                let all: Vec<_> = points.iter().map(|&p| point(p)).collect();
                for p in &all {
                    assert!(all.iter().all(|q| cross(&minus(p, &all[0]), &minus(q, &all[0])).is_zero()));
                }
                flat += 1;
                continue;
            }
        };
        shapes += 1;
        let shift = shape.shift();
        let corners: Vec<_> = shape.outlines()[0].corners().iter().map(|&corner| point(corner + shift)).collect();
        for (k, (a, b)) in edges(&corners).into_iter().enumerate() {
            let next = &corners[(k + 2) % corners.len()];
            assert!(cross(&minus(b, a), &minus(next, b)) > IBig::ZERO, "{points:?}");
            for &p in &points {
                assert!(cross(&minus(b, a), &minus(&point(p), a)) >= IBig::ZERO, "{points:?}");
            }
        }
        assert!(corners.iter().all(|corner| points.iter().any(|&p| point(p) == *corner)), "{points:?}");
        // The same of the points in any order, of the corners alone, and of its mirror image.
        random.shuffle(&mut points);
        assert_eq!(Shape::hull(&points).as_ref(), Ok(&shape));
        let corners: Vec<Vec2> = shape.outlines()[0].corners().iter().map(|&corner| corner + shift).collect();
        assert_eq!((Shape::hull(&corners).as_ref(), Shape::polygon(&corners).as_ref()), (Ok(&shape), Ok(&shape)));
        let image: Vec<Vec2> = points.iter().map(|p| Vec2::new(-p.x, p.y)).collect();
        let image = Shape::hull(&image).expect("a hull");
        assert_eq!((image.measure(), image.gyration()), (shape.measure(), shape.gyration()));
        assert_eq!(image.shift(), Vec2::new(-shift.x, shift.y));
    }
    assert!(shapes > 1_000 && flat > 20, "{shapes} {flat}");
}

#[test]
fn hulls_out_of_the_limits_are_refused() {
    let out_of = |quantity| Err(Error::OutOfRange { quantity });
    let circle = |count: i32| -> Vec<Vec2> {
        (0..count)
            .map(|i| {
                let (sin, cos) = (Fx::TAU / Fx::from(count) * i).sin_cos();
                Vec2::new(cos * 100, sin * 100)
            })
            .collect()
    };
    let corners = |points: &[Vec2]| Shape::hull(points).map(|shape| shape.outlines()[0].corners().len());
    assert_eq!(corners(&circle(limits::CORNERS as i32)), Ok(limits::CORNERS));
    assert_eq!(corners(&circle(limits::CORNERS as i32 + 1)), out_of(Quantity::Count));
    assert_eq!(corners(&[]), out_of(Quantity::Count));
    assert_eq!(corners(&[vec2(1, 1); 9]), out_of(Quantity::Count));
    assert_eq!(corners(&[vec2(0, 0), vec2(1, 1), vec2(-3, -3), vec2(2, 2)]), out_of(Quantity::Count));
    assert_eq!(corners(&vec![vec2(0, 0); limits::CHAIN + 1]), out_of(Quantity::Count));
    let far = corners(&[vec2(0, 0), vec2(1, 0), Vec2::new(limits::SIZE_MAX + Fx::DELTA, fx!(1))]);
    assert!(matches!(far, Err(Error::OutOfRange { quantity: Quantity::Size { .. } })), "{far:?}");
    let tiny = corners(&[vec2(0, 0), Vec2::new(Fx::DELTA, fx!(0)), Vec2::new(fx!(0), Fx::DELTA)]);
    assert!(matches!(tiny, Err(Error::OutOfRange { quantity: Quantity::Size { .. } })), "{tiny:?}");
}
