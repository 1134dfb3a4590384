//! Nothing overflows or panics: each bound at it and one past it, quarantine, and worlds at the edge of everything.

#[path = "support/cases.rs"]
mod cases;

use std::cell::Cell;
use std::sync::Arc;

use cases::cases;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use umbra_physics::limits::{
    ANGULAR_SPEED, BODIES, CHAIN, CONCAVE_CORNERS, CORNERS, EXCLUDED_PAIRS, FIELDS, FRICTION, GRAVITY, GRAVITY_SCALE,
    JOINT_ANGLE, JOINT_LENGTH, MASS_MAX, MASS_MIN, MATERIAL_PAIRS, MU_MAX_LOG2, PARTS, POSITION, QUERY, RATE_MAX,
    RATE_MIN, SIZE_MAX, SIZE_MIN, SPEED, STRANDS, SURFACE_SPEED, TEETH,
};
use umbra_physics::{
    Activity, AppliedForce, ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, BodyState, Cause, ColliderDef,
    Command, ContactSettings, CustomForce, CustomForceError, Damping, Dependence, Dimension, Distance, End, Error,
    Exclusion, Fault, FieldId, FieldKind, Filter, ForceField, ForceOrImpulse, ForceTorque, Frame, Fx, FxAccumulator,
    FxFactor, Gear, Integrator, JointDef, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass, MaterialPair,
    Part, Pulley, Quantity, QueryFilter, Region, Revolute, Shape, SpringConstants, TimeStep, Vec2, Weld, World,
    WorldDef, fx, vec2,
};

const ULP: Fx = Fx::DELTA;

fn world() -> World {
    World::new(WorldDef::default()).expect("a world")
}

fn out_of<T>(quantity: Quantity) -> Result<T, Error> {
    Err(Error::OutOfRange { quantity })
}

fn mu(value: Fx) -> FxFactor {
    FxFactor::from_scalar(value)
}

fn spring(start: BodyId, end: End, rest: Fx, stiffness: Fx, damping: Fx) -> FieldKind {
    FieldKind::Spring {
        near: Attachment::centre(start),
        far: end,
        spring: SpringConstants { rest, stiffness, damping },
    }
}

/// A world with a dynamic, a kinematic and a static body, and a field.
fn stage() -> (World, [BodyId; 3], FieldId) {
    let mut world = world();
    let disc = ColliderDef::ghost(Shape::circle(fx!(1)).expect("a disc"));
    let ball = BodyDef { mass: Mass::Kilograms(fx!(1)), ..BodyDef::dynamic().with_collider(disc) };
    let bodies = [ball, BodyDef::kinematic(), BodyDef::fixed()].map(|def| world.add_body(def).expect("a body"));
    let field =
        world.add_field(FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO }).expect("a field");
    (world, bodies, field)
}

/// The command is accepted, or refused with this error and the world as it was.
fn expect(world: &mut World, command: &Command, wanted: Result<(), Error>) {
    let before = world.state_hash();
    let is = world.execute(command).map(drop);
    assert_eq!(is, wanted, "{command:?}");
    if wanted.is_err() {
        assert_eq!(world.state_hash(), before, "refused, and yet changed by {command:?}");
    }
}

/// ±bound is accepted, ±(bound + an ulp) is not, in either component.
fn try_vector(bound: Fx, quantity: Quantity, command: impl Fn(Vec2, BodyId, FieldId) -> Command) {
    let (mut world, [body, ..], field) = stage();
    for good in [bound, -bound] {
        for v in [vec2(good, 0), vec2(0, good), Vec2::new(good, -good)] {
            expect(&mut world, &command(v, body, field), Ok(()));
        }
    }
    for bad in [bound + ULP, -bound - ULP, Fx::MAX, Fx::MIN] {
        for v in [vec2(bad, 0), vec2(0, bad)] {
            expect(&mut world, &command(v, body, field), out_of(quantity));
        }
    }
}

/// From least to most is accepted, an ulp beyond is not.
fn try_scalar(range: [Fx; 2], quantity: Quantity, command: impl Fn(Fx, BodyId, FieldId) -> Command) {
    let (mut world, [body, ..], field) = stage();
    for good in range {
        expect(&mut world, &command(good, body, field), Ok(()));
    }
    let bad = [range[0].checked_sub(ULP), range[1].checked_add(ULP), Some(Fx::MIN)];
    for bad in bad.into_iter().flatten() {
        expect(&mut world, &command(bad, body, field), out_of(with_value(quantity, bad)));
    }
}

/// The quantity with the value that was refused, if it has one.
fn with_value(quantity: Quantity, value: Fx) -> Quantity {
    match quantity {
        Quantity::Mass { .. } => Quantity::Mass { value },
        Quantity::Inertia { .. } => Quantity::Inertia { value },
        quantity => quantity,
    }
}

fn body(change: impl FnOnce(&mut BodyDef)) -> Command {
    let mut def = BodyDef::dynamic().with_collider(ColliderDef::ghost(Shape::circle(fx!(1)).expect("a disc")));
    change(&mut def);
    Command::AddBody(def)
}

#[test]
fn each_bound_of_a_vector_is_accepted_and_one_ulp_past_it_refused() {
    try_vector(POSITION, Quantity::Position, |position, body, _| Command::SetPosition { body, position });
    try_vector(POSITION, Quantity::Position, |position, _, _| body(|def| def.position = position));
    try_vector(SPEED, Quantity::Velocity, |velocity, body, _| Command::SetVelocity { body, velocity });
    try_vector(SPEED, Quantity::Velocity, |velocity, _, _| body(|def| def.velocity = velocity));
    try_vector(GRAVITY, Quantity::Gravity, |gravity, _, _| Command::SetGravity(gravity));
    let pin = |ends| Command::AddJoint(JointDef::new(ends, JointKind::default()));
    try_vector(POSITION, Quantity::Position, |point, body, _| {
        pin([End::World(point), End::Body(Attachment::centre(body))])
    });
    try_vector(SIZE_MAX, Quantity::JointPoint, |point, body, _| {
        pin([End::Body(Attachment { body, point }), End::World(Vec2::ZERO)])
    });
    let set = |id, law: FieldKind| Command::SetField { id, field: law.into() };
    try_vector(SPEED, Quantity::Velocity, |wind, _, id| {
        set(id, FieldKind::Drag { linear: fx!(1), quadratic: fx!(1), wind })
    });
    try_vector(GRAVITY, Quantity::Gravity, |acceleration, _, id| {
        set(id, FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius: fx!(1) }, acceleration })
    });
    try_vector(POSITION, Quantity::Position, |centre, _, id| {
        set(id, FieldKind::Zone { region: Region::Disc { centre, radius: POSITION }, acceleration: Vec2::X })
    });
    try_vector(POSITION, Quantity::Position, |corner, _, id| {
        set(id, FieldKind::Zone { region: Region::Box { min: corner, max: Vec2::ZERO }, acceleration: Vec2::X })
    });
    try_vector(POSITION, Quantity::Position, |corner, _, id| {
        set(id, FieldKind::Zone { region: Region::Box { min: Vec2::ZERO, max: corner }, acceleration: Vec2::X })
    });
    try_vector(POSITION, Quantity::Position, |point, body, id| {
        set(id, spring(body, End::World(point), fx!(1), fx!(1), fx!(1)))
    });
    try_vector(POSITION, Quantity::Position, |point, _, id| {
        set(id, FieldKind::Attractor { centre: End::World(point), mu: mu(fx!(1)), softening: fx!(1) })
    });
    try_vector(SIZE_MAX, Quantity::Position, |point, body, id| {
        set(id, FieldKind::Thrust { at: Attachment { body, point }, force: vec2(Fx::MAX, Fx::MIN) })
    });
    try_vector(SIZE_MAX, Quantity::Position, |point, body, id| {
        let far = End::World(Vec2::ZERO);
        set(
            id,
            FieldKind::Spring {
                near: Attachment { body, point },
                far,
                spring: SpringConstants { rest: fx!(1), stiffness: fx!(1), damping: fx!(1) },
            },
        )
    });
}

