//! Calls on joints: errors one by one, removal, views.

use super::scenes::{falling, point_mass, steps};
use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyKind, Distance, End, Error, Event, Fx, JointDef, JointId, JointKind, JointLimits,
    JointMotor, Prismatic, Quantity, Revolute, Weld, World, fx, limits, vec2,
};

fn out_of_range<T>(quantity: Quantity) -> Result<T, Error> {
    Err(Error::OutOfRange { quantity })
}

#[test]
fn wrong_joints_are_refused() {
    let mut world = falling();
    let [a, b] = [0, 1].map(|x| point_mass(&mut world, vec2(x, 0)));
    let [ground, lift] = [BodyDef::fixed(), BodyDef::kinematic()].map(|def| world.add_body(def).expect("a body"));
    let nobody = BodyId::from_parts(99, 0);
    let on_body = |body, point| End::Body(Attachment { body, point });
    let centre = |body| on_body(body, vec2(0, 0));
    let pin = |ends| JointDef::new(ends, JointKind::default());
    let rod = |length| JointDef::new([centre(a), centre(b)], JointKind::Distance(Distance::rod(length)));
    let line = |distance| JointDef::new([centre(a), centre(b)], JointKind::Distance(distance));
    let range = |lower, upper| Some(JointLimits { lower, upper });
    let slider = |limits| {
        JointDef::new([centre(a), centre(b)], JointKind::Prismatic(Prismatic { limits, ..Prismatic::default() }))
    };
    let bent = |limits| {
        let kind = JointKind::Revolute(Revolute { limits: Some(limits), ..Revolute::default() });
        JointDef::new([centre(a), centre(b)], kind)
    };
    let far = vec2(limits::SIZE_MAX + Fx::DELTA, fx!(0));
    let farther = vec2(limits::POSITION + Fx::DELTA, fx!(0));
    let here = End::World(vec2(0, 0));
    let cases = [
        (pin([centre(a), centre(nobody)]), Err(Error::NoSuchBody { body: nobody })),
        (pin([centre(a), centre(a)]), Err(Error::SameBody { body: a })),
        (pin([here, here]), Err(Error::NothingToMove)),
        (pin([centre(ground), here]), Err(Error::NothingToMove)),
        (pin([centre(ground), centre(lift)]), Err(Error::NothingToMove)),
        (pin([centre(a), on_body(b, far)]), out_of_range(Quantity::JointPoint)),
        (pin([End::World(farther), centre(b)]), out_of_range(Quantity::Position)),
        (rod(limits::SIZE_MIN - Fx::DELTA), out_of_range(Quantity::JointLength)),
        (rod(limits::JOINT_LENGTH + Fx::DELTA), out_of_range(Quantity::JointLength)),
        (rod(fx!(-1)), out_of_range(Quantity::JointLength)),
        (bent(JointLimits { lower: fx!(1), upper: fx!(0.5) }), out_of_range(Quantity::JointLimits)),
        (
            bent(JointLimits { lower: fx!(1), upper: limits::JOINT_ANGLE + Fx::DELTA }),
            out_of_range(Quantity::JointAngle),
        ),
        (bent(JointLimits::degrees(0, fx!(1e9))), out_of_range(Quantity::JointAngle)),
        (line(Distance::rope(fx!(0))), out_of_range(Quantity::JointLength)),
        (line(Distance { limits: range(fx!(-1), fx!(1)), ..Distance::default() }), out_of_range(Quantity::JointLength)),
        (line(Distance::spring(fx!(-1), fx!(1), fx!(1))), out_of_range(Quantity::JointLength)),
        (line(Distance { friction: fx!(-1), ..Distance::default() }), out_of_range(Quantity::JointForce)),
        (slider(range(fx!(1), fx!(0))), out_of_range(Quantity::JointLimits)),
        (slider(range(fx!(0), limits::JOINT_LENGTH + Fx::DELTA)), out_of_range(Quantity::JointLength)),
        (JointDef { break_force: Some(-Fx::DELTA), ..rod(fx!(1)) }, out_of_range(Quantity::BreakForce)),
    ];
    let before = world.state_hash();
    for (def, expected) in cases {
        assert_eq!(world.add_joint(def), expected, "{def:?}");
    }
    assert_eq!(world.state_hash(), before);
    for def in [rod(limits::SIZE_MIN), rod(limits::JOINT_LENGTH), pin([centre(lift), centre(a)])] {
        assert!(world.add_joint(def).is_ok(), "{def:?}");
    }
    let gone = JointId::from_parts(77, 0);
    assert_eq!(world.remove_joint(gone), Err(Error::NoSuchJoint { joint: gone }));
    assert_eq!(world.enable_joint(gone, true), Err(Error::NoSuchJoint { joint: gone }));
    assert_eq!(world.set_joint_break(gone, None), Err(Error::NoSuchJoint { joint: gone }));
    assert_eq!(world.set_joint_kind(gone, JointKind::default()), Err(Error::NoSuchJoint { joint: gone }));
    assert_eq!(world.joint(gone).map(|joint| joint.id()), Err(Error::NoSuchJoint { joint: gone }));
    assert_eq!(world.joints_of(nobody).map(drop), Err(Error::NoSuchBody { body: nobody }));
    let known = world.joints().next().expect("a joint").id();
    assert_eq!(world.set_joint_motor(gone, None), Err(Error::NoSuchJoint { joint: gone }));
    let weld = JointDef { kind: JointKind::Weld(Weld::default()), ..pin([centre(a), centre(b)]) };
    let weld = world.add_joint(weld).expect("a joint");
    assert_eq!(world.set_joint_motor(weld, None), Err(Error::NoMotor { joint: weld }));
    assert_eq!(world.remove_joint(weld), Ok(()));
    let pin = world.joints().last().expect("a joint").id();
    let motor = JointMotor { speed: fx!(1), max_force: -Fx::DELTA };
    assert_eq!(world.set_joint_motor(pin, Some(motor)), out_of_range(Quantity::JointForce));
    assert_eq!(world.set_joint_break(known, Some(fx!(-1))), out_of_range(Quantity::BreakForce));
    assert_eq!(
        world.set_joint_kind(known, JointKind::Distance(Distance::rod(fx!(0)))),
        out_of_range(Quantity::JointLength)
    );
}

