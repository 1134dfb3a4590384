//! Worlds whose bodies collide.

use alloc::vec::Vec;

use super::trial::{Numbers, Played, Trial, add_all, happened, near, near_fx, refused, same, same_body};
use crate::body::{BodyDef, BodyKind, Mass};
use crate::collider::{ColliderDef, ContactSettings, Filter, Material, MixRule};
use crate::contact::Contact;
use crate::error::{Cause, Error, Quantity};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::math::{TimeStep, Vec2, vec2};
use crate::replay::Snapshot;
use crate::scalar::FxWide;
use crate::shape::{Geometry, Part, Shape};
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
    let body = |i: u64| -> Result<BodyDef, Error> {
        let (friction, restitution) = (Fx::from_ratio((i % 4) as i64, 2), Fx::from_ratio((i % 3) as i64, 4));
        let material = Material { friction, restitution, ..Material::default() };
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
    (0..count).map(body).collect()
}

/// A pile of all shapes and its mirror image.
pub(super) fn piles(trial: &mut Trial) -> Played {
    let mut world = World::new(def())?;
    add_all(&mut world, [ground()?].into_iter().chain(falling(40)?))?;
    let mirror = |world: &World| Symmetry::MIRROR.world(world).ok_or(Error::Inconsistent);
    let mut image = mirror(&world)?;
    let mut max_contacts = 0;
    for _ in 0..300 {
        trial.step(&mut world);
        image.step();
        same("a pile and its mirror image", &mirror(&world)?.state_hash(), &image.state_hash())?;
        max_contacts = max_contacts.max(world.contacts().count());
    }
    happened("most touch something", max_contacts > 50)?;
    let lowest = world.bodies().filter(|body| body.kind() == BodyKind::Dynamic).map(|body| body.position().y).min();
    // A segment has no thickness.
    happened("nobody is deep in the ground", lowest.is_some_and(|y| y > fx!(-0.015625)))
}

/// Towers of light boxes under boxes of 10 to 1,000 times their mass, a heavy one that is thrown from one to the next, and a tower that lands
/// on a box of its own which dominates it; beside its mirror image.
pub(super) fn loads(trial: &mut Trial) -> Played {
    let mut world = World::new(def())?;
    let square = |mass: i32, position: Vec2, key: u64| -> Result<BodyDef, Error> {
        let shape = Shape::rectangle(fx!(1), fx!(1))?;
        let collider = ColliderDef { density: mass.into(), key, ..ColliderDef::new(shape) };
        Ok(BodyDef { position, key, ..BodyDef::dynamic().with_collider(collider) })
    };
    let mut bodies = [ground()?].to_vec();
    for (tower, load) in [10, 100, 1000].into_iter().enumerate() {
        let x = 6 * tower as i32 - 6;
        for (row, mass) in [1, 2, 1, load].into_iter().enumerate() {
            let height = fx!(0.5) + Fx::from(row as i32);
            bodies.push(square(mass, Vec2::new(x.into(), height), (10 * tower + row) as u64)?);
        }
    }
    bodies.push(BodyDef { velocity: vec2(5, 2), ..square(300, vec2(-12, 6), 99)? });
    for (row, mass) in [1, 1, 70].into_iter().enumerate() {
        let def = square(mass, Vec2::new(fx!(12), fx!(1.5) + Fx::from(row as i32)), 100 + row as u64)?;
        bodies.push(BodyDef { dominance: i32::from(row == 0), velocity: vec2(0, -4), ..def });
    }
    let ids = add_all(&mut world, bodies)?;
    let mirror = |world: &World| Symmetry::MIRROR.world(world).ok_or(Error::Inconsistent);
    let mut image = mirror(&world)?;
    let [mut deepest, mut landing] = [Fx::ZERO; 2];
    for _ in 0..240 {
        trial.step(&mut world);
        image.step();
        same("loads and their mirror image", &mirror(&world)?.state_hash(), &image.state_hash())?;
        for (deepest, tower) in [(&mut deepest, &ids[9..13]), (&mut landing, &ids[14..17])] {
            let of_tower = |contact: &Contact| contact.bodies.iter().all(|body| tower.contains(body));
            let points = world.contacts().filter(of_tower).flat_map(|contact| contact.points().to_vec());
            *deepest = points.fold(*deepest, |deepest, point| deepest.max(-point.separation));
        }
    }
    happened("a load lands on one that dominates it", landing > Fx::ZERO && landing < fx!(0.05))?;
    happened("and rests there", world.body(ids[16])?.position().y > fx!(2.495))?;
    happened("the heaviest one presses, and sinks in by less than 5 cm", deepest > fx!(0.01) && deepest < fx!(0.05))?;
    happened("it is still on top", world.body(ids[12])?.position().y > fx!(3.375))?;
    happened("the thrown one hits the first tower", world.body(ids[4])?.position().x > fx!(-5))
}

