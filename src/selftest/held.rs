//! Bodies that are held: locked, capped, disabled, moved to a goal.

use alloc::vec::Vec;

use super::trial::{Flight, Played, Trial, add_all, bits, exact, happened, near_fx, refused, same};
use crate::body::{Activity, BodyDef, BodyKind, Locks, Mass};
use crate::error::{Error, Quantity};
use crate::force::{Attachment, End, FieldKind};
use crate::fx::{Fx, fx};
use crate::integrate::Integrator;
use crate::limits;
use crate::math::{TimeStep, Vec2, vec2};
use crate::scalar::{FxAccumulator, SpringConstants, Turn};
use crate::world::{World, WorldDef};

fn along<T>(locked: bool, still: T, moved: T) -> T {
    if locked { still } else { moved }
}

pub(super) fn locks(trial: &mut Trial) -> Played {
    for integrator in [Integrator::VelocityVerlet, Integrator::Yoshida4, Integrator::PublishedVerlet] {
        let mut world = World::new(WorldDef { integrator, gravity: vec2(2, -8), ..exact() })?;
        let all = (0..8).map(|bits| Locks { x: bits & 1 > 0, y: bits & 2 > 0, rotation: bits & 4 > 0 });
        let all: Vec<Locks> = all.collect();
        let mass = Mass::Explicit { mass: fx!(2), inertia: fx!(4) };
        let defs = all.iter().map(|&locks| BodyDef { position: vec2(1, 3), mass, locks, ..BodyDef::dynamic() });
        let ids = add_all(&mut world, defs)?;
        let starts: Vec<_> = ids.iter().map(|&id| bits(&world, id)).collect::<Result<_, _>>()?;
        for tick in 0..96 {
            for &id in &ids {
                world.apply_force_at_point(id, vec2(tick % 4, 1), world.body(id)?.position() + vec2(0, 1))?;
                world.apply_impulse(id, vec2(fx!(0.25), fx!(-0.5)))?;
            }
            trial.step(&mut world);
        }
        let free = bits(&world, ids[0])?;
        let start = starts[0];
        happened("motion of the free one", free != start && free.3 != 0)?;
        for ((&id, locks), start) in ids.iter().zip(&all).zip(&starts) {
            let now = bits(&world, id)?;
            same("along x", &(now.0.x, now.1.x), &along(locks.x, (start.0.x, start.1.x), (free.0.x, free.1.x)))?;
            same("along y", &(now.0.y, now.1.y), &along(locks.y, (start.0.y, start.1.y), (free.0.y, free.1.y)))?;
            same("rotation", &(now.2, now.3), &along(locks.rotation, (start.2, start.3), (free.2, free.3)))?;
        }
        let why = Error::Locked { quantity: Quantity::Velocity };
        refused("a velocity along a lock", world.set_velocity(ids[1], vec2(1, 0)), why)?;
        world.set_locks(ids[7], Locks::NONE)?;
        trial.steps(&mut world, 16);
        happened("motion after the lock", bits(&world, ids[7])?.0 != starts[7].0)?;
    }
    Ok(())
}

pub(super) fn caps(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(6, -8), ..exact() })?;
    let capped = BodyDef {
        max_speed: Some(fx!(5)),
        max_angular_speed: Some(fx!(2)),
        mass: Mass::Explicit { mass: fx!(1), inertia: fx!(1) },
        ..BodyDef::dynamic()
    };
    let free = BodyDef { max_speed: None, max_angular_speed: None, ..capped.clone() };
    let kinematic = BodyDef { kind: BodyKind::Kinematic, ..capped.clone() };
    let limit = BodyDef {
        position: vec2(-(1 << 21), 0),
        velocity: Vec2::new(limits::SPEED, Fx::ZERO),
        max_speed: Some(limits::SPEED),
        ..capped.clone()
    };
    let ids = add_all(&mut world, [capped, free, kinematic, limit])?;
    world.set_velocity(ids[2], vec2(7, 0))?;
    let mut flight = Flight::new(fx!(0), fx!(0));
    for _ in 0..128 {
        for &id in &ids[..2] {
            world.apply_torque(id, fx!(-4))?;
        }
        trial.step(&mut world);
        flight.fly(fx!(6), 1);
    }
    let (slow, fast) = (world.body(ids[0])?, world.body(ids[1])?);
    same("the speed of the capped one", &(slow.velocity(), slow.angular_velocity()), &(vec2(3, -4), fx!(-2)))?;
    same("the way of the free one", &fast.position().x.to_bits(), &flight.x)?;
    same("the spin of the free one", &fast.angular_velocity(), &fx!(-8))?;
    same("a kinematic one", &world.body(ids[2])?.position(), &vec2(14, 0))?;
    // The limit of speeds is a cap like others: what is faster before is not at fault.
    let limit = world.body(ids[3])?;
    let speed = limit.velocity();
    same("one at the limit", &limit.activity(), &Activity::Awake)?;
    happened("speed to the right and down", speed.x > limits::SPEED - Fx::ONE && speed.y < fx!(-15))?;
    // From its cap it is struck, is fast for a step, and slow again.
    world.apply_impulse(ids[0], vec2(-64, 0))?;
    trial.step(&mut world);
    let speed = world.body(ids[0])?.velocity();
    near_fx("speed after a blow", speed.x * speed.x + speed.y * speed.y, fx!(25), 16)?;
    happened("a blow to the left", speed.x < fx!(-4))?;
    world.set_max_speeds(ids[0], None, None)?;
    trial.steps(&mut world, 48);
    happened("speed without a cap", world.body(ids[0])?.velocity().y < fx!(-5))
}

