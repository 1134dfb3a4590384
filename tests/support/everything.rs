//! A world and a recording with something of everything that a file can have in it.

#[allow(clippy::duplicate_mod, reason = "a program may take the seeds in beside this file")]
#[path = "seeds.rs"]
mod seeds;

use std::sync::Arc;
use std::{vec, vec::Vec};

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, BodyState, ColliderDef, ColliderId, Command, ContactSettings,
    CustomForce, CustomForceError, Damping, Dependence, Distance, End, Exclusion, Explosion, FieldId, FieldKind,
    Filter, ForceField, ForceOrImpulse, ForceTorque, Frame, Fx, FxFactor, Gear, Input, Inputs, Integrator, JointDef,
    JointId, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass, Material, MaterialPair, MixRule, Motor,
    OneWay, Part, PlanarMotor, Prismatic, Pulley, Random, RecordOptions, Recorder, Region, Revolute, Shape,
    SpringConstants, TimeStep, Weld, Wheel, World, WorldDef, fx, vec2,
};

struct Still;

impl CustomForce for Still {
    fn id(&self) -> u64 {
        9
    }
    fn version(&self) -> u32 {
        2
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Nothing
    }
    fn push(&self, _: &BodyState) -> Result<ForceTorque, CustomForceError> {
        Ok(ForceTorque::default())
    }
}

pub(crate) fn custom_forces() -> Vec<Arc<dyn CustomForce>> {
    vec![Arc::new(Still)]
}

fn shapes() -> Vec<Shape> {
    let disc = Shape::circle(fx!(0.5)).expect("a shape");
    let part = |x| Part { shape: disc.clone(), position: vec2(x, 0), angle: fx!(0.1), density: fx!(1) };
    vec![
        disc.clone(),
        Shape::rectangle(fx!(1), fx!(2)).expect("a shape"),
        Shape::capsule(fx!(1), fx!(0.5)).expect("a shape"),
        // Clockwise, and not about its centre.
        Shape::polygon(&[vec2(3, 3), vec2(fx!(3.1), fx!(5.7)), vec2(4, fx!(4.2))]).expect("a shape"),
        Shape::segment(vec2(0, 0), vec2(0, 1)).expect("a shape"),
        Shape::compound(&[part(-1), part(2)]).expect("a shape"),
    ]
}

/// Colliders that touch nothing.
fn ghosts() -> Vec<ColliderDef> {
    shapes().into_iter().map(ColliderDef::ghost).collect()
}

/// An open chain, and a closed one.
fn chains() -> Vec<Shape> {
    let points = [vec2(2, 0), vec2(0, 0), vec2(-2, fx!(0.5))];
    [false, true].map(|closed| Shape::chain(&points, closed).expect("a chain")).into()
}

/// A collider of every shape that a dynamic body may have, in the middle of its body with the default material, and then not.
fn colliders() -> Vec<ColliderDef> {
    let plain = shapes().into_iter().map(ColliderDef::new);
    let varied = |def: ColliderDef| ColliderDef {
        position: vec2(fx!(0.5), fx!(-0.25)),
        angle: fx!(0.3),
        density: fx!(2),
        material: Material {
            friction: fx!(0.1),
            restitution: fx!(0.5),
            rolling_resistance: fx!(0.25),
            surface_speed: fx!(-3),
            friction_rule: MixRule::Minimum,
            restitution_rule: MixRule::Maximum,
            id: 7,
        },
        filter: Filter { category: 6, mask: !4, group: -3 },
        one_way: Some(OneWay { direction: vec2(fx!(0.5), -2), tolerance: fx!(1.25) }),
        sensor: true,
        contact_events: false,
        hit_events: true,
        key: 8,
        user_data: u64::MAX,
        ..def
    };
    plain.clone().chain(plain.map(varied)).collect()
}