#[test]
fn each_bound_of_a_number_is_accepted_and_one_ulp_past_it_refused() {
    let set = |id, law: FieldKind| Command::SetField { id, field: law.into() };
    let turning = [-ANGULAR_SPEED, ANGULAR_SPEED];
    try_scalar(turning, Quantity::AngularVelocity, |velocity, body, _| Command::SetAngularVelocity { body, velocity });
    try_scalar(turning, Quantity::AngularVelocity, |spin, _, _| body(|def| def.angular_velocity = spin));
    let masses = [MASS_MIN, MASS_MAX];
    try_scalar(masses, Quantity::Mass { value: ULP }, |mass, body, _| Command::SetMass {
        body,
        mass: Mass::Kilograms(mass),
    });
    try_scalar(masses, Quantity::Mass { value: ULP }, |mass, body, _| Command::SetMass {
        body,
        mass: Mass::Explicit { mass, inertia: ULP },
    });
    try_scalar(masses, Quantity::Mass { value: ULP }, |mass, _, _| body(|def| def.mass = Mass::Kilograms(mass)));
    try_scalar([ULP, Fx::MAX], Quantity::Inertia { value: ULP }, |inertia, body, _| Command::SetMass {
        body,
        mass: Mass::Explicit { mass: MASS_MIN, inertia },
    });
    let scales = [-GRAVITY_SCALE, GRAVITY_SCALE];
    try_scalar(scales, Quantity::GravityScale, |scale, body, _| Command::SetGravityScale { body, scale });
    try_scalar(scales, Quantity::GravityScale, |scale, _, _| body(|def| def.gravity_scale = scale));
    let kept = [Fx::ZERO, Fx::ONE];
    try_scalar(kept, Quantity::Damping, |kept, _, _| Command::SetDamping {
        linear: Damping::kept_per_second(kept),
        angular: Damping::NONE,
    });
    try_scalar(kept, Quantity::Damping, |kept, _, _| Command::SetDamping {
        linear: Damping::NONE,
        angular: Damping::kept_per_second(kept),
    });
    try_scalar(kept, Quantity::Damping, |kept, body, _| Command::SetBodyDamping {
        body,
        linear: Some(Damping::kept_per_second(kept)),
        angular: None,
    });
    try_scalar(kept, Quantity::Damping, |kept, body, _| Command::SetBodyDamping {
        body,
        linear: None,
        angular: Some(Damping::kept_per_second(kept)),
    });
    // Minus a rate is no share, however it gets there; and no rate is too strong.
    for share in [-ULP, fx!(-1), fx!(-4), fx!(-5), fx!(-30), Fx::MIN] {
        let linear = Damping::kept_per_second(share);
        let command = Command::SetDamping { linear, angular: Damping::NONE };
        let again = Command::from_bytes(&command.to_bytes()).expect("what was written");
        let (mut world, ..) = stage();
        for command in [command, again] {
            expect(&mut world, &command, Err(Error::OutOfRange { quantity: Quantity::Damping }));
        }
    }
    for rate in [Fx::ZERO, ULP, fx!(4), fx!(4) + ULP, fx!(30), Fx::MAX] {
        let (mut world, [first, ..], _) = stage();
        let (linear, angular) = (Damping::rate(rate), Damping::rate(rate));
        expect(&mut world, &Command::SetDamping { linear, angular }, Ok(()));
        let (linear, angular) = (Some(linear), Some(angular));
        expect(&mut world, &Command::SetBodyDamping { body: first, linear, angular }, Ok(()));
        assert!(world.step().faults.is_empty());
    }
    let (mut world, ..) = stage();
    let linear = Damping::rate(-ULP);
    let refused = Err(Error::OutOfRange { quantity: Quantity::Damping });
    expect(&mut world, &Command::SetDamping { linear, angular: Damping::NONE }, refused);
    let limits = [Fx::ZERO, SPEED];
    try_scalar(limits, Quantity::MaxSpeed, |max, body, _| Command::SetMaxSpeeds {
        body,
        linear: Some(max),
        angular: None,
    });
    try_scalar(limits, Quantity::MaxAngularSpeed, |max, body, _| Command::SetMaxSpeeds {
        body,
        linear: None,
        angular: Some(max),
    });
    try_scalar(limits, Quantity::MaxSpeed, |max, _, _| body(|def| def.max_speed = Some(max)));
    try_scalar(limits, Quantity::MaxAngularSpeed, |max, _, _| body(|def| def.max_angular_speed = Some(max)));
    try_scalar(kept, Quantity::Damping, |kept, _, _| {
        body(|def| def.linear_damping = Some(Damping::kept_per_second(kept)))
    });
    try_scalar(kept, Quantity::Damping, |kept, _, _| {
        body(|def| def.angular_damping = Some(Damping::kept_per_second(kept)))
    });
    let none = Fx::ZERO;
    let rod = |body, length| {
        let ends = [End::World(Vec2::ZERO), End::Body(Attachment::centre(body))];
        JointDef::new(ends, JointKind::Distance(Distance::rod(length)))
    };
    try_scalar([SIZE_MIN, JOINT_LENGTH], Quantity::JointLength, |length, body, _| Command::AddJoint(rod(body, length)));
    let hinge = |body, kind| Command::AddJoint(JointDef { kind, ..rod(body, fx!(1)) });
    let revolute = Revolute::default();
    try_scalar([-JOINT_ANGLE, JOINT_ANGLE], Quantity::JointAngle, |lower, body, _| {
        let limits = Some(JointLimits { lower, upper: lower });
        hinge(body, JointKind::Revolute(Revolute { limits, ..revolute }))
    });
    try_scalar([-ANGULAR_SPEED, ANGULAR_SPEED], Quantity::MotorSpeed, |speed, body, _| {
        let motor = Some(JointMotor { speed, max_force: fx!(1) });
        hinge(body, JointKind::Revolute(Revolute { motor, ..revolute }))
    });
    try_scalar([none, Fx::MAX], Quantity::JointForce, |friction, body, _| {
        hinge(body, JointKind::Revolute(Revolute { friction, ..revolute }))
    });
    let (mut world, [first, ..], _) = stage();
    let largest = TEETH as i16;
    for (count, is_within) in [(1, true), (-largest, true), (largest, true), (0, false), (largest + 1, false)] {
        let gear = hinge(first, JointKind::Gear(Gear { teeth: [1, count] }));
        expect(&mut world, &gear, if is_within { Ok(()) } else { out_of(Quantity::Teeth) });
        let ratchet = hinge(first, JointKind::Revolute(Revolute { ratchet: Some(count), ..revolute }));
        expect(&mut world, &ratchet, if is_within { Ok(()) } else { out_of(Quantity::Teeth) });
    }
    let pulley = Pulley { grounds: [Vec2::ZERO; 2], strands: [1; 2], length: fx!(1) };
    for (count, is_within) in [(0, false), (1, true), (STRANDS, true), (STRANDS + 1, false)] {
        let rope = hinge(first, JointKind::Pulley(Pulley { strands: [1, count], ..pulley }));
        expect(&mut world, &rope, if is_within { Ok(()) } else { out_of(Quantity::Strands) });
    }
    try_scalar([SIZE_MIN, JOINT_LENGTH], Quantity::JointLength, |length, body, _| {
        hinge(body, JointKind::Pulley(Pulley { length, ..pulley }))
    });
    let elastic = |body, spring| hinge(body, JointKind::Weld(Weld { spring: Some(spring) }));
    let spring_of = JointSpring::new(fx!(1), fx!(1));
    try_scalar([none, fx!(1_000_000)], Quantity::SpringFrequency, |hertz, body, _| {
        elastic(body, JointSpring { hertz, ..spring_of })
    });
    try_scalar([none, fx!(1024)], Quantity::DampingRatio, |damping_ratio, body, _| {
        elastic(body, JointSpring { damping_ratio, ..spring_of })
    });
    try_scalar([-JOINT_ANGLE, JOINT_ANGLE], Quantity::JointAngle, |rest, body, _| {
        elastic(body, JointSpring { rest, ..spring_of })
    });
    try_scalar([none, Fx::MAX], Quantity::JointForce, |force, body, _| {
        elastic(body, JointSpring { max_force: Some(force), ..spring_of })
    });
    try_scalar([none, Fx::MAX], Quantity::BreakForce, |force, body, _| {
        Command::AddJoint(JointDef { break_force: Some(force), ..rod(body, fx!(1)) })
    });
    try_scalar([none, Fx::MAX], Quantity::BreakForce, |torque, body, _| {
        Command::AddJoint(JointDef { break_torque: Some(torque), ..rod(body, fx!(1)) })
    });
    try_scalar([none, POSITION], Quantity::RestLength, |rest, body, id| {
        set(id, spring(body, End::World(Vec2::ZERO), rest, fx!(1), fx!(1)))
    });
    try_scalar([none, Fx::MAX], Quantity::Stiffness, |stiffness, body, id| {
        set(id, spring(body, End::World(Vec2::ZERO), fx!(1), stiffness, fx!(1)))
    });
    try_scalar([none, Fx::MAX], Quantity::Drag, |damping, body, id| {
        set(id, spring(body, End::World(Vec2::ZERO), fx!(1), fx!(1), damping))
    });
    try_scalar([none, Fx::MAX], Quantity::Drag, |linear, _, id| {
        set(id, FieldKind::Drag { linear, quadratic: fx!(1), wind: Vec2::ZERO })
    });
    try_scalar([none, Fx::MAX], Quantity::Drag, |quadratic, _, id| {
        set(id, FieldKind::Drag { linear: fx!(1), quadratic, wind: Vec2::ZERO })
    });
    try_scalar([none, SIZE_MAX], Quantity::Softening, |softening, _, id| {
        set(id, FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu: mu(fx!(1)), softening })
    });
    try_scalar([none, POSITION], Quantity::Position, |radius, _, id| {
        set(id, FieldKind::Zone { region: Region::Disc { centre: Vec2::ZERO, radius }, acceleration: Vec2::X })
    });
}

#[test]
fn mu_is_accepted_up_to_two_to_the_64_and_not_a_bit_further() {
    let (mut world, _, id) = stage();
    let max_mu = {
        let root = FxFactor::from_ratio(1 << (MU_MAX_LOG2 / 2), 1);
        root.times(root)
    };
    // The next factor is one part in 2^63 more.
    let past = max_mu.plus(FxFactor::from_ratio(2, 1));
    assert!(past > max_mu);
    let attract = |mu| Command::SetField {
        id,
        field: FieldKind::Attractor { centre: End::World(Vec2::X), mu, softening: fx!(0) }.into(),
    };
    expect(&mut world, &attract(max_mu), Ok(()));
    expect(&mut world, &attract(FxFactor::ZERO), Ok(()));
    expect(&mut world, &attract(past), out_of(Quantity::Mu));
}

#[test]
fn rates_and_sleeping_times_have_their_bounds() {
    let (mut world, ..) = stage();
    for good in [TimeStep::hz(RATE_MIN), TimeStep::hz(RATE_MAX), TimeStep::ratio(u32::MAX, u32::MAX)] {
        expect(&mut world, &Command::SetTimeStep(good), Ok(()));
    }
    for bad in [
        TimeStep::hz(0),
        TimeStep::hz(RATE_MAX + 1),
        TimeStep::ratio(0, 1),
        TimeStep::ratio(0, 0),
        TimeStep::ratio(u32::MAX, u32::MAX - 1),
        TimeStep::ratio(429_496, u32::MAX),
    ] {
        expect(&mut world, &Command::SetTimeStep(bad), Err(Error::TimeStep));
        assert!(World::new(WorldDef { time_step: bad, ..WorldDef::default() }).is_err(), "{bad:?}");
    }
    expect(&mut world, &Command::SetSleepAfter(Some(u32::MAX)), Ok(()));
    expect(&mut world, &Command::SetSleepAfter(Some(0)), out_of(Quantity::SleepAfter));
    let zero = WorldDef { sleep_after: Some(0), ..WorldDef::default() };
    assert_eq!(World::new(zero).err(), out_of::<()>(Quantity::SleepAfter).err());
    let steep = WorldDef { gravity: vec2(0, GRAVITY + ULP), ..WorldDef::default() };
    assert_eq!(World::new(steep).err(), out_of::<()>(Quantity::Gravity).err());
}

#[test]
fn yoshida4_and_a_damping_of_zero_refuse_each_other_either_way() {
    let refused = Err(Error::DampingHasNoInverse);
    let (mut world, [first, ..], _) = stage();
    expect(
        &mut world,
        &Command::SetDamping { linear: Damping::kept_per_second(Fx::ZERO), angular: Damping::NONE },
        Ok(()),
    );
    expect(&mut world, &Command::SetIntegrator(Integrator::Yoshida4), refused);
    expect(&mut world, &Command::SetDamping { linear: Damping::NONE, angular: Damping::NONE }, Ok(()));
    expect(
        &mut world,
        &Command::SetBodyDamping { body: first, linear: None, angular: Some(Damping::kept_per_second(Fx::ZERO)) },
        Ok(()),
    );
    expect(&mut world, &Command::SetIntegrator(Integrator::Yoshida4), refused);
    expect(
        &mut world,
        &Command::SetBodyDamping { body: first, linear: None, angular: Some(Damping::kept_per_second(ULP)) },
        Ok(()),
    );
    expect(&mut world, &Command::SetIntegrator(Integrator::Yoshida4), Ok(()));
    expect(
        &mut world,
        &Command::SetBodyDamping { body: first, linear: Some(Damping::kept_per_second(Fx::ZERO)), angular: None },
        refused,
    );
    expect(
        &mut world,
        &Command::SetDamping { linear: Damping::NONE, angular: Damping::kept_per_second(Fx::ZERO) },
        refused,
    );
    expect(&mut world, &body(|def| def.linear_damping = Some(Damping::kept_per_second(Fx::ZERO))), refused);
    // The strongest rate of which something is left after a second, 33·ln 2, and the next.
    let last = Fx::from_bits(98_242_467_570);
    for (rate, answer) in [(last, Ok(())), (last + ULP, refused), (Fx::MAX, refused)] {
        let damping = Damping::rate(rate);
        expect(&mut world, &Command::SetBodyDamping { body: first, linear: Some(damping), angular: None }, answer);
        expect(&mut world, &Command::SetDamping { linear: Damping::NONE, angular: damping }, answer);
    }
}