/// Crosses, angles and dumbbells, by number.
fn compound(number: u64) -> Result<Shape, Error> {
    let part = |shape: Shape, position: Vec2, angle: Fx, density: Fx| Part { shape, position, angle, density };
    let (bar, disc) = (Shape::rectangle(fx!(1), fx!(0.25))?, Shape::circle(fx!(0.25))?);
    let at = |x: Fx, y: Fx| Vec2::new(x, y);
    let parts = match number % 3 {
        0 => {
            let upright = Shape::rectangle(fx!(0.25), fx!(1))?;
            [part(bar, at(fx!(0), fx!(0)), fx!(0), fx!(1)), part(upright, at(fx!(0), fx!(0)), fx!(0), fx!(1))].to_vec()
        }
        1 => {
            let second = part(bar.clone(), at(fx!(0.375), fx!(0.5)), fx!(1.25), fx!(3));
            [part(bar, at(fx!(0), fx!(0)), fx!(0), fx!(1)), second].to_vec()
        }
        _ => {
            let ends = [fx!(-0.5), fx!(0.5)].map(|x| part(disc.clone(), at(x, fx!(0)), fx!(0), fx!(1)));
            [part(bar, at(fx!(0), fx!(0)), fx!(0), fx!(1))].into_iter().chain(ends).collect()
        }
    };
    Shape::compound(&parts)
}

/// A pile of compounds, its mirror image, and a twin whose bodies have a collider for each part.
pub(super) fn compounds(trial: &mut Trial) -> Played {
    let (mut world, mut twin) = (World::new(def())?, World::new(def())?);
    add_all(&mut world, [ground()?])?;
    add_all(&mut twin, [ground()?])?;
    let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) };
    let (mut single_ids, mut multiple_ids) = (Vec::new(), Vec::new());
    for (i, body) in (0..).zip(falling(30)?) {
        let shape = compound(i)?;
        let Geometry::Compound { parts } = shape.geometry() else { return Err(Error::Inconsistent.into()) };
        let definition = |part: &Part| ColliderDef {
            position: part.position,
            angle: part.angle,
            ..ColliderDef { shape: part.shape.clone(), ..body.colliders[0].clone() }
        };
        let colliders = parts.iter().map(definition).collect();
        let body = BodyDef { mass, ..body };
        multiple_ids.push(twin.add_body(BodyDef { colliders, ..body.clone() })?);
        let collider = ColliderDef { shape: shape.clone(), ..body.colliders[0].clone() };
        single_ids.push(world.add_body(BodyDef { colliders: [collider].to_vec(), ..body })?);
    }
    let mirror = |world: &World| Symmetry::MIRROR.world(world).ok_or(Error::Inconsistent);
    let mut image = mirror(&world)?;
    let mut max_contacts = 0;
    let mut parts = 0;
    for _ in 0..240 {
        trial.step(&mut world);
        twin.step();
        image.step();
        same("a pile of compounds and its mirror image", &mirror(&world)?.state_hash(), &image.state_hash())?;
        for (&id, &twin_id) in single_ids.iter().zip(&multiple_ids) {
            same_body("a compound and colliders in its place", (&world, id), (&twin, twin_id))?;
        }
        max_contacts = max_contacts.max(world.contacts().count());
        parts = parts.max(world.contacts().filter(|contact| contact.parts != [0, 0]).count());
    }
    happened("most touch something, with several parts", max_contacts > 40 && parts > 20)
}

/// The points of hills from right to left, between walls.
fn hills() -> Vec<Vec2> {
    let mut numbers = Numbers(31);
    let at = |x: Fx, y: Fx| Vec2::new(x, y);
    let ends = [at(fx!(26), fx!(20)), at(fx!(-26), fx!(20))];
    let points = (0..400).map(|i| at(fx!(25) - Fx::from_ratio(i, 8), numbers.fx(1) / 4));
    [ends[0]].into_iter().chain(points).chain([ends[1]]).collect()
}