/// A law of each kind, on the bodies in slots 1 and 2.
fn fields() -> Vec<ForceField> {
    let at = |slot| Attachment { body: BodyId::from_parts(slot, 0), point: vec2(0, fx!(0.25)) };
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(3), damping: fx!(0.5) };
    let mu: FxFactor = "2.5".parse().expect("a factor");
    let kinds = [
        FieldKind::Attractor { centre: End::Body(at(2)), mu, softening: fx!(0.5) },
        FieldKind::Attractor { centre: End::World(vec2(1, 2)), mu, softening: fx!(0.5) },
        FieldKind::Spring { near: at(1), far: End::Body(at(2)), spring },
        FieldKind::Spring { near: at(1), far: End::World(vec2(5, 5)), spring },
        FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0.2), wind: vec2(1, 0) },
        FieldKind::Thrust { at: at(1), force: vec2(1, 1) },
        FieldKind::Zone { region: Region::Disc { centre: vec2(0, 0), radius: fx!(3) }, acceleration: vec2(0, 1) },
        FieldKind::Zone { region: Region::Box { min: vec2(0, 0), max: vec2(1, 1) }, acceleration: vec2(0, 1) },
        FieldKind::Custom { id: 9 },
        FieldKind::Buoyancy {
            min: vec2(-5, -5),
            max: vec2(5, 0),
            density: fx!(2),
            linear_drag: fx!(0.5),
            angular_drag: fx!(0.25),
            flow: vec2(1, 0),
        },
    ];
    kinds.map(|kind| ForceField { kind, force_groups: 5 }).into()
}

/// Friction that a command adds late: what it stops to the bit would hide a forged velocity of the start.
fn friction() -> ForceField {
    FieldKind::Friction { deceleration: fx!(0.5), angular_deceleration: fx!(0.25) }.into()
}

/// The slot of the collider of the box on the ground.
const ON_THE_GROUND: u32 = 7;

/// A joint of the body in slot 4 with the world.
fn pin() -> JointDef {
    let on_body = Attachment { body: BodyId::from_parts(4, 0), point: vec2(fx!(0.5), fx!(0.25)) };
    let ends = [End::World(vec2(fx!(0.75), 3)), End::Body(on_body)];
    JointDef { angles: [fx!(0.5), fx!(-0.25)], key: 3, user_data: 4, ..JointDef::new(ends, JointKind::default()) }
}

/// A pin with everything that acts on its angle.
fn driven_pin() -> JointDef {
    let kind = JointKind::Revolute(Revolute {
        limits: Some(JointLimits { lower: fx!(-1), upper: fx!(1.5) }),
        motor: Some(JointMotor { speed: fx!(2), max_force: fx!(30) }),
        spring: Some(JointSpring { rest: fx!(0.25), max_force: Some(fx!(9)), ..JointSpring::new(fx!(2), fx!(0.5)) }),
        friction: fx!(0.125),
        ratchet: None,
    });
    JointDef { kind, break_force: Some(fx!(5_000)), break_torque: Some(fx!(900)), ..pin() }
}

/// A pin with a ratchet, and limits that are farther apart than a tooth.
fn ratchet() -> JointDef {
    let limits = Some(JointLimits { lower: fx!(-9), upper: fx!(9) });
    JointDef { kind: JointKind::Revolute(Revolute { limits, ratchet: Some(-12), ..Revolute::default() }), ..pin() }
}

/// A rope over two points from the body in slot 5 to the body in slot 6.
fn pulley() -> JointDef {
    let pulley = Pulley { grounds: [vec2(0, 9), vec2(2, 9)], strands: [1, 2], length: fx!(30) };
    JointDef { kind: JointKind::Pulley(pulley), ..rod() }
}

/// A weld of the body in slot 4 to the world.
fn weld() -> JointDef {
    JointDef { kind: JointKind::Weld(Weld::default()), ..pin() }
}

