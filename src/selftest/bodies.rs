//! Bodies: shapes, kinds, what is done to them, sleep and quarantine.

use alloc::vec::Vec;

use super::trial::{Played, Trial, add_all, bits, exact, happened, near_fx, near_vec, refused, same, same_body, there};
use crate::body::{Activity, BodyDef, BodyKind, Damping, Mass};
use crate::collider::ColliderDef;
use crate::error::{Cause, Error, Fault};
use crate::force::{Attachment, End, FieldKind};
use crate::fx::{Fx, fx};
use crate::limits;
use crate::math::{Vec2, vec2};
use crate::scalar::{FxFactor, SpringConstants};
use crate::shape::{Part, Shape};
use crate::slots::BodyId;
use crate::world::{ApplyOptions, ForceOrImpulse, Frame, World, WorldDef};

/// Shapes and their I/m, m².
fn turning_shapes() -> Result<Vec<(Shape, Fx)>, Error> {
    let square = [vec2(0, 0), vec2(3, 0), vec2(3, 4), vec2(0, 4)];
    let half = |x: Fx| -> Result<Part, Error> {
        // Turned by a quarter, each is 1.5 m wide and 4 m high.
        let shape = Shape::rectangle(fx!(4), fx!(1.5))?;
        Ok(Part { shape, position: Vec2::new(x, fx!(9)), angle: Fx::FRAC_PI_2, density: fx!(2) })
    };
    // With r = 1 m and l = 2 m: (16/3 + 3π/2) / (4 + π).
    let capsule = (Fx::from_ratio(16, 3) + fx!(1.5) * Fx::PI) / (fx!(4) + Fx::PI);
    let third = Fx::from_ratio(25, 12);
    Ok(alloc::vec![
        (Shape::circle(fx!(2))?, fx!(2)),
        (Shape::rectangle(fx!(3), fx!(4))?, third),
        (Shape::capsule(fx!(2), fx!(1))?, capsule),
        (Shape::polygon(&square)?, third),
        // A right triangle of 3 m by 4 m: (9 + 16)/18.
        (Shape::polygon(&[vec2(3, 0), vec2(0, 4), vec2(0, 0)])?, Fx::from_ratio(25, 18)),
        (Shape::segment(vec2(1, 1), vec2(4, 5))?, third),
        (Shape::compound(&[half(fx!(0))?, half(fx!(1.5))?])?, third),
    ])
}

pub(super) fn shapes(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let shapes = turning_shapes()?;
    let bodies = shapes.iter().map(|(shape, _)| BodyDef {
        mass: Mass::Kilograms(fx!(8)),
        ..BodyDef::dynamic().with_collider(ColliderDef::ghost(shape.clone()))
    });
    let ids = add_all(&mut world, bodies)?;
    let plain = world.add_body(BodyDef::dynamic())?;
    for _ in 0..128 {
        for &id in ids.iter().chain([&plain]) {
            world.apply_torque(id, fx!(16))?;
        }
        trial.step(&mut world);
    }
    for (&id, (_, gyration)) in ids.iter().zip(&shapes) {
        // 16 N·m for 2 s on 8 kg. The formulas round to an ulp or two.
        near_fx("angular velocity by shape", world.body(id)?.angular_velocity(), fx!(4) / *gyration, 8)?;
    }
    let (rectangle, polygon) = (world.body(ids[1])?, world.body(ids[3])?);
    same("a rectangle and its corners", &rectangle.angular_velocity_exact(), &polygon.angular_velocity_exact())?;
    same("one without a collider", &world.body(plain)?.angular_velocity(), &fx!(0))?;
    let shift = |i: usize| shapes[i].0.shift();
    same("centres of mass", &[shift(3), shift(5)], &[vec2(fx!(1.5), 2), vec2(fx!(2.5), 3)])?;
    near_vec("centre of mass of a compound", shift(6), vec2(fx!(0.75), 9), 0)?;
    // 12 m² at ¾ kg/m².
    let collider = there("a collider", world.colliders_of(ids[1])?.next())?;
    world.set_collider(collider, ColliderDef { density: fx!(0.75), ..world.collider(collider)?.clone() })?;
    world.set_mass(ids[1], Mass::FromColliders)?;
    same("mass by density", &world.body(ids[1])?.mass(), &Some(fx!(9)))?;
    trial.steps(&mut world, 64);
    Ok(())
}

