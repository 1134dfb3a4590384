//! Compounds as colliders: each part touches by itself.

use super::scenes::{def, ground, keeps_its_bits, through_bytes, world};
use crate::seeds::run_seed;
use umbra_physics::{
    BodyDef, BodyId, Cause, ColliderDef, ContactSettings, Error, Fx, Geometry, Mass, Part, Shape, Symmetry, Vec2,
    World, WorldDef, fx, vec2,
};

fn part(shape: Shape, x: Fx, y: Fx) -> Part {
    Part { shape, position: Vec2::new(x, y), angle: fx!(0), density: fx!(1) }
}

/// A cup: a bottom and two walls, which is not convex.
fn cup() -> Result<Shape, Error> {
    let wall = Shape::rectangle(fx!(0.25), fx!(2))?;
    let walls = [fx!(-0.875), fx!(0.875)].map(|x| part(wall.clone(), x, fx!(1)));
    let parts: Vec<Part> = walls.into_iter().chain([part(Shape::rectangle(2, fx!(0.25))?, fx!(0), fx!(0))]).collect();
    Shape::compound(&parts)
}

fn of(shape: Shape, position: Vec2, key: u64) -> BodyDef {
    let collider = ColliderDef { key, ..ColliderDef::new(shape) };
    BodyDef { position, key, ..BodyDef::dynamic().with_collider(collider) }
}

/// Cups with balls above them.
fn cups(count: i32) -> Result<Vec<BodyDef>, Error> {
    let mut bodies = vec![ground()?];
    for i in 0..count {
        let x = Fx::from(3 * i) + fx!(0.125);
        bodies.push(of(cup()?, Vec2::new(x, fx!(1.25)), 10 * i as u64));
        let ball = Shape::circle(fx!(0.25))?;
        bodies.extend((1..5).map(|k| {
            of(ball.clone(), Vec2::new(x + Fx::from_ratio(i64::from(k % 2), 8), fx!(3) + k.into()), (10 * i + k) as u64)
        }));
    }
    Ok(bodies)
}

/// A body with a collider for each part of its compounds, and with the same mass.
fn taken_apart(def: &BodyDef) -> BodyDef {
    let each = |collider: &ColliderDef| match collider.shape.geometry() {
        Geometry::Compound { parts } => {
            let collider_of = |part: &Part| ColliderDef {
                shape: part.shape.clone(),
                position: part.position,
                angle: part.angle,
                ..collider.clone()
            };
            parts.iter().map(collider_of).collect()
        }
        _ => vec![collider.clone()],
    };
    BodyDef { colliders: def.colliders.iter().flat_map(each).collect(), ..def.clone() }
}

fn bits(world: &World, id: BodyId) -> impl PartialEq + std::fmt::Debug {
    let body = world.body(id).expect("it is there");
    (body.position_exact(), body.velocity_exact(), body.angle_exact(), body.angular_velocity_exact())
}

#[test]
fn a_compound_moves_as_a_body_with_a_collider_for_each_part() {
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1.5) };
    let bodies = cups(4).expect("a scene").into_iter().map(|def| BodyDef { mass, ..def });
    let bodies: Vec<BodyDef> = bodies
        .enumerate()
        .map(|(i, def)| if i == 0 { BodyDef { mass: Mass::FromColliders, ..def } } else { def })
        .collect();
    let (mut here, ids) = world(def(), bodies.clone()).expect("a scene");
    let (mut twin, twins) = world(def(), bodies.iter().map(taken_apart)).expect("a scene");
    let mut inside = 0;
    for step in 0..300 {
        here.step();
        twin.step();
        for (&body, &twin_body) in ids.iter().zip(&twins) {
            assert_eq!(bits(&here, body), bits(&twin, twin_body), "{body} after {step} steps");
        }
        inside += here.contacts().filter(|contact| contact.parts.contains(&2)).count();
    }
    assert!(inside > 1_000, "{inside}");
    // The balls are in their cups.
    for cup in ids[1..].chunks(5) {
        let x = here.body(cup[0]).expect("a cup").position().x;
        for &ball in &cup[1..] {
            assert!((here.body(ball).expect("a ball").position().x - x).abs() < fx!(1));
        }
    }
}

#[test]
fn mirrored_shuffled_and_restored_compounds_keep_their_bits() {
    let mut touched = false;
    keeps_its_bits(cups(4).expect("a scene"), (200, 5), |world| {
        touched = world.contacts().any(|contact| contact.parts[1] == 2);
    });
    assert!(touched);
}