#[test]
fn colliders_and_contacts_have_their_bounds() {
    let (mut world, [ball, ..], _) = stage();
    expect(&mut world, &Command::SetMass { body: ball, mass: Mass::Kilograms(Fx::ONE) }, Ok(()));
    let disc = ColliderDef::new(Shape::circle(fx!(1)).expect("a disc"));
    let mut is = |expected: Result<(), Error>, change: &dyn Fn(&mut ColliderDef)| {
        let mut def = disc.clone();
        change(&mut def);
        assert_eq!(def.check(), expected);
        expect(&mut world, &Command::AddCollider { body: ball, def }, expected);
    };
    for good in [Fx::ZERO, ULP, FRICTION] {
        is(Ok(()), &|def| def.material.friction = good);
    }
    for bad in [-ULP, FRICTION + ULP, Fx::MAX, Fx::MIN] {
        is(out_of(Quantity::Friction), &|def| def.material.friction = bad);
    }
    is(Ok(()), &|def| def.material.restitution = Fx::ONE);
    for bad in [-ULP, Fx::ONE + ULP] {
        is(out_of(Quantity::Restitution), &|def| def.material.restitution = bad);
    }
    for good in [Fx::ZERO, Fx::ONE] {
        is(Ok(()), &|def| def.material.rolling_resistance = good);
    }
    for bad in [-ULP, Fx::ONE + ULP] {
        is(out_of(Quantity::RollingResistance), &|def| def.material.rolling_resistance = bad);
    }
    for good in [SURFACE_SPEED, -SURFACE_SPEED] {
        is(Ok(()), &|def| def.material.surface_speed = good);
    }
    for bad in [SURFACE_SPEED + ULP, -SURFACE_SPEED - ULP, Fx::MIN] {
        is(out_of(Quantity::SurfaceSpeed), &|def| def.material.surface_speed = bad);
    }
    is(Ok(()), &|def| def.position = vec2(SIZE_MAX, -SIZE_MAX));
    for bad in [vec2(SIZE_MAX + ULP, 0), vec2(0, -SIZE_MAX - ULP), vec2(Fx::MIN, Fx::MIN)] {
        is(out_of(Quantity::ColliderPosition), &|def| def.position = bad);
    }
    is(Ok(()), &|def| (def.angle, def.density) = (Fx::MIN, Fx::MAX));
    is(out_of(Quantity::ColliderDensity { value: -ULP }), &|def| def.density = -ULP);
    // Any filter is one, also if it meets nothing.
    for (category, mask, group) in [(0, 1, 0), (1, 0, 0), (0, 0, -1), (0, u32::MAX, i32::MIN), (0, 0, 1)] {
        is(Ok(()), &|def| def.filter = Filter { category, mask, group });
    }
    let part = Part { shape: disc.shape.clone(), position: Vec2::ZERO, angle: Fx::ZERO, density: Fx::ONE };
    let compound = Shape::compound(&[part]).expect("a compound");
    is(Ok(()), &|def| def.shape = compound.clone());
    // A mass that the body cannot have: 4,096 kg/m² of 2^24 m², and none at all.
    let square = Shape::rectangle(SIZE_MAX, SIZE_MAX).expect("a square");
    let from = |density| BodyDef::dynamic().with_collider(ColliderDef { density, ..ColliderDef::new(square.clone()) });
    for (density, value) in [(fx!(4096), Fx::MAX), (Fx::ZERO, Fx::ZERO)] {
        expect(&mut world, &Command::AddBody(from(density)), out_of(Quantity::Mass { value }));
    }
    expect(&mut world, &Command::AddBody(from(Fx::ONE)), Ok(()));

    let limit = fx!(1024);
    let good = ContactSettings {
        substeps: 16,
        push_speed: limit,
        restitution_speed: limit,
        sleep_speed: limit,
        hit_speed: limit,
        max_pairs: 1 << 28,
        max_pairs_per_collider: 1 << 12,
    };
    expect(&mut world, &Command::SetContactSettings(good), Ok(()));
    let least = ContactSettings { substeps: 1, max_pairs: 1, max_pairs_per_collider: 1, ..good };
    expect(&mut world, &Command::SetContactSettings(least), Ok(()));
    for (quantity, bad) in [
        (Quantity::Substeps, ContactSettings { substeps: 0, ..good }),
        (Quantity::Substeps, ContactSettings { substeps: 17, ..good }),
        (Quantity::ContactSpeed, ContactSettings { push_speed: limit + ULP, ..good }),
        (Quantity::ContactSpeed, ContactSettings { restitution_speed: -ULP, ..good }),
        (Quantity::ContactSpeed, ContactSettings { sleep_speed: limit + ULP, ..good }),
        (Quantity::ContactSpeed, ContactSettings { hit_speed: limit + ULP, ..good }),
        (Quantity::Pairs, ContactSettings { max_pairs: 0, ..good }),
        (Quantity::Pairs, ContactSettings { max_pairs: (1 << 28) + 1, ..good }),
        (Quantity::Pairs, ContactSettings { max_pairs_per_collider: 0, ..good }),
        (Quantity::Pairs, ContactSettings { max_pairs_per_collider: (1 << 12) + 1, ..good }),
    ] {
        expect(&mut world, &Command::SetContactSettings(bad), out_of(quantity));
        assert_eq!(World::new(WorldDef { contacts: bad, ..WorldDef::default() }).map(drop), out_of(quantity));
    }
}

#[test]
fn sizes_of_shapes_have_their_bounds() {
    let size = |result: Result<Shape, Error>| result.map(drop);
    let refused = |dimension, value| out_of(Quantity::Size { dimension, value });
    for good in [SIZE_MIN, SIZE_MAX] {
        assert_eq!(size(Shape::circle(good)), Ok(()));
        assert_eq!(size(Shape::rectangle(good, SIZE_MIN)), Ok(()));
        assert_eq!(size(Shape::rectangle(SIZE_MIN, good)), Ok(()));
        assert_eq!(size(Shape::rectangle(SIZE_MAX, good)), Ok(()));
        assert_eq!(size(Shape::capsule(good, SIZE_MIN)), Ok(()));
        assert_eq!(size(Shape::capsule(SIZE_MAX, good)), Ok(()));
        assert_eq!(size(Shape::segment(Vec2::ZERO, vec2(good, 0))), Ok(()));
        assert_eq!(size(Shape::polygon(&[vec2(-good, -good), vec2(good, -good), vec2(0, good)])), Ok(()));
    }
    for bad in [SIZE_MIN - ULP, SIZE_MAX + ULP, Fx::ZERO, -SIZE_MIN, Fx::MAX, Fx::MIN] {
        assert_eq!(size(Shape::circle(bad)), refused(Dimension::Radius, bad));
        assert_eq!(size(Shape::capsule(bad, SIZE_MIN)), refused(Dimension::Length, bad));
    }
    for bad in [SIZE_MIN - ULP, SIZE_MAX + ULP, Fx::ZERO, -SIZE_MIN, Fx::MAX, Fx::MIN] {
        assert_eq!(size(Shape::rectangle(bad, SIZE_MIN)), refused(Dimension::Width, bad));
        assert_eq!(size(Shape::rectangle(SIZE_MAX, bad)), refused(Dimension::Height, bad));
        assert_eq!(size(Shape::capsule(SIZE_MAX, bad)), refused(Dimension::Rounding, bad));
    }
    let short = SIZE_MIN - ULP;
    assert_eq!(size(Shape::segment(Vec2::ZERO, vec2(short, 0))), refused(Dimension::Length, short));
    let long = SIZE_MAX + ULP;
    assert_eq!(size(Shape::segment(Vec2::ZERO, vec2(long, 0))), refused(Dimension::Coordinate(1), long));
    let all = size(Shape::segment(vec2(Fx::MIN, Fx::MIN), vec2(Fx::MAX, Fx::MAX)));
    assert_eq!(all, refused(Dimension::Coordinate(0), Fx::MIN));
    assert_eq!(size(Shape::polygon(&[Vec2::ZERO, Vec2::Y, vec2(long, 0)])), refused(Dimension::Coordinate(2), long));
    assert_eq!(size(Shape::polygon(&[Vec2::ZERO, vec2(ULP, 0), vec2(0, ULP)])), refused(Dimension::Extent, ULP));
    let corners = |n: usize| -> Vec<Vec2> {
        (0..n)
            .map(|i| {
                let (sin, cos) = (Fx::TAU / Fx::from(n as i32) * Fx::from(i as i32)).sin_cos();
                Vec2::new(cos * fx!(100), sin * fx!(100))
            })
            .collect()
    };
    assert_eq!(size(Shape::polygon(&corners(CORNERS))), Ok(()));
    assert_eq!(size(Shape::polygon(&corners(CORNERS + 1))), out_of(Quantity::Count));
    assert_eq!(size(Shape::polygon(&corners(2))), out_of(Quantity::Count));
    assert_eq!(size(Shape::polygon(&[])), out_of(Quantity::Count));
    let star: Vec<Vec2> = [0, 2, 4, 1, 3].map(|i| corners(5)[i]).to_vec();
    assert!(matches!(Shape::polygon(&star), Err(Error::NotConvex { .. })));
    let line = [Vec2::ZERO, Vec2::X, vec2(2, 0)];
    assert_eq!(size(Shape::polygon(&line)), Err(Error::NotConvex { corner: 0 }));
    let part = Part { shape: Shape::circle(fx!(1)).unwrap(), position: vec2(SIZE_MAX, 0), angle: fx!(0), density: ULP };
    let line = |count: usize| (0..count).map(|x| vec2(Fx::from_ratio(x as i64, 16), 0)).collect::<Vec<_>>();
    assert_eq!(size(Shape::chain(&line(CHAIN), false)), Ok(()));
    assert_eq!(size(Shape::chain(&line(CHAIN + 1), false)), out_of(Quantity::Count));
    // The edge of a saw, every other corner of which turns inwards.
    let saw = |count: usize| -> Vec<Vec2> {
        let tooth = |x: usize| vec2(Fx::from_ratio(x as i64, 16), fx!(1) + Fx::from((x % 2) as i32) / 4);
        (0..count - 2).rev().map(tooth).chain([vec2(0, 0), vec2(64, 0)]).collect()
    };
    assert_eq!(saw(CONCAVE_CORNERS).len(), CONCAVE_CORNERS);
    // Within the limit it has too many parts; a smooth arch has not.
    assert_eq!(size(Shape::concave_polygon(&saw(CONCAVE_CORNERS))), out_of(Quantity::Count));
    let arch = |count: usize| -> Vec<Vec2> {
        let point = |x: usize| {
            let x = Fx::from_ratio(x as i64, 16);
            Vec2::new(x, fx!(8) - (x - fx!(32)) * (x - fx!(32)) / 256)
        };
        (0..count).rev().map(point).collect()
    };
    assert_eq!(size(Shape::concave_polygon(&arch(CONCAVE_CORNERS))), Ok(()));
    assert_eq!(size(Shape::concave_polygon(&arch(CONCAVE_CORNERS + 1))), out_of(Quantity::Count));
    assert_eq!(size(Shape::compound(&vec![part.clone(); PARTS])), Ok(()));
    assert_eq!(size(Shape::compound(&vec![part.clone(); PARTS + 1])), out_of(Quantity::Count));
    assert_eq!(size(Shape::compound(&[])), out_of(Quantity::Count));
    let compound = Shape::compound(std::slice::from_ref(&part)).unwrap();
    assert_eq!(size(Shape::compound(&[Part { shape: compound, ..part.clone() }])), out_of(Quantity::Count));
    assert_eq!(
        size(Shape::compound(&[Part { density: Fx::ZERO, ..part.clone() }])),
        out_of(Quantity::Density { value: Fx::ZERO })
    );
    assert_eq!(
        size(Shape::compound(&[Part { position: vec2(0, long), ..part }])),
        refused(Dimension::Coordinate(0), long)
    );
}

