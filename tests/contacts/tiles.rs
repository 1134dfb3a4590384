//! Static tiles beside each other: no bumps at seams, real corners and gaps, edits.

use super::scenes::{def, material, square, world};
use crate::seeds::{is_short, run_seed, times};
use umbra_physics::collide::{Manifold, Pose, collide};
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Filter, Fx, Part, Random, Shape, Snapshot, Symmetry, Turn, Vec2, World, WorldDef, fx,
    vec2,
};

fn tile(width: Fx, height: Fx) -> Shape {
    Shape::rectangle(width, height).expect("a tile")
}

/// A static tile with its top right corner at a point.
fn below(corner: Vec2, width: Fx, height: Fx) -> BodyDef {
    let position = Vec2::new(corner.x - width / 2, corner.y - height / 2);
    BodyDef { position, ..BodyDef::fixed().with_collider(tile(width, height)) }
}

/// How a floor of tiles is made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Floor {
    /// A body for each tile.
    Bodies,
    /// A body with many colliders, for each thousand tiles.
    Colliders,
    /// A body with a compound, for each 200 tiles.
    Compounds,
    /// A body for each tile, of several lengths and heights.
    Lengths,
    /// One long tile.
    One,
}

/// A floor at height 0 from −2,000 m to 2,000 m.
fn floor(kind: Floor, length: Fx) -> Vec<BodyDef> {
    let ends = |length: Fx, count: i64| (0..count).map(move |i| fx!(-2_000) + length * Fx::from(i as i32 + 1));
    let count = fx!(4_000).to_bits() / length.to_bits();
    let body = |at: Vec2| BodyDef { position: at, key: 9, ..BodyDef::fixed() };
    match kind {
        Floor::One => vec![below(vec2(2_000, 0), fx!(4_000), fx!(1))],
        Floor::Bodies => ends(length, count).map(|x| below(Vec2::new(x, Fx::ZERO), length, fx!(1))).collect(),
        Floor::Lengths => {
            let mut random = Random::seeded(run_seed(3));
            let (mut x, mut tiles) = (fx!(-2_000), Vec::new());
            while x < fx!(2_000) {
                let width = random.number(length / 2..=length * fx!(1.5));
                x += width;
                tiles.push(below(Vec2::new(x, Fx::ZERO), width, random.number(fx!(0.5)..=fx!(2))));
            }
            tiles
        }
        Floor::Colliders | Floor::Compounds => {
            let max_tiles = if matches!(kind, Floor::Colliders) { 1_000 } else { 200 };
            let centres: Vec<Fx> = ends(length, count).map(|end| end - length / 2).collect();
            let row_of = |xs: &[Fx]| {
                let at = Vec2::new(xs[0], fx!(-0.5));
                let shape = tile(length, fx!(1));
                if max_tiles == 1_000 {
                    let collider_at =
                        |x: &Fx| ColliderDef { position: Vec2::new(*x - at.x, Fx::ZERO), ..shape.clone().into() };
                    return BodyDef { colliders: xs.iter().map(collider_at).collect(), ..body(at) };
                }
                let part = |x: &Fx| Part {
                    shape: shape.clone(),
                    position: Vec2::new(*x - at.x, Fx::ZERO),
                    angle: Fx::ZERO,
                    density: Fx::ONE,
                };
                let shape = Shape::compound(&xs.iter().map(part).collect::<Vec<_>>()).expect("a compound");
                let shift = shape.shift();
                BodyDef { position: at + shift, ..BodyDef::fixed().with_collider(shape) }
            };
            centres.chunks(max_tiles).map(row_of).collect()
        }
    }
}

