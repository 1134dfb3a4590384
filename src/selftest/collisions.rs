//! Worlds whose bodies collide.

use alloc::vec::Vec;

use super::trial::{Numbers, Played, Trial, add_all, happened, near, near_fx, refused, same};
use crate::body::{BodyDef, BodyKind, Mass};
use crate::collider::{ColliderDef, ContactSettings, Filter, Material};
use crate::error::{Cause, Error, Quantity};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{TimeStep, Vec2, vec2};
use crate::replay::Snapshot;
use crate::scalar::FxWide;
use crate::shape::Shape;
use crate::slots::BodyId;
use crate::symmetry::Symmetry;
use crate::world::{World, WorldDef};

fn def() -> WorldDef {
    WorldDef { gravity: vec2(0, fx!(-9.8125)), sleep_after: None, ..WorldDef::default() }
}

fn ground() -> Result<BodyDef, Error> {
    let ground = BodyDef::fixed().with_collider(Shape::rectangle(fx!(64), fx!(2))?);
    Ok(BodyDef { position: vec2(0, -1), key: u64::MAX, ..ground })
}

/// A shape of each kind, by number.
fn shape(number: u64) -> Result<Shape, Error> {
    match number % 5 {
        0 => Shape::rectangle(fx!(0.75), fx!(0.5)),
        1 => Shape::circle(fx!(0.3125)),
        2 => Shape::capsule(fx!(0.5), fx!(0.25)),
        3 => Shape::polygon(&[vec2(fx!(-0.5), 0), vec2(fx!(0.5), 0), vec2(fx!(0.25), fx!(0.625))]),
        _ => Shape::segment(vec2(fx!(-0.5), 0), vec2(fx!(0.5), fx!(0.125))),
    }
}

/// Bodies of all shapes in the air, with different materials.
fn falling(count: u64) -> Result<Vec<BodyDef>, Error> {
    let mut numbers = Numbers(17);
    let one = |i: u64| -> Result<BodyDef, Error> {
        let material =
            Material { friction: Fx::from_ratio((i % 4) as i64, 2), restitution: Fx::from_ratio((i % 3) as i64, 4) };
        let collider = ColliderDef { material, key: i, density: fx!(2), ..ColliderDef::new(shape(i)?) };
        Ok(BodyDef {
            position: vec2(numbers.fx(2), fx!(1) + fx!(0.5) * Fx::from(i as i32)),
            angle: numbers.fx(1),
            velocity: numbers.vec(1),
            angular_velocity: numbers.fx(2),
            key: i,
            ..BodyDef::dynamic().with_collider(collider)
        })
    };
    (0..count).map(one).collect()
}

/// A pile of all shapes and its mirror image.
pub(super) fn piles(trial: &mut Trial) -> Played {
    let mut world = World::new(def())?;
    add_all(&mut world, [ground()?].into_iter().chain(falling(40)?))?;
    let mirror = |world: &World| Symmetry::MIRROR.world(world).ok_or(Error::Inconsistent);
    let mut image = mirror(&world)?;
    let mut most = 0;
    for _ in 0..300 {
        trial.step(&mut world);
        image.step();
        same("a pile and its mirror image", &mirror(&world)?.state_hash(), &image.state_hash())?;
        most = most.max(world.contacts().count());
    }
    happened("most touch something", most > 50)?;
    let lowest = world.bodies().filter(|body| body.kind() == BodyKind::Dynamic).map(|body| body.position().y).min();
    // A segment has no thickness.
    happened("nobody is deep in the ground", lowest.is_some_and(|y| y > fx!(-0.015625)))
}

