//! Shapes that are cast from exact touch: they leave and slide freely, and meet at once what they are moved into.

use umbra_physics::{BodyDef, Fx, QueryFilter, Shape, Vec2, World, WorldDef, fx, vec2};

/// A world with fixed shapes at places.
fn world_of(shapes: &[(Shape, Vec2)]) -> World {
    let mut world = World::new(WorldDef::default()).expect("a world");
    for (shape, position) in shapes {
        let body = BodyDef { position: *position, ..BodyDef::fixed().with_collider(shape.clone()) };
        world.add_body(body).expect("a body");
    }
    world
}

/// The fraction, the normal and the number of ties of the first hit, once all calls agree on it.
fn first(world: &World, shape: &Shape, from: Vec2, translation: Vec2) -> Option<(Fx, Vec2, usize)> {
    let (queries, filter) = (world.queries(), QueryFilter::default());
    let pose = (from, fx!(0));
    let hit = queries.cast_shape(shape, pose, translation, &filter).expect("in range");
    let all = queries.cast_shape_all(shape, pose, translation, &filter).expect("in range");
    let ties = queries.cast_shape_ties(shape, pose, translation, &filter).expect("in range");
    assert_eq!((hit, ties.as_slice()), (all.first().copied(), &all[..ties.len()]));
    hit.map(|hit| (hit.fraction, hit.normal, ties.len()))
}

fn turned([x, y]: [Fx; 2], quarters: u32) -> Vec2 {
    match quarters % 4 {
        0 => Vec2::new(x, y),
        1 => Vec2::new(-y, x),
        2 => Vec2::new(-x, -y),
        _ => Vec2::new(y, -x),
    }
}

#[test]
fn what_leaves_or_slides_from_touch_meets_nothing_and_what_is_pushed_in_meets_it_at_once() {
    let square = Shape::rectangle(1, 1).expect("a square");
    let ball = Shape::circle(fx!(0.5)).expect("a ball");
    let pill = Shape::capsule(1, fx!(0.5)).expect("a pill");
    let diamond = [vec2(1, 0), vec2(0, 1), vec2(-1, 0), vec2(0, -1)].map(|corner| corner * fx!(0.5));
    let diamond = Shape::polygon(&diamond).expect("a diamond");
    let soft = [vec2(1, 1), vec2(-1, 1), vec2(-1, -1), vec2(1, -1)].map(|corner| corner * fx!(0.25));
    let soft = Shape::rounded_polygon(&soft, fx!(0.25)).expect("a soft square");
    // All of them reach from −½ to ½ m along y: two, one on the other, touch at a distance of 1 m.
    let shapes = [square, ball, pill, diamond, soft];
    for (below, above) in shapes.iter().flat_map(|below| shapes.iter().map(move |above| (below, above))) {
        for quarters in 0..2 {
            // A quarter turn of the place alone: the pill is longer along x.
            if quarters == 1 && [below, above].contains(&&shapes[2]) {
                continue;
            }
            for mirror in [1, -1] {
                let image = |x: Fx, y: Fx| turned([x * mirror, y], quarters);
                let world = world_of(&[(below.clone(), vec2(0, 0))]);
                let from = image(fx!(0), fx!(1));
                for (x, y) in [(0, 1), (1, 1), (7, 1), (1, 0), (5, 0), (0, 0)] {
                    let way = image(x.into(), y.into());
                    assert_eq!(first(&world, above, from, way), None, "{below:?} {above:?} {way}");
                }
                for (x, y) in [(0, -1), (1, -1), (5, -7), (0, -9)] {
                    let way = image(x.into(), y.into());
                    // The tip of a diamond lies beside another tip.
                    let (fraction, normal, ties) = match first(&world, above, from, way) {
                        Some(hit) => hit,
                        None => {
                            assert!(below == &shapes[3] && above == &shapes[3] && x != 0, "{below:?} {above:?} {way}");
                            continue;
                        }
                    };
                    assert_eq!((fraction, ties), (fx!(0), 1));
                    assert!(normal.dot(way) < fx!(0), "{below:?} {above:?} {way} {normal}");
                    if [below, above].iter().any(|shape| **shape == shapes[0]) {
                        assert_eq!(normal, image(fx!(0), fx!(1)), "{below:?} {above:?} {way}");
                    }
                }
                // A hair nearer they overlap, and any way meets that without a normal.
                let inner = image(fx!(0), fx!(1) - Fx::DELTA);
                assert_eq!(first(&world, above, inner, image(fx!(0), fx!(1))), Some((fx!(0), vec2(0, 0), 1)));
                // A hair away a way in meets it later, with the normal of the touch.
                let outer = image(fx!(0), fx!(1) + Fx::DELTA);
                let (fraction, normal, _) = first(&world, above, outer, image(fx!(0), fx!(-1))).expect("a hit");
                assert_eq!((fraction, normal), (Fx::DELTA, image(fx!(0), fx!(1))));
            }
        }
    }
}