#[test]
fn colliders_and_their_parts_come_and_go() {
    // Numbers of outlines shift with each of these: no bit depends on what was there before.
    let (mut here, ids) = world(def(), cups(3).expect("a scene")).expect("a scene");
    let shapes = [Shape::circle(fx!(0.5)), cup(), Shape::rectangle(1, 1)].map(|shape| shape.expect("a shape"));
    for step in 0..180_usize {
        let body = ids[1 + step / 3 % (ids.len() - 1)];
        let collider_id = here.colliders_of(body).expect("it").next();
        match (step % 3, collider_id) {
            (0, _) => _ = here.add_collider(body, shapes[step / 3 % 3].clone()).expect("a collider"),
            (1, Some(first_collider)) => {
                here.set_collider(first_collider, shapes[step / 7 % 3].clone()).expect("a collider")
            }
            (_, Some(first_collider)) if here.colliders_of(body).expect("it").count() > 1 => {
                here.remove_collider(first_collider).expect("a collider");
            }
            _ => {}
        }
        let mut fresh = through_bytes(&here);
        here.step();
        fresh.step();
        assert_eq!(fresh.state_hash(), here.state_hash(), "{step}");
    }
}

#[test]
fn parts_of_one_body_are_no_pairs() {
    let disc = Shape::circle(fx!(0.5)).expect("a disc");
    let parts: Vec<Part> = (0..256).map(|i| part(disc.clone(), Fx::from_ratio(i % 16, 64), Fx::ZERO)).collect();
    let crowd = of(Shape::compound(&parts).expect("a compound"), vec2(0, fx!(0.75)), 1);
    let contacts = ContactSettings { max_pairs: 256, max_pairs_per_collider: 1, ..ContactSettings::default() };
    let still = umbra_physics::WorldDef { contacts, ..def() };
    let (mut world, _) = world(still, [ground().expect("a ground"), crowd]).expect("a scene");
    for _ in 0..60 {
        assert!(world.step().faults.is_empty());
    }
    assert!(world.contacts().count() > 100);
    world.add_body(BodyDef { position: vec2(9, fx!(0.5)), ..BodyDef::dynamic().with_collider(disc) }).expect("a disc");
    // One pair too many: each outline has one, so that all are left out.
    let faults = world.step().faults;
    assert!(faults.len() == 2 && faults.iter().all(|fault| fault.cause == Cause::Pairs), "{faults:?}");
}

/// Boxes side by side as colliders of one body.
fn row(count: i32, size: Fx, key: u64) -> Result<BodyDef, Error> {
    let middle = Fx::from_ratio(i64::from(count - 1), 2);
    let collider = |i: i32| {
        let position = Vec2::new((Fx::from(i) - middle) * size, Fx::ZERO);
        Ok(ColliderDef { position, key: key + i as u64, ..ColliderDef::new(Shape::rectangle(size, size)?) })
    };
    Ok(BodyDef { key, colliders: (0..count).map(collider).collect::<Result<_, Error>>()?, ..BodyDef::dynamic() })
}

/// The squares of an L, of a cross and of a row, in units of their side.
const PIECES: [&[[i32; 2]]; 3] =
    [&[[0, 0], [0, 1], [0, 2], [1, 0]], &[[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]], &[[0, 0], [1, 0], [2, 0]]];

/// A compound of squares of 0.5 m.
fn piece(places: &[[i32; 2]]) -> Result<Shape, Error> {
    let unit = Shape::rectangle(fx!(0.5), fx!(0.5))?;
    let parts = places.iter().map(|&[x, y]| part(unit.clone(), Fx::from(x) / 2, Fx::from(y) / 2));
    Shape::compound(&parts.collect::<Vec<_>>())
}

/// A floor of tiles, a platform of boxes that moves and turns, rafts of boxes, and what falls on them.
fn flush() -> Result<Vec<BodyDef>, Error> {
    let floor = BodyDef { position: vec2(0, fx!(-0.5)), ..row(40, fx!(1), 10_000)? };
    let platform = BodyDef {
        position: vec2(fx!(-3), fx!(3)),
        velocity: vec2(fx!(0.5), 0),
        angular_velocity: fx!(0.0625),
        ..row(8, fx!(0.75), 20_000)?
    };
    let mut bodies = vec![
        BodyDef { kind: umbra_physics::BodyKind::Static, ..floor },
        BodyDef { kind: umbra_physics::BodyKind::Kinematic, ..platform },
    ];
    let mut random = umbra_physics::Random::seeded(29);
    for key in 0..36_u64 {
        let at = Vec2::new(random.number(fx!(-6)..=fx!(6)), fx!(4) + Fx::from(key as i32) / 3);
        let angle = random.number(fx!(0)..=fx!(3));
        let body = match key % 4 {
            0 => row(2 + (key / 4 % 4) as i32, fx!(0.375), 100 * key)?,
            1 => of(piece(PIECES[0])?, at, 100 * key),
            2 => of(piece(PIECES[1])?, at, 100 * key),
            _ => of(Shape::circle(fx!(0.25))?, at, 100 * key),
        };
        bodies.push(BodyDef { position: at, angle, velocity: vec2(0, -3), ..body });
    }
    Ok(bodies)
}