#[test]
#[ignore = "takes 5 GB: with `--ignored`"]
fn a_world_is_full_at_its_bounds() {
    let mut world = world();
    for _ in 0..BODIES {
        world.add_body(BodyDef::fixed()).expect("there is room");
    }
    expect(&mut world, &Command::AddBody(BodyDef::fixed()), Err(Error::Full));
    let last = world.bodies().last().expect("there are bodies").id();
    world.remove_body(last).expect("it is there");
    expect(&mut world, &Command::AddBody(BodyDef::fixed()), Ok(()));
    drop(world);

    let mut world = self::world();
    let drag = ForceField::from(FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind: Vec2::ZERO });
    for _ in 0..FIELDS {
        world.add_field(drag).expect("there is room");
    }
    expect(&mut world, &Command::AddField(drag), Err(Error::Full));
}

#[test]
fn calls_that_a_kind_of_body_cannot_take_are_refused() {
    let (mut world, [ball, rail, wall], _) = stage();
    let force = |body| Command::Apply {
        body,
        action: ForceOrImpulse::Force { force: Vec2::X, point: None },
        options: ApplyOptions::default(),
    };
    expect(&mut world, &force(rail), Err(Error::NotDynamic { body: rail }));
    expect(&mut world, &force(wall), Err(Error::NotDynamic { body: wall }));
    let still = Command::SetVelocity { body: wall, velocity: Vec2::ZERO };
    expect(&mut world, &still, Err(Error::NotMovable { body: wall }));
    let moving = Command::AddBody(BodyDef { velocity: vec2(ULP, 0), ..BodyDef::fixed() });
    expect(&mut world, &moving, out_of(Quantity::Velocity));
    let loop_ = spring(ball, End::Body(Attachment::centre(ball)), fx!(1), fx!(1), fx!(1));
    expect(&mut world, &Command::AddField(loop_.into()), Err(Error::SameBody { body: ball }));
    let stiff = spring(rail, End::Body(Attachment::centre(wall)), fx!(1), fx!(1), fx!(1));
    expect(&mut world, &Command::AddField(stiff.into()), Err(Error::NotDynamic { body: wall }));
    let law = FieldKind::Custom { id: 7 };
    expect(&mut world, &Command::AddField(law.into()), Err(Error::CustomForce { id: 7 }));
    expect(&mut world, &Command::Release(ball), Err(Error::NotQuarantined { body: ball }));
    // Nothing is too much for a single force; its torque, or an impulse, may be.
    let far = |vector: Vec2, point| ForceOrImpulse::Force { force: vector, point: Some(point) };
    let apply = |action| Command::Apply { body: ball, action, options: ApplyOptions::default() };
    expect(&mut world, &apply(far(vec2(Fx::MAX, Fx::MIN), vec2(Fx::MIN, Fx::MAX))), Ok(()));
    // From the far corner the two parts of the moment are 1.5·2^62 N·m each.
    world.set_position(ball, vec2(POSITION, -POSITION)).unwrap();
    let both = far(vec2(Fx::MIN, Fx::MIN), vec2(Fx::MIN, Fx::MAX));
    expect(&mut world, &apply(both), out_of(Quantity::Torque));
    let impulse = ForceOrImpulse::Impulse { impulse: vec2(Fx::MAX, 0), point: None };
    expect(&mut world, &apply(impulse), out_of(Quantity::Velocity));
    expect(&mut world, &apply(ForceOrImpulse::AngularImpulse(Fx::MIN)), out_of(Quantity::AngularVelocity));
    let exact = ForceOrImpulse::Impulse { impulse: vec2(SPEED, -SPEED), point: None };
    expect(&mut world, &apply(exact), Ok(()));
    let more = ForceOrImpulse::Impulse { impulse: vec2(ULP, 0), point: None };
    expect(&mut world, &apply(more), out_of(Quantity::Velocity));
}

type Bits = ([i128; 5], u64);

fn bits(world: &World, body: BodyId) -> Bits {
    let body = world.body(body).expect("it is there");
    let (x, v) = (body.position_exact(), body.velocity_exact());
    ([x.x, x.y, v.x, v.y, body.angular_velocity_exact()].map(FxAccumulator::to_bits), body.angle_exact().to_bits())
}

struct Faulty;

impl CustomForce for Faulty {
    fn id(&self) -> u64 {
        99
    }
    fn version(&self) -> u32 {
        1
    }
    fn depends_on(&self) -> Dependence {
        Dependence::Position
    }
    fn push(&self, body: &BodyState) -> Result<ForceTorque, CustomForceError> {
        if body.key == 1 {
            Err(CustomForceError { code: 42 })
        } else {
            Ok(ForceTorque { force: Vec2::X, torque: Fx::ONE })
        }
    }
}

/// A doomed body with neighbours on springs, and how it comes to leave the envelope.
fn doom(integrator: Integrator, way: usize) -> (World, [BodyId; 3], Option<Cause>) {
    let mut world = World::new(WorldDef { integrator, ..WorldDef::default() }).expect("a world");
    let disc = ColliderDef::ghost(Shape::circle(fx!(1)).expect("a disc"));
    let mass = Mass::Kilograms(fx!(1));
    let base = BodyDef { force_groups: 2, mass, ..BodyDef::dynamic().with_collider(disc) };
    let at = |position, velocity, spin| BodyDef {
        position,
        velocity,
        angular_velocity: spin,
        key: 1,
        force_groups: 1,
        ..base.clone()
    };
    let edge = POSITION - ULP;
    let def = match way {
        0 => at(Vec2::new(edge, Fx::ZERO), vec2(SPEED, 0), fx!(3)),
        1 => at(Vec2::ZERO, Vec2::new(fx!(0), -SPEED), fx!(0)),
        2 => at(Vec2::ZERO, Vec2::ZERO, ANGULAR_SPEED),
        _ => at(vec2(fx!(0.5), 0), vec2(fx!(0.1), 0), fx!(1)),
    };
    let (doomed, neighbour, bystander) = (
        world.add_body(def).unwrap(),
        world.add_body(BodyDef { position: vec2(3, 1), ..base.clone() }).unwrap(),
        world.add_body(BodyDef { position: vec2(9, 1), velocity: vec2(1, 0), ..base.clone() }).unwrap(),
    );
    let cause = match way {
        0 => Some(Cause::Position),
        1 => {
            world.apply_force(doomed, vec2(0, -1)).unwrap();
            Some(Cause::Velocity)
        }
        2 => {
            world.apply_torque(doomed, fx!(1)).unwrap();
            Some(Cause::AngularVelocity)
        }
        3 => {
            // Wide forces are below 2^63 N: 2^32 times the most is past it, and 2^17 times a torque of 2^46 N·m·… is too.
            let lever = vec2(Fx::MAX, 0);
            for _ in 0..6 {
                world.apply_force_at_point(doomed, vec2(0, Fx::MAX), lever).unwrap();
            }
            Some(Cause::Force)
        }
        4 => {
            let field = world
                .add_field(FieldKind::Attractor {
                    centre: End::World(vec2(fx!(0.5), ULP)),
                    mu: mu(fx!(2147483647)),
                    softening: fx!(0),
                })
                .unwrap();
            world.set_field(field, ForceField { force_groups: 1, ..*world.field(field).unwrap() }).unwrap();
            Some(Cause::Field { field })
        }
        5 => {
            world.register_custom_force(Arc::new(Faulty)).unwrap();
            let field = world.add_field(ForceField { kind: FieldKind::Custom { id: 99 }, force_groups: 1 }).unwrap();
            Some(Cause::CustomForce { field, code: 42 })
        }
        _ => {
            world.apply_force(doomed, vec2(Fx::MAX, 0)).unwrap();
            Some(Cause::Velocity)
        }
    };
    (world, [doomed, neighbour, bystander], cause)
}

#[test]
fn a_body_that_leaves_the_envelope_is_put_back_taken_out_and_reported() {
    for integrator in Integrator::ALL {
        for way in 0..7 {
            let (mut world, [doomed, neighbour, bystander], cause) = doom(integrator, way);
            let link = world
                .add_field(spring(neighbour, End::Body(Attachment::centre(doomed)), fx!(1), fx!(0), fx!(0)))
                .unwrap();
            let mut alone = world.clone();
            let (before, tick) = (bits(&world, doomed), world.tick());
            let report = world.step();
            assert_eq!(report.faults.iter().map(|f| f.body).collect::<Vec<_>>(), [doomed], "{integrator:?}, way {way}");
            assert_eq!(Some(report.faults[0].cause), cause, "{integrator:?}, way {way}");
            assert_eq!(world.tick(), tick + 1);
            assert_eq!(bits(&world, doomed), before, "{integrator:?}, way {way}: back to the bit");
            assert_eq!(world.body(doomed).unwrap().activity(), Activity::Quarantined);
            let applied = world.apply_force(doomed, Vec2::X);
            assert_eq!(applied, Err(Error::Quarantined { body: doomed }));
            assert_eq!(world.wake(doomed), Err(Error::Quarantined { body: doomed }));
            assert_eq!(world.set_kind(doomed, BodyKind::Static), Err(Error::Quarantined { body: doomed }));
            // The others are where they are without it.
            alone.remove_body(doomed).unwrap();
            alone.step();
            for body in [neighbour, bystander] {
                assert_eq!(bits(&world, body), bits(&alone, body), "{integrator:?}, way {way}");
            }
            // A spring with a pull is inert from the next tick on.
            let pull = spring(neighbour, End::Body(Attachment::centre(doomed)), fx!(1), fx!(50), fx!(1));
            world.set_field(link, pull).unwrap();
            for _ in 0..10 {
                assert_eq!(world.step().faults, []);
                alone.step();
            }
            for body in [neighbour, bystander] {
                assert_eq!(bits(&world, body), bits(&alone, body), "{integrator:?}, way {way}: the spring is inert");
            }
            assert_eq!(bits(&world, doomed), before);
            // Put somewhere good it is released, and pulls again.
            world.set_position(doomed, vec2(5, 5)).unwrap();
            world.set_velocity(doomed, Vec2::ZERO).unwrap();
            world.set_angular_velocity(doomed, Fx::ZERO).unwrap();
            world.set_key(doomed, 0).unwrap();
            world.set_force_groups(doomed, 2).unwrap();
            world.release(doomed).unwrap();
            assert_eq!(world.body(doomed).unwrap().activity(), Activity::Awake);
            assert_eq!(world.step().faults, [], "{integrator:?}, way {way}");
            assert_eq!(world.step().faults, [], "{integrator:?}, way {way}");
            assert_ne!(bits(&world, doomed).0[2], 0, "{integrator:?}, way {way}: it moves");
            alone.step();
            alone.step();
            assert_ne!(bits(&world, neighbour), bits(&alone, neighbour), "{integrator:?}, way {way}: and pulls");
        }
    }
}