/// A rod between the bodies in slots 5 and 6.
fn rod() -> JointDef {
    let [first, second] = [5, 6].map(|slot| End::Body(Attachment::centre(BodyId::from_parts(slot, 0))));
    let kind = JointKind::Distance(Distance::rod(fx!(1.5)));
    JointDef { collide_connected: true, events: true, ..JointDef::new([first, second], kind) }
}

/// A slider of the body in slot 6 in the world, with all that can act along its axis.
fn slider() -> JointDef {
    let ends = [End::World(vec2(4, 4)), End::Body(Attachment::centre(BodyId::from_parts(6, 0)))];
    let kind = JointKind::Prismatic(Prismatic {
        limits: Some(JointLimits { lower: fx!(-1), upper: fx!(2) }),
        motor: Some(JointMotor { speed: fx!(1), max_force: fx!(30) }),
        spring: Some(JointSpring::new(fx!(2), fx!(0.5))),
        friction: fx!(0.1),
    });
    JointDef { angles: [fx!(0.5), fx!(0)], ..JointDef::new(ends, kind) }
}

/// A wheel on its suspension, a rope, and a motor joint, between the bodies in slots 5 and 6.
fn wheel_rope_and_motor() -> [JointDef; 3] {
    let wheel = Wheel {
        limits: Some(JointLimits { lower: fx!(-0.2), upper: fx!(0.3) }),
        spring: Some(JointSpring { max_force: Some(fx!(90)), ..JointSpring::new(fx!(3), fx!(0.7)) }),
        motor: Some(JointMotor { speed: fx!(-2), max_force: fx!(4) }),
        friction: fx!(0.2),
    };
    let rope = Distance { spring: Some(JointSpring::new(fx!(1), fx!(0))), ..Distance::rope(fx!(3)) };
    let motor = Motor {
        motor: Some(PlanarMotor { velocity: vec2(1, 2), max_force: fx!(3) }),
        angular_spring: Some(JointSpring::new(fx!(2), fx!(0.5))),
        angular_motor: Some(JointMotor { speed: fx!(1), max_force: fx!(0.5) }),
        ..Motor::target(vec2(1, 1), fx!(3), fx!(1), fx!(40))
    };
    let kinds = [JointKind::Wheel(wheel), JointKind::Distance(rope), JointKind::Motor(motor)];
    kinds.map(|kind| JointDef { kind, ..rod() })
}

