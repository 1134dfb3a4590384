//! Compounds as colliders: each part touches by itself.

use super::scenes::{def, ground, keeps_its_bits, through_bytes, world};
use umbra_physics::{
    BodyDef, BodyId, Cause, ColliderDef, ContactSettings, Error, Fx, Geometry, Mass, Part, Shape, Vec2, World, fx, vec2,
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
            let one = |part: &Part| ColliderDef {
                shape: part.shape.clone(),
                position: part.position,
                angle: part.angle,
                ..collider.clone()
            };
            parts.iter().map(one).collect()
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
    let (mut there, twins) = world(def(), bodies.iter().map(taken_apart)).expect("a scene");
    let mut inside = 0;
    for step in 0..300 {
        here.step();
        there.step();
        for (&own, &other) in ids.iter().zip(&twins) {
            assert_eq!(bits(&here, own), bits(&there, other), "{own} after {step} steps");
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
        let own = here.colliders_of(body).expect("it").next();
        match (step % 3, own) {
            (0, _) => _ = here.add_collider(body, shapes[step / 3 % 3].clone()).expect("a collider"),
            (1, Some(own)) => here.set_collider(own, shapes[step / 7 % 3].clone()).expect("a collider"),
            (_, Some(own)) if here.colliders_of(body).expect("it").count() > 1 => {
                here.remove_collider(own).expect("a collider");
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