#[test]
fn a_body_that_no_field_reaches_is_put_back_as_well() {
    for integrator in Integrator::ALL {
        for way in [0, 1, 2, 3, 6] {
            let (mut world, [doomed, neighbour, bystander], cause) = doom(integrator, way);
            let mut alone = world.clone();
            alone.remove_body(doomed).unwrap();
            let before = bits(&world, doomed);
            let faults = world.step().faults.to_vec();
            assert_eq!(faults, [Fault { body: doomed, cause: cause.unwrap() }], "{integrator:?}, way {way}");
            assert_eq!(bits(&world, doomed), before, "{integrator:?}, way {way}: back to the bit");
            alone.step();
            for body in [neighbour, bystander] {
                assert_eq!(bits(&world, body), bits(&alone, body), "{integrator:?}, way {way}");
            }
        }
    }
}

#[test]
fn a_sum_of_forces_past_what_fits_is_found_in_the_step_whatever_the_order() {
    // 2^31 N at most a call and 2^63 N in all: the sum itself cannot overflow in calls that anyone makes, torques can.
    let mut world = world();
    let body = world
        .add_body(BodyDef { mass: Mass::Explicit { mass: MASS_MAX, inertia: Fx::MAX }, ..BodyDef::dynamic() })
        .unwrap();
    let push = |world: &mut World, sign: bool| {
        let force = if sign { vec2(0, Fx::MAX) } else { vec2(0, -Fx::MAX) };
        world.apply_force_at_point(body, force, vec2(Fx::MAX, 0)).unwrap();
    };
    (0..40).for_each(|_| push(&mut world, true));
    assert_eq!(world.body(body).unwrap().applied_torque(), None, "the sum does not fit now");
    (0..40).for_each(|_| push(&mut world, false));
    assert_eq!(world.body(body).unwrap().applied_torque().map(|t| t.to_bits()), Some(0), "and cancels to the bit");
    assert_eq!(world.step().faults, []);
    (0..40).for_each(|_| push(&mut world, true));
    assert_eq!(world.step().faults, [Fault { body, cause: Cause::Force }]);
}

#[test]
fn two_bodies_of_a_spring_that_pulls_too_hard_are_both_taken_out() {
    for integrator in Integrator::ALL {
        let mut world = World::new(WorldDef { integrator, ..WorldDef::default() }).unwrap();
        let ends = [POSITION, -POSITION].map(|x| {
            world
                .add_body(BodyDef { position: vec2(x, 0), mass: Mass::Kilograms(MASS_MIN), ..BodyDef::dynamic() })
                .unwrap()
        });
        world.add_field(spring(ends[0], End::Body(Attachment::centre(ends[1])), Fx::ZERO, Fx::MAX, Fx::MAX)).unwrap();
        let before = ends.map(|end| bits(&world, end));
        let faults: Vec<BodyId> = world.step().faults.iter().map(|fault| fault.body).collect();
        assert_eq!(faults, ends, "{integrator:?}");
        assert_eq!(ends.map(|end| bits(&world, end)), before, "{integrator:?}");
    }
}

fn edge() -> impl Strategy<Value = Fx> {
    // Bounds and their neighbours as often as anything between.
    let named = prop_oneof![
        Just(0i64),
        Just(1),
        Just(-1),
        Just(1 << 16),
        Just(1 << 31),
        Just(1 << 32),
        Just(-(1 << 32)),
        Just(1 << 44),
        Just(1 << 48),
        Just(1 << 52),
        Just(-(1 << 52)),
        Just(1 << 56),
        Just(1 << 62),
        Just(-(1 << 62)),
        Just(i64::MAX),
        Just(i64::MIN)
    ];
    let beside = (named, -1i64..=1).prop_map(|(bits, offset)| bits.saturating_add(offset));
    let spread = (any::<i64>(), 0u32..63).prop_map(|(bits, offset)| bits >> offset);
    prop_oneof![beside, spread].prop_map(Fx::from_bits)
}

fn edge_vector() -> impl Strategy<Value = Vec2> {
    (edge(), edge()).prop_map(|(x, y)| Vec2::new(x, y))
}

/// Anything the call takes at the bound; what is past it is cut off, so that worlds come to be.
fn within(bound: Fx) -> impl Strategy<Value = Fx> {
    edge().prop_map(move |value| {
        if value > bound {
            bound
        } else if value < -bound {
            -bound
        } else {
            value
        }
    })
}

fn vector_within(bound: Fx) -> impl Strategy<Value = Vec2> {
    (within(bound), within(bound)).prop_map(|(x, y)| Vec2::new(x, y))
}

fn positive(bound: Fx) -> impl Strategy<Value = Fx> {
    within(bound).prop_map(|value| if value < Fx::ZERO { -value } else { value })
}

/// A collider that touches nothing.
fn ghost() -> impl Strategy<Value = ColliderDef> {
    (0..5, positive(SIZE_MAX), positive(SIZE_MAX), prop_oneof![Just(Fx::ONE), edge()]).prop_map(
        |(which, a, b, density)| {
            let shape = match which {
                0 => Shape::circle(a),
                1 => Shape::rectangle(a, b),
                2 => Shape::capsule(a, b),
                3 => Shape::segment(Vec2::new(-a, b), Vec2::new(b, a)),
                _ => Shape::polygon(&[Vec2::new(-a, -b), Vec2::new(a, -b), Vec2::new(Fx::ZERO, b)]),
            };
            let shape = shape.unwrap_or_else(|_| Shape::circle(fx!(1)).expect("a disc"));
            ColliderDef { density, ..ColliderDef::ghost(shape) }
        },
    )
}

fn mass() -> impl Strategy<Value = Mass> {
    let kilograms = || prop_oneof![Just(MASS_MIN), Just(MASS_MAX), Just(Fx::ONE), edge()];
    prop_oneof![
        kilograms().prop_map(Mass::Kilograms),
        Just(Mass::FromColliders),
        (kilograms(), edge()).prop_map(|(mass, inertia)| Mass::Explicit { mass, inertia }),
    ]
}

fn damping() -> impl Strategy<Value = Option<Damping>> {
    let kept = prop_oneof![Just(ULP), Just(Fx::ZERO), Just(Fx::ONE), positive(Fx::ONE)];
    let rate = prop_oneof![Just(fx!(4) + ULP), Just(fx!(60)), Just(Fx::MAX), positive(Fx::MAX)];
    prop_oneof![
        1 => Just(None),
        4 => kept.prop_map(Damping::kept_per_second).prop_map(Some),
        2 => rate.prop_map(Damping::rate).prop_map(Some),
    ]
}

fn most() -> impl Strategy<Value = Option<Fx>> {
    prop_oneof![4 => Just(None), 1 => Just(Some(Fx::ZERO)), 1 => Just(Some(SPEED)), 2 => positive(SPEED).prop_map(Some)]
}

fn locks() -> impl Strategy<Value = Locks> {
    let any = (any::<bool>(), any::<bool>(), any::<bool>());
    prop_oneof![4 => Just(Locks::NONE), 1 => any.prop_map(|(x, y, rotation)| Locks { x, y, rotation })]
}

fn kind() -> impl Strategy<Value = BodyKind> {
    prop_oneof![4 => Just(BodyKind::Dynamic), 1 => Just(BodyKind::Kinematic), 1 => Just(BodyKind::Static)]
}

prop_compose! {
    fn body_def()(
        kind in kind(),
        position in vector_within(POSITION),
        angle in edge(),
        velocity in vector_within(SPEED),
        angular_velocity in within(ANGULAR_SPEED),
        (ghost, mass) in (prop::option::of(ghost()), mass()),
        gravity_scale in within(GRAVITY_SCALE),
        (linear_damping, angular_damping) in (damping(), damping()),
        ((max_speed, max_angular_speed), locks) in ((most(), most()), locks()),
        force_groups in 0u32..4,
    ) -> BodyDef {
        let still = kind == BodyKind::Static;
        let velocity = if still { Vec2::ZERO } else { velocity };
        let angular_velocity = if still || locks.rotation { Fx::ZERO } else { angular_velocity };
        let free = |v: Fx, locked: bool| if locked { Fx::ZERO } else { v };
        let velocity = Vec2::new(free(velocity.x, locks.x), free(velocity.y, locks.y));
        BodyDef { bullet: false, kind, position, angle, velocity, angular_velocity, colliders: ghost.into_iter().collect(), mass, gravity_scale, linear_damping,
            angular_damping, max_speed, max_angular_speed, locks, dominance: 0, force_groups, key: 0, user_data: 0 }
    }
}

fn handle() -> impl Strategy<Value = BodyId> {
    (0u32..6, 0u32..2).prop_map(|(slot, generation)| BodyId::from_parts(slot, generation * (slot % 2)))
}

fn attachment() -> impl Strategy<Value = Attachment> {
    (handle(), prop_oneof![Just(Vec2::ZERO), vector_within(SIZE_MAX)])
        .prop_map(|(body, point)| Attachment { body, point })
}

fn end() -> impl Strategy<Value = End> {
    prop_oneof![vector_within(POSITION).prop_map(End::World), attachment().prop_map(End::Body)]
}

