//! Sliders, wheels, ropes and springs in worlds.

use super::scenes::{assert_images_and_copies, assert_stays, falling, point_mass, slope, steps};
use umbra_physics::{
    Activity, Attachment, BodyDef, BodyId, BodyRef, Command, ContactSettings, Distance, End, Error, Fx, Inputs,
    JointDef, JointId, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass, Prismatic, RecordOptions,
    Recorder, Replay, Revolute, Shape, Vec2, Weld, Wheel, World, WorldDef, fx, vec2,
};

fn solid(mass: i32) -> Mass {
    Mass::Explicit { mass: Fx::from(mass), inertia: Fx::from(mass) }
}

/// A cabin in a shaft.
fn lift(prismatic: Prismatic) -> (World, BodyId, JointId) {
    let mut world = falling();
    let cabin = world.add_body(BodyDef { mass: solid(100), ..BodyDef::dynamic() }).expect("a body");
    let shaft = JointDef::along(&world, None, cabin, vec2(0, 0), vec2(0, 1)).expect("a joint");
    let lift = JointDef { kind: JointKind::Prismatic(prismatic), ..shaft };
    let lift = world.add_joint(lift).expect("a joint");
    (world, cabin, lift)
}

fn translation(world: &World, joint: JointId) -> Fx {
    world.joint(joint).expect("a joint").translation()
}

/// A motor lifts a cabin at its speed, turns round, is too weak for a load, and slips down under it.
#[test]
fn a_lift_goes_up_and_down() {
    let motor = |speed: Fx, max_force: i32| Some(JointMotor { speed, max_force: Fx::from(max_force) });
    let (mut world, cabin, lift) = lift(Prismatic { motor: motor(fx!(2), 5_000), ..Prismatic::default() });
    steps(&mut world, 60);
    // Up to its speed within a twentieth of a second, at 4,000 N.
    assert!((translation(&world, lift) - fx!(1.95)).abs() < fx!(0.01), "{}", translation(&world, lift));
    let force = world.joint(lift).expect("a joint").force();
    assert!((force - vec2(0, 1000)).length() < fx!(0.01), "{force:?}");
    world.set_joint_motor(lift, motor(fx!(-1), 5_000)).expect("a motor");
    let top = translation(&world, lift);
    steps(&mut world, 60);
    assert!((top - translation(&world, lift) - fx!(1)).abs() < fx!(0.1), "{top} {}", translation(&world, lift));
    // 900 N against 1,000 N: it falls with 1 m/s².
    world.set_joint_motor(lift, motor(fx!(1), 900)).expect("a motor");
    let start = world.body(cabin).expect("a body").velocity().y;
    steps(&mut world, 60);
    let change = world.body(cabin).expect("a body").velocity().y - start;
    assert!((change + fx!(1)).abs() < fx!(0.0001), "{change}");
}

/// A slow lift stays awake until it arrives, and a motor that turns round wakes it.
#[test]
fn a_slow_lift_arrives_and_sleeps() {
    let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(0.1) });
    let motor = |speed: Fx| Some(JointMotor { speed, max_force: fx!(5_000) });
    let (mut world, cabin, lift) = lift(Prismatic { limits, motor: motor(fx!(0.01)), ..Prismatic::default() });
    steps(&mut world, 540);
    assert!((translation(&world, lift) - fx!(0.09)).abs() < fx!(0.001), "{}", translation(&world, lift));
    steps(&mut world, 200);
    assert_eq!(world.body(cabin).expect("a body").activity(), Activity::Asleep);
    world.set_joint_motor(lift, motor(fx!(-1))).expect("a motor");
    steps(&mut world, 60);
    assert!((translation(&world, lift) + fx!(0.9)).abs() < fx!(0.02), "{}", translation(&world, lift));
}