pub(super) fn kinds(trial: &mut Trial) -> Played {
    let def = WorldDef { gravity: vec2(0, -8), linear_damping: Damping::kept_per_second(fx!(0.5)), ..exact() };
    let mut world = World::new(def)?;
    let fixed = world.add_body(BodyDef { position: vec2(1, 2), angle: fx!(1), ..BodyDef::fixed() })?;
    let carried =
        world.add_body(BodyDef { velocity: vec2(3, 1), angular_velocity: fx!(0.5), ..BodyDef::kinematic() })?;
    let falling = world.add_body(BodyDef {
        position: vec2(0, 100),
        linear_damping: Some(Damping::NONE),
        ..BodyDef::dynamic()
    })?;
    refused("a force on a static body", world.apply_force(fixed, vec2(1, 0)), Error::NotDynamic { body: fixed })?;
    refused(
        "a force on a kinematic body",
        world.apply_force(carried, vec2(1, 0)),
        Error::NotDynamic { body: carried },
    )?;
    refused("a velocity of a static body", world.set_velocity(fixed, vec2(1, 0)), Error::NotMovable { body: fixed })?;
    let start = bits(&world, fixed)?;
    trial.steps(&mut world, 128);
    same("a static body", &bits(&world, fixed)?, &start)?;
    let body = world.body(carried)?;
    same("a kinematic body", &(body.position(), body.velocity()), &(vec2(6, 2), vec2(3, 1)))?;
    near_fx("angle of a kinematic body", body.angle(), fx!(1), 1)?;
    same("a dynamic body", &world.body(falling)?.position(), &vec2(0, 84))?;
    // Each becomes the next.
    world.set_kind(fixed, BodyKind::Kinematic)?;
    world.set_velocity(fixed, vec2(-1, 0))?;
    world.set_kind(carried, BodyKind::Dynamic)?;
    world.set_body_damping(carried, Some(Damping::NONE), None)?;
    world.set_kind(falling, BodyKind::Static)?;
    trial.steps(&mut world, 64);
    same("from static to kinematic", &world.body(fixed)?.position(), &vec2(0, 2))?;
    same("from kinematic to dynamic", &world.body(carried)?.position(), &vec2(9, -1))?;
    let body = world.body(falling)?;
    same("from dynamic to static", &(body.position(), body.velocity()), &(vec2(0, 84), vec2(0, 0)))?;
    same("moving bodies", &world.moving_count(), &2)
}

/// Pushes a body that is not turned. The push of a tick is the same in both frames.
fn push(world: &mut World, id: BodyId, frame: Frame, tick: u32) -> Result<(), Error> {
    let options = ApplyOptions { frame, wake: true };
    let size = Fx::from_int(1 + (tick % 7) as i32);
    let force = Vec2::new(size, fx!(-0.25) * size);
    let arm = Vec2::new(fx!(0.5), Fx::from_ratio(i64::from(tick % 5) - 2, 4));
    let centre = world.body(id)?.position();
    let point = Some(if frame == Frame::World { centre + arm } else { arm });
    match tick % 4 {
        0 => world.apply(id, ForceOrImpulse::Force { force, point }, options),
        1 => world.apply(id, ForceOrImpulse::Impulse { impulse: force, point }, options),
        2 => world.apply(id, ForceOrImpulse::Torque(size), options),
        _ => world.apply(id, ForceOrImpulse::AngularImpulse(-size), options),
    }
}