fn law() -> impl Strategy<Value = FieldKind> {
    let any_mu = (any::<u64>(), 0u32..64, any::<bool>()).prop_map(|(value, offset, past)| {
        let value = FxFactor::from_ratio((value >> offset).max(1), 1);
        if past { value.times(FxFactor::from_ratio(1, 1 << 60)) } else { value }
    });
    prop_oneof![
        (end(), any_mu, positive(SIZE_MAX)).prop_map(|(centre, mu, softening)| FieldKind::Attractor {
            centre,
            mu,
            softening
        }),
        (attachment(), end(), positive(POSITION), positive(Fx::MAX), positive(Fx::MAX)).prop_map(
            |(near, far, rest, stiffness, damping)| {
                let spring = SpringConstants { rest, stiffness, damping };
                FieldKind::Spring { near, far, spring }
            }
        ),
        (positive(Fx::MAX), positive(Fx::MAX), vector_within(SPEED))
            .prop_map(|(linear, quadratic, wind)| FieldKind::Drag { linear, quadratic, wind }),
        (attachment(), edge_vector()).prop_map(|(at, force)| FieldKind::Thrust { at, force }),
        (vector_within(POSITION), positive(POSITION), vector_within(GRAVITY)).prop_map(
            |(centre, radius, acceleration)| {
                FieldKind::Zone { region: Region::Disc { centre, radius }, acceleration }
            }
        ),
        (vector_within(POSITION), vector_within(POSITION), vector_within(GRAVITY))
            .prop_map(|(min, max, acceleration)| FieldKind::Zone { region: Region::Box { min, max }, acceleration }),
        (98u64..101).prop_map(|id| FieldKind::Custom { id }),
        (
            (vector_within(POSITION), vector_within(POSITION), vector_within(SPEED)),
            (positive(Fx::MAX), positive(Fx::MAX), positive(Fx::MAX))
        )
            .prop_map(|((a, b, flow), (density, linear_drag, angular_drag))| {
                let (min, max) = (Vec2::new(a.x.min(b.x), a.y.min(b.y)), Vec2::new(a.x.max(b.x), a.y.max(b.y)));
                FieldKind::Buoyancy { min, max, density, linear_drag, angular_drag, flow }
            }),
    ]
}

fn field() -> impl Strategy<Value = ForceField> {
    (law(), prop_oneof![Just(u32::MAX), 0u32..4]).prop_map(|(kind, force_groups)| ForceField { kind, force_groups })
}

fn time_step() -> impl Strategy<Value = TimeStep> {
    prop_oneof![
        Just(TimeStep::hz(1)),
        Just(TimeStep::hz(10_000)),
        Just(TimeStep::hz(60)),
        Just(TimeStep::ratio(1001, 60_000)),
        Just(TimeStep::ratio(u32::MAX - 1, u32::MAX)),
        (any::<u32>(), any::<u32>()).prop_map(|(num, den)| TimeStep::ratio(num, den)),
    ]
}

fn integrator() -> impl Strategy<Value = Integrator> {
    (0usize..5).prop_map(|i| Integrator::ALL[i])
}

fn action() -> impl Strategy<Value = ForceOrImpulse> {
    prop_oneof![
        (edge_vector(), prop::option::of(edge_vector()))
            .prop_map(|(force, point)| ForceOrImpulse::Force { force, point }),
        edge().prop_map(ForceOrImpulse::Torque),
        (edge_vector(), prop::option::of(edge_vector()))
            .prop_map(|(impulse, point)| ForceOrImpulse::Impulse { impulse, point }),
        edge().prop_map(ForceOrImpulse::AngularImpulse),
    ]
}

fn options() -> impl Strategy<Value = ApplyOptions> {
    (any::<bool>(), any::<bool>())
        .prop_map(|(is_local, wake)| ApplyOptions { frame: if is_local { Frame::Body } else { Frame::World }, wake })
}

fn command() -> impl Strategy<Value = Command> {
    let field_id = || (0u32..4, 0u32..2).prop_map(|(slot, generation)| FieldId::from_parts(slot, generation));
    prop_oneof![
        6 => body_def().prop_map(Command::AddBody),
        1 => handle().prop_map(Command::RemoveBody),
        6 => (handle(), action(), options()).prop_map(|(body, action, options)| Command::Apply { body, action, options }),
        1 => Just(Command::ClearForces),
        1 => (handle(), edge_vector()).prop_map(|(body, position)| Command::SetPosition { body, position }),
        1 => (handle(), edge()).prop_map(|(body, angle)| Command::SetAngle { body, angle }),
        1 => (handle(), edge_vector()).prop_map(|(body, velocity)| Command::SetVelocity { body, velocity }),
        1 => (handle(), edge()).prop_map(|(body, velocity)| Command::SetAngularVelocity { body, velocity }),
        1 => (handle(), mass()).prop_map(|(body, mass)| Command::SetMass { body, mass }),
        1 => (handle(), ghost()).prop_map(|(body, def)| Command::AddCollider { body, def }),
        1 => (handle(), kind()).prop_map(|(body, kind)| Command::SetKind { body, kind }),
        1 => (handle(), edge()).prop_map(|(body, scale)| Command::SetGravityScale { body, scale }),
        1 => (handle(), damping(), damping())
            .prop_map(|(body, linear, angular)| Command::SetBodyDamping { body, linear, angular }),
        1 => (handle(), any::<u32>()).prop_map(|(body, force_groups)| Command::SetForceGroups { body, force_groups }),
        1 => (handle(), 0u64..3).prop_map(|(body, key)| Command::SetKey { body, key }),
        1 => (handle(), any::<u64>()).prop_map(|(body, user_data)| Command::SetUserData { body, user_data }),
        1 => handle().prop_map(Command::Wake),
        1 => handle().prop_map(Command::Sleep),
        1 => (handle(), locks()).prop_map(|(body, locks)| Command::SetLocks { body, locks }),
        1 => (handle(), most(), most())
            .prop_map(|(body, linear, angular)| Command::SetMaxSpeeds { body, linear, angular }),
        1 => handle().prop_map(Command::Disable),
        2 => handle().prop_map(Command::Enable),
        3 => (handle(), vector_within(POSITION), edge())
            .prop_map(|(body, position, angle)| Command::MoveTo { body, position, angle }),
        3 => handle().prop_map(Command::Release),
        8 => field().prop_map(Command::AddField),
        2 => (field_id(), field()).prop_map(|(id, field)| Command::SetField { id, field }),
        1 => field_id().prop_map(Command::RemoveField),
        1 => time_step().prop_map(Command::SetTimeStep),
        1 => edge_vector().prop_map(Command::SetGravity),
        2 => integrator().prop_map(Command::SetIntegrator),
        1 => (edge(), edge()).prop_map(|(linear, angular)| {
            let [linear, angular] = [linear, angular].map(Damping::kept_per_second);
            Command::SetDamping { linear, angular }
        }),
        1 => prop::option::of(0u32..4).prop_map(Command::SetSleepAfter),
    ]
}

/// Asserts the conditions that hold after every step, whatever came before.
fn check(world: &World) {
    for body in world.bodies() {
        let (x, v, spin) = (body.position_exact(), body.velocity_exact(), body.angular_velocity_exact());
        assert!(x.x.is_within(POSITION) && x.y.is_within(POSITION), "{} is at {}", body.id(), body.position());
        assert!(v.x.is_within(SPEED) && v.y.is_within(SPEED), "{} moves at {}", body.id(), body.velocity());
        assert!(spin.is_within(ANGULAR_SPEED), "{} spins at {}", body.id(), body.angular_velocity());
        let _ = (body.kinetic_energy(), body.momentum(), body.angular_momentum(), body.goal());
        for point in [Vec2::ZERO, Vec2::new(Fx::MAX, Fx::MIN), Vec2::new(Fx::MIN, Fx::MIN), body.position()] {
            let _ = (body.velocity_at(point), body.world_point(point), body.local_point(point));
            let _ = (body.world_vector(point), body.local_vector(point));
        }
        let _ = (body.rotation(), body.inertia(), body.applied_force(), body.applied_torque());
    }
    let _ = (world.energy(), world.momentum(), world.angular_momentum(), world.elapsed(), world.state_hash());
}

proptest! {
    #![proptest_config(cases(1_200))]

    #[test]
    fn no_world_within_the_bounds_panics_in_a_step(
        time_step in time_step(),
        integrator in integrator(),
        gravity in vector_within(GRAVITY),
        dampings in (positive(Fx::ONE), positive(Fx::ONE)),
        bodies in prop::collection::vec(body_def(), 1..5),
        fields in prop::collection::vec(field(), 0..6),
        pushes in prop::collection::vec((handle(), action()), 0..4),
    ) {
        let [linear_damping, angular_damping] = [dampings.0, dampings.1].map(Damping::kept_per_second);
        let own = WorldDef { sleep_after: Some(2), ..WorldDef::default() };
        let def = WorldDef { time_step, integrator, gravity, linear_damping, angular_damping, ..own };
        if let Ok(mut world) = World::new(def) {
            world.register_custom_force(Arc::new(Faulty)).unwrap();
            for body in bodies { let _ = world.add_body(body); }
            for field in fields { let _ = world.add_field(field); }
            for (body, action) in pushes {
                let _ = world.apply(body, action, ApplyOptions::default());
            }
            for _ in 0..4 {
                let faults = world.step().faults.to_vec();
                check(&world);
                // Released where they are, they are to be caught once more.
                faults.into_iter().for_each(|fault| world.release(fault.body).unwrap());
            }
        }
    }

    #[test]
    fn no_sequence_of_calls_panics_and_what_is_refused_changes_nothing(
        calls in prop::collection::vec(prop_oneof![6 => command().prop_map(Some), 1 => Just(None)], 1..60),
    ) {
        let mut world = world();
        world.register_custom_force(Arc::new(Faulty)).unwrap();
        for call in calls {
            match call {
                Some(command) => {
                    let before = world.state_hash();
                    if world.execute(&command).is_err() {
                        prop_assert_eq!(world.state_hash(), before, "{:?}", command);
                    }
                }
                None => drop(world.step().tick),
            }
            check(&world);
        }
    }
}

