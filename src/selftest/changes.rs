//! Worlds that change on the way: handles used again, setters, copies.

use alloc::collections::VecDeque;

use super::Problem;
use super::trial::{Numbers, Played, Trial, add_all, exact, happened, refused, same, same_body, there};
use crate::body::{BodyDef, BodyKind, Damping, Mass};
use crate::collider::ColliderDef;
use crate::error::Error;
use crate::force::{Attachment, End, FieldKind, ForceField, Region};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{TimeStep, Vec2, vec2};
use crate::scalar::{FxFactor, SpringConstants};
use crate::shape::Shape;
use crate::slots::{BodyId, FieldId};
use crate::world::{ApplyOptions, Command, Created, Explosion, ForceOrImpulse, World, WorldDef};

pub(super) fn recycling(trial: &mut Trial) -> Played {
    let def = WorldDef {
        gravity: vec2(fx!(0.1), fx!(-9.81)),
        linear_damping: Damping::kept_per_second(fx!(0.9)),
        ..WorldDef::default()
    };
    let (mut world, mut alone) = (World::new(def)?, World::new(def)?);
    let mut numbers = Numbers(2);
    let mut bystanders: VecDeque<(BodyId, FieldId)> = VecDeque::new();
    let mut stay = alloc::vec::Vec::new();
    let (mut most_body, mut most_field) = (0, 0);
    for tick in 0..300 {
        let velocity = numbers.vec(6);
        let bystander = world.add_body(BodyDef { velocity, ..BodyDef::dynamic() })?;
        let thrust = world.add_field(FieldKind::Thrust { at: Attachment::centre(bystander), force: numbers.vec(4) })?;
        bystanders.push_back((bystander, thrust));
        (most_body, most_field) = (most_body.max(bystander.parts().1), most_field.max(thrust.parts().1));
        if tick % 60 == 0 {
            let def = BodyDef { velocity, angular_velocity: fx!(0.3), ..BodyDef::dynamic() };
            stay.push((world.add_body(def.clone())?, alone.add_body(def)?));
        }
        if bystanders.len() > 5 {
            let (old, field) = there("a bystander", bystanders.pop_front())?;
            world.remove_body(old)?;
            refused("a body that is gone", world.set_velocity(old, vec2(0, 0)), Error::NoSuchBody { body: old })?;
            refused("a field that went with it", world.field(field).copied(), Error::NoSuchField { field })?;
        }
        trial.step(&mut world);
        alone.step();
        for &(body, twin) in &stay {
            same_body("one that stays", (&world, body), (&alone, twin))?;
        }
    }
    same("bodies", &(world.body_count(), alone.body_count()), &(10, 5))?;
    happened("slots used again", most_body > 20 && most_field > 20)
}

/// The body and fields that the commands below lead to, made at once; all that is moving apart.
fn as_it_became() -> Result<(WorldDef, BodyDef, [ForceField; 2]), Error> {
    let def = WorldDef {
        time_step: TimeStep::ratio(1001, 60_000),
        gravity: vec2(1, -3),
        integrator: Integrator::Yoshida4,
        linear_damping: Damping::kept_per_second(fx!(0.75)),
        angular_damping: Damping::kept_per_second(fx!(0.5)),
        sleep_after: None,
        ..WorldDef::default()
    };
    let capsule = ColliderDef { density: fx!(3), ..ColliderDef::ghost(Shape::capsule(fx!(2), fx!(0.5))?) };
    let body = BodyDef {
        position: vec2(4, -2),
        angle: fx!(0.7),
        velocity: vec2(-3, 5),
        angular_velocity: fx!(1.25),
        gravity_scale: fx!(-0.5),
        linear_damping: Some(Damping::kept_per_second(fx!(0.9))),
        angular_damping: Some(Damping::kept_per_second(fx!(0.6))),
        bullet: true,
        force_groups: 6,
        key: 11,
        user_data: 12,
        ..BodyDef::dynamic().with_collider(capsule)
    };
    let region = Region::Disc { centre: vec2(0, 0), radius: fx!(1000) };
    let zone = ForceField { kind: FieldKind::Zone { region, acceleration: vec2(0, 2) }, force_groups: 4 };
    let attractor =
        FieldKind::Attractor { centre: End::World(vec2(1, 1)), mu: FxFactor::from_ratio(30, 1), softening: fx!(0.5) };
    Ok((def, body, [zone, attractor.into()]))
}