/// The height of bounces, and speeds after impacts, against their closed forms; what touches nothing flies as if alone.
pub(super) fn impacts(trial: &mut Trial) -> Played {
    let disc = |restitution: Fx| -> Result<ColliderDef, Error> {
        let material = Material { friction: Fx::ZERO, restitution };
        Ok(ColliderDef { material, ..ColliderDef::new(Shape::circle(fx!(0.5))?) })
    };
    for integrator in Integrator::ALL {
        let mut world = World::new(WorldDef { integrator, ..def() })?;
        world.add_body(ground()?)?;
        let ball = world
            .add_body(BodyDef { position: vec2(0, fx!(4.5)), ..BodyDef::dynamic().with_collider(disc(fx!(0.5))?) })?;
        let free = BodyDef { position: vec2(9, fx!(4.5)), velocity: vec2(1, 9), ..BodyDef::dynamic() };
        let flies = world.add_body(free.clone().with_collider(disc(fx!(0))?))?;
        let mut alone = World::new(WorldDef { integrator, ..def() })?;
        let twin = alone.add_body(BodyDef { mass: Mass::Kilograms(fx!(2)), ..free })?;
        let (mut rises, mut highest) = (false, Fx::ZERO);
        for tick in 0..100 {
            trial.step(&mut world);
            alone.step();
            let body = world.body(ball)?;
            rises |= body.velocity().y > Fx::ZERO;
            if rises {
                highest = highest.max(body.position().y - fx!(0.5));
            }
            if tick < 90 {
                let [here, there] = [world.body(flies)?, alone.body(twin)?];
                same("a body that touches nothing", &here.position_exact(), &there.position_exact())?;
            }
        }
        // 4 m · e². Integrators of order 1 fall at the wrong speed by a step of gravity.
        let bound = if integrator.order() > 1 { 5 << 22 } else { 1 << 30 };
        near_fx("the height of a bounce", highest, fx!(1), bound)?;
    }
    let mut world = World::new(WorldDef { gravity: vec2(0, 0), ..def() })?;
    let of = |x: i32, v: i32, mass: i32| -> Result<BodyDef, Error> {
        let body = BodyDef::dynamic().with_collider(disc(fx!(1))?);
        Ok(BodyDef { position: vec2(x, 0), velocity: vec2(v, 0), mass: Mass::Kilograms(mass.into()), ..body })
    };
    let ids = add_all(&mut world, [of(-2, 3, 1)?, of(2, -1, 3)?])?;
    trial.steps(&mut world, 120);
    // (m1 − m2)·u1 + 2·m2·u2 and (m2 − m1)·u2 + 2·m1·u1, over m1 + m2.
    near_fx("the lighter one", world.body(ids[0])?.velocity().x, fx!(-3), 1 << 16)?;
    near_fx("the heavier one", world.body(ids[1])?.velocity().x, fx!(1), 1 << 16)
}

/// A cloud of bodies of all shapes and of masses 1 and 3 that falls together, without gravity: momentum stays.
pub(super) fn cloud(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(0, 0), ..def() })?;
    for (i, body) in (0..).zip(falling(60)?) {
        let position = Vec2::new(body.position.x, body.position.y - fx!(16));
        // Towards the middle, at the distance in a second.
        let velocity = Vec2::new(-position.x, -position.y);
        let mass = Mass::Kilograms(if i % 2 == 0 { fx!(1) } else { fx!(3) });
        world.add_body(BodyDef { position, velocity, mass, ..body })?;
    }
    let before = world.momentum()?;
    let mut touches = 0;
    for _ in 0..200 {
        trial.step(&mut world);
        touches += world.contacts().count();
    }
    happened("bodies meet", touches > 150)?;
    let after = world.momentum()?;
    // Public velocities are rounded to half an ulp: of 2 kg on the average, 2^-32 kg·m/s each.
    let bound = 60 << 33;
    near("momentum along x", FxWide::to_bits(after.x), before.x.to_bits(), bound)?;
    near("momentum along y", after.y.to_bits(), before.y.to_bits(), bound)
}

/// Colliders, filters, kinds, materials and settings change while bodies touch; a twin is restored from bytes now and then.
pub(super) fn changing_colliders(trial: &mut Trial) -> Played {
    let mut world = World::new(def())?;
    let ids = add_all(&mut world, [ground()?].into_iter().chain(falling(24)?))?;
    let lift = BodyDef {
        position: vec2(0, fx!(0.5)),
        ..BodyDef::kinematic().with_collider(Shape::rectangle(fx!(3), fx!(0.25))?)
    };
    let lift = world.add_body(lift)?;
    let mut twin = world.clone();
    let mut added = Vec::new();
    for tick in 0..240u32 {
        for world in [&mut world, &mut twin] {
            added.extend(change(world, (&ids, lift), tick)?);
        }
        trial.step(&mut world);
        twin.step();
        if tick % 7 == 0 {
            twin =
                Snapshot::from_bytes(&twin.snapshot().to_bytes(), &[]).map_err(|_| Error::Inconsistent)?.into_world();
        }
        same("a world and one that was restored", &world.state_hash(), &twin.state_hash())?;
    }
    happened("colliders came and went", added.len() > 40)?;
    let before = world.state_hash();
    let nothing = Filter { mask: 0, ..Filter::default() };
    let def = ColliderDef { filter: nothing, ..ColliderDef::new(shape(0)?) };
    let why = Error::OutOfRange { quantity: Quantity::Filter };
    refused("a filter of nothing", world.add_collider(ids[1], def), why)?;
    same("a world that refused", &world.state_hash(), &before)
}