/// The largest differences of height, of velocities and of the angular velocity, ulp, from a body on one long tile; how far it went, m.
fn differences(tiles: Vec<BodyDef>, body: &BodyDef, settled: usize, steps: usize) -> ([u64; 4], Fx) {
    let (mut here, body_ids) = world(def(), std::iter::once(body.clone()).chain(tiles)).expect("a scene");
    let (mut twin, twin_ids) =
        world(def(), std::iter::once(body.clone()).chain(floor(Floor::One, fx!(1)))).expect("a scene");
    let mut largest = [0; 4];
    for step in 0..steps {
        here.step();
        twin.step();
        if step < settled {
            continue;
        }
        let (body_here, twin_body) =
            (here.body(body_ids[0]).expect("it is there"), twin.body(twin_ids[0]).expect("it is there"));
        let apart = |a: Fx, b: Fx| a.to_bits().abs_diff(b.to_bits());
        let now = [
            apart(body_here.position().y, twin_body.position().y),
            apart(body_here.velocity().y, twin_body.velocity().y),
            apart(body_here.velocity().x, twin_body.velocity().x),
            apart(body_here.angular_velocity(), twin_body.angular_velocity()),
        ];
        largest = [0, 1, 2, 3].map(|i| largest[i].max(now[i]));
    }
    (largest, here.body(body_ids[0]).expect("it is there").position().x - body.position.x)
}

fn ball(position: Vec2, radius: Fx, key: u64) -> BodyDef {
    let collider = ColliderDef { key, ..ColliderDef::new(Shape::circle(radius).expect("a disc")) };
    BodyDef { position, key, ..BodyDef::dynamic().with_collider(collider) }
}

#[test]
fn a_ball_rolls_over_thousands_of_tiles_without_a_bump() {
    let share = if is_short() { 10 } else { 1 };
    let floors = [Floor::Bodies, Floor::Colliders, Floor::Compounds, Floor::Lengths];
    for (kind, (speed, length)) in
        floors.into_iter().flat_map(|kind| [(10, fx!(0.125)), (30, fx!(0.25))].map(|run| (kind, run)))
    {
        let start = BodyDef {
            velocity: vec2(speed, 0),
            angular_velocity: Fx::from(-2 * speed),
            ..ball(vec2(fx!(-1_990.0371), fx!(0.5)), fx!(0.5), 1)
        };
        let steps = if speed == 10 { 7_600 } else { 7_200 } / share;
        let (largest, way) = differences(floor(kind, length), &start, 0, steps);
        let seams = (way / length).ceil_to_int();
        assert!(seams >= 10_000 / share as i64, "{kind:?}: {seams}");
        // With the middle within half a micrometre of a seam, which happens at one of 10^5 where lengths are random, it is on both tiles for a
        // step.
        let allowed = if kind == Floor::Lengths { [1 << 15, 1 << 20, 1 << 20, 1 << 21] } else { [0; 4] };
        let is_within = (0..4).all(|i| largest[i] <= allowed[i]);
        assert!(is_within, "{kind:?} at {speed} m/s: {largest:?} ulp, after {seams} seams");
    }
}

#[test]
fn boxes_and_capsules_slide_over_tiles_without_a_bump() {
    let smooth = material(fx!(0), fx!(0));
    let shapes =
        [Shape::rectangle(1, 1), Shape::capsule(1, fx!(0.25)), Shape::polygon(&[vec2(0, 0), vec2(2, 0), vec2(1, 1)])];
    for kind in [Floor::Bodies, Floor::Compounds, Floor::Lengths] {
        for (i, shape) in shapes.clone().into_iter().enumerate() {
            for speed in [10, 30] {
                let shape = shape.clone().expect("a shape");
                let below = shape.bounds().min.y;
                let collider = ColliderDef { material: smooth, ..ColliderDef::new(shape) };
                let body = BodyDef {
                    position: Vec2::new(fx!(-1_990), -below),
                    velocity: vec2(speed, 0),
                    ..BodyDef::dynamic().with_collider(collider)
                };
                let (largest, way) = differences(floor(kind, fx!(0.375)), &body, 120, 1_200);
                assert!(way / fx!(0.375) > fx!(500), "{kind:?}: {way} m");
                // The corners are on two tiles, as on two segments of a chain: two manifolds, each of which ends its last pass within a
                // unit of velocity of rest, as the one manifold of a long tile does. The unit is 2^-26 of the power of two above five times
                // the speed: 2^-20 and 2^-18 m/s. A corner that comes over a seam in a step is on one of both tiles for all of it, which
                // adds some units. Heights add up what is left of that: at most 1/22 s of it, as an overlap shrinks to 0.63 in a step, if
                // all of it had one sign.
                let units = if speed == 10 { 1 << 16 } else { 1 << 18 };
                let [height, velocities @ ..] = largest;
                let is_smooth = height <= units / 32 && velocities.iter().all(|&ulps| ulps <= units);
                assert!(is_smooth, "{kind:?}, shape {i} at {speed} m/s: {largest:?} ulp");
            }
        }
    }
}

