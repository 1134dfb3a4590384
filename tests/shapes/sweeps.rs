//! Times of impact: closed forms, and what the distance says all along the way.

use crate::seeds::{run_seed, times};
use umbra_physics::{Error, Fx, Quantity, Random, Shape, ShapeDistance, ShapeImpact, Sweep, Vec2, fx, limits, vec2};

/// The largest overlap of shapes that touch, 2^-20 m.
const TOUCH: Fx = Fx::from_bits(1 << 12);

/// The bound of the distance at an impact: 2^-26 m and 2^-26 of a size.
fn bound(a: &Shape, b: &Shape) -> Fx {
    let reach = |shape: &Shape| shape.bounds().min.length().max(shape.bounds().max.length());
    Fx::from_bits(1 << 6) + (reach(a) + reach(b)) / (1 << 26)
}

fn impact(a: &Shape, sweep_a: &Sweep, b: &Shape, sweep_b: &Sweep) -> Option<ShapeImpact> {
    a.time_of_impact(sweep_a, b, sweep_b).expect("in range")
}

fn moving(x: Fx, y: Fx, translation: Vec2) -> Sweep {
    Sweep { translation, ..Sweep::at(Vec2::new(x, y), fx!(0)) }
}

fn to_f64(x: Fx) -> f64 {
    x.to_bits() as f64 / 2_f64.powi(32)
}

#[test]
fn straight_ways_meet_when_the_gap_is_gone() {
    let (square, disc) = (Shape::rectangle(1, 1).expect("a square"), Shape::circle(fx!(0.5)).expect("a disc"));
    let pill = Shape::capsule(1, fx!(0.5)).expect("a pill");
    for (a, b) in [(&square, &square), (&square, &disc), (&disc, &disc), (&pill, &square)] {
        // A gap of 4 m between them that 8 m, 6 m and −2 m, or 16 m close.
        let reach = a.bounds().max.x + b.bounds().max.x;
        for (way_a, way_b, fraction) in [(8, 0, fx!(0.5)), (6, -2, fx!(0.5)), (0, -16, fx!(0.25)), (6, 1, fx!(0.8))] {
            let sweep_a = moving(fx!(0), fx!(0), vec2(way_a, 0));
            let sweep_b = moving(reach + fx!(4), fx!(0), vec2(way_b, 0));
            let hit = impact(a, &sweep_a, b, &sweep_b).expect("a hit");
            let early = fraction - hit.fraction;
            assert!(early >= fx!(0) && early < Fx::from_bits(32), "{a:?} {b:?} {} {fraction}", hit.fraction);
            assert_eq!(hit.distance.normal, vec2(1, 0));
            assert!(hit.distance.separation >= fx!(0) && hit.distance.separation <= bound(a, b));
            let back = impact(b, &sweep_b, a, &sweep_a).expect("a hit");
            assert_eq!((back.fraction, back.distance.normal), (hit.fraction, vec2(-1, 0)));
        }
        // They go together, or apart, or stop before, or come to touch in the end, or pass by.
        for (way_a, way_b, y) in [(9, 9, 0), (-3, 1, 0), (3, 0, 0), (5, 1, 0), (30, 0, 2)] {
            let sweep_a = moving(fx!(0), fx!(0), vec2(way_a, 0));
            let sweep_b = moving(reach + fx!(4), y.into(), vec2(way_b, 0));
            assert_eq!(impact(a, &sweep_a, b, &sweep_b), None, "{a:?} {b:?} {way_a} {way_b}");
        }
    }
}