/// Every command there is, the shortest and the longest of each; all are allowed in the world that is recorded.
pub(crate) fn commands() -> Vec<Command> {
    let body = BodyId::from_parts(1, 0);
    let point = Some(vec2(fx!(0.5), fx!(-7)));
    let actions = [
        ForceOrImpulse::Force { force: vec2(1, -2), point },
        ForceOrImpulse::Torque(fx!(0.5)),
        ForceOrImpulse::Impulse { impulse: vec2(1, 2), point: None },
        ForceOrImpulse::AngularImpulse(fx!(-0.25)),
    ];
    let options = ApplyOptions { frame: Frame::Body, wake: false };
    let mut commands: Vec<Command> = actions.map(|action| Command::Apply { body, action, options }).into();
    let masses_given = [Mass::Kilograms(fx!(3)), Mass::Explicit { mass: fx!(4), inertia: fx!(5) }];
    let masses = [Mass::FromColliders].into_iter().chain(masses_given);
    commands.extend(masses.map(|mass| Command::SetMass { body, mass }));
    commands.extend(fields().into_iter().map(Command::AddField));
    commands.extend(colliders().into_iter().map(|def| Command::AddCollider { body, def }));
    let collider = ColliderId::from_parts(ON_THE_GROUND, 0);
    let joint = JointId::from_parts(1, 0);
    commands.extend(colliders().into_iter().step_by(11).map(|def| Command::SetCollider { collider, def }));
    let damped = BodyDef {
        linear_damping: Some(Damping::kept_per_second(fx!(0.5))),
        angular_damping: Some(Damping::kept_per_second(fx!(0.25))),
        ..BodyDef::dynamic()
    };
    let set_field = |field| Command::SetField { id: FieldId::from_parts(0, 0), field };
    commands.extend([
        Command::AddBody(BodyDef {
            mass: Mass::Explicit { mass: fx!(2), inertia: fx!(3) },
            position: vec2(fx!(0.125), -8),
            angle: fx!(0.75),
            velocity: vec2(-3, 4),
            angular_velocity: fx!(-1),
            gravity_scale: fx!(2),
            max_speed: Some(fx!(9)),
            max_angular_speed: Some(fx!(0.75)),
            dominance: -3,
            bullet: true,
            force_groups: 6,
            key: 7,
            user_data: u64::MAX,
            ..damped
        }),
        Command::AddBody(BodyDef { colliders: ghosts(), ..BodyDef::kinematic() }),
        Command::AddBody(BodyDef::fixed()),
        Command::AddBody(BodyDef::fixed().with_collider(chains().remove(0))),
        Command::AddBody(BodyDef::kinematic().with_collider(chains().remove(1))),
        Command::AddBody(BodyDef { colliders: colliders(), ..BodyDef::dynamic() }),
        Command::SetPosition { body, position: vec2(1, -2) },
        Command::SetAngle { body, angle: fx!(1) },
        Command::SetVelocity { body, velocity: vec2(1, 2) },
        Command::SetAngularVelocity { body, velocity: fx!(0.5) },
        Command::SetKind { body, kind: BodyKind::Dynamic },
        Command::SetGravityScale { body, scale: fx!(-0.5) },
        Command::SetBodyDamping {
            body,
            linear: Some(Damping::kept_per_second(fx!(0.5))),
            angular: Some(Damping::kept_per_second(fx!(0.75))),
        },
        Command::SetBodyDamping { body, linear: None, angular: None },
        Command::SetDominance { body, dominance: -4 },
        Command::SetBullet { body, bullet: true },
        Command::Explode(Explosion { falloff: fx!(30), mask: 5, ..Explosion::new(vec2(1, 2), fx!(0.25)) }),
        Command::SetForceGroups { body, force_groups: 3 },
        Command::SetKey { body, key: 1 << 40 },
        Command::SetUserData { body, user_data: 6 },
        Command::Wake(body),
        Command::Release(BodyId::from_parts(7, 0)),
        set_field(fields()[2]),
        set_field(fields()[8]),
        Command::Disable(body),
        Command::SetTimeStep(TimeStep::ratio(1001, 60_000)),
        Command::SetGravity(vec2(0, -9)),
        Command::SetIntegrator(Integrator::PublishedVerlet),
        Command::SetDamping {
            linear: Damping::kept_per_second(fx!(0.5)),
            angular: Damping::kept_per_second(fx!(0.25)),
        },
        Command::SetSleepAfter(None),
        Command::SetSleepAfter(Some(20)),
        Command::SetRandom(Random::seeded(3)),
        Command::SetBlob(vec![1, 2, 3]),
        Command::ClearForces,
        Command::Enable(body),
        Command::SetLocks { body, locks: Locks { x: true, y: false, rotation: true } },
        Command::SetMaxSpeeds { body, linear: Some(fx!(3)), angular: Some(fx!(0.5)) },
        Command::SetMaxSpeeds { body, linear: None, angular: None },
        Command::MoveTo { body: BodyId::from_parts(9, 0), position: vec2(fx!(0.5), 2), angle: fx!(3) },
        Command::SetContactSettings(ContactSettings {
            substeps: 3,
            push_speed: fx!(2),
            hit_speed: fx!(5),
            ..ContactSettings::default()
        }),
        Command::ExcludePair { a: BodyId::from_parts(0, 0), b: body, exclusion: Exclusion::Always },
        Command::ExcludePair { a: body, b: BodyId::from_parts(0, 0), exclusion: Exclusion::UntilApart },
        Command::AllowPair { a: body, b: BodyId::from_parts(0, 0) },
        Command::SetMaterialPair { first: 9, second: 7, pair: Some(MaterialPair::default()) },
        Command::SetMaterialPair { first: 8, second: 8, pair: Some(MaterialPair::default()) },
        Command::SetMaterialPair { first: 8, second: 8, pair: None },
        Command::AddJoint(weld()),
        Command::AddJoint(driven_pin()),
        Command::AddJoint(JointDef { break_force: Some(fx!(2000)), ..rod() }),
        Command::SetJointKind { joint, kind: rod().kind },
        Command::SetJointKind { joint, kind: slider().kind },
        Command::SetJointKind { joint, kind: wheel_rope_and_motor()[0].kind },
        Command::SetJointKind { joint, kind: wheel_rope_and_motor()[1].kind },
        Command::SetJointKind { joint, kind: wheel_rope_and_motor()[2].kind },
        Command::SetJointKind { joint, kind: JointKind::Gear(Gear { teeth: [12, -36] }) },
        Command::SetJointKind { joint, kind: pulley().kind },
        Command::SetJointKind { joint, kind: ratchet().kind },
        Command::SetJointKind { joint, kind: JointKind::Distance(Distance::spring(fx!(1), fx!(2), fx!(0))) },
        Command::SetJointKind { joint, kind: weld().kind },
        Command::SetJointKind { joint, kind: driven_pin().kind },
        Command::SetJointMotor {
            joint: JointId::from_parts(0, 0),
            motor: Some(JointMotor { speed: fx!(-1), max_force: fx!(2) }),
        },
        Command::SetJointMotor { joint: JointId::from_parts(0, 0), motor: None },
        Command::SetSleepAfter(Some(3)),
        Command::SetJointBreak { joint, force: Some(fx!(0.5)) },
        Command::SetJointBreak { joint, force: None },
        Command::SetJointBreakTorque { joint, torque: Some(fx!(7)) },
        Command::SetJointBreakTorque { joint, torque: None },
        Command::EnableJoint { joint, enabled: false },
        Command::Sleep(BodyId::from_parts(3, 0)),
        Command::AddField(friction()),
        Command::SetBodyDamping { body, linear: Some(Damping::rate(fx!(30))), angular: Some(Damping::rate(Fx::MAX)) },
        Command::SetDamping { linear: Damping::rate(fx!(4.5)), angular: Damping::rate(fx!(20)) },
        Command::RemoveCollider(collider),
        Command::RemoveField(FieldId::from_parts(0, 0)),
        Command::RemoveJoint(joint),
        Command::RemoveBody(BodyId::from_parts(3, 0)),
    ]);
    commands
}

