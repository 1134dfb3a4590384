//! Values that the tests of another engine expect of shapes, in the conventions of this one.
//!
//! The scenes and values are those of Box2D's [`test_shape.c`](https://github.com/erincatto/box2d/blob/main/test/test_shape.c) and
//! [`test_distance.c`](https://github.com/erincatto/box2d/blob/main/test/test_distance.c), to the last bit here in place of its tolerances. What differs:
//!
//! - `b2MakeBox` takes half sides, [`Shape::rectangle`] whole ones;
//! - shapes are re-centred at their centre of mass, and a pose or a collider places them: [`Shape::shift`] is the centre that Box2D reports;
//! - [`Shape::gyration`] is the moment of inertia for a mass of 1 kg about the centre of mass, where Box2D has the moment for a density;
//! - a ray is its start and its translation in both, and a fraction is a part of the translation;
//! - time of impact and shape casts stop at the surface, where Box2D stops a slop before it.

use umbra_physics::{BodyDef, Fx, FxFactor, QueryFilter, Shape, Sweep, Vec2, World, WorldDef, fx, vec2};

fn square() -> Shape {
    Shape::rectangle(2, 2).expect("a square")
}

fn segment(a: Vec2, b: Vec2) -> Shape {
    Shape::segment(a, b).expect("a segment")
}

/// The distance of two shapes as they were given.
fn between(a: &Shape, b: &Shape) -> umbra_physics::ShapeDistance {
    a.distance_to((a.shift(), fx!(0)), b, (b.shift(), fx!(0))).expect("in range")
}

#[test]
fn masses_and_inertias() {
    let circle = Shape::circle(1).expect("a disc");
    assert_eq!(circle.measure(), FxFactor::PI);
    assert_eq!(circle.gyration(), FxFactor::from_ratio(1, 2));
    let square = square();
    assert_eq!((square.measure(), square.shift()), (FxFactor::from_ratio(4, 1), vec2(0, 0)));
    // 8/3 of a mass of 4.
    assert_eq!(square.gyration(), FxFactor::from_ratio(2, 3));
    // A capsule is between the hull of points on its ends and the box around it.
    let capsule = Shape::capsule(2, 1).expect("a capsule");
    let outer = Shape::rectangle(4, 2).expect("a box");
    let ends = (0..8).map(|i| {
        let angle = Fx::PI / 3 * (i % 4) - Fx::FRAC_PI_2 + if i < 4 { fx!(0) } else { Fx::PI };
        let (sin, cos) = angle.sin_cos();
        Vec2::new(cos + if i < 4 { fx!(1) } else { fx!(-1) }, sin)
    });
    let inner = Shape::hull(&ends.collect::<Vec<_>>()).expect("a hull");
    for property in [Shape::measure, |shape: &Shape| shape.measure().times(shape.gyration())] {
        assert!(property(&inner) < property(&capsule) && property(&capsule) < property(&outer));
    }
    // Moved, only the centre changes.
    let offset = Vec2::new(fx!(0.4), fx!(-0.7));
    let corners = [(1, 2), (-1, 2), (-1, -2), (1, -2)].map(|(x, y)| Vec2::new(Fx::from(x) / 4, Fx::from(y) / 4));
    let [here, there] = [Vec2::ZERO, offset].map(|v| Shape::polygon(&corners.map(|c| c + v)).expect("a box"));
    assert_eq!((here.measure(), here.gyration(), offset), (there.measure(), there.gyration(), there.shift()));
}

#[test]
fn boxes_and_points() {
    let bounds = |shape: &Shape| [shape.bounds().min + shape.shift(), shape.bounds().max + shape.shift()];
    assert_eq!(bounds(&Shape::circle(1).expect("a disc")), [vec2(-1, -1), vec2(1, 1)]);
    assert_eq!(bounds(&square()), [vec2(-1, -1), vec2(1, 1)]);
    assert_eq!(bounds(&segment(vec2(0, 1), vec2(0, -1))), [vec2(0, -1), vec2(0, 1)]);
    // The disc is around (1, 0) there.
    let disc = Shape::circle(1).expect("a disc");
    let (inside, outside) = (Vec2::new(fx!(0.5), fx!(0.5)), vec2(4, -4));
    assert_eq!([inside, outside].map(|p| disc.contains(p - vec2(1, 0))), [true, false]);
    assert_eq!([inside, outside].map(|p| square().contains(p)), [true, false]);
}

