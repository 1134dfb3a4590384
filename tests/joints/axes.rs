//! Limits, motors, friction and springs of joints in worlds.

use super::scenes::{assert_images_and_copies, assert_stays, falling, slope, steps};
use umbra_physics::{
    Activity, BodyDef, BodyId, ColliderDef, Command, Error, Fx, FxFactor, Inputs, Irreversible, JointDef, JointId,
    JointKind, JointLimits, JointMotor, JointSpring, Mass, RecordOptions, Recorder, Replay, Revolute, Shape, Vec2,
    Weld, World, WorldDef, fx, vec2,
};

/// A world without gravity with a wheel of 1 kg·m² on an axle.
fn wheel(revolute: Revolute) -> (World, BodyId, JointId) {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(1) };
    let wheel = world.add_body(BodyDef { mass, ..BodyDef::dynamic() }).expect("a body");
    let axle = JointDef::at(&world, None, wheel, vec2(0, 0)).expect("a joint");
    let joint = world.add_joint(JointDef { kind: JointKind::Revolute(revolute), ..axle }).expect("a joint");
    (world, wheel, joint)
}

fn motor(speed: i32, max_force: i32) -> Option<JointMotor> {
    Some(JointMotor { speed: Fx::from(speed), max_force: Fx::from(max_force) })
}

fn angle(world: &World, joint: JointId) -> Fx {
    world.joint(joint).expect("a joint").angle()
}

/// Limits of many turns hold where they are: at 270°, at ±π, at three turns; the angle is not wrapped.
#[test]
fn limits_hold_over_many_turns() {
    let pi = Fx::PI;
    for (lower, upper) in [(-pi * 3 / 2, pi * 3 / 2), (-pi, pi), (-pi * 6, pi * 6), (fx!(0), pi * 41)] {
        for direction in [1, -1] {
            let limits = Some(JointLimits { lower, upper });
            let (mut world, wheel, joint) =
                wheel(Revolute { limits, motor: motor(12 * direction, 100), ..Revolute::default() });
            steps(&mut world, 900);
            let stop = if direction > 0 { upper } else { lower };
            assert!((angle(&world, joint) - stop).abs() < fx!(0.0001), "{} of {stop}", angle(&world, joint));
            assert!(world.body(wheel).expect("a body").angular_velocity().abs() < fx!(0.0001));
            // The motor presses with its torque, the limit holds against it.
            assert!(world.joint(joint).expect("a joint").torque().abs() < fx!(0.01));
        }
    }
}

/// A wheel that turns 40 times a second relative to a lift that turns as well, counts its turns, also where its angle is set by a call.
#[test]
fn whole_turns_are_counted() {
    let limits = Some(JointLimits { lower: fx!(-100_000), upper: fx!(100_000) });
    let (mut world, wheel, joint) = wheel(Revolute { limits, ..Revolute::default() });
    world.set_angular_velocity(wheel, fx!(-251)).expect("a speed");
    steps(&mut world, 600);
    let body = world.body(wheel).expect("a body");
    let wanted = body.angular_velocity() * 10;
    assert!((angle(&world, joint) - wanted).abs() < fx!(0.01), "{} of {wanted}", angle(&world, joint));
    let before = angle(&world, joint);
    let turned = world.body(wheel).expect("a body").angle_exact().radians() + fx!(3);
    world.set_angle(wheel, turned).expect("an angle");
    assert!((angle(&world, joint) - before - fx!(3)).abs() < fx!(0.0001), "{} after {before}", angle(&world, joint));
    world.set_angle(wheel, turned - fx!(3)).expect("an angle");
    assert!((angle(&world, joint) - before).abs() < fx!(0.0001));
}

/// A motor has its torque: α = τ/I, to 10^-5, and its speed after that, to 10^-6.
#[test]
fn a_motor_has_its_torque_and_its_speed() {
    let (mut world, wheel, joint) = wheel(Revolute { motor: motor(5, 2), ..Revolute::default() });
    for tick in 1..=300 {
        world.step();
        let spin = world.body(wheel).expect("a body").angular_velocity();
        let wanted = (Fx::from_ratio(2 * tick, 60)).min(fx!(5));
        assert!((spin - wanted).abs() < fx!(0.00005), "{tick}: {spin} of {wanted}");
        if tick < 150 {
            assert!((world.joint(joint).expect("a joint").torque() - fx!(2)).abs() < fx!(0.00001));
        }
    }
    assert!((world.joint(joint).expect("a joint").speed() - fx!(5)).abs() < fx!(0.000002));
    assert!(world.joint(joint).expect("a joint").torque().abs() < fx!(0.001));
}