#[test]
fn a_ball_on_a_seam_rests_on_both_tiles() {
    // How deep a ball at x has sunk after eight steps, and the number of its contacts.
    let rest = |x: Fx, tiles: &[BodyDef]| {
        let bodies = std::iter::once(ball(Vec2::new(x, fx!(0.5)), fx!(0.5), 1)).chain(tiles.iter().cloned());
        let (mut world, ids) = world(def(), bodies).expect("a scene");
        (0..8).for_each(|_| _ = world.step());
        (fx!(0.5) - position(&world, ids[0]).y, world.contacts().count())
    };
    let tiles = [block(fx!(-0.5), fx!(-0.5), 2), block(fx!(0.5), fx!(-0.5), 3)];
    let long = [below(vec2(2, 0), fx!(4), fx!(1))];
    let (sunk, count) = rest(fx!(0), &long);
    assert!(count == 1 && sunk < fx!(0.00003), "{sunk} m");
    // Directions are compared within 2^-20: there neither tile is nearer. Each bears half of the weight, and yields half as much. (A ball
    // that is off the seam is slowly pushed away from it, by the corner of the other tile.)
    let off = fx!(0.5) / (1 << 20);
    for x in [-off / 2, fx!(0), off / 2] {
        let (half, count) = rest(x, &tiles);
        assert!(count == 2 && (sunk - half * 2).abs() < sunk / 64, "{half} and {sunk} m, {count} contacts");
    }
    for x in [-off * 2, off * 2, fx!(0.25)] {
        assert_eq!(rest(x, &tiles), (sunk, 1));
    }
}

#[test]
fn a_box_slides_over_tiles_beside_lower_and_higher_ones() {
    // The sides of tiles are on the surface of the floor from below, where their neighbours end.
    for heights in [[fx!(0.5), fx!(2)], [fx!(2), fx!(0.5)], [fx!(0.75), fx!(0.75)]] {
        let tiles = (-4..40_i32).map(|i| below(vec2(i + 1, 0), fx!(1), heights[(i & 1) as usize]));
        let collider = ColliderDef { material: material(fx!(0), fx!(0)), ..ColliderDef::new(tile(fx!(1), fx!(1))) };
        let start = BodyDef {
            position: Vec2::new(fx!(0.3), fx!(0.5)),
            velocity: vec2(10, 0),
            ..BodyDef::dynamic().with_collider(collider)
        };
        let (mut world, ids) = world(def(), std::iter::once(start).chain(tiles)).expect("a scene");
        for step in 0..180 {
            world.step();
            let velocity = world.body(ids[0]).expect("it is there").velocity();
            assert_eq!(velocity.x, fx!(10), "{heights:?} after {step} steps");
        }
    }
}

#[test]
fn tiles_that_were_added_before_and_after_a_body_are_alike() {
    // Pairs name the collider first that was added first.
    let tiles: Vec<BodyDef> = (0..40).map(|x| block(Fx::from(x), fx!(-0.5), 100 + x as u64)).collect();
    let rolling = BodyDef { velocity: vec2(6, 0), angular_velocity: fx!(-12), ..ball(vec2(0, fx!(0.5)), fx!(0.5), 1) };
    let sliding = BodyDef { velocity: vec2(6, 0), ..square(vec2(3, fx!(0.5)), 2).expect("a square") };
    let run = |after: usize| {
        let (first, last) = tiles.split_at(after);
        let bodies = first.iter().chain([&rolling, &sliding]).chain(last).cloned();
        let (mut world, _) = world(def(), bodies).expect("a scene");
        let hash = |_| {
            world.step();
            world.physics_hash()
        };
        (0..240).map(hash).collect::<Vec<u64>>()
    };
    let expected = run(0);
    for after in [1, 7, 12, 20, 40] {
        let actual = run(after);
        assert_eq!(actual.iter().zip(&expected).position(|(a, b)| a != b), None, "after {after} tiles");
    }
}