pub(super) fn pushes(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let start = BodyDef { mass: Mass::Explicit { mass: fx!(2), inertia: fx!(0.5) }, ..BodyDef::dynamic() };
    let ids = add_all(&mut world, [start.clone(), start.clone()])?;
    let (mut momentum, mut spin) = (Vec2::ZERO, fx!(0));
    for tick in 0..280 {
        for (&id, frame) in ids.iter().zip([Frame::World, Frame::Body]) {
            // Turned back before each push, so that the two frames have the same axes.
            world.set_angle(id, fx!(0))?;
            push(&mut world, id, frame, tick)?;
            // And many small ones that cancel, in no order.
            for force in [vec2(5, 1), vec2(-2, 7), vec2(-3, -8)] {
                world.apply_force_at_point(id, force, vec2(100, 100))?;
                world.apply_torque(id, fx!(3))?;
            }
            world.apply_torque(id, fx!(-9))?;
        }
        let size = Fx::from_int(1 + (tick % 7) as i32);
        let force = Vec2::new(size, fx!(-0.25) * size);
        let arm = Vec2::new(fx!(0.5), Fx::from_ratio(i64::from(tick % 5) - 2, 4));
        let torque = arm.x * force.y - arm.y * force.x;
        let second = Fx::from_ratio(1, 64);
        match tick % 4 {
            0 => (momentum, spin) = (momentum + force.map(|c| c * second), spin + torque * second),
            1 => (momentum, spin) = (momentum + force, spin + torque),
            2 => spin += size * second,
            _ => spin -= size,
        }
        trial.step(&mut world);
        same_body("a push in the other frame", (&world, ids[1]), (&world, ids[0]))?;
        let body = world.body(ids[0])?;
        // All of it is a multiple of 2^-11: no push rounds.
        same("momentum of all pushes", &body.velocity().map(|v| v * fx!(2)), &momentum)?;
        same("angular momentum of all pushes", &(body.angular_velocity() * fx!(0.5)), &spin)?;
    }
    // Turned by what they like, the impulse in the body's frame goes where the body points.
    world.set_angle(ids[1], fx!(1))?;
    let before = world.body(ids[1])?.velocity();
    world.apply(ids[1], ForceOrImpulse::Impulse { impulse: vec2(8, 0), point: None }, ApplyOptions::BODY)?;
    let gained = world.body(ids[1])?.velocity() - before;
    near_vec("an impulse along a turned body", gained, Vec2::new(fx!(4) * fx!(1).cos(), fx!(4) * fx!(1).sin()), 4)?;
    trial.steps(&mut world, 20);
    Ok(())
}

pub(super) fn sleep(trial: &mut Trial) -> Played {
    let def = WorldDef {
        linear_damping: Damping::kept_per_second(fx!(0.0001)),
        angular_damping: Damping::kept_per_second(fx!(0.0001)),
        sleep_after: Some(10),
        ..WorldDef::default()
    };
    let (mut world, mut awake) = (World::new(def)?, World::new(WorldDef { sleep_after: None, ..def })?);
    // A loner, and two that a spring of 5 m joins, at rest.
    let bodies = [(vec2(50, 0), vec2(8, 3)), (vec2(0, 0), vec2(0, 0)), (vec2(3, 4), vec2(0, 0))];
    let mut ids = Vec::new();
    for world in [&mut world, &mut awake] {
        ids = add_all(world, bodies.map(|(position, velocity)| BodyDef { position, velocity, ..BodyDef::dynamic() }))?;
        let spring = SpringConstants { rest: fx!(5), stiffness: fx!(100), damping: fx!(1) };
        let far = End::Body(Attachment::centre(ids[2]));
        world.add_field(FieldKind::Spring { near: Attachment::centre(ids[1]), far, spring })?;
    }
    let loner = ids[0];
    let island = [ids[1], ids[2]];
    let mut slept = [0, 0];
    let run = |trial: &mut Trial, world: &mut World, awake: &mut World, slept: &mut [u32; 2]| -> Played {
        for _ in 0..240 {
            trial.step(world);
            awake.step();
            slept[0] += u32::from(world.last_report().fell_asleep.contains(&loner));
            slept[1] += u32::from(island.iter().all(|id| world.last_report().fell_asleep.contains(id)));
            for &id in &ids {
                same_body("a body that may sleep", (world, id), (awake, id))?;
            }
        }
        Ok(())
    };
    run(trial, &mut world, &mut awake, &mut slept)?;
    same("who fell asleep", &slept, &[1, 1])?;
    same("moving bodies", &world.moving_count(), &0)?;
    // Not felt; and nothing wakes.
    world.apply(
        loner,
        ForceOrImpulse::Force { force: vec2(9, 9), point: None },
        ApplyOptions { wake: false, frame: Frame::World },
    )?;
    world.apply(
        loner,
        ForceOrImpulse::Impulse { impulse: vec2(9, 9), point: None },
        ApplyOptions { wake: false, frame: Frame::Body },
    )?;
    run(trial, &mut world, &mut awake, &mut slept)?;
    same("moving bodies", &world.moving_count(), &0)?;
    // Gravity wakes all, and sends them to sleep when it goes.
    for gravity in [vec2(0, fx!(-0.5)), vec2(0, 0)] {
        world.set_gravity(gravity)?;
        awake.set_gravity(gravity)?;
        same("moving bodies", &world.moving_count(), &3)?;
        run(trial, &mut world, &mut awake, &mut slept)?;
    }
    same("who fell asleep", &slept, &[2, 2])?;
    // A blow wakes the loner alone, one on either end the whole island.
    for (target, woken) in [(loner, &[loner][..]), (island[1], &island)] {
        world.apply_impulse(target, vec2(1, 2))?;
        awake.apply_impulse(target, vec2(1, 2))?;
        trial.step(&mut world);
        awake.step();
        let mut woke = world.last_report().woke.to_vec();
        woke.sort_unstable();
        same("who woke", &&woke[..], &woken)?;
        run(trial, &mut world, &mut awake, &mut slept)?;
    }
    Ok(())
}