/// A body whose slider reaches far is welded to a body that turns and does not give way: the joints may be added in either order.
#[test]
fn the_order_of_joints_does_not_matter_where_one_reaches_far() {
    let hashes = [[0, 1], [1, 0]].map(|order| {
        let mut world = falling();
        let body = |x, mass, key| {
            let angular_velocity = fx!(2);
            BodyDef { position: vec2(x, 0), angular_velocity, mass, key, ..BodyDef::dynamic() }
        };
        let [rail, sled, fixed] = [(0, solid(1), 1), (14, solid(2), 2), (2, Mass::Kilograms(fx!(3)), 3)]
            .map(|(x, mass, key)| world.add_body(body(x, mass, key)).expect("a body"));
        let slider = JointDef::along(&world, rail, sled, vec2(0, 0), vec2(1, 0)).expect("a joint");
        let spring = Some(JointSpring::new(fx!(1), fx!(0)));
        let kind = JointKind::Wheel(Wheel { spring, ..Wheel::default() });
        let slider = JointDef { kind, key: 5, ..slider };
        let weld = JointDef::at(&world, rail, fixed, vec2(1, 0)).expect("a joint");
        let weld = JointDef { kind: JointKind::Weld(Weld { spring }), key: 6, ..weld };
        for index in order {
            world.add_joint([slider, weld][index]).expect("a joint");
        }
        steps(&mut world, 30);
        world.physics_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}

/// A joint without gravity stays where it is at any angle, to the bit.
#[test]
fn sliders_at_all_angles_stay_still() {
    for i in 0..4096_i64 {
        let mut world = World::new(WorldDef::default()).expect("a world");
        let angle = Fx::PI * 2 * Fx::from_ratio(i, 4096);
        let body = BodyDef { mass: solid(2), position: vec2(1, fx!(0.5)), angle, ..BodyDef::dynamic() };
        let body = world.add_body(body).expect("a body");
        let (sin, cos) = angle.sin_cos();
        let rail = JointDef::along(&world, None, body, vec2(0, 0), Vec2::new(cos, sin)).expect("a joint");
        let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(1) });
        let kind = JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() });
        world.add_joint(JointDef { kind, ..rail }).expect("a joint");
        steps(&mut world, 3);
        let body = world.body(body).expect("a body");
        // The angle of the frame is rounded to 2^-32 rad.
        let speed = body.velocity().length().max(body.angular_velocity().abs());
        assert!(speed <= fx!(0.0000001), "{i}: {speed}");
    }
}

/// On a diagonal axis a body whose rotation is locked falls to its limit and stays: it does not drift.
#[test]
fn a_slider_on_a_diagonal_does_not_drift() {
    let mut world = falling();
    let locks = Locks { rotation: true, ..Locks::NONE };
    let body = BodyDef { mass: solid(1), locks, ..BodyDef::dynamic() };
    let body = world.add_body(body).expect("a body");
    let rail = JointDef::along(&world, None, body, vec2(0, 0), vec2(1, 1)).expect("a joint");
    let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(1) });
    let kind = JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() });
    world.add_joint(JointDef { kind, ..rail }).expect("a joint");
    world.set_sleep_after(None).expect("a number");
    steps(&mut world, 300);
    let start = world.body(body).expect("a body").position();
    assert!((start.length() - fx!(1)).abs() < fx!(0.0001), "{start:?}");
    steps(&mut world, 10_000);
    let drift = (world.body(body).expect("a body").position() - start).length();
    assert!(drift < fx!(0.000001), "{drift}");
}

/// A heavy slider far out on a light arm that spins gains no energy.
#[test]
fn a_slider_far_out_gains_no_energy() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let arm = world.add_body(BodyDef { mass: solid(1), ..BodyDef::dynamic() }).expect("a body");
    let out = BodyDef { mass: solid(20), position: vec2(100, 0), ..BodyDef::dynamic() };
    let out = world.add_body(out).expect("a body");
    let rail = JointDef {
        ends: [End::Body(Attachment::centre(arm)), End::Body(Attachment::centre(out))],
        ..JointDef::along(&world, arm, out, vec2(1, 0), vec2(1, 0)).expect("a joint")
    };
    world.add_joint(rail).expect("a joint");
    world.set_velocity(out, vec2(0, 10)).expect("a velocity");
    world.set_sleep_after(None).expect("a number");
    let energy = |world: &World| {
        let part = |body: BodyId| {
            world.body(body).expect("a body").kinetic_energy().expect("small").to_scalar().expect("small")
        };
        part(arm) + part(out)
    };
    world.step();
    let start = energy(&world);
    for tick in 0..10_000 {
        world.step();
        assert!(energy(&world) < start * fx!(1.0001), "{tick}: {} of {start}", energy(&world));
    }
}