/// A motor that turns round wakes its wheel at once, also just before it would sleep.
#[test]
fn a_motor_that_turns_round_wakes_its_wheel() {
    let (mut world, wheel, joint) = wheel(Revolute { motor: motor(0, 2), ..Revolute::default() });
    steps(&mut world, 120);
    assert_eq!(world.body(wheel).expect("a body").activity(), Activity::Asleep);
    world.set_joint_motor(joint, motor(-3, 2)).expect("a motor");
    steps(&mut world, 1);
    let spin = world.body(wheel).expect("a body").angular_velocity();
    assert!((spin + Fx::from_ratio(2, 60)).abs() < fx!(0.00001), "{spin}");
}

/// A car on its brakes: wheels that a motor of speed 0 holds on a slope of 20° do not creep in ten minutes.
#[test]
fn brakes_hold_a_car_on_a_slope() {
    let mut world = falling();
    slope(&mut world);
    let (sin, cos) = (fx!(0.34202014), fx!(0.93969262));
    let up = |along: Fx, height: Fx| Vec2::new(along * cos - height * sin, along * sin + height * cos);
    let chassis = BodyDef::dynamic().with_collider(Shape::rectangle(2, fx!(0.4)).expect("a shape"));
    let chassis = BodyDef { angle: Fx::PI / 9, position: up(fx!(0), fx!(0.7)), ..chassis };
    let chassis = world.add_body(chassis).expect("a body");
    for side in [-1, 1] {
        let at = up(fx!(0.7) * side, fx!(0.4));
        let tyre = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.4)).expect("a shape"));
        let tyre = world.add_body(BodyDef { position: at, ..tyre }).expect("a body");
        let axle = JointDef::at(&world, chassis, tyre, at).expect("a joint");
        let kind = JointKind::Revolute(Revolute { motor: motor(0, 1000), ..Revolute::default() });
        world.add_joint(JointDef { kind, ..axle }).expect("a joint");
    }
    assert_stays(&mut world, chassis);
}

/// A door with a spring swings with its period about its hinge: 0.5 Hz, undamped.
#[test]
fn a_door_swings_with_the_period_of_its_spring() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let door = BodyDef::dynamic().with_collider(Shape::rectangle(1, fx!(0.1)).expect("a shape"));
    let door = world.add_body(BodyDef { position: vec2(fx!(0.5), 0), ..door }).expect("a body");
    let hinge = JointDef::at(&world, None, door, vec2(0, 0)).expect("a joint");
    let spring = Some(JointSpring { rest: fx!(0.5), ..JointSpring::new(fx!(0.5), fx!(0)) });
    let kind = JointKind::Revolute(Revolute { spring, ..Revolute::default() });
    let hinge = world.add_joint(JointDef { kind, ..hinge }).expect("a joint");
    world.set_sleep_after(None).expect("a number");
    // After ten whole periods it is back where it began, at an angle of 0, with no speed but half a sub-step's.
    steps(&mut world, 1200);
    assert!(angle(&world, hinge).abs() < fx!(0.0005), "{}", angle(&world, hinge));
    steps(&mut world, 60);
    assert!((angle(&world, hinge) - fx!(1)).abs() < fx!(0.0005), "{}", angle(&world, hinge));
}

/// A tower of ten welded boxes with a hundred times their mass on top leans by less than 1 mm.
#[test]
fn a_welded_tower_stands_straight() {
    let mut world = falling();
    let mut below: Option<BodyId> = None;
    for i in 0..10 {
        let density = if i == 9 { fx!(100) } else { fx!(1) };
        let part = ColliderDef { density, ..ColliderDef::new(Shape::rectangle(fx!(0.5), 1).expect("a shape")) };
        let part = BodyDef {
            position: Vec2::new(fx!(0), fx!(0.5) + Fx::from(i)),
            colliders: vec![part],
            ..BodyDef::dynamic()
        };
        let part = world.add_body(part).expect("a body");
        let weld = JointDef::at(&world, below, part, vec2(0, i)).expect("a joint");
        world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), ..weld }).expect("a joint");
        below = Some(part);
    }
    let top = below.expect("a tower");
    world.apply_impulse(top, vec2(5, 0)).expect("an impulse");
    steps(&mut world, 600);
    let lean = world.body(top).expect("a body").position().x.abs();
    assert!(lean < fx!(0.001), "{lean}");
}

