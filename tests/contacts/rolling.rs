//! Rolling resistance against closed forms: what rolls slows down by two thirds of c·g, stops, and stands on a slope below atan(c).

use super::scenes::{def, through_bytes, world};
use umbra_physics::{
    BodyDef, BodyId, ColliderDef, Fx, Geometry, Material, Scalar, Shape, Snapshot, Symmetry, TimeStep, Vec2, World,
    WorldDef, fx, vec2,
};

/// A body with this collider, whose rolling resistance is c and whose friction is 0.9.
fn rolling<S: Scalar>(geometry: Geometry<S>, c: Fx, base: BodyDef<S>) -> BodyDef<S> {
    let material =
        Material { friction: S::from_fx(fx!(0.9)), rolling_resistance: S::from_fx(c), ..Material::default() };
    let shape = Shape::new(geometry).expect("a shape");
    BodyDef { colliders: vec![ColliderDef { material, ..ColliderDef::new(shape) }], ..base }
}

fn disc<S: Scalar>(c: Fx) -> BodyDef<S> {
    rolling(Geometry::Circle { radius: S::from_fx(fx!(0.5)) }, c, BodyDef::dynamic())
}

fn floor<S: Scalar>() -> BodyDef<S> {
    let geometry = Geometry::Rectangle { width: S::from_fx(fx!(200)), height: S::from_fx(fx!(2)) };
    let base = BodyDef { position: Vec2::new(S::ZERO, S::from_fx(fx!(-1))), ..BodyDef::fixed() };
    rolling(geometry, Fx::ZERO, base)
}

/// A disc at this velocity on a level floor, rolling without slip.
fn on_the_floor<S: Scalar>(c: Fx, velocity: Fx) -> (World<S>, BodyId) {
    let scalar = |value: Fx| S::from_fx(value);
    let gravity = Vec2::new(S::ZERO, scalar(fx!(-10)));
    let def = WorldDef { gravity, sleep_after: None, ..WorldDef::default() };
    let mut world = World::with_scalar(def).expect("a world");
    world.add_body(floor()).expect("a floor");
    let disc = BodyDef {
        position: Vec2::new(S::ZERO, scalar(fx!(0.5))),
        velocity: Vec2::new(scalar(velocity), S::ZERO),
        angular_velocity: scalar(velocity * -2),
        ..disc(c)
    };
    let id = world.add_body(disc).expect("a disc");
    (world, id)
}

fn near(value: Fx, expected: Fx, bound: Fx) {
    assert!((value - expected).abs() <= bound, "{value} for {expected}");
}

fn speed(world: &World, id: BodyId) -> Fx {
    world.body(id).expect("it").velocity().x
}

#[test]
fn a_disc_slows_down_by_two_thirds_of_c_g_and_stops() {
    for c in [fx!(0.015), fx!(0.15), fx!(0.6)] {
        for start in [fx!(3), fx!(-3)] {
            let (mut world, id) = on_the_floor::<Fx>(c, start);
            let mut before = start.abs();
            for tick in 1..=1200 {
                world.step();
                let slower = c * fx!(10) * Fx::from_ratio(2 * tick, 180);
                let now = speed(&world, id) * start.signum();
                near(now, (start.abs() - slower).max(Fx::ZERO), fx!(0.004));
                // Friction and rolling resistance take turns, and what is left at the stop changes its sign.
                assert!(now.abs() <= before.max(fx!(0.002)), "{now} after {before}");
                before = now.abs();
            }
            // Two units of the solver.
            assert!(c == fx!(0.015) || before <= Fx::from_bits(1 << 11), "{before}");
        }
    }
}

#[test]
fn a_ball_stopped_by_rolling_resistance_stays() {
    let (mut world, id) = on_the_floor::<Fx>(fx!(0.15), fx!(2));
    (0..180).for_each(|_| _ = world.step());
    let at = world.body(id).expect("it").position();
    (0..3600).for_each(|_| _ = world.step());
    let end = world.body(id).expect("it").position();
    // A minute at a velocity that the solver does not see: about half a unit, 2^-23 m/s.
    near(end.x, at.x, fx!(0.00001));
}

