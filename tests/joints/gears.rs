//! Gears in worlds.

use super::scenes::{assert_images_and_copies, assert_near, falling, steps, wheel};
use umbra_physics::{
    BodyDef, BodyId, Error, Fx, Gear, JointDef, JointId, JointKind, JointMotor, Mass, Quantity, Symmetry, World,
    WorldDef, fx, limits, vec2,
};

fn mesh(world: &mut World, first: BodyId, second: BodyId, teeth: [i16; 2]) -> JointId {
    let gear = JointDef::gear(world, first, second, teeth).expect("a gear");
    world.add_joint(gear).expect("a gear")
}

fn speed(world: &World, body: BodyId) -> Fx {
    world.body(body).expect("a body").angular_velocity()
}

/// A torque on the first wheel turns both as the inertia I₁ + I₂·(z₁/z₂)² says, for all signs of the teeth.
#[test]
fn a_torque_turns_both_wheels() {
    for teeth in [[12, 36], [36, 12], [12, -36], [-12, 36], [-20, -20], [1, 1_000]] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let [(first, _), (second, _)] =
            [(0, fx!(2)), (5, fx!(3))].map(|(x, inertia)| wheel(&mut world, vec2(x, 0), inertia));
        let gear = mesh(&mut world, first, second, teeth);
        for _ in 0..60 {
            world.apply_torque(first, fx!(7)).expect("a torque");
            world.step();
        }
        let [z1, z2] = teeth.map(|count| Fx::from(i32::from(count)));
        let ratio = z1 / z2;
        let expected = fx!(7) / (fx!(2) + fx!(3) * ratio * ratio);
        assert_near(speed(&world, first), expected, fx!(0.0005));
        assert_near(speed(&world, second), -expected * ratio, fx!(0.0005));
        // It gives the second wheel its torque.
        let torque = world.joint(gear).expect("a joint").torque();
        assert_near(torque, -expected * ratio * 3, fx!(0.001));
        assert_near(world.joint(gear).expect("a joint").angle(), fx!(0), fx!(0.0001));
    }
}

/// A train of 60 to 1, by 1 : 5, 1 : 4, 1 : 3, is in step to the last bits however long it has run.
#[test]
fn a_train_keeps_its_ratio() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let wheels = [0, 2, 4, 6].map(|x| wheel(&mut world, vec2(x, 0), fx!(1)));
    let gears: Vec<JointId> = [[1, -5], [1, -4], [1, -3]]
        .into_iter()
        .enumerate()
        .map(|(i, teeth)| mesh(&mut world, wheels[i].0, wheels[i + 1].0, teeth))
        .collect();
    world.set_joint_motor(wheels[0].1, Some(JointMotor { speed: fx!(60), max_force: fx!(1_000) })).expect("a motor");
    steps(&mut world, 3_600);
    for (body, expected) in wheels.iter().zip([fx!(60), fx!(12), fx!(3), fx!(1)]) {
        assert_near(speed(&world, body.0), expected, fx!(0.0001));
    }
    for gear in gears {
        assert_near(world.joint(gear).expect("a joint").angle(), fx!(0), fx!(0.00001));
    }
}

/// Teeth that are forced by more than half a tooth fit at the next one.
#[test]
fn a_gear_jumps_to_the_next_tooth() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let [(first, _), (second, _)] = [0, 5].map(|x| wheel(&mut world, vec2(x, 0), fx!(1)));
    let gear = mesh(&mut world, first, second, [10, 10]);
    for (turn, expected) in [(fx!(0.4), fx!(0.4)), (fx!(0.6), fx!(-0.4))] {
        // In teeth of a tenth of a turn.
        let tooth = Fx::PI / 5;
        world.set_angle(second, tooth * turn).expect("an angle");
        world.set_angle(first, fx!(0)).expect("an angle");
        assert_near(world.joint(gear).expect("a joint").angle(), tooth * expected, fx!(0.00001));
        steps(&mut world, 120);
        assert_near(world.joint(gear).expect("a joint").angle(), fx!(0), fx!(0.00001));
        for body in [first, second] {
            world.set_angular_velocity(body, fx!(0)).expect("a speed");
        }
    }
}