fn made_body(created: Created) -> Result<BodyId, Problem> {
    let body = if let Created::Body(body) = created { Some(body) } else { None };
    there("a body made by a command", body)
}

fn made_field(created: Created) -> Result<FieldId, Problem> {
    let field = if let Created::ForceField(field) = created { Some(field) } else { None };
    there("a field made by a command", field)
}

pub(super) fn setters(trial: &mut Trial) -> Played {
    let (def, like, [zone, attractor]) = as_it_became()?;
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..exact() })?;
    let start = BodyDef { velocity: vec2(9, 9), ..BodyDef::kinematic().with_collider(Shape::circle(fx!(1))?) };
    let body = made_body(world.execute(&Command::AddBody(start))?)?;
    let collider = there("a collider", world.colliders_of(body)?.next())?;
    let target = made_body(world.execute(&Command::AddBody(BodyDef::dynamic()))?)?;
    let id = made_field(world.execute(&Command::AddField(
        FieldKind::Thrust { at: Attachment::centre(target), force: vec2(1, 1) }.into(),
    ))?)?;
    let last = made_field(world.execute(&Command::AddField(attractor))?)?;
    trial.steps(&mut world, 40);
    let shots = [
        ForceOrImpulse::Force { force: vec2(1, 2), point: Some(vec2(1, 0)) },
        ForceOrImpulse::Torque(fx!(1)),
        ForceOrImpulse::Impulse { impulse: vec2(1, 2), point: None },
        ForceOrImpulse::AngularImpulse(fx!(1)),
    ];
    for action in shots {
        world.execute(&Command::Apply { body: target, action, options: ApplyOptions::BODY })?;
    }
    // Out at once, and back.
    world.execute(&Command::SetPosition { body: target, position: Vec2::new(crate::limits::POSITION, fx!(0)) })?;
    world.execute(&Command::SetVelocity { body: target, velocity: vec2(1000, 0) })?;
    trial.step(&mut world);
    world.execute(&Command::Release(target))?;
    let commands = [
        Command::Disable(target),
        Command::Enable(target),
        Command::SetLocks { body, locks: like.locks },
        Command::SetKind { body, kind: BodyKind::Kinematic },
        Command::MoveTo { body, position: like.position, angle: like.angle },
        Command::SetMaxSpeeds { body, linear: like.max_speed, angular: like.max_angular_speed },
        Command::SetKind { body, kind: BodyKind::Dynamic },
        Command::SetCollider { collider, def: like.colliders[0].clone() },
        Command::SetMass { body, mass: like.mass },
        Command::SetPosition { body, position: like.position },
        Command::SetAngle { body, angle: like.angle },
        Command::SetVelocity { body, velocity: like.velocity },
        Command::SetAngularVelocity { body, velocity: like.angular_velocity },
        Command::SetGravityScale { body, scale: like.gravity_scale },
        Command::SetBodyDamping { body, linear: like.linear_damping, angular: like.angular_damping },
        Command::SetBullet { body, bullet: like.bullet },
        Command::Explode(Explosion { falloff: fx!(40), ..Explosion::new(like.position, fx!(0.5)) }),
        Command::SetForceGroups { body, force_groups: like.force_groups },
        Command::SetKey { body, key: like.key },
        Command::SetUserData { body, user_data: like.user_data },
        Command::SetField { id, field: zone },
        Command::SetTimeStep(def.time_step),
        Command::SetGravity(def.gravity),
        Command::SetIntegrator(def.integrator),
        Command::SetDamping { linear: def.linear_damping, angular: def.angular_damping },
        Command::SetSleepAfter(def.sleep_after),
        Command::Wake(body),
        Command::RemoveField(last),
        Command::RemoveBody(target),
    ];
    for command in &commands {
        same("what a setter makes", &world.execute(command)?, &Created::Nothing)?;
    }
    world.add_field(attractor)?;
    let mut anew = World::new(def)?;
    let copy = anew.add_body(like)?;
    anew.add_field(zone)?;
    anew.add_field(attractor)?;
    same("the definition", world.def(), &def)?;
    for _ in 0..200 {
        trial.step(&mut world);
        anew.step();
        same_body("a body that became so", (&world, body), (&anew, copy))?;
    }
    let body = world.body(body)?;
    same("what the caller gave it", &(body.force_groups(), body.key(), body.user_data()), &(6, 11, 12))?;
    happened("one body is left", world.body_count() == 1)
}

