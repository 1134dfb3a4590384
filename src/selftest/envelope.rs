//! Numbers near the ends of what is admitted.

use super::trial::{Flight, Played, Trial, add_all, exact, happened, near, near_wide, refused, same};
use crate::body::{Activity, BodyDef, Mass};
use crate::collider::ColliderDef;
use crate::error::{Cause, Error, Quantity};
use crate::force::{Attachment, End, FieldKind};
use crate::fx::{Fx, fx};
use crate::limits;
use crate::math::{TimeStep, Vec2, vec2};
use crate::scalar::{FxFactor, FxWide, SpringConstants};
use crate::shape::Shape;
use crate::world::{World, WorldDef};

pub(super) fn extreme_masses(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let (light, heavy) = (Mass::Kilograms(limits::MASS_MIN), Mass::Kilograms(limits::MASS_MAX));
    let (small, large) = (Shape::circle(limits::SIZE_MIN)?, Shape::rectangle(limits::SIZE_MAX, limits::SIZE_MAX)?);
    let ghost = |shape| BodyDef::dynamic().with_collider(ColliderDef::ghost(shape));
    let grain = BodyDef { mass: light, ..ghost(small) };
    let hulk = BodyDef { mass: heavy, position: vec2(0, 100), ..ghost(large) };
    let ids = add_all(&mut world, [grain.clone(), hulk.clone(), grain, hulk])?;
    // The grain's inertia is 2^-31 kg·m², the hulk's 2^24·2^25/12.
    let (push, torque) = (Fx::from_ratio(1, 1024), Fx::from_ratio(1, 1 << 26));
    let mut flight = Flight::new(fx!(0), fx!(0));
    for _ in 0..64 {
        world.apply_force(ids[0], Vec2::new(push, fx!(0)))?;
        world.apply_torque(ids[0], torque)?;
        world.apply_force(ids[1], vec2(1 << 24, 0))?;
        world.apply_torque(ids[1], fx!(1_000_000_000))?;
        trial.step(&mut world);
        // 2^-10 N on 2^-16 kg is 64 m/s²; 2^24 N on 2^24 kg is 1 m/s².
        flight.fly(fx!(64), 1);
        same("place of 15 mg", &world.body(ids[0])?.position().x.to_bits(), &flight.x)?;
    }
    same("velocities", &[ids[0], ids[1]].map(|id| world.body(id).map(|b| b.velocity().x)), &[Ok(fx!(64)), Ok(fx!(1))])?;
    same("spin of 15 mg", &world.body(ids[0])?.angular_velocity(), &fx!(32))?;
    let spin = Fx::from_ratio(12 * 1_000_000_000, 1 << 49);
    near("spin of 16,777 t", world.body(ids[1])?.angular_velocity().to_bits().into(), spin.to_bits().into(), 1)?;
    // A grain on a hulk by a spring: ω of the grain is 1/64 · 64 = 1/step, as stiff as a spring may be with room.
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(0.0625), damping: fx!(0) };
    let far = End::Body(Attachment { body: ids[3], point: vec2(0, -98) });
    world.add_field(FieldKind::Spring { near: Attachment::centre(ids[2]), far, spring })?;
    world.apply_impulse(ids[3], vec2(1 << 20, 0))?;
    let before = world.momentum()?;
    trial.steps(&mut world, 256);
    // An ulp of velocity is 2^-8 kg·m/s of the hulk.
    near_wide("momentum of a grain on a hulk", world.momentum()?.x, before.x, 2 << 56)?;
    happened("the grain is drawn along", world.body(ids[2])?.position().x > fx!(0.1))
}