/// A static square of a metre with its centre at a point.
fn block(x: Fx, y: Fx, key: u64) -> BodyDef {
    let collider = ColliderDef { key, ..ColliderDef::new(tile(fx!(1), fx!(1))) };
    BodyDef { position: Vec2::new(x, y), key, ..BodyDef::fixed().with_collider(collider) }
}

fn position(world: &World, id: BodyId) -> Vec2 {
    world.body(id).expect("it is there").position()
}

#[test]
fn a_removed_tile_opens_its_neighbours_in_the_same_tick() {
    // A ball at rest over the middle of a tile, and one that rolls towards it.
    for velocity in [0, 2] {
        let balls = ball(Vec2::new(Fx::from(-velocity), fx!(0.25)), fx!(0.25), 1);
        let balls = BodyDef { velocity: vec2(velocity, 0), angular_velocity: Fx::from(-4 * velocity), ..balls };
        let tiles = (-6..=6_i32).map(|x| block(Fx::from(x), fx!(-0.5), x as u64 & 0xFF));
        let (mut world, ids) = world(def(), std::iter::once(balls).chain(tiles)).expect("a scene");
        (0..30).for_each(|_| _ = world.step());
        let before = position(&world, ids[0]);
        world.remove_body(ids[7]).expect("the tile at 0");
        world.step();
        if velocity == 0 {
            let fallen = before.y - position(&world, ids[0]).y;
            // g·h²/2
            assert!(fallen > fx!(0.00138), "{fallen} m in the tick of the removal");
        }
        for _ in 0..120 {
            world.step();
            let at = position(&world, ids[0]);
            // The inner edges of the neighbours are real: it stays in the gap.
            assert!(at.y > fx!(-0.25) || at.x.abs() <= fx!(0.26), "{at}");
        }
        assert!(position(&world, ids[0]).y < fx!(-1), "{}", position(&world, ids[0]));
        // Another tile closes it again: the next ball rolls over it.
        world.add_body(block(fx!(0), fx!(-0.5), 99)).expect("a tile");
        let next =
            BodyDef { velocity: vec2(2, 0), angular_velocity: fx!(-8), ..ball(vec2(-4, fx!(0.25)), fx!(0.25), 2) };
        let next = world.add_body(next).expect("a ball");
        (0..240).for_each(|_| _ = world.step());
        assert!(position(&world, next).x > fx!(3.9) && position(&world, next).y > fx!(0.24));
    }
}

#[test]
fn steps_walls_and_ends_are_real() {
    // A floor of tiles, a step of 1 m at 4 m, a wall of two tiles at −4 m that stands on the floor, and nothing beyond 8 m.
    let tiles = (-6..=8_i32).flat_map(|x| {
        let height = if x >= 4 { fx!(0.5) } else { fx!(-0.5) };
        let at = Fx::from(x);
        let wall = (x == -4).then(|| [fx!(0.5), fx!(1.5)].map(|y| block(at, y, 50 + y.to_bits() as u64)));
        std::iter::once(block(at, height, x as u64 & 0xFF)).chain(wall.into_iter().flatten())
    });
    let tiles: Vec<BodyDef> = tiles.collect();
    let smooth = material(fx!(0), fx!(0));
    for (speed, end) in [(3_i32, 3), (-3, -3)] {
        let collider = ColliderDef { material: smooth, ..ColliderDef::new(tile(fx!(1), fx!(1))) };
        let body = BodyDef {
            position: vec2(0, fx!(0.5)),
            velocity: vec2(speed, 0),
            ..BodyDef::dynamic().with_collider(collider)
        };
        let (mut world, ids) = world(def(), std::iter::once(body).chain(tiles.clone())).expect("a scene");
        let mut farthest = fx!(0);
        for _ in 0..180 {
            world.step();
            farthest = farthest.max(position(&world, ids[0]).x * Fx::from(speed.signum()));
        }
        // It reaches the edge, and no more than the overlap of a hit.
        assert!((farthest - Fx::from(end * speed.signum())).abs() < fx!(0.02), "{farthest} at {speed} m/s");
    }
    // Over the end of the floor it falls.
    let start = BodyDef { velocity: vec2(3, 0), ..ball(vec2(6, fx!(1.3)), fx!(0.25), 1) };
    let (mut world, ids) = world(def(), std::iter::once(start).chain(tiles)).expect("a scene");
    (0..120).for_each(|_| _ = world.step());
    assert!(position(&world, ids[0]).y < fx!(-1), "{}", position(&world, ids[0]));
}