/// A ball that rolls over the seams of a chain, beside one on a single segment; a crowd on hills, and its mirror image; a body in a
/// closed chain that nothing leaves.
pub(super) fn chains(trial: &mut Trial) -> Played {
    let (mut world, mut twin) = (World::new(def())?, World::new(def())?);
    let flat: Vec<Vec2> = (0..=800).map(|i| Vec2::new(fx!(100) - Fx::from_ratio(i, 4), Fx::ZERO)).collect();
    world.add_body(BodyDef::fixed().with_collider(Shape::chain(&flat, false)?))?;
    twin.add_body(BodyDef::fixed().with_collider(Shape::chain(&[flat[0], flat[800]], false)?))?;
    let ball = BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?);
    let ball = BodyDef { position: Vec2::new(fx!(-95), fx!(0.5)), velocity: vec2(24, 1), ..ball };
    let (ball_id, twin_id) = (world.add_body(ball.clone())?, twin.add_body(ball)?);
    let mut last = 0;
    let mut seams = 0;
    for _ in 0..400 {
        trial.step(&mut world);
        twin.step();
        same_body("a ball on a chain and on one segment", (&world, ball_id), (&twin, twin_id))?;
        if let Some(contact) = world.contacts().next() {
            seams += u32::from(contact.parts[0] != last);
            last = contact.parts[0];
        }
    }
    happened("the ball goes over seams", seams > 300)?;
    let mut world = World::new(def())?;
    world.add_body(BodyDef::fixed().with_collider(Shape::chain(&hills(), false)?))?;
    let room = [vec2(-40, 9), vec2(-32, 9), vec2(-32, 1), vec2(-40, 1)];
    world.add_body(BodyDef::fixed().with_collider(Shape::chain(&room, true)?))?;
    let disc = ColliderDef {
        material: Material { restitution: Fx::ONE, ..Material::default() },
        ..ColliderDef::new(Shape::circle(fx!(0.5))?)
    };
    let within = BodyDef { position: vec2(-36, 5), velocity: vec2(5, 3), ..BodyDef::dynamic().with_collider(disc) };
    let within = world.add_body(within)?;
    let crowd = add_all(
        &mut world,
        (0..)
            .zip(falling(30)?)
            .map(|(i, body)| BodyDef { position: Vec2::new(body.position.x * 5, fx!(2) + Fx::from(i % 6)), ..body }),
    )?;
    let mirror = |world: &World| Symmetry::MIRROR.world(world).ok_or(Error::Inconsistent);
    let mut image = mirror(&world)?;
    let mut long = 0;
    for _ in 0..240 {
        trial.step(&mut world);
        image.step();
        same("a crowd on hills and its mirror image", &mirror(&world)?.state_hash(), &image.state_hash())?;
        long += world.contacts().filter(|contact| contact.parts[0] > 255).count();
    }
    happened("bodies touch segments above 255", long > 100)?;
    for id in crowd {
        happened("nobody falls through", world.body(id)?.position().y > fx!(-0.5))?;
    }
    let place = world.body(within)?.position() - vec2(-36, 5);
    happened("what is in a room stays in it", place.x.abs() < fx!(3.6) && place.y.abs() < fx!(3.6))
}

/// The height of bounces, and speeds after impacts, against their closed forms; what touches nothing flies as if alone.
pub(super) fn impacts(trial: &mut Trial) -> Played {
    let disc = |restitution: Fx| -> Result<ColliderDef, Error> {
        let material = Material { friction: Fx::ZERO, restitution, ..Material::default() };
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
        let mut rises = false;
        let mut highest = Fx::ZERO;
        for tick in 0..100 {
            trial.step(&mut world);
            alone.step();
            let body = world.body(ball)?;
            rises |= body.velocity().y > Fx::ZERO;
            if rises {
                highest = highest.max(body.position().y - fx!(0.5));
            }
            if tick < 90 {
                let [body, twin] = [world.body(flies)?, alone.body(twin)?];
                same("a body that touches nothing", &body.position_exact(), &twin.position_exact())?;
            }
        }
        // 4 m · e². Integrators of order 1 fall at the wrong speed by a step of gravity.
        let bound = if integrator.order() > 1 { 5 << 22 } else { 1 << 30 };
        near_fx("the height of a bounce", highest, fx!(1), bound)?;
    }
    let mut world = World::new(WorldDef { gravity: vec2(0, 0), ..def() })?;
    let disc_at = |x: i32, v: i32, mass: i32| -> Result<BodyDef, Error> {
        let body = BodyDef::dynamic().with_collider(disc(fx!(1))?);
        Ok(BodyDef { position: vec2(x, 0), velocity: vec2(v, 0), mass: Mass::Kilograms(mass.into()), ..body })
    };
    let ids = add_all(&mut world, [disc_at(-2, 3, 1)?, disc_at(2, -1, 3)?])?;
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
            added.extend(change(world, &ids, lift, tick)?);
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
    let def = ColliderDef { density: fx!(-1), ..ColliderDef::new(shape(0)?) };
    let why = Error::OutOfRange { quantity: Quantity::ColliderDensity { value: fx!(-1) } };
    refused("a density below zero", world.add_collider(ids[1], def), why)?;
    same("a world that refused", &world.state_hash(), &before)
}