/// A body takes its joints along; the report of the next step names them, and handles of joints never name another one.
#[test]
fn a_body_takes_its_joints_along() {
    let mut world = falling();
    let bodies = [0, 1, 2].map(|x| point_mass(&mut world, vec2(x, 0)));
    let rod = |world: &mut World, i: usize| {
        let def = JointDef::between(world, bodies[i], vec2(i as i32, 0), bodies[i + 1], vec2(i as i32 + 1, 0));
        world.add_joint(def.expect("a rod")).expect("a rod")
    };
    let joints = [rod(&mut world, 0), rod(&mut world, 1)];
    let pin = JointDef::at(&world, None, bodies[2], vec2(2, 0)).expect("a pin");
    let pin = world.add_joint(pin).expect("a pin");
    world.step();
    assert_eq!(world.joint_count(), 3);
    world.remove_body(bodies[1]).expect("a body");
    assert_eq!(world.joints().map(|joint| joint.id()).collect::<Vec<_>>(), [pin]);
    let report = world.step();
    assert_eq!((report.removed, report.joints_removed), (&bodies[1..2], &joints[..]));
    let events: Vec<Event> = report.events().collect();
    assert_eq!(
        events[..3],
        [Event::Removed(bodies[1]), Event::JointRemoved(joints[0]), Event::JointRemoved(joints[1])]
    );
    assert!(world.step().joints_removed.is_empty());
    let next = JointDef::between(&world, bodies[0], vec2(0, 0), bodies[2], vec2(2, 0)).expect("a rod");
    let next = world.add_joint(next).expect("a rod");
    assert_eq!(next.parts(), (joints[1].parts().0, 1), "the slot that was freed last");
    assert!(joints.iter().all(|&joint| world.joint(joint).is_err()));
}

/// Joints are listed by key, then by handle.
#[test]
fn joints_are_listed_by_key() {
    let mut world = falling();
    let body = point_mass(&mut world, vec2(0, 0));
    let add = |world: &mut World, key: u64| {
        let def = JointDef::at(world, None, body, vec2(0, 0)).expect("a joint");
        world.add_joint(JointDef { key, user_data: 10 * key, ..def }).expect("a joint")
    };
    let ids = [5, 1, 5, 0].map(|key| add(&mut world, key));
    let listed: Vec<JointId> = world.joints_of(body).expect("a body").map(|joint| joint.id()).collect();
    assert_eq!(listed, [ids[3], ids[1], ids[0], ids[2]]);
    assert!(world.joints().map(|joint| (joint.key(), joint.user_data())).eq([(0, 0), (1, 10), (5, 50), (5, 50)]));
}

/// Without a dynamic body a joint does nothing, and it goes on when there is one again; so does one of a disabled body.
#[test]
fn joints_without_a_body_to_move_wait() {
    let mut world = falling();
    let load = point_mass(&mut world, vec2(0, -1));
    let rod = JointDef::between(&world, None, vec2(0, 0), load, vec2(0, -1)).expect("a rod");
    let rod = world.add_joint(rod).expect("a rod");
    steps(&mut world, 60);
    let force = |world: &World| world.joint(rod).expect("a joint").force();
    assert!(force(&world).y > fx!(9));
    world.set_kind(load, BodyKind::Kinematic).expect("a kind");
    assert_eq!(force(&world), vec2(0, 0));
    steps(&mut world, 10);
    world.set_kind(load, BodyKind::Dynamic).expect("a kind");
    steps(&mut world, 60);
    assert!(force(&world).y > fx!(9));
    world.disable(load).expect("a body");
    assert_eq!(force(&world), vec2(0, 0));
    steps(&mut world, 10);
    world.enable(load).expect("a body");
    steps(&mut world, 60);
    assert!(force(&world).y > fx!(9));
    assert!((world.body(load).expect("a body").position() - vec2(0, -1)).length() < fx!(0.001));
}

/// The frames of a joint are where the bodies stand: the angle starts at 0 whatever the bodies' angles are, and follows the second one.
#[test]
fn the_angle_of_a_joint_is_measured_from_the_pose() {
    let mut world = World::new(umbra_physics::WorldDef::default()).expect("a world");
    let turned =
        |world: &mut World, angle: Fx| world.add_body(BodyDef { angle, ..BodyDef::dynamic() }).expect("a body");
    for (first, second) in [(fx!(0), fx!(0)), (fx!(3), fx!(-2)), (fx!(-100), fx!(7))] {
        let [a, b] = [first, second].map(|angle| turned(&mut world, angle));
        let joint = JointDef::at(&world, a, b, vec2(1, 0)).expect("a joint");
        let joint = world.add_joint(joint).expect("a joint");
        let angle = |world: &World| world.joint(joint).expect("a joint").angle();
        assert!(angle(&world).abs() < fx!(0.00000001), "{}", angle(&world));
        world.set_angle(b, second + fx!(0.5)).expect("an angle");
        assert!((angle(&world) - fx!(0.5)).abs() < fx!(0.00000001), "{}", angle(&world));
    }
}