/// A weight on a drum lifts a heavier one on a larger wheel by the gear: both hang still where their moments are as their teeth.
#[test]
fn moments_are_in_balance_as_their_teeth() {
    let mut world = falling();
    // A beam of 1 m on each wheel, with its mass at the end.
    let beam = |world: &mut World, x: i32, mass: i32| {
        let mass = Mass::Explicit { mass: Fx::from(mass), inertia: fx!(0.1) };
        let body = world.add_body(BodyDef { position: vec2(x + 1, 0), mass, ..BodyDef::dynamic() }).expect("a body");
        let pin = JointDef::at(world, None, body, vec2(x, 0)).expect("a joint");
        world.add_joint(pin).expect("a joint");
        body
    };
    let (light, heavy) = (beam(&mut world, 0, 1), beam(&mut world, 4, 3));
    let gear = mesh(&mut world, light, heavy, [10, -30]);
    steps(&mut world, 1);
    // Of the same sense of turning, 1 kg at ten teeth against 3 kg at thirty would fall.
    assert!(speed(&world, light) < fx!(-0.1) && speed(&world, heavy) < fx!(-0.03));
    let mut world = falling();
    let (light, heavy) = (beam(&mut world, 0, 1), beam(&mut world, 4, 3));
    let balanced = mesh(&mut world, light, heavy, [10, 30]);
    assert_eq!(balanced, gear);
    steps(&mut world, 60);
    assert_near(speed(&world, light), fx!(0), fx!(0.0001));
    assert_near(world.joint(balanced).expect("a joint").torque(), fx!(30), fx!(0.01));
}

#[test]
fn images_and_copies_go_on_in_the_same_bits() {
    assert_images_and_copies(|| {
        let mut world = falling();
        let wheels = [0, 2, 4].map(|x| wheel(&mut world, vec2(x, 0), fx!(1)));
        mesh(&mut world, wheels[0].0, wheels[1].0, [12, 20]);
        mesh(&mut world, wheels[2].0, wheels[1].0, [8, -20]);
        world.set_joint_motor(wheels[0].1, Some(JointMotor { speed: fx!(3), max_force: fx!(1) })).expect("a motor");
        let free = [6, 8].map(|x| {
            let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(0.2) };
            let body = BodyDef { position: vec2(x, 0), angular_velocity: fx!(2), mass, ..BodyDef::dynamic() };
            world.add_body(body).expect("a body")
        });
        mesh(&mut world, free[0], free[1], [3, 5]);
        world
    });
}

/// Turned by a quarter, gears are out of step unless both of them together turn by whole teeth.
#[test]
fn a_quarter_turn_keeps_whole_teeth() {
    for (teeth, has_image) in [([12, 20], true), ([12, 21], false), ([20, -60], true), ([1, 1], false)] {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let [(first, _), (second, _)] = [0, 5].map(|x| wheel(&mut world, vec2(x, 0), fx!(1)));
        mesh(&mut world, first, second, teeth);
        assert_eq!(Symmetry::TURN.world(&world).is_some(), has_image, "{teeth:?}");
        assert!(Symmetry::MIRROR.world(&world).is_some());
    }
}

/// A gear has no motor, and no teeth out of range.
#[test]
fn teeth_out_of_range_are_refused() {
    let largest = limits::TEETH as i16;
    for teeth in [[0, 1], [1, 0], [largest + 1, 1], [1, i16::MIN]] {
        let refusal = Err(Error::OutOfRange { quantity: Quantity::Teeth });
        assert_eq!(JointKind::<Fx>::Gear(Gear { teeth }).check(), refusal);
    }
    assert_eq!(JointKind::<Fx>::Gear(Gear { teeth: [largest, -largest] }).check(), Ok(()));
    let mut world = World::new(WorldDef::default()).expect("a world");
    let [(first, _), (second, _)] = [0, 5].map(|x| wheel(&mut world, vec2(x, 0), fx!(1)));
    let gear = mesh(&mut world, first, second, [1, 1]);
    assert_eq!(world.set_joint_motor(gear, None), Err(Error::NoMotor { joint: gear }));
}