#[test]
fn rays() {
    let ray = |shape: &Shape, centre: Vec2| {
        let hit = shape.cast_ray(vec2(-4, 0) - centre, vec2(8, 0)).expect("in range").expect("a hit");
        (hit.fraction, hit.normal)
    };
    assert_eq!(ray(&Shape::circle(1).expect("a disc"), vec2(1, 0)), (fx!(0.5), vec2(-1, 0)));
    assert_eq!(ray(&square(), vec2(0, 0)), (fx!(0.375), vec2(-1, 0)));
    assert_eq!(ray(&segment(vec2(0, 1), vec2(0, -1)), vec2(0, 0)), (fx!(0.5), vec2(-1, 0)));
    // As a segment of a chain it is met from its right alone, which is the left of the picture on the way down.
    let chain = |a: Vec2, b: Vec2| Shape::chain(&[a, b], false).expect("a chain").cast_ray(vec2(-4, 0), vec2(8, 0));
    assert_eq!(chain(vec2(0, 1), vec2(0, -1)).expect("in range").map(|hit| hit.fraction), Some(fx!(0.5)));
    assert_eq!(chain(vec2(0, -1), vec2(0, 1)), Ok(None));
}

#[test]
fn distances() {
    let said = between(&segment(vec2(-1, -1), vec2(-1, 1)), &segment(vec2(2, 0), vec2(1, 0)));
    assert_eq!((said.separation, said.points), (fx!(2), [vec2(-1, 0), vec2(1, 0)]));
    let said = between(&square(), &segment(vec2(2, -1), vec2(2, 1)));
    assert_eq!((said.separation, said.normal), (fx!(1), vec2(1, 0)));
    // The sides face each other from −1 to 1.
    assert_eq!(said.points, [vec2(1, 0), vec2(2, 0)]);
    // A plank as thin as a shape may be, and a disc a slop of 5 mm beside its end: its short side is nearest, and has a normal.
    let plank = Shape::rectangle(1, Fx::from_ratio(1, 128)).expect("a plank");
    let grain = Shape::circle(Fx::from_ratio(1, 128)).expect("a grain");
    let x = fx!(0.505) + Fx::from_ratio(1, 128);
    let said = plank.distance_to((vec2(0, 0), fx!(0)), &grain, (Vec2::new(x, fx!(0)), fx!(0))).expect("in range");
    assert_eq!((said.separation, said.normal), (fx!(0.505) - fx!(0.5), vec2(1, 0)));
}

#[test]
fn casts_and_times_of_impact() {
    // The square stands, and a segment 1 m beside it goes 2 m to the left: they meet half way.
    let mut world = World::new(WorldDef::default()).expect("a world");
    world.add_body(BodyDef::fixed().with_collider(square())).expect("a square");
    let rod = segment(vec2(2, -1), vec2(2, 1));
    let pose = (rod.shift(), fx!(0));
    let hit = world.queries().cast_shape(&rod, pose, vec2(-2, 0), &QueryFilter::default()).expect("in range");
    assert_eq!(hit.map(|hit| (hit.fraction, hit.normal, hit.point)), Some((fx!(0.5), vec2(1, 0), vec2(1, 0))));
    let sweep = Sweep { translation: vec2(-2, 0), ..Sweep::at(rod.shift(), fx!(0)) };
    let impact = square().time_of_impact(&Sweep::default(), &rod, &sweep).expect("in range").expect("a hit");
    assert!(fx!(0.5) - impact.fraction < Fx::from_bits(32) && impact.fraction <= fx!(0.5), "{}", impact.fraction);
    assert_eq!(impact.distance.normal, vec2(1, 0));
}