/// A weight far out on an arm of 1 kg that is free, or turns about a pin: the force that holds the weight is a torque of the arm that is larger by the
/// length of the arm, while the arm is a thousand times as light. It gains no energy, comes off its axis by no more than centimetres, and stays within
/// the range of velocities.
#[test]
fn a_weight_far_out_on_a_light_arm_gains_no_energy() {
    let far = [(30, fx!(0.1)), (100, fx!(0.1)), (100, fx!(1)), (100, fx!(10)), (300, fx!(1)), (1000, fx!(10))];
    let velocities = [vec2(10, 0), vec2(0, 10), vec2(7, -7)];
    let scenes =
        [false, true].into_iter().flat_map(|is_pinned| far.map(|(reach, inertia)| (is_pinned, reach, inertia)));
    for (is_pinned, reach, inertia) in scenes {
        for mass in [100, 1000] {
            for velocity in velocities {
                let mut world = World::new(WorldDef { sleep_after: None, ..WorldDef::default() }).expect("a world");
                let light = Mass::Explicit { mass: fx!(1), inertia };
                let arm = world.add_body(BodyDef { mass: light, ..BodyDef::dynamic() }).expect("a body");
                let weight = BodyDef { position: vec2(reach, 0), velocity, mass: solid(mass), ..BodyDef::dynamic() };
                let weight = world.add_body(weight).expect("a body");
                let ends = [arm, weight].map(|body| End::Body(Attachment::centre(body)));
                let slider = JointDef::new(ends, JointKind::Prismatic(Prismatic::default()));
                let slider = world.add_joint(slider).expect("a joint");
                if is_pinned {
                    let pin = JointDef::at(&world, None, arm, vec2(0, 0)).expect("a pin");
                    world.add_joint(pin).expect("a joint");
                }
                let start = world.kinetic_energy().expect("a small energy");
                let limit = start.to_scalar().expect("it fits") * fx!(1.02);
                for _ in 0..300 {
                    assert!(world.step().faults.is_empty(), "{reach} m, {mass} kg at {velocity}, {inertia} kg·m²");
                    let energy = world.kinetic_energy().expect("a small energy").to_scalar().expect("it fits");
                    assert!(energy < limit, "{reach} m, {mass} kg at {velocity}, {inertia} kg·m²: {energy} J");
                    let off_axis = world.joint(slider).expect("a joint").offset().y.abs();
                    assert!(off_axis < fx!(0.05), "{reach} m, {mass} kg at {velocity}, {inertia} kg·m²: {off_axis} m");
                }
            }
        }
    }
}

/// Joints of free bodies whose points are beside their centres are solved at once: one sub-step takes a relative velocity away along and across
/// an axis, and around, but for the part of 2^-11 by which joints give way.
#[test]
fn a_tree_of_sliders_is_solved_in_one_sub_step() {
    let brake = Some(JointMotor { speed: fx!(0), max_force: fx!(1_000) });
    let limits = Some(JointLimits { lower: fx!(0), upper: fx!(0) });
    let kinds = [
        JointKind::Prismatic(Prismatic { motor: brake, ..Prismatic::default() }),
        JointKind::Wheel(Wheel { limits, ..Wheel::default() }),
    ];
    for kind in kinds {
        let contacts = ContactSettings { substeps: 1, ..ContactSettings::default() };
        let mut world = World::new(WorldDef { contacts, ..WorldDef::default() }).expect("a world");
        let mass = |mass, inertia| Mass::Explicit { mass, inertia };
        let rail = BodyDef { mass: mass(fx!(1), fx!(0.1)), ..BodyDef::dynamic() };
        let rail = world.add_body(rail).expect("a body");
        let (position, velocity) = (vec2(1, fx!(0.7)), vec2(fx!(-0.01), 0));
        let sled = BodyDef { mass: mass(fx!(2), fx!(0.4)), position, velocity, ..BodyDef::dynamic() };
        let sled = world.add_body(sled).expect("a body");
        let hub = vec2(fx!(0.25), fx!(0.5));
        let joint = JointDef::along(&world, rail, sled, hub, vec2(1, 0)).expect("a joint");
        world.add_joint(JointDef { kind, ..joint }).expect("a joint");
        world.step();
        let [rail, sled] = [rail, sled].map(|body| world.body(body).expect("a body"));
        let velocity = |body: BodyRef<'_>| {
            let arm = hub - body.position();
            body.velocity() + Vec2::new(-arm.y, arm.x) * body.angular_velocity()
        };
        let left = velocity(sled) - velocity(rail);
        assert!(left.length() < fx!(0.00002), "{kind:?}: {left}");
        let spin = sled.angular_velocity() - rail.angular_velocity();
        assert!(matches!(kind, JointKind::Wheel(_)) || spin.abs() < fx!(0.00002), "{spin}");
    }
}