/// The changes of a tick.
fn change(world: &mut World, ids: &[BodyId], lift: BodyId, tick: u32) -> Result<Option<BodyId>, Error> {
    let up = if tick % 60 < 30 { fx!(0.03125) } else { fx!(-0.03125) };
    let position = world.body(lift)?.position() + vec2(0, up);
    world.move_to(lift, position, Fx::ZERO)?;
    let body = ids[1 + tick as usize % (ids.len() - 1)];
    let collider = world.colliders_of(body)?.next();
    match (tick % 8, collider) {
        (0, _) => world.add_collider(body, shape(u64::from(tick))?).map(|_| Some(body)),
        (2, Some(collider)) => world.remove_collider(collider).map(|()| Some(body)),
        (3, Some(collider)) => {
            let def = world.collider(collider)?.clone();
            let filter = Filter { category: 1 << (tick % 3), mask: !(1 << (tick % 5)), group: 0 };
            world.set_collider(collider, ColliderDef { filter, ..def }).map(|()| None)
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
            let [sleeper, twin] = [world.body(id)?, awake.body(id)?];
            let place =
                |body: crate::world::BodyRef<'_>| (body.position_exact(), body.velocity_exact(), body.angle_exact());
            same("one that slept and one that did not", &place(sleeper), &place(twin))?;
        }
    }
    happened("sleepers wake", woken >= 6)?;
    happened("a crowd is quarantined", crowded == 20)
}

/// Boxes on belts, with friction by each rule, speed up by μ·g; a belt and its mirror image run alike.
pub(super) fn belts(trial: &mut Trial) -> Played {
    // √(μ1·μ2), their mean, the smaller one, their product and the larger one of 0.25 and 1.
    let rules = [(MixRule::Standard, fx!(0.5)), (MixRule::GeometricMean, fx!(0.5)), (MixRule::Mean, fx!(0.625))];
    let rules = rules.into_iter().chain([
        (MixRule::Minimum, fx!(0.25)),
        (MixRule::Product, fx!(0.25)),
        (MixRule::Maximum, fx!(1)),
    ]);
    for (rule, friction) in rules {
        let surface = |friction, surface_speed| Material {
            friction,
            surface_speed,
            friction_rule: rule,
            restitution_rule: rule,
            ..Material::default()
        };
        let belt = |speed: Fx| -> Result<(World, BodyId), Error> {
            let mut ground = ground()?;
            ground.colliders[0].material = surface(fx!(0.25), -speed);
            let mut world = World::new(def())?;
            world.add_body(ground)?;
            let shape = ColliderDef {
                material: surface(fx!(1), Fx::ZERO),
                ..ColliderDef::new(Shape::rectangle(fx!(2), fx!(1))?)
            };
            let id =
                world.add_body(BodyDef { position: vec2(0, fx!(0.5)), ..BodyDef::dynamic().with_collider(shape) })?;
            Ok((world, id))
        };
        let ((mut right, id), (mut left, _)) = (belt(fx!(64))?, belt(fx!(-64))?);
        for _ in 0..60 {
            trial.step(&mut right);
            left.step();
        }
        let [body, image] = [right.body(id)?, left.body(id)?];
        same("a belt and its mirror image", &body.position_exact().x, &image.position_exact().x.negated())?;
        // 1 s, within 2^-8 m/s: the first step finds no pressure yet.
        near_fx("the speed of a box on a belt", body.velocity().x, friction * fx!(9.8125), 1 << 24)?;
    }
    Ok(())
}