#[test]
fn a_tile_with_another_filter_hides_no_edge() {
    let filter = |category, mask| Filter { category, mask, group: 0 };
    let mut hidden = block(fx!(1), fx!(-0.5), 2);
    hidden.colliders[0].filter = filter(2, !0);
    // It meets category 1 alone, and comes from where the other tile is.
    let mut ball = ball(vec2(1, fx!(-0.5)), fx!(0.25), 3);
    ball.velocity = vec2(-3, 0);
    ball.colliders[0].filter = filter(4, 1);
    let def = WorldDef { gravity: vec2(0, 0), ..def() };
    let (mut world, ids) = world(def, [block(fx!(0), fx!(-0.5), 1), hidden, ball]).expect("a scene");
    for _ in 0..60 {
        world.step();
        let x = position(&world, ids[2]).x;
        assert!(x > fx!(0.74), "{x}");
    }
}

/// A convex polygon, and the two that a cut from one edge to another makes of it.
fn cut(random: &mut Random) -> Option<[Vec<Vec2>; 3]> {
    let count = 3 + random.below(5) as usize;
    let mut angles: Vec<f64> =
        (0..count).map(|_| random.below(1 << 20) as f64 / f64::from(1 << 20) * std::f64::consts::TAU).collect();
    angles.sort_by(f64::total_cmp);
    let grid = |x: f64| Fx::from_bits(((x * 4096.0) as i64) << 20);
    let corners: Vec<Vec2> = angles.iter().map(|a| Vec2::new(grid(2.0 * a.cos()), grid(2.0 * a.sin()))).collect();
    let [i, j] = [random.below(count as u64) as usize, random.below(count as u64) as usize];
    let (i, j) = (i.min(j), i.max(j));
    if i == j {
        return None;
    }
    let mut point_on = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % count]);
        let part = Fx::from_ratio(1 + random.below(3) as i64, 4);
        Vec2::new(a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part)
    };
    let (from, to) = (point_on(i), point_on(j));
    let first = [from].into_iter().chain(corners[i + 1..=j].iter().copied()).chain([to]).collect();
    let second = [to].into_iter().chain(corners[j + 1..].iter().chain(&corners[..=i]).copied()).chain([from]).collect();
    Some([corners, first, second])
}

/// A static polygon where its corners are.
fn fixed(corners: &[Vec2], key: u64) -> Option<BodyDef> {
    let shape = Shape::polygon(corners).ok()?;
    let collider = ColliderDef { key, ..ColliderDef::new(shape.clone()) };
    Some(BodyDef { position: shape.shift(), key, ..BodyDef::fixed().with_collider(collider) })
}

