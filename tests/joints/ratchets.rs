//! Ratchets in worlds.

use super::scenes::{assert_images_and_copies, assert_near, falling, point_mass, steps, still, wheel};
use umbra_physics::{
    BodyId, Error, Fx, Irreversible, JointDef, JointId, JointKind, JointLimits, JointMotor, Quantity, Revolute,
    Snapshot, Symmetry, World, fx, vec2,
};

/// A wheel of 1 kg·m² on such an axle of the world.
fn wheel_on(world: &mut World, revolute: Revolute) -> (BodyId, JointId) {
    let (body, joint) = wheel(world, vec2(0, 0), fx!(1));
    world.set_joint_kind(joint, JointKind::Revolute(revolute)).expect("a kind");
    (body, joint)
}

fn ratchet(teeth: i16) -> Revolute {
    Revolute { ratchet: Some(teeth), ..Revolute::default() }
}

fn angle(world: &World, joint: JointId) -> Fx {
    world.joint(joint).expect("a joint").angle()
}

/// Forwards nothing holds it; backwards it goes to the last tooth that it has passed, and stops there without a rebound.
#[test]
fn it_turns_on_freely_and_back_by_less_than_a_tooth() {
    for (teeth, sign) in [(12, fx!(1)), (-12, fx!(-1)), (1, fx!(1)), (1_000, fx!(1)), (-60, fx!(-1))] {
        let mut world = still();
        let (body, joint) = wheel_on(&mut world, ratchet(teeth));
        world.set_angular_velocity(body, sign * 3).expect("a velocity");
        steps(&mut world, 300);
        // 15 rad.
        assert_eq!(world.body(body).expect("a body").angular_velocity(), sign * 3);
        let tooth = Fx::TAU / i32::from(teeth.abs());
        let passed = (fx!(15) / tooth).floor();
        let stop = sign * tooth * passed;
        assert_near(world.joint(joint).expect("a joint").stop().expect("a ratchet"), stop, fx!(0.00001));
        world.set_angular_velocity(body, -sign * 3).expect("a velocity");
        steps(&mut world, 300);
        assert_near(angle(&world, joint), stop, fx!(0.001));
        assert_near(world.body(body).expect("a body").angular_velocity(), fx!(0), fx!(0.001));
        assert_near(world.joint(joint).expect("a joint").stop().expect("a ratchet"), stop, fx!(0.00001));
    }
}

/// A winch: a weight on the rim of a drum, which a motor winds up tooth by tooth. Without the motor it stays at the last tooth, for as long as it takes.
#[test]
fn a_winch_holds_its_load() {
    let mut world = falling();
    let (body, joint) = wheel_on(
        &mut world,
        Revolute { motor: Some(JointMotor { speed: fx!(-1), max_force: fx!(60) }), ..ratchet(-24) },
    );
    // 50 N·m.
    let weight = |world: &mut World| world.apply_torque(body, fx!(50)).expect("a torque");
    for _ in 0..500 {
        weight(&mut world);
        world.step();
    }
    let wound = angle(&world, joint);
    assert_near(wound, fx!(-8.3), fx!(0.1));
    world.set_joint_motor(joint, None).expect("a motor");
    let stop = world.joint(joint).expect("a joint").stop().expect("a ratchet");
    for _ in 0..6_000 {
        weight(&mut world);
        world.step();
    }
    assert_near(angle(&world, joint), stop, fx!(0.001));
    assert_near(world.joint(joint).expect("a joint").torque(), fx!(-50), fx!(0.001));
    assert!(stop - wound < Fx::TAU / 24, "{stop} after {wound}");
}

/// A ratchet begins where it stands, whatever the angle; a body that is put elsewhere takes its tooth along, and a joint that was disabled begins anew.
#[test]
fn it_engages_where_it_stands() {
    let mut world = still();
    let (body, joint) = wheel_on(&mut world, Revolute::default());
    let stop = |world: &World| world.joint(joint).expect("a joint").stop().map(|stop| stop / Fx::TAU * 12);
    assert_eq!(stop(&world), None);
    world.set_angle(body, fx!(-2)).expect("an angle");
    world.set_joint_kind(joint, JointKind::Revolute(ratchet(12))).expect("a kind");
    // 2 rad are 3.8 teeth.
    assert_near(stop(&world).expect("a ratchet"), fx!(-4), fx!(0.0001));
    world.set_angle(body, fx!(-2.7)).expect("an angle");
    assert_near(stop(&world).expect("a ratchet"), fx!(-6), fx!(0.0001));
    // Of the same ratchet with a motor the tooth stays.
    world.set_angular_velocity(body, fx!(1)).expect("a velocity");
    steps(&mut world, 60);
    assert_near(stop(&world).expect("a ratchet"), fx!(-4), fx!(0.0001));
    world.set_joint_motor(joint, Some(JointMotor { speed: fx!(-1), max_force: fx!(5) })).expect("a motor");
    steps(&mut world, 60);
    assert_near(angle(&world, joint) / Fx::TAU * 12, fx!(-4), fx!(0.001));
    world.enable_joint(joint, false).expect("a joint");
    world.set_angular_velocity(body, fx!(-2)).expect("a velocity");
    steps(&mut world, 30);
    world.enable_joint(joint, true).expect("a joint");
    assert_near(stop(&world).expect("a ratchet"), fx!(-6), fx!(0.0001));
}

