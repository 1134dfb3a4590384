//! Pulleys in worlds.

use super::scenes::{assert_images_and_copies, falling, steps};
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, BodyDef, BodyId, Damping, Error, Fx, JointDef, JointId, JointKind, Mass, Pulley, Quantity, Shape, Vec2,
    World, fx, vec2,
};

fn load(world: &mut World, position: Vec2, mass: Fx) -> BodyId {
    let mass = Mass::Explicit { mass, inertia: mass };
    world.add_body(BodyDef { position, mass, ..BodyDef::dynamic() }).expect("a body")
}

/// Two loads at the height 0 on a rope over points 8 m above.
fn hoist(world: &mut World, masses: [Fx; 2], strands: [u8; 2]) -> ([BodyId; 2], JointId) {
    let bodies = [0, 1].map(|k| load(world, vec2(3 * k as i32, 0), masses[k]));
    let rope = JointDef::pulley(world, bodies, [vec2(0, 0), vec2(3, 0)], [vec2(0, 8), vec2(3, 8)], strands);
    let rope = world.add_joint(rope.expect("a rope")).expect("a rope");
    (bodies, rope)
}

fn velocity(world: &World, body: BodyId) -> Vec2 {
    world.body(body).expect("a body").velocity()
}

fn height(world: &World, body: BodyId) -> f64 {
    world.body(body).expect("a body").position().y.to_f64()
}

/// Atwood's machine: with z strands, T = g·(z₁ + z₂)/(z₁²/m₁ + z₂²/m₂) pulls each load by z·T.
#[test]
fn two_loads_move_as_atwood_says() {
    for (masses, strands) in [
        ([fx!(1), fx!(3)], [1, 1]),
        ([fx!(5), fx!(5.01)], [1, 1]),
        ([fx!(1), fx!(1_000)], [1, 1]),
        ([fx!(1), fx!(1)], [1, 2]),
        ([fx!(2), fx!(3)], [3, 2]),
        ([fx!(1), fx!(70)], [1, 64]),
    ] {
        let mut world = falling();
        world.set_sleep_after(None).expect("never");
        let (bodies, rope) = hoist(&mut world, masses, strands);
        steps(&mut world, 60);
        let [m1, m2] = masses.map(ToF64::to_f64);
        let [z1, z2] = strands.map(f64::from);
        let tension = 10.0 * (z1 + z2) / (z1 * z1 / m1 + z2 * z2 / m2);
        for (body, mass, strands) in [(bodies[0], m1, z1), (bodies[1], m2, z2)] {
            let (speed, expected) = (velocity(&world, body).y.to_f64(), strands * tension / mass - 10.0);
            println!("{masses:?} {strands}: {speed} of {expected}");
            assert!((speed - expected).abs() < 3e-6, "{masses:?}: {speed} is not {expected}");
        }
        let force = world.joint(rope).expect("a joint").force();
        let expected = z2 * tension;
        assert!((force.y.to_f64() - expected).abs() < 1e-3 * expected && force.x.abs() < fx!(0.001), "{force}");
    }
}

/// A rope that hangs through does nothing, and holds at its length: the loads fly up on parabolas, and the rope takes the jerk without a gain of energy.
#[test]
fn it_pulls_and_does_not_push() {
    let mut world = falling();
    let (bodies, rope) = hoist(&mut world, [fx!(1), fx!(2)], [1, 1]);
    for body in bodies {
        world.set_velocity(body, vec2(0, 5)).expect("a velocity");
    }
    steps(&mut world, 30);
    assert_eq!(bodies.map(|body| velocity(&world, body)), [vec2(0, 0); 2]);
    assert_eq!(world.joint(rope).expect("a joint").force(), vec2(0, 0));
    assert!(world.joint(rope).expect("a joint").length() < fx!(14));
    let energy = |world: &World| world.energy().expect("an energy").to_f64();
    let before = energy(&world);
    let mut longest = fx!(0);
    for _ in 0..60 {
        world.step();
        longest = longest.max(world.joint(rope).expect("a joint").length());
    }
    let after = energy(&world);
    println!("longest {longest}, energy {before} to {after}");
    assert!(longest < fx!(16.02) && after < before + 0.01, "{longest}, {before} to {after}");
}

/// Two loads of one mass hang still, and sleep.
#[test]
fn equal_loads_rest() {
    let mut world = falling();
    let (bodies, rope) = hoist(&mut world, [fx!(4), fx!(4)], [1, 1]);
    steps(&mut world, 3_600);
    println!("rope {}", world.joint(rope).expect("a joint").length());
    for body in bodies {
        assert!(height(&world, body).abs() < 0.002, "{}", height(&world, body));
        assert_eq!(world.body(body).expect("a body").activity(), Activity::Asleep);
    }
}

/// A load that swings, against one that hangs straight (a swinging Atwood machine): it keeps its energy of some 70 J, and the rope its length.
#[test]
fn a_swinging_load_keeps_the_energy() {
    for mass in [fx!(1.1), fx!(1.2)] {
        let mut world = falling();
        let (bodies, rope) = hoist(&mut world, [fx!(1), mass], [1, 1]);
        world.set_position(bodies[0], vec2(-4, 1)).expect("a position");
        let joint = world.joint(rope).expect("a joint");
        let (JointKind::Pulley(pulley), length) = (joint.def().kind, joint.length()) else { panic!("a pulley") };
        world.set_joint_kind(rope, JointKind::Pulley(Pulley { length, ..pulley })).expect("a length");
        let energy = |world: &World| world.energy().expect("an energy").to_f64();
        let start = energy(&world);
        let (mut stretch, mut drift) = (fx!(0), 0.0_f64);
        for _ in 0..1_200 {
            world.step();
            stretch = stretch.max(world.joint(rope).expect("a joint").length() - length);
            drift = drift.max((energy(&world) - start).abs());
        }
        println!("swinging against {mass} kg: stretch {stretch}, energy {drift} J");
        assert!(stretch < fx!(0.0005) && drift < 0.2, "{stretch}, {drift}");
    }
}