/// A car: a chassis on two wheels with springs, as its joints stand.
fn car(world: &mut World, at: Vec2, angle: Fx, wheel: Wheel) -> (BodyId, [BodyId; 2], [JointId; 2]) {
    let (sin, cos) = angle.sin_cos();
    let place = |x: Fx, y: Fx| at + Vec2::new(x * cos - y * sin, x * sin + y * cos);
    let body = BodyDef::dynamic().with_collider(Shape::rectangle(fx!(2.4), fx!(0.5)).expect("a shape"));
    let chassis = world.add_body(BodyDef { position: at, angle, ..body }).expect("a body");
    let axles = [fx!(-0.8), fx!(0.8)].map(|x| {
        let hub = place(x, fx!(-0.4));
        let tyre = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.4)).expect("a shape"));
        let tyre = world.add_body(BodyDef { position: hub, angle, ..tyre }).expect("a body");
        let axle = JointDef::along(world, chassis, tyre, hub, Vec2::new(-sin, cos)).expect("a joint");
        let axle = world.add_joint(JointDef { kind: JointKind::Wheel(wheel), ..axle }).expect("a joint");
        (tyre, axle)
    });
    (chassis, axles.map(|(tyre, _)| tyre), axles.map(|(_, axle)| axle))
}

fn suspension() -> Wheel {
    let limits = Some(JointLimits { lower: fx!(-0.25), upper: fx!(0.25) });
    Wheel { limits, spring: Some(JointSpring::new(fx!(3), fx!(0.7))), ..Wheel::default() }
}

/// The largest distance of a hub from its axis.
fn off_axis(world: &World, axles: [JointId; 2]) -> Fx {
    let off = axles.map(|axle| {
        let axle = world.joint(axle).expect("a joint");
        let (length, along) = (axle.length(), axle.translation());
        (length * length - along * along).max(fx!(0)).checked_sqrt().expect("not negative")
    });
    off[0].max(off[1])
}

/// A flat road.
fn road(world: &mut World) {
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(200, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, fx!(-0.5)), ..ground }).expect("a body");
}

/// A car that falls from 5 m, tilted, and one that a heavy box hits, keeps its wheels on their axes and comes to rest.
#[test]
fn wheels_stay_on_their_axes() {
    let mut world = falling();
    road(&mut world);
    // Wheels that turn without friction in the air never rest.
    let (chassis, _, axles) = car(&mut world, vec2(0, 5), fx!(1), Wheel { friction: fx!(0.1), ..suspension() });
    let mut off = fx!(0);
    for _ in 0..600 {
        world.step();
        off = off.max(off_axis(&world, axles));
    }
    assert!(off < fx!(0.03), "{off}");
    assert!(off_axis(&world, axles) < fx!(0.0005), "{}", off_axis(&world, axles));
    assert_eq!(world.body(chassis).expect("a body").activity(), Activity::Asleep);
}