#[test]
fn mirrored_shuffled_and_restored_rafts_keep_their_bits() {
    let mut contacts = 0;
    keeps_its_bits(flush().expect("a scene"), (240, 12), |world| contacts = contacts.max(world.contacts().count()));
    assert!(contacts > 40, "{contacts}");
}

#[test]
fn rafts_that_are_turned_or_listed_otherwise_keep_their_bits() {
    let bodies = flush().expect("a scene");
    let (mut listed, ids) = world(def(), bodies.clone()).expect("a scene");
    let bodies_reversed = bodies.into_iter().map(|mut def| {
        def.colliders.reverse();
        def
    });
    let (mut reversed, twins) = world(def(), bodies_reversed).expect("a scene");
    let mut image = Symmetry::TURN.world(&listed).expect("an image");
    for step in 0..240 {
        for world in [&mut listed, &mut reversed, &mut image] {
            world.step();
        }
        for (&id, &twin) in ids.iter().zip(&twins) {
            assert_eq!(bits(&listed, id), bits(&reversed, twin), "{id} after {step} steps");
        }
        assert_eq!(Symmetry::TURN.world(&listed).expect("an image").first_difference(&image), None, "{step}");
    }
}

/// Boxes of unlike heights beside each other: each covers a part of an edge of the next one.
fn stairs(random: &mut umbra_physics::Random, key: u64) -> BodyDef {
    let mut left = Fx::ZERO;
    let mut collider = |i: u64| {
        let [width, height, up] = [fx!(1), fx!(1), fx!(0.25)].map(|max| random.number(fx!(0.125)..=max));
        let position = Vec2::new(left + width / 2, up);
        left += width;
        ColliderDef { position, key: key + i, ..ColliderDef::new(Shape::rectangle(width, height).expect("a box")) }
    };
    BodyDef { key, colliders: (0..4).map(&mut collider).collect(), ..BodyDef::dynamic() }
}

#[test]
fn edges_that_are_covered_in_part_have_the_same_contacts_in_either_order() {
    let mut random = umbra_physics::Random::seeded(run_seed(11));
    let mut contacts = 0;
    for case in 0..2_000 {
        let bodies = [0, 100].map(|key| {
            let [x, y] = [0, 1].map(|_| random.number(fx!(-1)..=fx!(1)));
            let angle = if case % 3 == 0 { fx!(0) } else { random.number(fx!(0)..=fx!(6)) };
            BodyDef { position: Vec2::new(x, y), angle, ..stairs(&mut random, key) }
        });
        let (mut here, ids) = world(def(), bodies.clone()).expect("a scene");
        let (mut reversed, twins) = world(def(), bodies.into_iter().rev()).expect("a scene");
        for step in 0..4 {
            here.step();
            reversed.step();
            for (&id, &twin) in ids.iter().zip(twins.iter().rev()) {
                assert_eq!(bits(&here, id), bits(&reversed, twin), "case {case}, {step}");
            }
        }
        contacts += here.contacts().count();
    }
    assert!(contacts > 500, "{contacts}");
}

/// Rafts, pieces and what falls on them stay above the floor, and come to lie there without sinking into each other.
#[test]
fn a_heap_of_rafts_and_pieces_does_not_sink_in() {
    let mut bodies = flush().expect("a scene");
    bodies.remove(1);
    let walls = [-8, 8].map(|x| {
        let wall = Shape::rectangle(1, 60).expect("a wall");
        BodyDef { position: vec2(x, 20), key: 50_000 + x as u64 % 3, ..BodyDef::fixed().with_collider(wall) }
    });
    bodies.extend(walls);
    let (mut world, ids) = world(def(), bodies).expect("a scene");
    (0..900).for_each(|_| _ = world.step());
    let contacts = world.contacts().flat_map(|contact| contact.points().to_vec());
    let pushed = contacts.filter(|point| point.normal_impulse > Fx::ZERO);
    let deepest = pushed.fold(Fx::ZERO, |deepest, point| deepest.min(point.separation));
    assert!(deepest > fx!(-0.02), "{deepest}");
    for &id in &ids[1..37] {
        let body = world.body(id).expect("a body");
        assert!(body.position().y > fx!(0.15) && body.position().x.abs() < fx!(8), "{id}: {}", body.position());
        assert!(body.velocity().x.abs() + body.velocity().y.abs() < fx!(0.2), "{id}: {}", body.velocity());
    }
}