/// Limits hold beside the teeth: at the upper one the wheel stays between it and the last tooth.
#[test]
fn limits_hold_beside_it() {
    let mut world = still();
    let limits = Some(JointLimits::degrees(-90, 100));
    let (body, joint) = wheel_on(&mut world, Revolute { limits, ..ratchet(12) });
    for (velocity, degrees) in [(5, 100), (-5, 90), (5, 100)] {
        world.set_angular_velocity(body, Fx::from(velocity)).expect("a velocity");
        steps(&mut world, 120);
        assert_near(angle(&world, joint), Fx::from(degrees).to_radians(), fx!(0.001));
    }
}

/// Copies and snapshots go on from the same tooth, and no step goes back over it.
#[test]
fn the_tooth_is_state() {
    let mut world = still();
    let (body, joint) = wheel_on(&mut world, ratchet(12));
    world.set_angular_velocity(body, fx!(2)).expect("a velocity");
    steps(&mut world, 100);
    let copy = Snapshot::from_bytes(&world.snapshot().to_bytes(), &[]);
    let mut restored = copy.expect("its own bytes").into_world();
    for world in [&mut world, &mut restored] {
        world.set_angular_velocity(body, fx!(-2)).expect("a velocity");
        steps(world, 100);
    }
    assert_eq!(restored.state_hash(), world.state_hash());
    // 3.3 rad were six teeth and a part.
    assert_near(angle(&world, joint), Fx::TAU / 2, fx!(0.001));
    let image = Symmetry::MIRROR.world(&world).expect("an image");
    let [stop, image_stop] = [&world, &image].map(|world| world.joint(joint).expect("a joint").stop());
    assert_eq!(image_stop, stop.map(|stop| -stop));
}

/// A step in which a tooth is engaged has no way back: the tooth would stay.
#[test]
fn a_step_that_engages_a_tooth_has_no_way_back() {
    let mut world = still();
    world.set_sleep_after(None).expect("never");
    let (body, joint) = wheel_on(&mut world, ratchet(64));
    world.set_angular_velocity(body, fx!(2)).expect("a velocity");
    let stop = |world: &World| world.joint(joint).expect("a joint").stop();
    let mut refused = 0;
    for _ in 0..30 {
        let before = stop(&world);
        world.step();
        if stop(&world) != before {
            assert_eq!(world.step_back(&[]), Err(Error::NotReversible { why: Irreversible::Joint }));
            refused += 1;
        }
    }
    // A radian is ten teeth.
    assert_eq!(refused, 10);
}

/// A pendulum on a ratchet, a clutch between two wheels, and a weight on a rope beside it.
fn clutch() -> World {
    let mut world = falling();
    let bob = point_mass(&mut world, vec2(1, 0));
    let hinge = JointDef::at(&world, None, bob, vec2(0, 0)).expect("a joint");
    world.add_joint(JointDef { kind: JointKind::Revolute(ratchet(40)), ..hinge }).expect("a joint");
    let (first, _) = wheel_on(&mut world, Revolute::default());
    let (second, _) = wheel_on(&mut world, Revolute::default());
    let clutch = JointDef::at(&world, first, second, vec2(0, 0)).expect("a joint");
    world.add_joint(JointDef { kind: JointKind::Revolute(ratchet(-7)), ..clutch }).expect("a joint");
    world.set_angular_velocity(first, fx!(3)).expect("a velocity");
    world
}

#[test]
fn images_and_copies_have_the_same_teeth() {
    assert_images_and_copies(clutch);
}

/// Numbers of teeth out of range are refused.
#[test]
fn teeth_out_of_range_are_refused() {
    for (teeth, is_fine) in
        [(0, false), (1, true), (1_024, true), (1_025, false), (-1_024, true), (-1_025, false), (i16::MIN, false)]
    {
        let refusal = Err(Error::OutOfRange { quantity: Quantity::Teeth });
        assert_eq!(JointKind::<Fx>::Revolute(ratchet(teeth)).check(), if is_fine { Ok(()) } else { refusal });
    }
}