#[test]
fn a_bar_that_turns_meets_a_disc_at_the_angle_where_its_side_is_there() {
    let bar = Shape::rectangle(8, fx!(0.5)).expect("a bar");
    for (distance, radius, start) in [(fx!(3), fx!(0.5), 1.2), (fx!(2), fx!(0.25), 2.5), (fx!(3.5), fx!(0.125), 3.0)] {
        let disc = Shape::circle(radius).expect("a disc");
        for turns in [0, 1, 50] {
            // The disc stands at the angle 0 and the bar at `start` above: at a half turn of it the other end comes first.
            let still = Sweep::at(Vec2::new(distance, fx!(0)), fx!(0));
            let angle = Fx::from_bits((start * 2_f64.powi(32)) as i64);
            let rotation = fx!(-3.5) - Fx::TAU * turns;
            let sweep = Sweep { rotation, ..Sweep::at(vec2(0, 0), angle) };
            let hit = impact(&bar, &sweep, &disc, &still).expect("a hit");
            // The side of the bar is ¼ m from its axis.
            let touch = ((0.25 + to_f64(radius)) / to_f64(distance)).asin();
            let expected = (start - touch) / -to_f64(rotation);
            assert!((to_f64(hit.fraction) - expected).abs() < 1e-8, "{distance} {turns}: {} {expected}", hit.fraction);
            assert!(hit.distance.separation >= -Fx::from_bits(64) && hit.distance.separation <= bound(&bar, &disc));
            // Mirrored, it is the same moment.
            let mirrored = Sweep { rotation: -rotation, ..Sweep::at(vec2(0, 0), -angle) };
            assert_eq!(impact(&bar, &mirrored, &disc, &still).map(|hit| hit.fraction), Some(hit.fraction));
        }
        // Out of reach of its ends it may turn as often as it likes.
        let far = Sweep::at(Vec2::new(fx!(4.01) + radius, fx!(0)), fx!(0));
        let spin = Sweep { rotation: limits::JOINT_ANGLE, ..Sweep::default() };
        assert_eq!(impact(&bar, &spin, &disc, &far), None);
    }
}

#[test]
fn what_touches_leaves_slides_and_rolls_and_meets_what_it_goes_into() {
    let (square, disc) = (Shape::rectangle(1, 1).expect("a square"), Shape::circle(fx!(0.5)).expect("a disc"));
    let floor = Shape::rectangle(20, 1).expect("a floor");
    let ground = Sweep::at(vec2(0, 0), fx!(0));
    for shape in [&square, &disc] {
        for way in [vec2(0, 0), vec2(0, 3), vec2(5, 0), vec2(-5, 0), vec2(4, 1)] {
            assert_eq!(impact(&floor, &ground, shape, &moving(fx!(0), fx!(1), way)), None, "{shape:?} {way}");
        }
        let hit = impact(&floor, &ground, shape, &moving(fx!(0), fx!(1), vec2(4, -1))).expect("a hit");
        assert!(hit.fraction <= TOUCH && hit.distance.normal == vec2(0, 1), "{hit:?}");
        let hit = impact(&floor, &ground, shape, &moving(fx!(0), fx!(0.75), vec2(0, 1))).expect("they overlap");
        assert_eq!((hit.fraction, hit.distance.separation), (fx!(0), fx!(-0.25)));
    }
    // A wheel rolls, a square that turns on the floor digs in with a corner.
    let rolling = Sweep { rotation: fx!(-12), ..moving(fx!(-3), fx!(1), vec2(6, 0)) };
    assert_eq!(impact(&floor, &ground, &disc, &rolling), None);
    let hit = impact(&floor, &ground, &square, &rolling).expect("a corner");
    assert!(hit.fraction < fx!(0.001) && hit.distance.separation >= -TOUCH);
}

/// The distance at a fraction of the way; the place is rounded to ulps.
fn at(a: &Shape, sweep_a: &Sweep, b: &Shape, sweep_b: &Sweep, fraction: Fx) -> ShapeDistance {
    let pose = |sweep: &Sweep| (sweep.position + sweep.translation * fraction, sweep.angle + sweep.rotation * fraction);
    a.distance_to(pose(sweep_a), b, pose(sweep_b)).expect("in range")
}

