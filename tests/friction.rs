//! Friction with a ground that is seen from above: constant decelerations, an exact stop, and what it holds.

use umbra_physics::{
    Activity, BodyDef, BodyId, Error, FieldKind, ForceField, Fx, Integrator, Irreversible, Locks, Mass, Quantity,
    Region, Shape, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

const TICK: Fx = fx!(0.015625);

fn friction(deceleration: Fx, angular_deceleration: Fx) -> FieldKind {
    FieldKind::Friction { deceleration, angular_deceleration }
}

fn world(integrator: Integrator) -> World {
    World::new(WorldDef { time_step: TimeStep::hz(64), integrator, ..WorldDef::default() }).expect("a world")
}

/// A world with a body and a friction of 2 m/s² and 3 rad/s².
fn sliding(integrator: Integrator, velocity: Vec2, angular_velocity: Fx) -> (World, BodyId) {
    let mut world = world(integrator);
    world.add_field(friction(fx!(2), fx!(3))).expect("a field");
    let body = world.add_body(BodyDef { velocity, angular_velocity, ..BodyDef::dynamic() }).expect("a body");
    (world, body)
}

fn velocity(world: &World, body: BodyId) -> Vec2 {
    world.body(body).expect("a body").velocity()
}

fn position(world: &World, body: BodyId) -> Vec2 {
    world.body(body).expect("a body").position()
}

#[test]
fn speed_and_spin_fall_at_constant_rates_whatever_the_mass_and_the_integrator() {
    for integrator in Integrator::ALL {
        let (mut world, body) = sliding(integrator, vec2(3, -4), fx!(-6));
        let heavy = BodyDef { velocity: vec2(3, -4), mass: Mass::Kilograms(fx!(70)), ..BodyDef::dynamic() };
        let heavy = world.add_body(heavy).expect("a body");
        for tick in 1..=96 {
            world.step();
            let t = TICK * tick;
            let left = vec2(3, -4) * ((fx!(5) - t * 2) / 5);
            assert!((velocity(&world, body) - left).length() < fx!(0.00000002), "{integrator} {tick}");
            assert_eq!(velocity(&world, heavy), velocity(&world, body));
            let spin = world.body(body).unwrap().angular_velocity();
            assert!((spin + fx!(6) - t * 3).abs() < fx!(0.00000002), "{integrator} {tick}: {spin}");
            // The way vt − at²/2, and half a step's loss for the integrators of order 1.
            let way = fx!(5) * t - t * t;
            let late = match integrator {
                Integrator::VelocityVerlet => fx!(0.0000001),
                _ => fx!(2) * TICK * t,
            };
            assert!((position(&world, body).length() - way).abs() <= late, "{integrator} {tick}");
        }
    }
}

#[test]
fn a_body_stops_to_the_bit_in_its_direction_and_falls_asleep() {
    for (v, spin) in [(vec2(3, -4), fx!(-6)), (Vec2::new(fx!(0.013), fx!(0.37)), fx!(2.34)), (vec2(-7, 1), fx!(0.01))] {
        for integrator in Integrator::ALL {
            let (mut world, body) = sliding(integrator, v, spin);
            let (mut last, mut turning) = (v.length(), spin.abs());
            for tick in 0..300 {
                world.step();
                let look = world.body(body).unwrap();
                let now = look.velocity();
                let across = now.x * v.y - now.y * v.x;
                assert!(now.x * v.x + now.y * v.y >= fx!(0) && across.abs() < fx!(0.00000003), "{tick}: {now}");
                assert!(look.angular_velocity() * spin >= fx!(0));
                // As long as it moves it loses, and then it has nothing, below an ulp either.
                let left = last - fx!(2) * TICK;
                assert!(if left > fx!(0.0000001) { (now.length() - left).abs() < fx!(0.00000001) } else { true });
                if left < fx!(-0.0000001) {
                    assert!(look.velocity_exact() == Vec2::default(), "{integrator} {tick}: {now}");
                }
                if turning < fx!(3) * TICK - fx!(0.0000001) {
                    assert_eq!(look.angular_velocity_exact().to_bits(), 0);
                }
                (last, turning) = (now.length(), look.angular_velocity().abs());
            }
            assert_eq!(world.body(body).unwrap().activity(), Activity::Asleep, "{integrator}");
            if integrator == Integrator::VelocityVerlet {
                let way = v.length() * v.length() / 4;
                let error = (position(&world, body).length() - way).abs();
                assert!(error <= fx!(2) * TICK * TICK / 8 + fx!(0.0000001), "{v}: {error}");
            }
        }
    }
}

#[test]
fn what_is_pushed_by_less_stays_to_the_bit_and_by_more_goes_by_the_difference() {
    for integrator in Integrator::ALL {
        for (push, moves) in [(fx!(1.999), false), (fx!(2), false), (fx!(2.5), true)] {
            let (mut world, body) = sliding(integrator, vec2(0, 0), fx!(0));
            let mass = world.body(body).unwrap().mass().unwrap();
            let everywhere = Region::Disc { centre: vec2(0, 0), radius: fx!(1000) };
            let wind = vec2(fx!(0.6), fx!(0.8)) * push;
            // Half of it by a field, half by the caller.
            world.add_field(FieldKind::Zone { region: everywhere, acceleration: wind / 2 }).unwrap();
            for _ in 0..128 {
                world.apply_force(body, wind * mass / 2).unwrap();
                world.step();
            }
            let (way, speed) = (position(&world, body).length(), velocity(&world, body).length());
            if moves {
                // The first kick of the published integrator is a half.
                let late = if integrator == Integrator::PublishedVerlet { push * TICK } else { fx!(0.00001) };
                assert!((speed - (push - fx!(2)) * 2).abs() < late, "{integrator} {push}: {speed}");
            } else {
                // An integrator that steps backwards in between, or drifts by accelerations, lets it go by half of a·h² in a step.
                let creeps = matches!(integrator, Integrator::Yoshida4 | Integrator::PublishedVerlet);
                let creep = if creeps { push * TICK * TICK / 2 * 128 } else { fx!(0) };
                assert!(
                    speed == fx!(0) && way <= creep + fx!(0.0000001) && (creep > fx!(0) || way == fx!(0)),
                    "{integrator} {push}: {way}"
                );
            }
        }
    }
}

#[test]
fn frictions_of_one_body_add_up_in_any_order_and_act_on_their_groups() {
    let parts = [fx!(0.1), fx!(0.7), fx!(1.2)];
    let run = |order: [usize; 3]| {
        let mut world = world(Integrator::VelocityVerlet);
        for i in order {
            world.add_field(friction(parts[i], parts[i] * 2)).unwrap();
        }
        world.add_field(ForceField { kind: friction(fx!(50), fx!(50)), force_groups: 2 }).unwrap();
        let def = BodyDef { velocity: vec2(3, 1), angular_velocity: fx!(4), force_groups: 1, ..BodyDef::dynamic() };
        let body = world.add_body(def.clone()).unwrap();
        let mover = BodyDef { velocity: vec2(3, 1), ..BodyDef::kinematic() };
        let mover = world.add_body(mover).unwrap();
        (0..40).for_each(|_| _ = world.step());
        assert_eq!(velocity(&world, mover), vec2(3, 1));
        let look = world.body(body).unwrap();
        (look.velocity_exact(), look.angular_velocity_exact(), look.position_exact())
    };
    let first = run([0, 1, 2]);
    assert_eq!(first, run([2, 1, 0]));
    assert_eq!(first, run([1, 2, 0]));
    let speed = first.0.map(|part| part.value()).length();
    assert!((speed - vec2(3, 1).length() + fx!(2) * TICK * 40).abs() < fx!(0.00000002), "{speed}");
}

#[test]
fn it_wakes_and_lets_go_what_it_held_and_minds_locks() {
    let (mut world, body) = sliding(Integrator::VelocityVerlet, vec2(0, 0), fx!(0));
    let everywhere = Region::Disc { centre: vec2(0, 0), radius: fx!(1000) };
    world.add_field(FieldKind::Zone { region: everywhere, acceleration: vec2(1, 0) }).unwrap();
    (0..60).for_each(|_| _ = world.step());
    assert_eq!((world.body(body).unwrap().activity(), position(&world, body)), (Activity::Asleep, vec2(0, 0)));
    let (field, _) = world.fields().find(|(_, field)| matches!(field.kind, FieldKind::Friction { .. })).unwrap();
    world.set_field(field, friction(fx!(0.5), fx!(0))).unwrap();
    (0..64).for_each(|_| _ = world.step());
    assert!((velocity(&world, body).x - fx!(0.5)).abs() < fx!(0.00000002));
    let (mut world, body) = sliding(Integrator::VelocityVerlet, vec2(0, 3), fx!(0));
    world.set_locks(body, Locks { x: true, rotation: true, ..Locks::NONE }).unwrap();
    (0..32).for_each(|_| _ = world.step());
    assert!((velocity(&world, body) - vec2(0, 2)).length() < fx!(0.00000001));
}

/// Curling: a stone of 20 kg strikes another one, and both slide on until they have stopped.
#[test]
fn stones_that_strike_each_other_stop_where_their_speeds_take_them() {
    let mut world = World::new(WorldDef::default()).unwrap();
    world.add_field(friction(fx!(0.2), fx!(0.4))).unwrap();
    let stone = umbra_physics::ColliderDef {
        material: umbra_physics::Material { friction: fx!(0), restitution: fx!(1), ..Default::default() },
        ..umbra_physics::ColliderDef::new(Shape::circle(fx!(0.15)).unwrap())
    };
    let stone = BodyDef { mass: Mass::Kilograms(fx!(20)), ..BodyDef::dynamic().with_collider(stone) };
    let red = world.add_body(BodyDef { velocity: Vec2::new(fx!(2.4), fx!(0)), ..stone.clone() }).unwrap();
    let yellow = world.add_body(BodyDef { position: vec2(10, 0), ..stone }).unwrap();
    (0..1_500).for_each(|_| _ = world.step());
    // 2.4² − 2·0.2·9.7 is the square of its speed there.
    let reach = (fx!(2.4) * fx!(2.4) - fx!(0.4) * fx!(9.7)) / fx!(0.4);
    assert!((position(&world, yellow).x - fx!(10) - reach).abs() < fx!(0.02), "{}", position(&world, yellow));
    assert!((position(&world, red).x - fx!(9.7)).abs() < fx!(0.02), "{}", position(&world, red));
    assert!([red, yellow].iter().all(|&stone| world.body(stone).unwrap().activity() == Activity::Asleep));
}

#[test]
fn decelerations_out_of_range_are_refused_and_its_steps_are_not_undone() {
    let mut world = world(Integrator::VelocityVerlet);
    let largest = fx!(65536);
    assert!(world.add_field(friction(largest, largest)).is_ok());
    let out = Err(Error::OutOfRange { quantity: Quantity::Deceleration });
    for [linear, angular] in
        [[largest + Fx::DELTA, fx!(0)], [-Fx::DELTA, fx!(0)], [fx!(0), -Fx::DELTA], [fx!(0), largest + Fx::DELTA]]
    {
        assert_eq!(world.add_field(friction(linear, angular)), out);
    }
    world.set_sleep_after(None).unwrap();
    let velocity = vec2(limits(), -limits());
    let body = world.add_body(BodyDef { velocity, angular_velocity: limits(), ..BodyDef::dynamic() }).unwrap();
    world.step();
    let look = world.body(body).unwrap();
    assert!((look.velocity().x + look.velocity().y).abs() <= Fx::DELTA && look.velocity().x < limits() - fx!(700));
    assert!((limits() - look.angular_velocity() - fx!(1024)).abs() < fx!(0.000001));
    assert!(matches!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Velocity { .. } })));
}

fn limits() -> Fx {
    umbra_physics::limits::SPEED
}