#[test]
fn a_crate_slides_over_a_row_of_tiles_until_a_wall_is_in_its_way() {
    let tile = Shape::rectangle(1, 1).expect("a tile");
    let mut tiles: Vec<(Shape, Vec2)> = (0..20).map(|x| (tile.clone(), vec2(x, 0))).collect();
    for shape in [tile.clone(), Shape::circle(fx!(0.5)).expect("a ball"), Shape::capsule(1, fx!(0.5)).expect("a pill")]
    {
        let reach = shape.bounds().max.x;
        let world = world_of(&tiles);
        for way in [vec2(18, 0), vec2(-18, 0), vec2(3, 2), vec2(-1, 5)] {
            assert_eq!(first(&world, &shape, vec2(9, 1), way), None, "{shape:?} {way}");
        }
        tiles.push((tile.clone(), vec2(14, 1)));
        let world = world_of(&tiles);
        let (fraction, normal, ties) = first(&world, &shape, vec2(9, 1), vec2(16, 0)).expect("the wall");
        let way = fx!(4.5) - reach;
        assert!((fraction * 16 - way).abs() <= Fx::from_bits(16), "{shape:?} {fraction}");
        assert_eq!((normal, ties), (vec2(-1, 0), 1));
        // The other way it is free, and down it meets all that it stands on at once.
        assert_eq!(first(&world, &shape, vec2(9, 1), vec2(-9, 0)), None);
        let (fraction, normal, _) = first(&world, &shape, vec2(9, 1), vec2(2, -1)).expect("the floor");
        assert_eq!((fraction, normal), (fx!(0), vec2(0, 1)));
        tiles.pop();
    }
}

#[test]
fn a_crate_falls_through_a_shaft_of_its_own_width() {
    let tile = Shape::rectangle(1, 1).expect("a tile");
    let mut tiles: Vec<(Shape, Vec2)> = (0..10).flat_map(|y| [-1, 1].map(|x| (tile.clone(), vec2(x, -y)))).collect();
    tiles.push((tile.clone(), vec2(0, -12)));
    let world = world_of(&tiles);
    for shape in [tile, Shape::circle(fx!(0.5)).expect("a ball")] {
        let (fraction, normal, ties) = first(&world, &shape, vec2(0, 3), vec2(0, -28)).expect("the ground");
        assert_eq!((fraction, normal, ties), (fx!(0.5), vec2(0, 1), 1));
        // A hair to the side an edge is in the way.
        let beside = Vec2::new(Fx::DELTA, fx!(3));
        assert!(first(&world, &shape, beside, vec2(0, -28)).is_some_and(|hit| hit.0 < fx!(0.125)), "{shape:?}");
    }
}

#[test]
fn thin_rods_meet_across_and_end_to_end_and_slide_along_each_other() {
    let rod = Shape::segment(vec2(-1, 0), vec2(1, 0)).expect("a rod");
    let world = world_of(&[(rod.clone(), vec2(0, 0))]);
    let cast = |from: Vec2, way: Vec2| first(&world, &rod, from, way);
    // Across, and end to end.
    assert_eq!(cast(vec2(0, 2), vec2(0, -4)), Some((fx!(0.5), vec2(0, 1), 1)));
    assert_eq!(cast(vec2(4, 0), vec2(-4, 0)), Some((fx!(0.5), vec2(1, 0), 1)));
    // End at end: away, aside, together.
    assert_eq!([vec2(1, 0), vec2(0, 1), vec2(0, -1), vec2(-1, 1)].map(|way| cast(vec2(2, 0), way)), [None; 4]);
    assert_eq!(cast(vec2(2, 0), vec2(-1, 0)), Some((fx!(0), vec2(1, 0), 1)));
    // On each other: along is free. A rod has no side, so that either way across is a way in.
    assert_eq!([vec2(1, 0), vec2(-1, 0)].map(|way| cast(vec2(1, 0), way)), [None; 2]);
    assert_eq!(cast(vec2(1, 0), vec2(0, -1)), Some((fx!(0), vec2(0, 1), 1)));
    // On a segment of a chain, which has a side, up is free.
    let ground = Shape::chain(&[vec2(4, 0), vec2(0, 0), vec2(-4, 0)], false).expect("a ground");
    let world = world_of(&[(ground, vec2(0, 0))]);
    let square = Shape::rectangle(1, 1).expect("a square");
    for (shape, y) in [(&rod, fx!(0)), (&square, fx!(0.5))] {
        let cast = |way: Vec2| first(&world, shape, Vec2::new(fx!(0.25), y), way);
        assert_eq!([vec2(0, 1), vec2(1, 1), vec2(3, 0), vec2(-3, 0)].map(cast), [None; 4]);
        assert_eq!(cast(vec2(1, -1)).map(|(fraction, normal, _)| (fraction, normal)), Some((fx!(0), vec2(0, 1))));
    }
}