/// A world with something of everything: every shape, one of them twice, every law, free slots, bodies asleep and
/// quarantined, forces that wait for the next step.
pub(crate) fn world() -> World {
    let def = WorldDef { gravity: vec2(0, -10), sleep_after: Some(2), ..WorldDef::default() };
    let mut world = World::new(def).expect("a world");
    world.register_custom_force(custom_forces().remove(0)).expect("a law");
    for shape in shapes().into_iter().chain([shapes().remove(0)]) {
        let mass = Mass::Kilograms(fx!(1));
        let def = BodyDef {
            position: vec2(fx!(0.3), 3),
            mass,
            ..BodyDef::dynamic().with_collider(ColliderDef::ghost(shape))
        };
        world
            .add_body(BodyDef {
                angular_velocity: fx!(1),
                linear_damping: Some(Damping::kept_per_second(fx!(0.9))),
                angular_damping: Some(Damping::rate(fx!(7))),
                ..def
            })
            .expect("a body");
    }
    // Beyond the envelope with its first step.
    let edge = BodyDef { position: vec2(1 << 30, 0), velocity: vec2(1 << 20, 0), ..BodyDef::dynamic() };
    world.add_body(edge).expect("a body");
    for field in fields() {
        world.add_field(field).expect("a field");
    }
    let gone = world.add_field(fields()[3]).expect("a field");
    world.remove_field(gone).expect("it is there");
    let [wheel, rope, motor] = wheel_rope_and_motor();
    let gear = JointDef { kind: JointKind::Gear(Gear { teeth: [12, -36] }), ..rod() };
    for joint in [driven_pin(), rod(), slider(), wheel, rope, pin(), motor, gear, pulley(), ratchet()] {
        world.add_joint(joint).expect("a joint");
    }
    world.remove_joint(JointId::from_parts(5, 0)).expect("it is there");
    world.set_blob(b"some bytes of the game's").expect("few");
    world.add_body(BodyDef { gravity_scale: Fx::ZERO, force_groups: 0, ..BodyDef::dynamic() }).expect("a body");
    // One on its way, one that is disabled, one that is locked.
    let rail = world.add_body(BodyDef::kinematic()).expect("a body");
    let capped = BodyDef { max_speed: Some(fx!(7)), max_angular_speed: Some(fx!(0.5)), ..BodyDef::dynamic() };
    let out = world.add_body(capped).expect("a body");
    world.disable(out).expect("it is there");
    let locks = Locks { y: true, rotation: true, ..Locks::NONE };
    world.add_body(BodyDef { locks, ..BodyDef::dynamic() }).expect("a body");
    // A box on the ground, and colliders on bodies that came without.
    let square = ColliderDef::new(shapes().remove(1));
    for (y, def) in [(0, BodyDef::fixed()), (2, BodyDef::dynamic())] {
        let place = BodyDef { position: vec2(100, y), ..def };
        world.add_body(place.with_collider(square.clone())).expect("a body");
    }
    for shape in chains() {
        world.add_body(BodyDef { position: vec2(50, 0), ..BodyDef::fixed().with_collider(shape) }).expect("a body");
    }
    let mut added =
        colliders().into_iter().map(|def| world.add_collider(BodyId::from_parts(1, 0), def).expect("a collider"));
    let first = added.next().expect("some");
    added.for_each(drop);
    world.remove_collider(first).expect("it is there");
    let gone = world.add_body(BodyDef::fixed()).expect("a body");
    world.remove_body(gone).expect("it is there");
    for tick in 0..9 {
        world.move_to(rail, vec2(tick, 1), fx!(0.25)).expect("it is near");
        world.step();
    }
    world.move_to(rail, vec2(9, 1), fx!(0.5)).expect("it is near");
    for (slot, push) in [(1, -2), (4, 3)] {
        let body = BodyId::from_parts(slot, 0);
        world.apply_force_at_point(body, vec2(fx!(-0.1), push), vec2(3, 4)).expect("a force");
    }
    world
}