pub(super) fn edge(trial: &mut Trial) -> Played {
    let mut world = World::new(exact())?;
    let (place, speed) = (limits::POSITION, limits::SPEED);
    let ulp = Fx::DELTA;
    let beyond = BodyDef { position: Vec2::new(place + ulp, fx!(0)), ..BodyDef::dynamic() };
    refused("a place beyond", world.add_body(beyond), Error::OutOfRange { quantity: Quantity::Position })?;
    let beyond = BodyDef { velocity: Vec2::new(fx!(0), -speed - ulp), ..BodyDef::dynamic() };
    refused("a speed beyond", world.add_body(beyond), Error::OutOfRange { quantity: Quantity::Velocity })?;
    let at = |x: Fx, y: Fx, vx: Fx, vy: Fx| BodyDef {
        position: Vec2::new(x, y),
        velocity: Vec2::new(vx, vy),
        ..BodyDef::dynamic()
    };
    let stays = world.add_body(at(place, -place, fx!(0), fx!(0)))?;
    let crosses = world.add_body(at(-place, place, speed, -speed))?;
    let creeps = world.add_body(at(place - ulp, fx!(0), Fx::from_bits(64), fx!(0)))?;
    let leaves = world.add_body(at(place, fx!(0), Fx::from_bits(64), fx!(0)))?;
    let hardly = world.add_body(at(place, fx!(0), Fx::from_bits(1), fx!(0)))?;
    trial.step(&mut world);
    // An ulp of place in a tick.
    let faults: alloc::vec::Vec<_> = world.last_report().faults.iter().map(|fault| (fault.body, fault.cause)).collect();
    same("who leaves at once", &faults, &alloc::vec![(leaves, Cause::Position), (hardly, Cause::Position)])?;
    same("one at the very edge", &world.body(creeps)?.position().x, &place)?;
    trial.step(&mut world);
    same("one that creeps out", &world.body(creeps)?.activity(), &Activity::Quarantined)?;
    trial.steps(&mut world, 510);
    same("one in the corner", &world.body(stays)?.position(), &Vec2::new(place, -place))?;
    // 512/64 s at 2^20 m/s.
    let way = speed * fx!(8);
    same("one that crosses", &world.body(crosses)?.position(), &Vec2::new(way - place, place - way))?;
    // The slowest and the fastest step there are.
    for step in [TimeStep::hz(1), TimeStep::hz(10_000)] {
        world.set_time_step(step)?;
        trial.steps(&mut world, 20);
    }
    let way = way + speed * fx!(20) + speed * fx!(0.002);
    let bound = Fx::DELTA.to_bits().unsigned_abs() << 20;
    // 0.002 is a number to an ulp, times 2^20.
    near(
        "one that crosses on",
        world.body(crosses)?.position().x.to_bits().into(),
        (way - place).to_bits().into(),
        bound.into(),
    )
}

pub(super) fn largest_numbers(trial: &mut Trial) -> Played {
    let gravity = limits::GRAVITY;
    let mut world = World::new(WorldDef { gravity: Vec2::new(-gravity, gravity), ..exact() })?;
    // 2^16·16 m/s² from −2^19 m/s: 2^14 m/s a tick.
    let start = Vec2::new(limits::SPEED, -limits::SPEED);
    let flies = BodyDef { gravity_scale: limits::GRAVITY_SCALE, velocity: start, ..BodyDef::dynamic() };
    let flies = world.add_body(flies)?;
    let heavy = BodyDef { mass: Mass::Kilograms(limits::MASS_MAX), gravity_scale: fx!(0), ..BodyDef::dynamic() };
    let pushed = world.add_body(BodyDef { position: vec2(0, 1 << 20), ..heavy.clone() })?;
    let drawn =
        world.add_body(BodyDef { position: Vec2::new(Fx::from_int(1 << 27), fx!(0)), force_groups: 2, ..heavy })?;
    // 2^64 m³/s² from 2^27 m away: 2^10 m/s².
    let mu = FxFactor::from_ratio(1 << 32, 1).times(FxFactor::from_ratio(1 << 32, 1));
    let kind = FieldKind::Attractor { centre: End::World(vec2(0, 0)), mu, softening: fx!(0) };
    world.add_field(crate::force::ForceField { kind, force_groups: 2 })?;
    let mut force = FxWide::default();
    for _ in 0..128 {
        for _ in 0..3 {
            world.apply_force(pushed, Vec2::new(Fx::MAX, Fx::MIN))?;
            force = force.plus(FxWide::from_scalar(Fx::MAX)).ok_or(Error::Full)?;
        }
        trial.step(&mut world);
    }
    happened("no fault", world.last_report().faults.is_empty())?;
    let body = world.body(flies)?;
    same("velocity under the strongest gravity", &body.velocity(), &-start)?;
    same("place under the strongest gravity", &body.position(), &vec2(0, 0))?;
    // 3·2^31 N on 2^24 kg for 2 s; the positive ones an ulp less each.
    let body = world.body(pushed)?;
    near("velocity under the largest forces", body.velocity().x.to_bits().into(), i128::from(fx!(768).to_bits()), 1)?;
    same("velocity under the largest forces", &body.velocity().y, &fx!(-768))?;
    // ½·2^10·2² m, and 2^-16 of it more as it comes nearer.
    let way = Fx::from_int(1 << 27) - world.body(drawn)?.position().x;
    near("way towards the strongest attractor", way.to_bits().into(), fx!(2048).to_bits().into(), 1 << 28)?;
    happened("forces that sum up beyond 2^31", force.to_scalar().is_none())
}