#[test]
fn without_a_coefficient_it_rolls_for_ever() {
    let (mut world, id) = on_the_floor::<Fx>(fx!(0), fx!(2));
    (0..600).for_each(|_| _ = world.step());
    near(speed(&world, id), fx!(2), fx!(0.00005));
    let contact = world.contacts().next().expect("it touches");
    assert_eq!(contact.rolling_impulse, fx!(0));
}

#[test]
fn the_impulse_is_that_of_the_torque() {
    let (mut world, id) = on_the_floor::<Fx>(fx!(0.15), fx!(2));
    (0..60).for_each(|_| _ = world.step());
    let contact = world.contacts_of(id).expect("it").next().expect("it touches");
    // c·R·m·g·h with h = 1/300 s, against the clockwise rotation.
    let mass = world.body(id).expect("it").mass().expect("a mass");
    near(contact.rolling_impulse, mass * fx!(0.15) * fx!(5) / 300, fx!(0.000001));
}

/// The acceleration of a disc on a slope over a second, once the contact is there, and the way it has gone from rest.
fn on_a_slope(c: Fx, tilt: Fx) -> (Fx, Fx) {
    let (sin, cos) = tilt.sin_cos();
    let at = |along: Fx| Vec2::new(-sin * along, cos * along);
    let slope = BodyDef { position: at(fx!(-1)), angle: tilt, ..floor() };
    let disc = BodyDef { position: at(fx!(0.5)), ..disc(c) };
    let (mut world, ids) = world(def(), [slope, disc]).expect("a scene");
    (0..30).for_each(|_| _ = world.step());
    let before = world.body(ids[1]).expect("it").velocity();
    (0..60).for_each(|_| _ = world.step());
    let body = world.body(ids[1]).expect("it");
    (body.velocity().distance(before), body.position().distance(at(fx!(0.5))))
}

#[test]
fn a_ball_stands_on_slopes_below_the_coefficient_and_rolls_on_steeper_ones() {
    let c = fx!(0.2);
    let limit = c.atan2(Fx::ONE);
    for below in [fx!(0.5) * limit, limit - fx!(0.002)] {
        let (acceleration, way) = on_a_slope(c, below);
        assert!(acceleration < fx!(0.00001) && way < fx!(0.001), "{acceleration} m/s², {way} m at {below}");
    }
    for above in [limit + fx!(0.002), limit + fx!(0.1), fx!(2) * limit] {
        let (acceleration, _) = on_a_slope(c, above);
        let (sin, cos) = above.sin_cos();
        near(acceleration, fx!(20) / 3 * (sin - c * cos), fx!(0.0005));
    }
}

/// A ball on top of a planet slows down as it does on a floor: its own radius counts.
#[test]
fn where_both_are_round_the_smaller_radius_counts() {
    let planet = rolling(Geometry::Circle { radius: fx!(4000) }, fx!(0), BodyDef::fixed());
    let planet = BodyDef { position: vec2(0, -4000), ..planet };
    let ball =
        BodyDef { position: vec2(0, fx!(0.5)), velocity: vec2(2, 0), angular_velocity: fx!(-4), ..disc(fx!(0.15)) };
    let (mut world, ids) = world(def(), [planet, ball]).expect("a scene");
    (0..60).for_each(|_| _ = world.step());
    near(speed(&world, ids[1]), fx!(1), fx!(0.01));
}

/// A pair of discs, one of which is a wheel of ten metres on a plank of half a metre: the row of the plank has an arm far beyond it.
#[test]
fn a_large_wheel_turns_a_small_plank() {
    let wheel = BodyDef {
        position: vec2(0, 10),
        angular_velocity: fx!(2),
        ..rolling(Geometry::Circle { radius: fx!(10) }, fx!(0.5), BodyDef::dynamic())
    };
    let plank = rolling(Geometry::Rectangle { width: fx!(0.5), height: fx!(0.1) }, fx!(0), BodyDef::dynamic());
    let plank = BodyDef { position: vec2(0, fx!(-0.05)), velocity: vec2(0, 1), ..plank };
    let (mut world, ids) = world(WorldDef { gravity: vec2(0, 0), ..def() }, [wheel, plank]).expect("a scene");
    let spin = |world: &World| -> Fx {
        let body = |id| world.body(id).expect("it");
        body(ids[0]).angular_velocity() - body(ids[1]).angular_velocity()
    };
    let mut before = spin(&world);
    for _ in 0..30 {
        let energy = world.kinetic_energy().expect("an energy");
        world.step();
        assert!(world.kinetic_energy().expect("an energy") <= energy);
        assert!(spin(&world).abs() <= before.abs() + fx!(0.00001), "{} {before}", spin(&world));
        before = spin(&world);
    }
    assert!(before < fx!(1.9), "{before}");
}