/// A force off the centre turns a load, as a force of any other kind would: the rope is held at the corner of a beam, and the beam comes to hang from it.
#[test]
fn a_beam_hangs_from_its_end() {
    let mut world = falling();
    let beam = BodyDef::dynamic().with_collider(Shape::rectangle(2, fx!(0.25)).expect("a shape"));
    let damping = Some(Damping::kept_per_second(fx!(0.5)));
    let beam = BodyDef { linear_damping: damping, angular_damping: damping, ..beam };
    let beam = world.add_body(beam).expect("a body");
    let mass = world.body(beam).expect("a body").mass().expect("a mass");
    let weight = load(&mut world, vec2(3, 0), mass);
    let rope = JointDef::pulley(&world, [beam, weight], [vec2(1, 0), vec2(3, 0)], [vec2(1, 8), vec2(3, 8)], [1, 1]);
    world.add_joint(rope.expect("a rope")).expect("a rope");
    steps(&mut world, 1_800);
    let body = world.body(beam).expect("a body");
    let end = body.world_point(vec2(1, 0)).expect("a point");
    assert!((end.x - fx!(1)).abs() < fx!(0.02) && (body.position().x - fx!(1)).abs() < fx!(0.02), "{end}");
    assert!((end.y - body.position().y - fx!(1)).abs() < fx!(0.01), "{end} {}", body.position());
}

/// Loads on one rope touch each other: the heavy one comes down on the light one that stands in its way.
#[test]
fn loads_that_meet_touch() {
    let mut world = falling();
    let bodies = [(0, 1), (2, 3)].map(|(y, mass)| {
        let body = BodyDef::dynamic().with_collider(Shape::rectangle(1, 1).expect("a shape"));
        let mass = Mass::Kilograms(Fx::from(mass));
        world.add_body(BodyDef { position: vec2(0, y), mass, ..body }).expect("a body")
    });
    let rope = JointDef::pulley(&world, bodies, [vec2(0, 0), vec2(0, 2)], [vec2(0, 9), vec2(0, 9)], [1, 1]);
    world.add_joint(rope.expect("a rope")).expect("a rope");
    steps(&mut world, 120);
    let apart = height(&world, bodies[1]) - height(&world, bodies[0]);
    assert!((apart - 1.0).abs() < 0.01, "{apart}");
}

/// Loads of unlike masses on a floor: the rope is taut, the light one hangs, and all rests.
fn on_a_floor() -> World {
    let mut world = falling();
    let floor = BodyDef::fixed().with_collider(Shape::rectangle(20, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..floor }).expect("a body");
    let [light, heavy] = [(-2, fx!(4)), (1, fx!(0.5))].map(|(x, y)| {
        let body = BodyDef::dynamic().with_collider(Shape::rectangle(1, 1).expect("a shape"));
        let mass = Mass::Kilograms(if x < 0 { fx!(2) } else { fx!(20) });
        world.add_body(BodyDef { position: Vec2::new(Fx::from(x), y), mass, ..body }).expect("a body")
    });
    let points = [Vec2::new(fx!(-2), fx!(4.5)), Vec2::new(fx!(1), fx!(1))];
    let rope = JointDef::pulley(&world, [light, heavy], points, [vec2(-1, 8), vec2(1, 8)], [1, 1]).expect("a rope");
    world.add_joint(rope).expect("a rope");
    world
}

#[test]
fn a_light_load_hangs_from_a_heavy_one_on_the_floor() {
    let mut world = on_a_floor();
    let damping = Damping::kept_per_second(fx!(0.3));
    world.set_damping(damping, damping).expect("a damping");
    steps(&mut world, 3_600);
    let rope = world.joints().next().expect("a rope");
    let force = rope.force().length();
    println!("rope {} of {force} N", rope.length());
    assert!((force - fx!(20)).abs() < fx!(0.2), "{force}");
    let is_asleep = |body| world.body(body).is_ok_and(|body| body.activity() == Activity::Asleep);
    assert!(rope.bodies().into_iter().flatten().all(is_asleep));
}

#[test]
fn images_and_copies_have_the_same_bits() {
    assert_images_and_copies(on_a_floor);
    assert_images_and_copies(|| {
        let mut world = falling();
        let (bodies, _) = hoist(&mut world, [fx!(1), fx!(3)], [2, 1]);
        world.set_velocity(bodies[0], vec2(3, 1)).expect("a velocity");
        world
    });
}

/// Values out of range are refused by name.
#[test]
fn values_out_of_range_are_refused() {
    let pulley = Pulley { grounds: [vec2(0, 1), vec2(2, 1)], strands: [1, 1], length: fx!(2) };
    assert_eq!(JointKind::Pulley(pulley).check(), Ok(()));
    let far = [vec2(0, 1), Vec2::new(Fx::MAX, fx!(0))];
    for (pulley, quantity) in [
        (Pulley { grounds: far, ..pulley }, Quantity::Position),
        (Pulley { strands: [0, 1], ..pulley }, Quantity::Strands),
        (Pulley { strands: [1, 65], ..pulley }, Quantity::Strands),
        (Pulley { length: fx!(0), ..pulley }, Quantity::JointLength),
        (Pulley { length: Fx::from(1 << 21), ..pulley }, Quantity::JointLength),
    ] {
        assert_eq!(JointKind::Pulley(pulley).check(), Err(Error::OutOfRange { quantity }));
    }
}