/// Some of everything: a swarm around an attractor that a body carries, in wind, with a pair on a spring.
fn busy() -> Result<(World, alloc::vec::Vec<BodyId>), Error> {
    let def =
        WorldDef { gravity: vec2(0, -1), linear_damping: Damping::kept_per_second(fx!(0.95)), ..WorldDef::default() };
    let mut world = World::new(def)?;
    let mut numbers = Numbers(3);
    let swarm = (0..12).map(|i| BodyDef {
        position: numbers.vec(5),
        velocity: numbers.vec(3),
        angular_velocity: numbers.fx(2),
        mass: Mass::Explicit { mass: Fx::from_int(1 + i), inertia: fx!(2) },
        force_groups: if i < 6 { 1 } else { 2 },
        ..BodyDef::dynamic()
    });
    let ids = add_all(&mut world, swarm)?;
    let centre = End::Body(Attachment::centre(ids[0]));
    let pull = FieldKind::Attractor { centre, mu: FxFactor::from_ratio(50, 1), softening: fx!(1) };
    world.add_field(ForceField { kind: pull, force_groups: 1 })?;
    world.add_field(ForceField {
        kind: FieldKind::Drag { linear: fx!(0.1), quadratic: fx!(0.01), wind: vec2(1, 0) },
        force_groups: 2,
    })?;
    let spring = SpringConstants { rest: fx!(3), stiffness: fx!(20), damping: fx!(0.2) };
    let near = Attachment { body: ids[7], point: vec2(fx!(0.5), 0) };
    world.add_field(FieldKind::Spring { near, far: End::Body(Attachment::centre(ids[8])), spring })?;
    Ok((world, ids))
}

/// Inputs of the players at a tick.
fn inputs(world: &mut World, ids: &[BodyId], tick: u32) -> Result<(), Error> {
    let id = ids[tick as usize * 5 % ids.len()];
    world.apply_force(id, Vec2::new(Fx::from_int(tick as i32 % 9), fx!(2)))?;
    if tick % 16 == 0 { world.apply_impulse(id, vec2(-1, 3)) } else { Ok(()) }
}

pub(super) fn going_back(trial: &mut Trial) -> Played {
    let (mut world, ids) = busy()?;
    let (mut rolled_back, _) = busy()?;
    let mut saved = world.clone();
    let mut last = 0;
    for tick in 0..240 {
        if tick % 8 == 0 && tick > 0 {
            // Eight ticks again from the copy, with the same inputs, in this world's memory and in another's.
            let now = world.state_hash();
            rolled_back.clone_from(&saved);
            world.clone_from(&saved);
            for again in last..tick {
                for world in [&mut world, &mut rolled_back] {
                    inputs(world, &ids, again)?;
                    world.step();
                }
            }
            same("the state after going back", &[world.state_hash(), rolled_back.state_hash()], &[now, now])?;
            saved.clone_from(&world);
            last = tick;
        }
        inputs(&mut world, &ids, tick)?;
        trial.step(&mut world);
    }
    // With an input less it is another future.
    rolled_back.clone_from(&saved);
    (last..240).for_each(|_| _ = rolled_back.step());
    happened("inputs that matter", rolled_back.state_hash() != world.state_hash())
}

pub(super) fn looking_ahead(trial: &mut Trial) -> Played {
    let (mut world, ids) = busy()?;
    for tick in 0..60 {
        inputs(&mut world, &ids, tick)?;
        trial.step(&mut world);
    }
    let mut ahead = ids.iter().map(|&id| world.preview(id)).collect::<Result<alloc::vec::Vec<_>, _>>()?;
    for _ in 0..120 {
        trial.step(&mut world);
        for (preview, &id) in ahead.iter_mut().zip(&ids) {
            preview.step();
            same_body("a preview", (preview.world(), preview.id()), (&world, id))?;
        }
    }
    let companies: alloc::vec::Vec<usize> = ahead.iter().map(|preview| preview.world().body_count()).collect();
    // The centre alone, five around it with it, the pair together, the rest alone.
    same("the size of outlooks", &&companies[..], &&[1, 2, 2, 2, 2, 2, 1, 2, 2, 1, 1, 1][..])
}