#[test]
fn a_polygon_in_two_parts_pushes_as_a_whole_one() {
    let mut random = Random::seeded(run_seed(12));
    let def = WorldDef { gravity: vec2(0, 0), ..def() };
    // Bodies that are pushed, and those that the parts push in another way.
    let mut counts = [[0_i32; 2]; 2];
    for _ in 0..times(10_000) {
        let Some(parts) = cut(&mut random) else { continue };
        let [Some(whole), Some(first), Some(second)] = [0, 1, 2].map(|i| fixed(&parts[i], i as u64)) else { continue };
        let mut at = || random.number(fx!(-2.5)..=fx!(2.5));
        let (place, velocity) = (Vec2::new(at(), at()), Vec2::new(at(), at()));
        let is_disc = random.below(2) == 0;
        let body = match is_disc {
            true => ball(place, fx!(0.25), 7),
            false => BodyDef { angle: random.number(fx!(0)..=fx!(3)), ..square(place, 7).expect("a square") },
        };
        let body = BodyDef { velocity, ..body };
        let step = |statics: Vec<BodyDef>| {
            let (mut world, ids) = world(def, std::iter::once(body.clone()).chain(statics)).expect("a scene");
            world.step();
            let body = world.body(ids[0]).expect("it is there");
            (body.velocity() - velocity, body.angular_velocity())
        };
        // Nobody whose nearest edge may be the cut: a body that is deep in one of the parts.
        let pose = |def: &BodyDef| Pose::new(def.position, Turn::from_radians(def.angle));
        let outline = |def: &BodyDef| def.colliders[0].shape.outlines()[0].clone();
        let manifold = collide(&outline(&whole), &pose(&whole), &outline(&body), &pose(&body), fx!(0.02));
        let is_shallow = |manifold: &Manifold| manifold.count == 1 && manifold.points[0].separation > fx!(-0.05);
        if !manifold.as_ref().is_none_or(is_shallow) {
            continue;
        }
        let (whole_speeds, halves_speeds) = (step(vec![whole]), step(vec![first, second]));
        let size = |v: Vec2| v.x.abs() + v.y.abs();
        if size(whole_speeds.0) < fx!(0.01) && size(halves_speeds.0) < fx!(0.01) {
            continue;
        }
        counts[usize::from(is_disc)][0] += 1;
        let apart = size(whole_speeds.0 - halves_speeds.0);
        let differs = apart > fx!(0.0001) + size(whole_speeds.0) / 1_000;
        counts[usize::from(is_disc)][1] += i32::from(differs && manifold.is_some());
    }
    // Near a corner of the whole, one manifold has the deeper edge alone, and two manifolds have both. How many do depends on the seed.
    let is_alike = |[pushed, off]: &[i32; 2]| cfg!(debug_assertions) || *pushed > 50 && off * 8 < *pushed;
    assert!(counts.iter().all(is_alike), "{counts:?}");
}

/// A landscape of columns of tiles, with caves, that is not symmetric.
fn landscape(width: i32) -> Vec<BodyDef> {
    let mut random = Random::seeded(run_seed(17));
    let mut tiles = Vec::new();
    for x in -width..=width {
        let top = random.below(3) as i32;
        for y in -3..top {
            if random.below(6) > 0 || y == -3 {
                tiles.push(block(Fx::from(x), Fx::from(y), tiles.len() as u64 + 1_000));
            }
        }
    }
    for side in [-1, 1] {
        tiles.push(below(Vec2::new(Fx::from(side * (width + 1)) + fx!(0.5), fx!(9)), fx!(1), fx!(13)));
        let last = tiles.last_mut().expect("a wall");
        (last.key, last.colliders[0].key) = (5_000 + side as u64 % 7, 5_000 + side as u64 % 7);
    }
    tiles
}

fn crowd(count: u64, width: i32) -> Vec<BodyDef> {
    let mut random = Random::seeded(run_seed(21));
    let each = |key: u64| {
        let at = Vec2::new(random.number(Fx::from(-width)..=Fx::from(width)), fx!(4) + Fx::from(key as i32) / 4);
        let shape = match key % 3 {
            0 => return ball(at, fx!(0.375), key),
            1 => tile(fx!(0.75), fx!(0.75)),
            _ => Shape::capsule(fx!(0.75), fx!(0.25)).expect("a capsule"),
        };
        let collider = ColliderDef { key, ..ColliderDef::new(shape) };
        let angle = random.number(fx!(0)..=fx!(3));
        BodyDef { position: at, key, angle, ..BodyDef::dynamic().with_collider(collider) }
    };
    (0..count).map(each).collect()
}