/// A car drives as fast as its wheels turn, over bumps, and its brakes hold it on a slope for ten minutes.
#[test]
fn a_car_drives_and_brakes() {
    let mut world = falling();
    road(&mut world);
    for x in [6, 9, 14] {
        let bump = BodyDef::fixed().with_collider(Shape::capsule(fx!(0.8), fx!(0.1)).expect("a shape"));
        world.add_body(BodyDef { position: vec2(x, 0), ..bump }).expect("a body");
    }
    let motor = |speed: i32| Some(JointMotor { speed: Fx::from(speed), max_force: fx!(20) });
    let (chassis, _, axles) = car(&mut world, vec2(0, fx!(0.8)), fx!(0), Wheel { motor: motor(-10), ..suspension() });
    let mut off = fx!(0);
    for _ in 0..360 {
        world.step();
        off = off.max(off_axis(&world, axles));
    }
    let car = world.body(chassis).expect("a body");
    // 10 rad/s of wheels of 0.4 m, and no slip.
    assert!(car.position().x > fx!(18) && (car.velocity().x - fx!(4)).abs() < fx!(0.1), "{:?}", car.position());
    assert!(off < fx!(0.005), "{off}");
    axles.iter().for_each(|&axle| world.set_joint_motor(axle, motor(0)).expect("a motor"));
    steps(&mut world, 300);
    assert_eq!(world.body(chassis).expect("a body").activity(), Activity::Asleep);
}

#[test]
fn brakes_hold_a_car_with_springs_on_a_slope() {
    let mut world = falling();
    slope(&mut world);
    let brake = Some(JointMotor { speed: fx!(0), max_force: fx!(1000) });
    let wheel = Wheel { motor: brake, ..suspension() };
    let (chassis, ..) = car(&mut world, vec2(fx!(-0.274), fx!(0.752)), Fx::PI / 9, wheel);
    assert_stays(&mut world, chassis);
}

/// A pendulum on a rope goes slack and taut; two weights on a spring between them keep their momentum.
#[test]
fn ropes_and_springs_keep_momentum() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let [a, b] = [0, 3].map(|x| point_mass(&mut world, vec2(x, 0)));
    let spring = JointDef::between(&world, a, vec2(0, 0), b, vec2(3, 0)).expect("a joint");
    let distance = Distance {
        limits: Some(JointLimits { lower: fx!(0.5), upper: fx!(5) }),
        ..Distance::spring(fx!(2), fx!(0.5), fx!(0))
    };
    let spring = JointDef { kind: JointKind::Distance(distance), ..spring };
    let spring = world.add_joint(spring).expect("a joint");
    world.set_velocity(b, vec2(1, 4)).expect("a velocity");
    world.set_sleep_after(None).expect("a number");
    let momentum = |world: &World| {
        let [a, b] = [a, b].map(|body| world.body(body).expect("a body"));
        (a.velocity() + b.velocity(), a.position().cross(a.velocity()) + b.position().cross(b.velocity()))
    };
    let (linear, angular) = momentum(&world);
    for tick in 0..1200 {
        world.step();
        let (now, angular_now) = momentum(&world);
        assert!((now - linear).length() < fx!(0.00001), "{tick}: {now:?}");
        assert!((angular_now - angular).abs() < fx!(0.05), "{tick}: {angular_now} of {angular}");
        let length = world.joint(spring).expect("a joint").length();
        assert!(length > fx!(0.499) && length < fx!(5.001), "{tick}: {length}");
    }
}