#[test]
fn before_an_impact_shapes_are_apart_and_at_it_they_are_at_each_other() {
    let mut random = Random::seeded(run_seed(32));
    let triangle = Shape::polygon(&[vec2(-1, -1), vec2(2, 0), vec2(0, 1)]).expect("a triangle");
    let soft = Shape::rounded_polygon(&[vec2(-1, 0), vec2(1, 0), vec2(0, 1)], fx!(0.3)).expect("a soft triangle");
    let shapes = [
        Shape::circle(fx!(0.75)).expect("a disc"),
        Shape::rectangle(1, 3).expect("a box"),
        Shape::capsule(3, fx!(0.25)).expect("a pill"),
        Shape::segment(vec2(-2, 0), vec2(2, 1)).expect("a rod"),
        triangle,
        soft,
    ];
    let mut counts = [0; 3];
    for i in 0..times(1_500) {
        let [a, b] = [0, 1].map(|_| &shapes[random.below(shapes.len() as u64) as usize]);
        let mut sweep = |size: i32| Sweep {
            position: Vec2::new(random.number(fx!(-6)..=fx!(6)), random.number(fx!(-6)..=fx!(6))),
            angle: random.number(fx!(-4)..=fx!(4)),
            translation: Vec2::new(random.number(fx!(-9)..=fx!(9)), random.number(fx!(-9)..=fx!(9))),
            rotation: random.number(fx!(-3)..=fx!(3)) * size,
        };
        let (sweep_a, sweep_b) = (sweep(i % 3), sweep(i % 5));
        let hit = impact(a, &sweep_a, b, &sweep_b);
        let case = format!("{i}: {a:?} {sweep_a:?} {b:?} {sweep_b:?} {hit:?}");
        let swapped = impact(b, &sweep_b, a, &sweep_a);
        assert_eq!(swapped.map(|hit| hit.fraction), hit.map(|hit| hit.fraction), "{case}");
        // Places are rounded by some ulps in the samples.
        let slack = bound(a, b) + Fx::from_bits(64);
        let end = hit.map_or(fx!(1), |hit| hit.fraction);
        for k in 0..=40 {
            let fraction = Fx::from_ratio(k, 40) * end;
            let separation = at(a, &sweep_a, b, &sweep_b, fraction).separation;
            assert!(separation >= -TOUCH - slack || end == fx!(0), "{case}: {separation} at {fraction}");
        }
        match hit {
            None => counts[0] += 1,
            Some(hit) if hit.fraction == fx!(0) => {
                counts[1] += 1;
                assert!(hit.distance.separation <= TOUCH, "{case}");
            }
            Some(hit) => {
                counts[2] += 1;
                assert!(hit.distance.separation.abs() <= bound(a, b), "{case}");
                // What the distance says for the rounded fraction, which is a little earlier: by 2^-32 of a way below 64 m.
                let said = at(a, &sweep_a, b, &sweep_b, hit.fraction).separation;
                assert!((said - hit.distance.separation).abs() <= slack + Fx::from_bits(64), "{case}: {said}");
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
}

#[test]
fn parts_and_chains_are_met_where_they_are_first() {
    let ball = Shape::circle(fx!(0.5)).expect("a ball");
    let pair = Shape::concave_polygon(&[vec2(-4, 0), vec2(4, 0), vec2(4, 3), vec2(3, 3), vec2(3, 1), vec2(-4, 1)]);
    let pair = pair.expect("an angle");
    let still = Sweep::at(pair.shift(), fx!(0));
    // Onto the inner side of the upright part, and past it onto the ground.
    let hit = impact(&pair, &still, &ball, &moving(fx!(0), fx!(2), vec2(5, 0))).expect("a hit");
    assert!((hit.fraction - fx!(0.5)).abs() < Fx::from_bits(32) && hit.distance.normal == vec2(-1, 0), "{hit:?}");
    let hit = impact(&pair, &still, &ball, &moving(fx!(-2), fx!(5), vec2(0, -7))).expect("a hit");
    assert!((hit.fraction - fx!(0.5)).abs() < Fx::from_bits(32) && hit.distance.normal == vec2(0, 1), "{hit:?}");
    // A chain from its outer side alone.
    let chain = Shape::chain(&[vec2(9, 0), vec2(0, 0), vec2(-9, 0)], false).expect("a chain");
    let ground = Sweep::default();
    let hit = impact(&chain, &ground, &ball, &moving(fx!(-3), fx!(2), vec2(1, -3))).expect("a hit");
    assert_eq!((hit.distance.parts, hit.distance.normal), ([1, 0], vec2(0, 1)));
    assert_eq!(impact(&chain, &ground, &ball, &moving(fx!(-3), fx!(-2), vec2(1, 3))), None);
}

#[test]
fn motions_out_of_range_are_refused() {
    let disc = Shape::circle(1).expect("a disc");
    let refused = |sweep: Sweep| disc.time_of_impact(&sweep, &disc, &Sweep::default()).err();
    let out_of = |quantity| Some(Error::OutOfRange { quantity });
    assert_eq!(refused(Sweep::at(vec2(limits::POSITION + Fx::DELTA, 0), fx!(0))), out_of(Quantity::Position));
    assert_eq!(refused(moving(fx!(0), fx!(0), vec2(limits::QUERY + Fx::DELTA, 0))), out_of(Quantity::Query));
    let rotation = limits::JOINT_ANGLE + Fx::DELTA;
    assert_eq!(refused(Sweep { rotation, ..Sweep::default() }), out_of(Quantity::Query));
    assert_eq!(
        refused(Sweep { rotation: -limits::JOINT_ANGLE, ..Sweep::at(vec2(limits::POSITION, 0), Fx::MIN) }),
        None
    );
}