/// The bytes of a file that a test changes, one after the other: by night all of them, by day every 37th, which in words of 4 and 8 bytes
/// is another one each time.
#[allow(dead_code, reason = "each test that takes this file in uses a part of it")]
pub(crate) fn places(length: usize) -> impl Iterator<Item = usize> {
    (0..length).step_by(if seeds::is_short() { 37 } else { 1 })
}

/// All commands, a few a tick: by the level itself, and by two players.
pub(crate) fn recording() -> Vec<u8> {
    let mut world = world();
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 1, snapshot_every: 24 });
    for (tick, some) in commands().chunks(4).enumerate() {
        let mut inputs = Inputs::new();
        for (i, command) in some.iter().enumerate() {
            if i == 3 {
                recorder.execute(&mut world, command).expect("it is allowed");
            } else {
                let (player, sequence) = ((tick + i) as u32 % 2, i as u32);
                inputs.insert(Input { player, sequence, command: command.clone() }).expect("the first");
            }
        }
        if tick == 5 {
            _ = world.random_mut().bits();
        }
        recorder.step(&mut world, &inputs);
        assert!(recorder.outcomes().iter().all(|outcome| outcome.result.is_ok()), "{:?}", recorder.outcomes());
    }
    recorder.step(&mut world, &Inputs::new());
    recorder.finish(&world)
}