/// The corners of a square of this side at a place and an angle, in world axes.
fn square(side: f64, at: [f64; 2], angle: f64) -> [[f64; 2]; 4] {
    let (sin, cos) = angle.sin_cos();
    [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
        .map(|[x, y]| [at[0] + side * (cos * x - sin * y), at[1] + side * (sin * x + cos * y)])
}

/// The depth by which two convex polygons overlap, negative if they are apart.
fn depth(a: &[[f64; 2]; 4], b: &[[f64; 2]; 4]) -> f64 {
    let separation = |polygon: &[[f64; 2]; 4], second: &[[f64; 2]; 4]| {
        let along = (0..4).map(|i| {
            let ([x, y], [to_x, to_y]) = (polygon[i], polygon[(i + 1) % 4]);
            let length = (to_x - x).hypot(to_y - y);
            let height = |&[px, py]: &[f64; 2]| ((to_y - y) * (px - x) - (to_x - x) * (py - y)) / length;
            second.iter().map(height).fold(f64::INFINITY, f64::min)
        });
        along.fold(f64::NEG_INFINITY, f64::max)
    };
    -separation(a, b).max(separation(b, a))
}

/// Pieces of squares that overlap by up to 2 cm, in all positions in which they hook into each other, are pushed apart by about as much: no
/// pair of squares pushes the one through the other.
#[test]
fn pieces_that_overlap_a_little_are_pushed_apart_a_little() {
    let mut random = umbra_physics::Random::seeded(7);
    let (mut tried, mut failures) = (0, Vec::new());
    for case in 0..20_000 {
        let kinds = [0, 1].map(|_| random.number(fx!(0)..=fx!(2.99)).to_bits() as usize >> 32);
        let angle = if case % 2 == 0 { fx!(0) } else { random.number(fx!(0)..=fx!(6)) };
        let [x, y] = [0, 1].map(|_| random.number(fx!(-1.5)..=fx!(1.5)));
        let f = |value: Fx| value.to_bits() as f64 / 4_294_967_296.0;
        let bodies = [(0, Vec2::new(fx!(0), fx!(0)), fx!(0)), (1, Vec2::new(x, y), angle)].map(
            |(side, position, angle): (usize, _, _)| BodyDef {
                angle,
                ..of(piece(PIECES[kinds[side]]).expect("a piece"), position, side as u64)
            },
        );
        let still = WorldDef { gravity: vec2(0, 0), ..def() };
        let (mut world, ids) = world(still, bodies).expect("a scene");
        let squares = |world: &World, side: usize| -> Vec<[[f64; 2]; 4]> {
            let body = world.body(ids[side]).expect("a body");
            let count = PIECES[kinds[side]].len() as f64;
            // A compound is centred at its centre of mass.
            let centre =
                [0, 1].map(|axis| PIECES[kinds[side]].iter().map(|at| f64::from(at[axis]) / 2.0).sum::<f64>() / count);
            let corner = |at: &[i32; 2]| {
                let [x, y] = [0, 1].map(|axis| f64::from(at[axis]) / 2.0 - centre[axis]);
                let (sin, cos) = f(body.angle()).sin_cos();
                let place = [f(body.position().x) + cos * x - sin * y, f(body.position().y) + sin * x + cos * y];
                square(0.5, place, f(body.angle()))
            };
            PIECES[kinds[side]].iter().map(corner).collect()
        };
        let deepest = |world: &World| {
            let (a, b) = (squares(world, 0), squares(world, 1));
            let depths = a.iter().flat_map(|a| b.iter().map(move |b| depth(a, b)));
            depths.fold(f64::NEG_INFINITY, f64::max)
        };
        let before = deepest(&world);
        if !(0.002..0.02).contains(&before) {
            continue;
        }
        tried += 1;
        let starts = ids.iter().map(|&id| world.body(id).expect("a body").position()).collect::<Vec<_>>();
        let mut fastest = Fx::ZERO;
        for _ in 0..120 {
            world.step();
            for &id in &ids {
                let body = world.body(id).expect("a body");
                fastest = fastest.max(body.velocity().length()).max(body.angular_velocity().abs());
            }
        }
        let ways = ids
            .iter()
            .zip(&starts)
            .map(|(&id, &start)| f((world.body(id).expect("a body").position() - start).length()));
        let way = ways.fold(0.0, f64::max);
        if fastest > fx!(0.5) || deepest(&world) > before.min(0.006) || way > 0.2 {
            failures.push(format!(
                "{case}: {kinds:?} at {x} {y}, {angle}: {before:.4} m deep, then {:.4}; {fastest} m/s, {way:.3} m",
                deepest(&world)
            ));
        }
    }
    assert!(failures.is_empty(), "{} of {tried}: {:#?}", failures.len(), &failures[..failures.len().min(12)]);
    assert!(tried > 100, "{tried}");
}