#[test]
fn mirrored_shuffled_and_restored_tiles_keep_their_bits() {
    let bodies: Vec<BodyDef> = landscape(8).into_iter().chain(crowd(40, 7)).collect();
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    Random::seeded(5).shuffle(&mut order);
    let (mut here, ids) = world(def(), bodies.clone()).expect("a scene");
    let (mut twin_world, twins) = world(def(), order.iter().map(|&i| bodies[i].clone())).expect("a scene");
    let twin = |i: usize| twins[order.iter().position(|&at| at == i).expect("it is there")];
    let mut image = Symmetry::MIRROR.world(&here).expect("an image");
    let mut restored = here.clone();
    let mut fell = 0;
    for step in 0..300 {
        if step % 20 == 10 {
            // A tile goes: its place is empty, and later edges are real there.
            let i = step / 20 * 3;
            for (world, id) in
                [(&mut here, ids[i]), (&mut image, ids[i]), (&mut restored, ids[i]), (&mut twin_world, twin(i))]
            {
                world.remove_body(id).expect("a tile");
            }
        }
        let kept = here.clone();
        for world in [&mut here, &mut twin_world, &mut image, &mut restored] {
            world.step();
        }
        assert_eq!(here.physics_hash(), twin_world.physics_hash(), "{step}");
        assert_eq!(Symmetry::MIRROR.world(&here).expect("an image").first_difference(&image), None, "{step}");
        assert_eq!(here.state_hash(), restored.state_hash(), "{step}");
        if step % 10 == 0 {
            let bytes = restored.snapshot().to_bytes();
            restored = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
            // One that goes back takes the same way again.
            let after = here.state_hash();
            here.clone_from(&kept);
            here.step();
            assert_eq!(here.state_hash(), after, "{step}");
        }
        fell = ids[bodies.len() - 40..].iter().filter(|&&id| position(&here, id).y < fx!(-4)).count();
    }
    // The lowest row and the walls are whole.
    assert_eq!(fell, 0);
    assert!(here.contacts().count() > 40);
}

#[cfg(feature = "float")]
#[test]
fn floats_have_no_bumps_either() {
    use umbra_physics::{Geometry, Scalar, TimeStep, scalar::ToF64};
    fn height<S: Scalar + ToF64>(is_disc: bool) -> [f64; 2] {
        let scalar = S::from_fx;
        let def = WorldDef {
            gravity: Vec2::new(S::ZERO, scalar(fx!(-10))),
            time_step: TimeStep::hz(60),
            sleep_after: None,
            ..WorldDef::default()
        };
        let mut world = World::with_scalar(def).expect("a world");
        for i in -4..900 {
            let rectangle = Geometry::Rectangle { width: scalar(fx!(0.375)), height: S::ONE };
            let shape = Shape::new(rectangle).expect("a tile");
            let position = Vec2::new(scalar(fx!(0.375) * Fx::from(i)), scalar(fx!(-0.5)));
            world.add_body(BodyDef { position, ..BodyDef::fixed().with_collider(shape) }).expect("a tile");
        }
        let disc = Geometry::Circle { radius: scalar(fx!(0.5)) };
        let shape = Shape::new(if is_disc { disc } else { Geometry::Rectangle { width: S::ONE, height: S::ONE } });
        let mut collider = ColliderDef::new(shape.expect("a shape"));
        collider.material.friction = S::ZERO;
        let start = BodyDef {
            position: Vec2::new(S::ZERO, scalar(fx!(0.5))),
            velocity: Vec2::new(scalar(fx!(10)), S::ZERO),
            ..BodyDef::dynamic().with_collider(collider)
        };
        let id = world.add_body(start).expect("a body");
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for step in 0..1_800 {
            world.step();
            let body = world.body(id).expect("it is there");
            if step > 120 {
                let y = body.position().y.to_f64();
                range = [range[0].min(y), range[1].max(y)];
            }
            assert!(body.velocity().x.to_f64() > 9.999, "{step}");
        }
        range
    }
    for is_disc in [true, false] {
        let ([low, high], [from, to]) = (height::<f64>(is_disc), height::<f32>(is_disc));
        assert!(high - low < 1e-6, "{low} to {high}");
        assert!(to - from < 1e-4, "{from} to {to}");
    }
}