/// Discs, capsules and rounded boxes that fall onto a floor between two walls.
fn heap(c: Fx) -> Vec<BodyDef> {
    let wall = |x| BodyDef { position: vec2(x, 0), angle: Fx::PI / 2, ..floor() };
    let mut bodies = vec![floor(), wall(-6), wall(6)];
    for i in 0..30_i32 {
        let geometry = match i % 3 {
            0 => Geometry::Circle { radius: fx!(0.4) },
            1 => Geometry::Capsule { length: fx!(0.5), radius: fx!(0.3) },
            _ => Geometry::RoundedPolygon {
                corners: [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| vec2(x, y) / 2).into(),
                radius: fx!(0.125),
            },
        };
        let (x, y) = (Fx::from_ratio(i64::from(i % 5 * 7 - 14), 4), Fx::from_ratio(i64::from(i / 5 * 5 + 3), 4));
        let at = BodyDef {
            position: Vec2::new(x, y),
            angular_velocity: Fx::from(i % 7 - 3),
            key: i as u64 + 9,
            ..BodyDef::dynamic()
        };
        let mut body = rolling(geometry, c, at);
        body.colliders[0].key = i as u64 + 9;
        bodies.push(body);
    }
    bodies
}

#[test]
fn a_mirrored_heap_rolls_the_other_way() {
    let (mut world, _) = world(def(), heap(fx!(0.1))).expect("a scene");
    let image = |world: &World| Symmetry::MIRROR.world(world).expect("an image");
    let mut mirrored = image(&world);
    let mut rolled = 0;
    for tick in 0..240 {
        world.step();
        mirrored.step();
        if tick == 120 {
            // Impulses are scaled alike.
            let time_step = TimeStep::hz(100);
            world.set_time_step(time_step).and_then(|()| mirrored.set_time_step(time_step)).expect("a time step");
        }
        assert_eq!(image(&world).state_hash(), mirrored.state_hash(), "{tick}");
        rolled += world.contacts().filter(|contact| contact.rolling_impulse != fx!(0)).count();
    }
    assert!(rolled > 1000, "{rolled}");
}

#[test]
fn a_heap_from_bytes_or_in_another_order_goes_on_with_the_same_bits() {
    let bodies = heap(fx!(0.1));
    let reversed: Vec<BodyDef> = bodies.iter().rev().cloned().collect();
    let (mut here, _) = world(def(), bodies).expect("a scene");
    // All pairs are the other way round.
    let (mut twin, _) = world(def(), reversed).expect("a scene");
    for _ in 0..200 {
        here.step();
        twin.step();
        assert_eq!(here.physics_hash(), twin.physics_hash());
        here = through_bytes(&here);
    }
}

/// The energy of a heap never grows by rolling resistance: no more than it does without it.
#[test]
fn a_heap_comes_to_rest_sooner() {
    let left = |c| {
        let (mut world, _) = world(def(), heap(c)).expect("a scene");
        (0..300).for_each(|_| _ = world.step());
        world.kinetic_energy().expect("an energy")
    };
    assert!(left(fx!(0.3)) < left(fx!(0)));
}