/// A world with all kinds of sliders and lines.
fn everything() -> World {
    let mut world = falling();
    let arm = BodyDef::dynamic().with_collider(Shape::rectangle(1, fx!(0.2)).expect("a shape"));
    let mut last: Option<BodyId> = None;
    for i in 0..8 {
        let at = vec2(i, 3);
        let position = at + vec2(fx!(0.5), 0);
        let body = world.add_body(BodyDef { position, key: i as u64, ..arm.clone() }).expect("a body");
        let limits = (i % 2 == 0).then_some(JointLimits { lower: fx!(-0.2), upper: fx!(0.3) });
        let motor = (i % 3 == 1).then_some(JointMotor { speed: fx!(1), max_force: fx!(8) });
        let spring = (i % 3 != 1).then_some(JointSpring::new(fx!(3), fx!(0.2)));
        let friction = Fx::from_ratio(i64::from(i), 10);
        let axis = vec2(i % 3 - 1, 1 + i % 2);
        let joint = match i % 4 {
            0 => JointDef::at(&world, last, body, at),
            1 | 2 => JointDef::along(&world, last, body, at, axis),
            _ => JointDef::between(&world, last, at - vec2(fx!(0.5), 0), body, position),
        };
        let joint = joint.expect("a joint");
        let kind = match i % 4 {
            0 => joint.kind,
            1 => JointKind::Prismatic(Prismatic { limits, motor, spring, friction }),
            2 => JointKind::Wheel(Wheel { limits, spring, motor, friction }),
            _ => {
                let limits = Some(JointLimits { lower: fx!(0.2), upper: fx!(1.2) });
                JointKind::Distance(Distance { limits, motor, spring, friction })
            }
        };
        world.add_joint(JointDef { kind, key: i as u64, ..joint }).expect("a joint");
        last = Some(body);
    }
    // A ring.
    let rail = JointDef::along(&world, None, last, vec2(8, 3), vec2(1, 2)).expect("a joint");
    let kind = JointKind::Wheel(suspension());
    world.add_joint(JointDef { kind, key: 9, ..rail }).expect("a joint");
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(20, 1).expect("a shape"));
    world.add_body(BodyDef { position: vec2(0, -1), ..ground }).expect("a body");
    world
}

#[test]
fn images_and_copies_have_the_same_bits() {
    assert_images_and_copies(everything);
}

/// Motors that push are changed as a part of their kind, in what is recorded too; a command for motors that turn is refused.
#[test]
fn motors_that_push_are_recorded() {
    let (mut world, cabin, lift) = lift(Prismatic::default());
    let motor = Some(JointMotor { speed: fx!(1), max_force: fx!(5_000) });
    let command = Command::SetJointMotor { joint: lift, motor };
    assert_eq!(world.execute(&command), Err(Error::NoMotor { joint: lift }));
    let weld = JointDef::at(&world, None, cabin, vec2(0, 0)).expect("a joint");
    let weld = world.add_joint(JointDef { kind: JointKind::Weld(Weld::default()), enabled: false, ..weld });
    let weld = weld.expect("a joint");
    assert_eq!(world.set_joint_motor(weld, motor), Err(Error::NoMotor { joint: weld }));

    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 10 });
    let kind = JointKind::Prismatic(Prismatic { motor, ..Prismatic::default() });
    recorder.execute(&mut world, &Command::SetJointKind { joint: lift, kind }).expect("a motor");
    (0..60).for_each(|_| _ = recorder.step(&mut world, &Inputs::new()));
    assert!(translation(&world, lift) > fx!(0.9));
    let replay = Replay::from_bytes(&recorder.finish(&world), &[]).expect("its own bytes");
    assert_eq!(replay.verify(), Ok(()));
}

/// A rope that becomes a rod, and a rod that becomes a spring, keep the impulse along their line; a slider that becomes a hinge keeps none.
#[test]
fn kinds_with_the_same_rows_keep_their_impulses() {
    let mut world = falling();
    let load = point_mass(&mut world, vec2(0, -2));
    let rope = JointDef::between(&world, None, vec2(0, 0), load, vec2(0, -2)).expect("a joint");
    let rope = world.add_joint(JointDef { kind: JointKind::Distance(Distance::rope(fx!(2))), ..rope });
    let rope = rope.expect("a joint");
    steps(&mut world, 60);
    let force = world.joint(rope).expect("a joint").force();
    assert!((force - vec2(0, 10)).length() < fx!(0.001), "{force:?}");
    for kind in [Distance::rod(fx!(2)), Distance::spring(fx!(2), fx!(3), fx!(1))] {
        world.set_joint_kind(rope, JointKind::Distance(kind)).expect("a kind");
        assert_eq!(world.joint(rope).expect("a joint").force(), force);
    }
    world.set_joint_kind(rope, JointKind::Revolute(Revolute::default())).expect("a kind");
    assert_eq!(world.joint(rope).expect("a joint").force(), vec2(0, 0));
}