#[test]
fn a_step_goes_back_to_the_bit_or_not_at_all() {
    let reversible =
        prop_oneof![Just(Integrator::SymplecticEuler), Just(Integrator::VelocityVerlet), Just(Integrator::Yoshida4)];
    let still = (prop::collection::vec(body_def(), 1..5), prop::collection::vec(field(), 0..4), 0u32..8);
    let inputs = (prop::collection::vec((handle(), action()), 0..4), handle(), vector_within(POSITION));
    let strategy = (time_step(), reversible, vector_within(GRAVITY), still, inputs);
    let (undone, refused) = (Cell::new(0), Cell::new(0));
    let mut runner = TestRunner::new(cases(1_200));
    let result = runner.run(&strategy, |(time_step, integrator, gravity, (bodies, fields, rough), inputs)| {
        let def = WorldDef { time_step, integrator, gravity, sleep_after: None, ..WorldDef::default() };
        let Ok(mut world) = World::new(def) else { return Ok(()) };
        world.register_custom_force(Arc::new(Faulty)).unwrap();
        // Most without what has no way back, so that most steps have one.
        for body in bodies {
            let calm = BodyDef { linear_damping: None, angular_damping: None, ..body.clone() };
            let _ = world.add_body(if rough == 0 { body } else { calm });
        }
        for mut field in fields {
            match &mut field.kind {
                FieldKind::Drag { .. } if rough != 1 => continue,
                FieldKind::Spring { spring, .. } if rough != 2 => spring.damping = Fx::ZERO,
                _ => {}
            }
            let _ = world.add_field(field);
        }
        let (pushes, moved, place) = inputs;
        let there_and_back = |world: &mut World, applied: &[AppliedForce], before: Option<u64>| {
            let after = world.state_hash();
            if world.step_back(applied).is_ok() {
                undone.set(undone.get() + 1);
                check(world);
                prop_assert!(before.is_none_or(|before| world.state_hash() == before));
                prop_assert!(world.step().faults.is_empty());
            } else {
                refused.set(refused.get() + 1);
            }
            prop_assert_eq!(world.state_hash(), after);
            Ok(())
        };
        for _ in 0..3 {
            for (body, action) in &pushes {
                let _ = world.apply(*body, *action, ApplyOptions::default());
            }
            let before = world.state_hash();
            let mut traced = world.clone();
            let applied = world.step().applied.to_vec();
            traced.step_traced();
            prop_assert_eq!(traced.state_hash(), world.state_hash());
            prop_assert_eq!(traced.last_report(), world.last_report());
            there_and_back(&mut world, &applied, Some(before))?;
            // From where no step led.
            let mut elsewhere = world.clone();
            let _ = elsewhere.set_position(moved, place);
            there_and_back(&mut elsewhere, &applied, None)?;
        }
        Ok(())
    });
    result.unwrap();
    assert!(undone.get() > 1_000 && refused.get() > 1_000, "{} undone, {} not", undone.get(), refused.get());
}

#[test]
fn the_corners_of_the_envelope_are_stepped_through_without_a_panic() {
    let rates = [TimeStep::hz(1), TimeStep::hz(10_000), TimeStep::ratio(u32::MAX - 1, u32::MAX)];
    let mut faults = 0;
    for integrator in Integrator::ALL {
        for time_step in rates {
            for mass in [MASS_MIN, MASS_MAX] {
                for kept in [ULP, Fx::HALF, Fx::ONE - ULP, Fx::ONE] {
                    let def = WorldDef {
                        time_step,
                        integrator,
                        gravity: vec2(GRAVITY, -GRAVITY),
                        linear_damping: Damping::kept_per_second(kept),
                        angular_damping: Damping::kept_per_second(kept),
                        sleep_after: Some(1),
                        ..WorldDef::default()
                    };
                    let mut world = World::new(def).unwrap();
                    let corner = |x, y| BodyDef {
                        position: vec2(x, y),
                        mass: Mass::Explicit { mass, inertia: ULP },
                        ..BodyDef::dynamic()
                    };
                    let fast = |v: Fx, w: Fx| BodyDef {
                        velocity: vec2(v, -v),
                        angular_velocity: w,
                        gravity_scale: GRAVITY_SCALE,
                        ..corner(Fx::ZERO, Fx::ZERO)
                    };
                    let ids = [
                        corner(POSITION, POSITION),
                        corner(-POSITION, -POSITION),
                        fast(SPEED, ANGULAR_SPEED),
                        fast(-SPEED, -ANGULAR_SPEED),
                        corner(ULP, Fx::ZERO),
                    ]
                    .map(|def| world.add_body(def).unwrap());
                    let arm = |body, x| Attachment { body, point: vec2(x, -SIZE_MAX) };
                    let spring = SpringConstants { rest: POSITION, stiffness: Fx::MAX, damping: Fx::MAX };
                    for (a, b) in [(0, 1), (2, 3), (0, 4), (2, 4)] {
                        world
                            .add_field(FieldKind::Spring {
                                near: arm(ids[a], SIZE_MAX),
                                far: End::Body(arm(ids[b], -SIZE_MAX)),
                                spring,
                            })
                            .unwrap();
                    }
                    let mu = FxFactor::from_ratio(u64::MAX, 1);
                    world
                        .add_field(FieldKind::Attractor { centre: End::World(Vec2::ZERO), mu, softening: Fx::ZERO })
                        .unwrap();
                    world
                        .add_field(FieldKind::Drag { linear: Fx::MAX, quadratic: Fx::MAX, wind: vec2(SPEED, SPEED) })
                        .unwrap();
                    world
                        .add_field(FieldKind::Drag { linear: Fx::ZERO, quadratic: ULP, wind: vec2(-SPEED, SPEED) })
                        .unwrap();
                    world
                        .add_field(FieldKind::Thrust { at: arm(ids[3], SIZE_MAX), force: vec2(Fx::MAX, Fx::MIN) })
                        .unwrap();
                    for _ in 0..6 {
                        let out = world.step().faults.to_vec();
                        faults += out.len();
                        check(&world);
                        out.into_iter().for_each(|fault| world.release(fault.body).unwrap());
                    }
                }
            }
        }
    }
    assert!(faults > 1_000, "{faults} faults: these are no corners");
}

#[cfg(feature = "float")]
mod floats {
    use super::*;
    use umbra_physics::Geometry;

    #[test]
    fn nan_and_infinity_are_refused_wherever_they_enter() {
        let mut world = World::<f64>::with_scalar(WorldDef::default()).unwrap();
        let plain = BodyDef::dynamic().with_collider(Shape::new(Geometry::Circle { radius: 1.0 }).unwrap());
        let body = world.add_body(plain.clone()).unwrap();
        let rail = world.add_body(BodyDef::kinematic()).unwrap();
        let id = world.add_field(FieldKind::Drag { linear: 1.0, quadratic: 0.0, wind: Vec2::ZERO }).unwrap();
        let part = ColliderDef::new(Shape::new(Geometry::Circle { radius: 1.0 }).unwrap());
        let collider = world.add_collider(body, part.clone()).unwrap();
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for v in [Vec2::new(bad, 0.0), Vec2::new(0.0, bad)] {
                let at = Attachment { body, point: v };
                let set = |law: FieldKind<f64>| Command::SetField { id, field: law.into() };
                let spring = SpringConstants { rest: 1.0, stiffness: 1.0, damping: 1.0 };
                let near = Attachment { body, point: Vec2::ZERO };
                let origin = End::World(Vec2::ZERO);
                let disc = Region::Disc { centre: Vec2::ZERO, radius: 1.0 };
                let apply = |action| Command::Apply { body, action, options: ApplyOptions::default() };
                let made_of = |change: fn(&mut ColliderDef<f64>, Vec2<f64>)| {
                    let mut def = part.clone();
                    change(&mut def, v);
                    def
                };
                let settings = ContactSettings::default();
                let add = |change: fn(&mut BodyDef<f64>, Vec2<f64>)| {
                    let mut def = plain.clone();
                    change(&mut def, v);
                    Command::AddBody(def)
                };
                for command in [
                    add(|def, v| def.position = v),
                    add(|def, v| def.velocity = v),
                    add(|def, v| def.angle = v.x + v.y),
                    add(|def, v| def.angular_velocity = v.x + v.y),
                    add(|def, v| def.gravity_scale = v.x + v.y),
                    add(|def, v| def.linear_damping = Some(Damping::kept_per_second(v.x + v.y))),
                    add(|def, v| def.mass = Mass::Kilograms(v.x + v.y)),
                    Command::SetPosition { body, position: v },
                    Command::SetVelocity { body, velocity: v },
                    Command::SetAngle { body, angle: bad },
                    Command::SetAngularVelocity { body, velocity: bad },
                    Command::SetMass { body, mass: Mass::Kilograms(bad) },
                    Command::SetMass { body, mass: Mass::Explicit { mass: 1.0, inertia: bad } },
                    Command::SetGravityScale { body, scale: bad },
                    Command::SetBodyDamping { body, linear: Some(Damping::kept_per_second(bad)), angular: None },
                    Command::SetBodyDamping { body, linear: None, angular: Some(Damping::kept_per_second(bad)) },
                    Command::SetMaxSpeeds { body, linear: Some(bad), angular: None },
                    Command::SetMaxSpeeds { body, linear: None, angular: Some(bad) },
                    Command::MoveTo { body: rail, position: v, angle: 0.0 },
                    Command::MoveTo { body: rail, position: Vec2::ZERO, angle: bad },
                    add(|def, v| def.max_speed = Some(v.x + v.y)),
                    add(|def, v| def.max_angular_speed = Some(v.x + v.y)),
                    Command::SetGravity(v),
                    Command::SetDamping { linear: Damping::kept_per_second(bad), angular: Damping::NONE },
                    Command::SetDamping { linear: Damping::NONE, angular: Damping::kept_per_second(bad) },
                    apply(ForceOrImpulse::Force { force: v, point: None }),
                    apply(ForceOrImpulse::Force { force: Vec2::X, point: Some(v) }),
                    apply(ForceOrImpulse::Torque(bad)),
                    apply(ForceOrImpulse::Impulse { impulse: v, point: None }),
                    apply(ForceOrImpulse::Impulse { impulse: Vec2::X, point: Some(v) }),
                    apply(ForceOrImpulse::AngularImpulse(bad)),
                    set(FieldKind::Drag { linear: bad, quadratic: 0.0, wind: Vec2::ZERO }),
                    set(FieldKind::Drag { linear: 0.0, quadratic: bad, wind: Vec2::ZERO }),
                    set(FieldKind::Drag { linear: 0.0, quadratic: 0.0, wind: v }),
                    set(FieldKind::Thrust { at, force: Vec2::X }),
                    set(FieldKind::Thrust { at: near, force: v }),
                    set(FieldKind::Spring { near: at, far: origin, spring }),
                    set(FieldKind::Spring { near, far: End::World(v), spring }),
                    set(FieldKind::Spring { near, far: origin, spring: SpringConstants { rest: bad, ..spring } }),
                    set(FieldKind::Spring { near, far: origin, spring: SpringConstants { stiffness: bad, ..spring } }),
                    set(FieldKind::Spring { near, far: origin, spring: SpringConstants { damping: bad, ..spring } }),
                    set(FieldKind::Attractor { centre: End::World(v), mu: 1.0, softening: 0.0 }),
                    set(FieldKind::Attractor { centre: origin, mu: bad, softening: 0.0 }),
                    set(FieldKind::Attractor { centre: origin, mu: 1.0, softening: bad }),
                    set(FieldKind::Zone { region: Region::Disc { centre: v, radius: 1.0 }, acceleration: Vec2::X }),
                    set(FieldKind::Zone {
                        region: Region::Disc { centre: Vec2::ZERO, radius: bad },
                        acceleration: Vec2::X,
                    }),
                    set(FieldKind::Zone { region: Region::Box { min: v, max: Vec2::X }, acceleration: Vec2::X }),
                    set(FieldKind::Zone { region: Region::Box { min: Vec2::ZERO, max: v }, acceleration: Vec2::X }),
                    set(FieldKind::Zone { region: disc, acceleration: v }),
                    Command::AddCollider { body, def: made_of(|def, v| def.position = v) },
                    Command::AddCollider { body, def: made_of(|def, v| def.angle = v.x + v.y) },
                    Command::AddCollider { body, def: made_of(|def, v| def.density = v.x + v.y) },
                    Command::SetCollider { collider, def: made_of(|def, v| def.material.friction = v.x + v.y) },
                    Command::SetCollider { collider, def: made_of(|def, v| def.material.restitution = v.x + v.y) },
                    Command::SetContactSettings(ContactSettings { push_speed: bad, ..settings }),
                    Command::SetContactSettings(ContactSettings { restitution_speed: bad, ..settings }),
                ] {
                    let before = world.state_hash();
                    let refused = world.execute(&command);
                    assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{command:?}: {refused:?}");
                    assert_eq!(world.state_hash(), before, "{command:?}");
                }
                let (disc, rectangle) =
                    (Geometry::Circle { radius: bad }, Geometry::Rectangle { width: 1.0, height: bad });
                assert!(Shape::new(disc).is_err() && Shape::new(rectangle).is_err());
                let capsule = Geometry::Capsule { length: bad, radius: 1.0 };
                assert!(Shape::new(capsule).is_err() && Shape::segment(v, Vec2::ZERO).is_err());
                assert!(Shape::polygon(&[Vec2::ZERO, Vec2::X, v]).is_err());
            }
        }
    }

    #[test]
    fn a_float_body_that_leaves_the_envelope_is_quarantined_too() {
        for integrator in Integrator::ALL {
            let mut world = World::<f64>::with_scalar(WorldDef { integrator, ..WorldDef::default() }).unwrap();
            let body = world.add_body(BodyDef { mass: Mass::Kilograms(1.0 / 65_536.0), ..BodyDef::dynamic() }).unwrap();
            world.apply_force(body, Vec2::new(f64::MAX, 0.0)).unwrap();
            assert_eq!(world.step().faults.len(), 1, "{integrator:?}");
            assert_eq!(world.body(body).unwrap().position(), Vec2::ZERO);
        }
    }

    #[test]
    fn however_many_leave_at_once_all_are_quarantined() {
        for count in 1..=4 {
            let mut world = World::<f64>::with_scalar(WorldDef::default()).unwrap();
            for i in 0..8 {
                let y = if i < count { 1_073_741_823.0 } else { 0.0 };
                let (position, velocity) = (Vec2::new(0.0, y), Vec2::new(0.0, 1_000.0));
                world.add_body(BodyDef { position, velocity, ..BodyDef::dynamic() }).unwrap();
            }
            assert_eq!(world.step().faults.len(), count, "nobody pushed them");
        }
    }
}