pub(super) fn disabled(trial: &mut Trial) -> Played {
    let mut world = World::new(WorldDef { gravity: vec2(0, -8), sleep_after: Some(8), ..exact() })?;
    let def = BodyDef { velocity: vec2(1, 2), angular_velocity: fx!(3), ..BodyDef::dynamic() };
    let ids = add_all(&mut world, [def.clone(), def.clone(), BodyDef { position: vec2(0, 9), ..def }])?;
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(16), damping: fx!(1) };
    world.disable(ids[0])?;
    let near = Attachment { body: ids[0], point: vec2(1, 0) };
    world.add_field(FieldKind::Spring { near, far: End::Body(Attachment::centre(ids[2])), spring })?;
    let still = bits(&world, ids[0])?;
    let mut flight = Flight::new(fx!(9), fx!(2));
    trial.steps(&mut world, 64);
    flight.fly(fx!(-8), 64);
    same("one that is out", &bits(&world, ids[0])?, &still)?;
    same("what is attached to it", &world.body(ids[2])?.position().y.to_bits(), &flight.x)?;
    same("activity", &world.body(ids[0])?.activity(), &Activity::Disabled)?;
    refused("a push on one that is out", world.apply_force(ids[0], vec2(1, 0)), Error::Disabled { body: ids[0] })?;
    refused("to enable one that is not", world.enable(ids[1]), Error::NotDisabled { body: ids[1] })?;
    // Back in, it begins where it was, and the spring pulls.
    world.enable(ids[0])?;
    let mut alone = Flight::new(fx!(0), fx!(2));
    trial.steps(&mut world, 64);
    [&mut flight, &mut alone].into_iter().for_each(|flight| flight.fly(fx!(-8), 64));
    happened("a pull on it", world.body(ids[0])?.position().y.to_bits() != alone.x)?;
    happened("a pull on the other", world.body(ids[2])?.position().y.to_bits() != flight.x)
}

pub(super) fn goals(trial: &mut Trial) -> Played {
    let steps = [TimeStep::hz(64), TimeStep::ratio(1001, 60_000), TimeStep::hz(50)];
    for integrator in Integrator::ALL {
        let mut world = World::new(WorldDef { integrator, ..exact() })?;
        let lift = world.add_body(BodyDef::kinematic())?;
        let load = world.add_body(BodyDef { position: vec2(0, 2), ..BodyDef::dynamic() })?;
        let spring = SpringConstants { rest: fx!(2), stiffness: fx!(32), damping: fx!(2) };
        let near = Attachment { body: load, point: vec2(fx!(0.5), 0) };
        world.add_field(FieldKind::Spring { near, far: End::Body(Attachment::centre(lift)), spring })?;
        let mut turned = false;
        for tick in 0..48i32 {
            world.set_time_step(steps[tick as usize % 3])?;
            let place = Vec2::new(Fx::from_ratio(tick.into(), 7), Fx::from_ratio(i64::from(tick % 5), 3));
            let angle = Fx::from_ratio(i64::from(tick) * 11, 10);
            world.move_to(lift, place, angle)?;
            trial.step(&mut world);
            let body = world.body(lift)?;
            let v = body.velocity();
            same("place", &body.position_exact(), &place.map(FxAccumulator::from_scalar))?;
            same("angle", &body.angle_exact(), &Turn::from_radians(angle))?;
            happened("a velocity", tick == 0 || v.x > fx!(6) && v.x < fx!(10))?;
            turned |= body.angular_velocity() < fx!(0);
        }
        // 1.1 rad a tick is the short way; from the last to the first turn as well.
        happened("no way back", !turned)?;
        let before = bits(&world, lift)?;
        trial.steps(&mut world, 8);
        let after = bits(&world, lift)?;
        same("where it stands", &(after.0, after.2), &(before.0, before.2))?;
        same("how it stands", &world.body(lift)?.velocity(), &Vec2::ZERO)?;
        refused("a dynamic body", world.move_to(load, Vec2::ZERO, fx!(0)), Error::NotKinematic { body: load })?;
        happened("a pull on the load", world.body(load)?.position().x > fx!(0.5))?;
    }
    Ok(())
}