/// A cross of four arms welded to a hub keeps its angular momentum after it was pushed, in 10^4 steps.
#[test]
fn a_windmill_of_welds_keeps_its_momentum() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let arm = BodyDef::dynamic().with_collider(Shape::rectangle(1, fx!(0.2)).expect("a shape"));
    let hub =
        world.add_body(BodyDef::dynamic().with_collider(Shape::circle(fx!(0.3)).expect("a shape"))).expect("a body");
    let mut bodies = vec![hub];
    for (i, at) in [vec2(1, 0), vec2(0, 1), vec2(-1, 0), vec2(0, -1)].into_iter().enumerate() {
        let angle = Fx::FRAC_PI_2 * i as i32;
        let blade = world.add_body(BodyDef { position: at, angle, ..arm.clone() }).expect("a body");
        let weld = JointDef::at(&world, hub, blade, at / fx!(2)).expect("a joint");
        world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), ..weld }).expect("a joint");
        bodies.push(blade);
    }
    world.set_sleep_after(None).expect("a number");
    world.apply_impulse_at_point(bodies[1], vec2(0, fx!(0.1)), vec2(fx!(1.5), 0)).expect("an impulse");
    let momentum = |world: &World| {
        let of_body = |&body: &BodyId| {
            let body = world.body(body).expect("a body");
            let (at, velocity, mass) = (body.position(), body.velocity(), body.mass().expect("a mass"));
            body.inertia().and_then(FxFactor::to_scalar).expect("an inertia") * body.angular_velocity()
                + mass * at.cross(velocity)
        };
        bodies.iter().map(of_body).fold(fx!(0), |sum, part| sum + part)
    };
    let energy = |world: &World| {
        let of_body = |&body: &BodyId| {
            world.body(body).expect("a body").kinetic_energy().expect("small").to_scalar().expect("small")
        };
        bodies.iter().map(of_body).fold(fx!(0), |sum, part| sum + part)
    };
    world.step();
    let (start, start_energy) = (momentum(&world), energy(&world));
    steps(&mut world, 10_000);
    assert!((momentum(&world) - start).abs() < start.abs() / fx!(1000), "{} of {start}", momentum(&world));
    assert!(energy(&world) < start_energy * fx!(1.001), "{} of {start_energy}", energy(&world));
}

/// A scene with all of it, two steps of whose images and copies have the same bits.
fn everything() -> World {
    let mut world = falling();
    let arm = BodyDef::dynamic().with_collider(Shape::rectangle(1, fx!(0.2)).expect("a shape"));
    let mut last: Option<BodyId> = None;
    for i in 0..6 {
        let position = Vec2::new(Fx::from(i) + fx!(0.5), fx!(3));
        let body = world.add_body(BodyDef { position, key: i as u64, ..arm.clone() }).expect("a body");
        let joint = JointDef::at(&world, last, body, vec2(i, 3)).expect("a joint");
        let revolute = Revolute {
            limits: (i % 2 == 0).then(|| JointLimits::degrees(-20, 30)),
            motor: if i % 3 == 1 { motor(4, 60) } else { None },
            spring: (i % 3 == 2).then(|| JointSpring::new(fx!(2), fx!(0.2))),
            friction: Fx::from_ratio(i64::from(i), 10),
            ratchet: None,
        };
        let kind = if i == 4 { JointKind::Weld(Weld::default()) } else { JointKind::Revolute(revolute) };
        world.add_joint(JointDef { kind, key: i as u64, ..joint }).expect("a joint");
        last = Some(body);
    }
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(20, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, -1), ..ground }).expect("a body");
    world
}

#[test]
fn images_and_copies_have_the_same_bits() {
    assert_images_and_copies(everything);
}

/// A clock's hand that turns once in ten minutes goes on, and a motor that is held sleeps.
#[test]
fn a_slow_motor_keeps_its_wheel_awake() {
    let slow = Some(JointMotor { speed: fx!(0.01), max_force: fx!(1) });
    let (mut world, hand, joint) = wheel(Revolute { motor: slow, ..Revolute::default() });
    steps(&mut world, 600);
    assert!((angle(&world, joint) - fx!(0.1)).abs() < fx!(0.0001), "{}", angle(&world, joint));
    let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(0.2) });
    world
        .set_joint_kind(joint, JointKind::Revolute(Revolute { limits, motor: slow, ..Revolute::default() }))
        .expect("a kind");
    steps(&mut world, 900);
    assert_eq!(world.body(hand).expect("a body").activity(), Activity::Asleep);
}

