//! Any calls on any world.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use umbra_physics::scalar::Factor;
use umbra_physics::{
    Action, AppliedForce, Attachment, BodyDef, BodyId, BodyKind, Command, End, Field, FieldId, Frame, Fx, FxFactor, Integrator, Law,
    Made, Manner, Mass, Region, Shape, SpringLaw, TimeStep, Vec2, World, WorldDef,
};

/// A number: any bits, or one of a size that is likely to be admitted.
fn number(u: &mut Unstructured<'_>) -> Result<Fx> {
    let bits: i64 = u.arbitrary()?;
    Ok(Fx::from_bits(bits >> u.int_in_range(0..=63)?))
}

fn vector(u: &mut Unstructured<'_>) -> Result<Vec2> {
    Ok(Vec2::new(number(u)?, number(u)?))
}

/// Of damping; none at all as likely as another, as only then steps can be undone.
fn share(u: &mut Unstructured<'_>) -> Result<Fx> {
    Ok(if u.arbitrary()? { Fx::ONE } else { Fx::from_bits(u.int_in_range(0..=1 << 32)?) })
}

fn shape(u: &mut Unstructured<'_>) -> Result<Option<Shape>> {
    Ok(match u.int_in_range(0..=5)? {
        0 => Shape::circle(number(u)?.abs_or_max()).ok(),
        1 => Shape::rectangle(number(u)?, number(u)?).ok(),
        2 => Shape::capsule(number(u)?, number(u)?).ok(),
        3 => Shape::segment(vector(u)?, vector(u)?).ok(),
        4 => Shape::polygon(&[vector(u)?, vector(u)?, vector(u)?, vector(u)?]).ok(),
        _ => None,
    })
}

trait AbsOrMax {
    fn abs_or_max(self) -> Self;
}

impl AbsOrMax for Fx {
    fn abs_or_max(self) -> Self {
        self.checked_abs().unwrap_or(Self::MAX)
    }
}

fn mass(u: &mut Unstructured<'_>) -> Result<Mass> {
    Ok(match u.int_in_range(0..=2)? {
        0 => Mass::Density(number(u)?),
        1 => Mass::Of(number(u)?),
        _ => Mass::WithInertia(number(u)?, number(u)?),
    })
}

fn kind(u: &mut Unstructured<'_>) -> Result<BodyKind> {
    Ok(*u.choose(&[BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static])?)
}

fn definition(u: &mut Unstructured<'_>) -> Result<BodyDef> {
    Ok(BodyDef {
        kind: kind(u)?,
        position: vector(u)?,
        angle: number(u)?,
        velocity: vector(u)?,
        angular_velocity: number(u)?,
        shape: shape(u)?,
        mass: mass(u)?,
        gravity_scale: number(u)?,
        linear_damping: if u.arbitrary()? { Some(share(u)?) } else { None },
        angular_damping: if u.arbitrary()? { Some(share(u)?) } else { None },
        groups: u.arbitrary()?,
        key: u.arbitrary()?,
        user_data: u.arbitrary()?,
    })
}

fn field(u: &mut Unstructured<'_>, bodies: &[BodyId]) -> Result<Field> {
    let body = |u: &mut Unstructured<'_>| {
        let body = if bodies.is_empty() { BodyId::from_parts(0, 0) } else { *u.choose(bodies)? };
        Ok(Attachment { body, point: vector(u)? })
    };
    let end = |u: &mut Unstructured<'_>| Ok(if u.arbitrary()? { End::World(vector(u)?) } else { End::Body(body(u)?) });
    let law = match u.int_in_range(0..=4)? {
        0 => {
            let mu = <FxFactor as Factor<Fx>>::from_scalar(number(u)?);
            Law::Attractor { centre: end(u)?, mu, softening: number(u)? }
        }
        1 => {
            let spring = SpringLaw { rest: number(u)?, stiffness: number(u)?, damping: number(u)? };
            Law::Spring { near: body(u)?, far: end(u)?, spring }
        }
        2 => Law::Drag { linear: number(u)?, quadratic: number(u)?, wind: vector(u)? },
        3 => Law::Thrust { at: body(u)?, force: vector(u)? },
        _ => {
            let region = if u.arbitrary()? {
                Region::Disc { centre: vector(u)?, radius: number(u)? }
            } else {
                Region::Box { min: vector(u)?, max: vector(u)? }
            };
            Law::Zone { region, acceleration: vector(u)? }
        }
    };
    Ok(Field { law, groups: u.arbitrary()? })
}