/// A disc that stands on a slope goes on standing when the time step changes: the impulse is scaled with it.
#[test]
fn a_change_of_the_time_step_moves_nothing() {
    let (sin, cos) = fx!(0.15).sin_cos();
    let at = |along: Fx| Vec2::new(-sin * along, cos * along);
    let slope = BodyDef { position: at(fx!(-1)), angle: fx!(0.15), ..floor() };
    let (mut world, ids) =
        world(def(), [slope, BodyDef { position: at(fx!(0.5)), ..disc(fx!(0.2)) }]).expect("a scene");
    (0..120).for_each(|_| _ = world.step());
    for rate in [240, 30, 60] {
        world.set_time_step(TimeStep::hz(rate)).expect("a time step");
        for _ in 0..rate {
            world.step();
            let spin = world.body(ids[1]).expect("it").angular_velocity();
            assert!(spin.abs() < fx!(0.0001), "{spin} at {rate} Hz");
        }
    }
}

#[cfg(feature = "float")]
#[test]
fn floats_roll_as_fixed_point_does() {
    use umbra_physics::scalar::ToF64;
    fn end<S: Scalar + ToF64>(c: Fx) -> [f64; 2] {
        let (mut world, id) = on_the_floor::<S>(c, fx!(2));
        (0..60).for_each(|_| _ = world.step());
        let after = world.body(id).expect("it").velocity().x.to_f64();
        (0..120).for_each(|_| _ = world.step());
        [after, world.body(id).expect("it").velocity().x.to_f64()]
    }
    let fixed = end::<Fx>(fx!(0.15));
    for (float, bound) in [(end::<f64>(fx!(0.15)), 1e-5), (end::<f32>(fx!(0.15)), 1e-4)] {
        assert!((0..2).all(|i| (float[i] - fixed[i]).abs() < bound), "{float:?} {fixed:?}");
    }
}

#[test]
fn a_world_of_bouncing_and_rolling_bodies_can_be_saved_after_every_step() {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    world.add_body(floor()).expect("a floor");
    for i in 0..8 {
        let mut body = disc(fx!(1));
        body.colliders[0].material.restitution = fx!(1) * i / 8;
        let (position, angular_velocity) = (Vec2::new(Fx::from(3 * i), fx!(0.5) + fx!(0.3) * i), fx!(40));
        world.add_body(BodyDef { position, angular_velocity, ..body }).expect("a disc");
    }
    for _ in 0..240 {
        world.step();
        let bytes = world.snapshot().to_bytes();
        let restored = Snapshot::from_bytes(&bytes, &[]).expect("its own bytes").into_world();
        assert_eq!(restored.state_hash(), world.state_hash());
    }
}

/// The point of a disc on a face and the point at the end of the face are one: a load that started from nothing there would press the disc in.
/// A step takes the disc by 5 mm, so that it passes the end in all parts of a step.
#[test]
fn a_disc_that_rolls_over_the_end_of_a_table_keeps_its_impulse() {
    for (way, tenth) in [1, -1].into_iter().flat_map(|way| (0..10).map(move |tenth| (way, tenth))) {
        let way = Fx::from_ratio(way, 1);
        let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
        let table = BodyDef { position: vec2(0, fx!(-0.5)), ..BodyDef::fixed() };
        world
            .add_body(rolling(Geometry::Rectangle { width: fx!(4), height: fx!(1) }, Fx::ZERO, table))
            .expect("a table");
        let disc = BodyDef {
            position: vec2(way * (fx!(1.9) + fx!(0.0005) * Fx::from_ratio(tenth, 1)), fx!(0.5)),
            velocity: vec2(way * fx!(0.3), 0),
            angular_velocity: way * fx!(-0.6),
            ..disc(Fx::ZERO)
        };
        let id = world.add_body(disc).expect("a disc");
        let mut steps_beyond = 0;
        for _ in 0..120 {
            world.step();
            let ahead = world.body(id).expect("a disc").position().x * way - fx!(2);
            if ahead > fx!(0.1) {
                break;
            }
            steps_beyond += u32::from(ahead > Fx::ZERO);
            let contact = world.contacts().next().expect("a contact");
            let [point] = contact.points() else { panic!("{contact:?}") };
            // 0.785 kg under gravity for a sub-step of 1/300 s: 0.026 N·s where it stands.
            assert!(point.normal_impulse > fx!(0.02), "{ahead}: {contact:?}");
        }
        assert!(steps_beyond > 10, "{steps_beyond}");
    }
}