/// Damping to 2^-32 of a velocity makes 2^11 times of it in the middle of a step of Yoshida's, which goes back in time there.
#[test]
fn damping_that_goes_too_far_back_takes_out_the_body_that_it_carries_away() {
    for damping in [None, Some(Damping::kept_per_second(fx!(0.5)))] {
        for at in [0, 1, 77, 199] {
            for (cause, fast) in [
                (Cause::Velocity, BodyDef { velocity: vec2(0, 1 << 19), ..BodyDef::dynamic() }),
                (Cause::AngularVelocity, BodyDef { angular_velocity: fx!(524_288), ..BodyDef::dynamic() }),
            ] {
                let mut world = World::new(WorldDef {
                    integrator: Integrator::Yoshida4,
                    time_step: TimeStep::hz(1),
                    linear_damping: Damping::kept_per_second(ULP),
                    angular_damping: Damping::kept_per_second(ULP),
                    ..WorldDef::default()
                })
                .expect("a world");
                let bodies: Vec<_> = (0..200)
                    .map(|i| {
                        let calm =
                            BodyDef { linear_damping: damping.filter(|_| i % 2 == at % 2), ..BodyDef::dynamic() };
                        let def = if i == at { fast.clone() } else { calm };
                        world.add_body(def).expect("there is room")
                    })
                    .collect();
                assert_eq!(world.step().faults, [Fault { body: bodies[at], cause }], "body {at}, {damping:?}");
            }
        }
    }
}

/// The faults of each of the next steps.
fn faults_of(world: &mut World, steps: u32) -> Vec<Vec<Fault>> {
    (0..steps).map(|_| world.step().faults.to_vec()).collect()
}

#[test]
fn a_body_that_leaves_is_caught_at_once_however_calm_its_block_was() {
    type Change = fn(&mut World, BodyId) -> Result<(), Error>;
    let changes: [(&str, Change); 9] = [
        ("velocity", |world, body| world.set_velocity(body, vec2(fx!(0), fx!(-1_048_575.999)))),
        ("impulse", |world, body| world.apply_impulse(body, vec2(fx!(0), fx!(-1_046_000)))),
        ("position", |world, body| world.set_position(body, vec2(fx!(0), fx!(-1_073_741_823)))),
        ("spin", |world, body| {
            world.set_angular_velocity(body, fx!(1_048_575.999))?;
            world.apply_torque(body, fx!(1))
        }),
        ("force", |world, body| world.apply_force(body, vec2(fx!(0), fx!(-2_147_000_000)))),
        ("gravity", |world, _| world.set_gravity(vec2(fx!(0), fx!(-65_536)))),
        ("gravity scale", |world, body| {
            world.set_velocity(body, vec2(0, -1_000_000))?;
            world.set_gravity_scale(body, fx!(16))
        }),
        ("a new one", |world, _| {
            let velocity = vec2(fx!(0), fx!(-1_048_575.999));
            world.add_body(BodyDef { velocity, ..BodyDef::dynamic() }).map(drop)
        }),
        ("kind", |world, body| {
            world.set_kind(body, BodyKind::Kinematic)?;
            world.set_velocity(body, vec2(fx!(0), fx!(-1_048_575.999)))?;
            world.set_kind(body, BodyKind::Dynamic)
        }),
    ];
    for (name, change) in changes {
        let def =
            WorldDef { gravity: vec2(0, -100), sleep_after: None, time_step: TimeStep::hz(2), ..WorldDef::default() };
        let mut world = World::new(def).expect("a world");
        let ids: Vec<BodyId> = (0..200)
            .map(|_| {
                let mass = Mass::Explicit { mass: fx!(1), inertia: fx!(1) };
                world.add_body(BodyDef { mass, ..BodyDef::dynamic() }).expect("a body")
            })
            .collect();
        // In the midst of a calm time, or at its end.
        for calm in [1, 7, 31, 32, 33, 40] {
            let mut kept = world.clone();
            assert!(faults_of(&mut kept, calm).concat().is_empty());
            change(&mut kept, ids[150]).expect("a fair change");
            // A copy keeps nothing of what is cached.
            let mut fresh = kept.clone();
            let faults = faults_of(&mut kept, 80);
            assert_eq!(faults, faults_of(&mut fresh, 80), "{name}, after {calm} steps");
            assert!(!faults.concat().is_empty(), "{name}, after {calm} steps: nobody left");
            assert_eq!(kept.state_hash(), fresh.state_hash(), "{name}, after {calm} steps");
        }
    }
}

#[test]
fn a_body_that_only_falls_is_caught_at_the_same_step_as_one_that_is_watched() {
    // 2,047 m/s a kick is still bounded; one more a second is not, and such a body is looked at in each step.
    for gravity in [fx!(-4_094), fx!(-4_097), fx!(-60_000)] {
        let def = WorldDef {
            gravity: Vec2::new(fx!(0), gravity),
            sleep_after: None,
            time_step: TimeStep::hz(1),
            ..WorldDef::default()
        };
        let mut world = World::new(def).expect("a world");
        let body = world.add_body(BodyDef::dynamic()).expect("a body");
        let last = SPEED.to_bits() / -gravity.to_bits();
        for tick in 1..=last + 1 {
            let faults = world.step().faults.to_vec();
            assert_eq!(faults.is_empty(), tick <= last, "{gravity}, tick {tick}: {faults:?}");
        }
        assert_eq!(world.body(body).expect("it is there").activity(), Activity::Quarantined);
    }
}

#[test]
fn queries_look_as_far_as_the_limit_and_no_farther() {
    let mut world = world();
    world.add_body(BodyDef::fixed().with_collider(Shape::circle(1).expect("a disc"))).expect("a disc");
    let (queries, all) = (world.queries(), QueryFilter::default());
    let ray = |from: Fx, translation: Fx| {
        queries.cast_ray(vec2(from, 0), vec2(translation, 0), &all).map(|hit| hit.map(|hit| hit.point))
    };
    for sign in [1, -1] {
        assert_eq!(ray((-QUERY - Fx::ONE) * sign, QUERY * sign), Ok(Some(vec2(-sign, 0))), "at the end of the ray");
        assert_eq!(ray((-QUERY - Fx::ONE - ULP) * sign, QUERY * sign), Ok(None), "beyond it");
        assert_eq!(ray(Fx::ZERO, (QUERY + ULP) * sign), out_of(Quantity::Query));
    }
    let is_within_reach = |from: Fx, reach: Fx| {
        queries.closest_point(vec2(from, 0), reach, &all).map(|is_within_reach| is_within_reach.is_some())
    };
    assert_eq!(
        (is_within_reach(QUERY + Fx::ONE, QUERY), is_within_reach(QUERY + Fx::ONE + ULP, QUERY)),
        (Ok(true), Ok(false))
    );
    assert_eq!(
        (is_within_reach(Fx::ZERO, QUERY + ULP), is_within_reach(Fx::ZERO, -ULP)),
        (out_of(Quantity::Query), out_of(Quantity::Query))
    );
}

#[test]
fn pairs_of_materials_and_of_bodies_are_limited() {
    let mut world = World::new(WorldDef::default()).expect("a world");
    let pairs = (1..).flat_map(|a: u32| (1..=a).map(move |b| (a, b)));
    let set = |world: &mut World, (a, b): (u32, u32)| world.set_material_pair(a, b, Some(MaterialPair::default()));
    for pair in pairs.clone().take(MATERIAL_PAIRS) {
        set(&mut world, pair).expect("there is room");
    }
    let beyond = pairs.clone().nth(MATERIAL_PAIRS).expect("one more");
    assert_eq!(set(&mut world, beyond), Err(Error::Full));
    set(&mut world, (1, 1)).expect("it is there");
    world.set_material_pair(1, 1, None).expect("it is there");
    set(&mut world, beyond).expect("there is room again");

    let bodies: Vec<BodyId> = (0..400).map(|_| world.add_body(BodyDef::dynamic()).expect("a body")).collect();
    let pairs = (1..bodies.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    let exclude =
        |world: &mut World, (a, b): (usize, usize)| world.exclude_pair(bodies[a], bodies[b], Exclusion::Always);
    for pair in pairs.clone().take(EXCLUDED_PAIRS) {
        exclude(&mut world, pair).expect("there is room");
    }
    let beyond = pairs.clone().nth(EXCLUDED_PAIRS).expect("one more");
    assert_eq!(exclude(&mut world, beyond), Err(Error::Full));
    exclude(&mut world, (1, 0)).expect("it is there");
    world.allow_pair(bodies[0], bodies[1]).expect("it is there");
    exclude(&mut world, beyond).expect("there is room again");
}