pub(super) fn quarantine(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(0, 8), ..exact() })?;
    let (place, speed, spin) = (limits::POSITION, limits::SPEED, limits::ANGULAR_SPEED);
    let unit = fx!(1);
    let start =
        BodyDef { mass: Mass::Explicit { mass: unit, inertia: unit }, gravity_scale: fx!(0), ..BodyDef::dynamic() };
    // 1/8 m/s a tick: 2^20 m/s after eight; a metre a tick: 2^30 m after eight; likewise rad/s.
    let faster =
        world.add_body(BodyDef { velocity: Vec2::new(fx!(0), speed - unit), gravity_scale: unit, ..start.clone() })?;
    let position = Vec2::new(place - fx!(8), fx!(5));
    let farther = world.add_body(BodyDef { position, velocity: vec2(64, 0), ..start.clone() })?;
    let quicker = world.add_body(BodyDef { angular_velocity: spin - unit, ..start.clone() })?;
    let pulled = world.add_body(BodyDef { position: vec2(0, 1), force_groups: 2, ..start })?;
    let mut last = Vec::new();
    for _ in 0..8 {
        world.apply_torque(quicker, fx!(8))?;
        trial.step(&mut world);
        happened("nothing wrong inside the envelope", world.last_report().faults.is_empty())?;
        last = [faster, farther, quicker, pulled].map(|id| bits(&world, id)).into_iter().collect::<Result<_, _>>()?;
    }
    same("the largest velocity", &world.body(faster)?.velocity().y, &speed)?;
    same("the farthest place", &world.body(farther)?.position().x, &place)?;
    same("the largest spin", &world.body(quicker)?.angular_velocity(), &spin)?;
    world.apply_torque(quicker, fx!(8))?;
    let mu = FxFactor::from_ratio(1 << 32, 1).times(FxFactor::from_ratio(1 << 32, 1));
    let kind = FieldKind::Attractor { centre: End::World(vec2(0, 0)), mu, softening: fx!(0) };
    let field = world.add_field(crate::force::ForceField { kind, force_groups: 2 })?;
    trial.step(&mut world);
    let causes = [Cause::Velocity, Cause::Position, Cause::AngularVelocity, Cause::Field { field }];
    let ids = [faster, farther, quicker, pulled];
    let expected: Vec<Fault> = ids.into_iter().zip(causes).map(|(body, cause)| Fault { body, cause }).collect();
    same("faults and their causes", &world.last_report().faults, &&expected[..])?;
    for (id, last) in ids.into_iter().zip(&last) {
        same("the last good state", &bits(&world, id)?, last)?;
        same("activity", &world.body(id)?.activity(), &Activity::Quarantined)?;
        refused("a push on one in quarantine", world.apply_force(id, vec2(1, 0)), Error::Quarantined { body: id })?;
    }
    trial.steps(&mut world, 20);
    for (id, last) in ids.into_iter().zip(&last) {
        same("the state in quarantine", &bits(&world, id)?, last)?;
    }
    world.remove_field(field)?;
    world.set_velocity(faster, vec2(0, 0))?;
    world.set_velocity(farther, vec2(-64, 0))?;
    world.set_angular_velocity(quicker, fx!(0))?;
    ids.into_iter().try_for_each(|id| world.release(id))?;
    refused("a release of one that is free", world.release(faster), Error::NotQuarantined { body: faster })?;
    trial.steps(&mut world, 64);
    happened("nothing wrong after the release", world.last_report().faults.is_empty())?;
    same("the way back", &world.body(farther)?.position().x, &(place - fx!(64)))?;
    same("the fall after the release", &world.body(faster)?.velocity().y, &fx!(8))?;
    there("all four are about", (world.moving_count() == 4).then_some(())).map(drop)
}