/// The changes of a tick.
fn change(world: &mut World, (ids, lift): (&[BodyId], BodyId), tick: u32) -> Result<Option<BodyId>, Error> {
    let up = if tick % 60 < 30 { fx!(0.03125) } else { fx!(-0.03125) };
    let position = world.body(lift)?.position() + vec2(0, up);
    world.move_to(lift, position, Fx::ZERO)?;
    let body = ids[1 + tick as usize % (ids.len() - 1)];
    let own = world.colliders_of(body)?.next();
    match (tick % 8, own) {
        (0, _) => world.add_collider(body, shape(u64::from(tick))?).map(|_| Some(body)),
        (2, Some(own)) => world.remove_collider(own).map(|()| Some(body)),
        (3, Some(own)) => {
            let def = world.collider(own)?.clone();
            let filter = Filter { category: 1 << (tick % 3), mask: !(1 << (tick % 5)), group: 0 };
            world.set_collider(own, ColliderDef { filter, ..def }).map(|()| None)
        }
        (4, _) => {
            let kind = if world.body(body)?.kind() == BodyKind::Dynamic { BodyKind::Static } else { BodyKind::Dynamic };
            world.set_kind(body, kind).map(|()| None)
        }
        (5, _) if tick % 40 == 5 => world.set_time_step(TimeStep::hz(60 + tick % 50)).map(|()| None),
        (6, _) if tick % 40 == 6 => world
            .set_contact_settings(ContactSettings { substeps: 4 + tick % 3, ..world.def().contacts })
            .map(|()| None),
        (7, _) => world.set_position(body, vec2(0, 8)).map(|()| None),
        _ => Ok(None),
    }
}

/// Bodies asleep in the way of others, woken by touch; a crowd beyond the allowed number of pairs; no bit depends on who slept.
pub(super) fn touched(trial: &mut Trial) -> Played {
    let contacts = ContactSettings { max_pairs: 64, max_pairs_per_collider: 8, ..ContactSettings::default() };
    let still = WorldDef { gravity: vec2(0, 0), contacts, ..def() };
    let (mut world, mut awake) = (World::new(WorldDef { sleep_after: Some(8), ..still })?, World::new(still)?);
    let disc = |x: Fx, y: i32, v: i32| -> Result<BodyDef, Error> {
        let body = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?);
        Ok(BodyDef { position: vec2(x, y), velocity: vec2(v, 0), ..body })
    };
    let row: Vec<BodyDef> = (0..6).map(|x| disc(x.into(), 0, 0)).collect::<Result<_, _>>()?;
    let crowd: Vec<BodyDef> = (0..20).map(|_| disc(fx!(40), 9, 0)).collect::<Result<_, _>>()?;
    let all: Vec<BodyDef> = row.into_iter().chain([disc(fx!(-5.75), 0, 4)?]).chain(crowd).collect();
    let ids = add_all(&mut world, all.clone())?;
    add_all(&mut awake, all)?;
    let (mut woken, mut crowded) = (0, 0);
    for _ in 0..200 {
        trial.step(&mut world);
        awake.step();
        woken += world.last_report().woke.len();
        crowded += world.last_report().faults.iter().filter(|fault| fault.cause == Cause::Pairs).count();
        for &id in &ids {
            let [here, there] = [world.body(id)?, awake.body(id)?];
            let place =
                |body: crate::world::BodyRef<'_>| (body.position_exact(), body.velocity_exact(), body.angle_exact());
            same("one that slept and one that did not", &place(here), &place(there))?;
        }
    }
    happened("sleepers wake", woken >= 6)?;
    happened("a crowd is quarantined", crowded == 20)
}