fn command(u: &mut Unstructured<'_>, bodies: &[BodyId], fields: &[FieldId]) -> Result<Command> {
    let body = if bodies.is_empty() { BodyId::from_parts(u.arbitrary()?, 0) } else { *u.choose(bodies)? };
    let id = if fields.is_empty() { FieldId::from_parts(u.arbitrary()?, 0) } else { *u.choose(fields)? };
    Ok(match u.int_in_range(0..=26)? {
        0 | 1 => Command::AddBody(definition(u)?),
        2 => Command::RemoveBody(body),
        3 | 4 => {
            let point = if u.arbitrary()? { Some(vector(u)?) } else { None };
            let action = match u.int_in_range(0..=3)? {
                0 => Action::Force { force: vector(u)?, point },
                1 => Action::Torque(number(u)?),
                2 => Action::Impulse { impulse: vector(u)?, point },
                _ => Action::AngularImpulse(number(u)?),
            };
            let frame = if u.arbitrary()? { Frame::World } else { Frame::Body };
            Command::Apply { body, action, manner: Manner { frame, wake: u.arbitrary()? } }
        }
        5 => Command::SetPosition { body, position: vector(u)? },
        6 => Command::SetAngle { body, angle: number(u)? },
        7 => Command::SetVelocity { body, velocity: vector(u)? },
        8 => Command::SetAngularVelocity { body, velocity: number(u)? },
        9 => Command::SetMass { body, mass: mass(u)? },
        10 => Command::SetShape { body, shape: shape(u)? },
        11 => Command::SetKind { body, kind: kind(u)? },
        12 => Command::SetGravityScale { body, scale: number(u)? },
        13 => Command::SetBodyDamping { body, linear: Some(share(u)?), angular: None },
        14 => Command::Release(body),
        15 | 16 => Command::AddField(field(u, bodies)?),
        17 => Command::SetIntegrator(*u.choose(&Integrator::ALL)?),
        18 => Command::SetTimeStep(TimeStep::ratio(u.int_in_range(1..=1001)?, u.int_in_range(1..=60_000)?)),
        19 => Command::SetGravity(vector(u)?),
        20 => Command::RemoveField(id),
        21 => Command::SetField { id, field: field(u, bodies)? },
        22 => Command::SetGroups { body, groups: u.arbitrary()? },
        23 => Command::SetDamping { linear: share(u)?, angular: share(u)? },
        24 => Command::ClearForces,
        25 => Command::SetSleepAfter(*u.choose(&[None, Some(1), Some(3)])?),
        _ => Command::Wake(body),
    })
}

struct Play(World, Vec<Command>, Vec<u8>);

impl std::fmt::Debug for Play {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Play").field(&self.0).field(&self.1).finish()
    }
}

impl<'a> Arbitrary<'a> for Play {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let def = WorldDef {
            time_step: TimeStep::hz(*u.choose(&[1, 50, 60, 64, 10_000])?),
            integrator: *u.choose(&Integrator::ALL)?,
            linear_damping: share(u)?,
            angular_damping: share(u)?,
            sleep_after: *u.choose(&[None, Some(1), Some(3)])?,
            ..WorldDef::default()
        };
        let world = World::new(def).or_else(|_| World::new(WorldDef::default()));
        let mut world = world.map_err(|_| arbitrary::Error::IncorrectFormat)?;
        // Commands name bodies that exist by then, so they are made by carrying them out on a trial world.
        let start = world.clone();
        let (mut bodies, mut fields) = (Vec::new(), Vec::new());
        let (mut commands, mut steps) = (Vec::new(), Vec::new());
        while !u.is_empty() && commands.len() < 64 {
            let command = command(u, &bodies, &fields)?;
            match world.execute(&command) {
                Ok(Made::Body(body)) => bodies.push(body),
                Ok(Made::Field(field)) => fields.push(field),
                _ => {}
            }
            commands.push(command);
            steps.push(u.int_in_range(0..=3)?);
        }
        Ok(Self(start, commands, steps))
    }
}

/// The same world, its bodies taken through the step stage by stage, for a field that acts on nobody; all awake.
fn stage_by_stage(world: &World) -> Option<World> {
    let mut world = world.clone();
    let region = Region::Disc { centre: Vec2::ZERO, radius: Fx::ONE };
    world.add_field(Field { law: Law::Zone { region, acceleration: Vec2::X }, groups: 0 }).ok()?;
    Some(world)
}

/// What a step does to the bodies. Which of them sleep is left out: it changes no bit of the rest.
fn assert_moved_alike(a: &World, b: &World) {
    for (a, b) in a.bodies().zip(b.bodies()) {
        assert_eq!(a.position_exact(), b.position_exact());
        assert_eq!(a.velocity_exact(), b.velocity_exact());
        assert_eq!(a.angle_exact(), b.angle_exact());
        assert_eq!(a.angular_velocity_exact(), b.angular_velocity_exact());
    }
    let (a, b) = (a.last_report(), b.last_report());
    assert_eq!((a.faults, a.drag_outside), (b.faults, b.drag_outside));
}

/// A step that is undone leads to the state before it, and on to the one after it; one that cannot be undone changes nothing.
fn assert_there_and_back(world: &mut World, before: u64, applied: &[AppliedForce]) {
    let after = world.state_hash();
    if world.step_back(applied).is_ok() {
        assert_eq!(world.state_hash(), before);
        world.step();
    }
    assert_eq!(world.state_hash(), after);
}

fuzz_target!(|play: Play| {
    let Play(mut world, commands, steps) = play;
    for (command, steps) in commands.iter().zip(steps) {
        let before = world.state_hash();
        if world.execute(command).is_err() {
            assert_eq!(world.state_hash(), before, "a refused call changed the world: {command:?}");
        }
        let mut twin = world.clone();
        let mut staged = stage_by_stage(&world).expect("there is room for a field");
        for _ in 0..steps {
            let before = world.state_hash();
            let applied = world.step().applied.to_vec();
            twin.step_traced();
            staged.step();
            assert_moved_alike(&world, &staged);
            assert_there_and_back(&mut world, before, &applied);
        }
        assert_eq!(world.state_hash(), twin.state_hash());
    }
    let _ = (world.energy(), world.momentum(), world.angular_momentum());
});