/// A step in which a whole turn was counted cannot be undone: the joint would not count back.
#[test]
fn a_step_that_counts_a_turn_cannot_be_undone() {
    let limits = Some(JointLimits { lower: fx!(-1_000), upper: fx!(1_000) });
    let (mut world, wheel, joint) = wheel(Revolute { limits, ..Revolute::default() });
    world.set_sleep_after(None).expect("a number");
    world.set_angular_velocity(wheel, fx!(10)).expect("a speed");
    let (mut undone, mut refused) = (0, 0);
    for _ in 0..120 {
        let before = (world.state_hash(), angle(&world, joint));
        world.step();
        match world.step_back(&[]) {
            Ok(()) => {
                assert_eq!((world.state_hash(), angle(&world, joint)), before);
                undone += 1;
                world.step();
            }
            Err(error) => {
                assert_eq!(error, Error::NotReversible { why: Irreversible::Joint });
                refused += 1;
            }
        }
    }
    // Twenty radians are three turns, and the step after each starts from the state that it left.
    assert_eq!((undone, refused), (114, 6));
}

/// A call sets the angle of a body between two steps, past half a turn: the snapshot of the tick has the turns before the call.
#[test]
fn a_recorded_angle_plays_again() {
    let limits = Some(JointLimits { lower: fx!(-1_000), upper: fx!(1_000) });
    let (mut world, wheel, joint) = wheel(Revolute { limits, ..Revolute::default() });
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 1 });
    for tick in 0..8 {
        let command = Command::SetAngle { body: wheel, angle: fx!(2) * tick };
        recorder.execute(&mut world, &command).expect("an angle");
        recorder.step(&mut world, &Inputs::new());
    }
    assert!((angle(&world, joint) - fx!(14)).abs() < fx!(0.001), "{}", angle(&world, joint));
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("its own bytes");
    assert_eq!(replay.verify(), Ok(()));
}

/// Motors against each other in a bridge between two banks, each beside a spring that is next to nothing: no hinge has more torque than its motor.
#[test]
fn a_spring_does_not_give_what_a_motor_lacks() {
    let mut world = falling();
    let motors = [(-3, 2), (-1, 1), (-3, 3), (-2, 5), (3, 1), (0, 3), (-1, 3)];
    let speeds = [-1, 1, 1, 0, -3, -3];
    let mut last: Option<BodyId> = None;
    for (i, (speed, max_force)) in (0..).zip(motors) {
        let next = speeds.get(i as usize).map(|&velocity| {
            let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(0.1) };
            let position = Vec2::new(Fx::from(i) + fx!(0.5), fx!(0));
            let bar = BodyDef { mass, position, velocity: vec2(0, velocity), ..BodyDef::dynamic() };
            world.add_body(bar).expect("a body")
        });
        let joint = JointDef::at(&world, last, next, vec2(i, 0)).expect("a joint");
        let motor = motor(speed, max_force);
        let spring = Some(JointSpring::new(fx!(0.0001), fx!(0)));
        let kind = JointKind::Revolute(Revolute { motor, spring, ..Revolute::default() });
        world.add_joint(JointDef { kind, ..joint }).expect("a joint");
        last = next;
    }
    for tick in 0..120 {
        world.step();
        for (joint, (_, max_force)) in world.joints().zip(motors) {
            let torque = joint.torque().abs();
            assert!(torque < Fx::from(max_force) * fx!(1.001), "tick {tick}: {torque} of {max_force}");
        }
    }
}

/// A hub that turns as it is told, and is far smaller than the wheel that friction ties to it: the wheel turns as fast.
#[test]
fn a_small_hub_carries_a_large_wheel_along() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let disc = |radius: Fx| Shape::circle(radius).expect("a shape");
    let hub = BodyDef { angular_velocity: fx!(2), ..BodyDef::kinematic().with_collider(disc(fx!(0.1))) };
    let hub = world.add_body(hub).expect("a body");
    let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
    let wheel = BodyDef { mass, ..BodyDef::dynamic().with_collider(disc(fx!(4))) };
    let wheel = world.add_body(wheel).expect("a body");
    let joint = JointDef::at(&world, hub, wheel, vec2(0, 0)).expect("a joint");
    let kind = JointKind::Revolute(Revolute { friction: fx!(1_000), ..Revolute::default() });
    world.add_joint(JointDef { kind, ..joint }).expect("a joint");
    steps(&mut world, 3);
    let spin = world.body(wheel).expect("a body").angular_velocity();
    assert!((spin - fx!(2)).abs() < fx!(0.000001), "{spin}");
}
